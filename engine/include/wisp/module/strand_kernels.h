/// Arguments of the kernels of strands (kernels.h).
#pragma once

#include "wisp/module/random.h"
#include "wisp/module/shapes.h"

WISP_BEGIN_C

/// Strand data is lane-interleaved: a group holds sixteen strands, one strand per lane and one vertex index per
/// row.
#define WISP_LANES 16

/// Arguments of the jitter of segment lengths and directions along strands (Kim 2026, eq. 2-7). Works in place,
/// from root to tip.
typedef struct wisp_strand_jitter_args
{
    const int32_t* group_row;   ///< [group_count + 1] first row of each group
    const int32_t* lane_strand; ///< [group_count][16] index of the strand, seeds its random numbers
    const float* rest;          ///< [row][3][16] m, rest shape, which gives the rest lengths
    float* position;            ///< [row][3][16] m, base shape in, deformed shape out
    const float* stretch;       ///< [group_count][16] stretching stiffness k_s > 0
    const float* bend;          ///< [group_count][16] bending stiffness k_b > 0
    wisp_random_key length_key, angle_key, axis_key;
    float angle_max; ///< rad, maximum angle, reached at stiffness 1
    int dimension;   ///< 2: a straight strand bends about the z axis; 3: about a random perpendicular
    bool in_plane;   ///< a straight strand bends along x and y, whatever its z
} wisp_strand_jitter_args;

/// Arguments of the rotation of whole strands about their roots towards a target (Kim 2026, eq. 8-13). Works in
/// place.
typedef struct wisp_strand_align_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    const int32_t* lane_count; ///< [group_count][16] vertices of the strand, 0 in an empty lane
    float* position;           ///< [row][3][16] m
    const float* intensity;    ///< [group_count][16] weight x at the root, in [0, 1]
    wisp_vec3 target;          ///< m
    float radius;              ///< m, strands outside keep their bits; below 0: all are outside
    bool nearest;              ///< a strand is inside if any vertex is within radius, not only the tip
    int dimension;             ///< 2: a strand that points away from the target turns about the z axis
    bool in_plane;             ///< turn about the z axis, by directions and distances without z: z keeps its bits

    /// [group_count][4][16] vector from root to target, in m, and intensity, of the last turn of each strand; 0: none. Strands
    /// outside the radius turn by it, those inside replace it. Null: strands outside do not turn.
    float* swept;
    const float *rest,
        *moved;    ///< [row][3][16] m: `swept` belongs to the shape `rest` and turns along to `moved`; or null
    float turn[4]; ///< quaternion x y z w: how the moved shape is turned as a whole
} wisp_strand_align_args;

/// Arguments of the copy from lanes to strands one after the other, in the user's order.
typedef struct wisp_strand_unpack_args
{
    const int32_t* group_row;   ///< [group_count + 1] first row of each group
    const int32_t* lane_strand; ///< [group_count][16] index of the strand
    const int32_t* lane_count;  ///< [group_count][16] vertices of the strand, 0 in an empty lane
    const int32_t* offsets;     ///< [strand_count + 1] first vertex of each strand, in the user's order
    const float* position;      ///< [row][3][16] m
    float* points;              ///< [vertex_count][3] m
} wisp_strand_unpack_args;

/// Arguments of the check that positions and velocities of strand vertices are finite and bounded.
typedef struct wisp_strand_bound_args
{
    const float* position; ///< [row][3][16] m
    const float* velocity; ///< [row][3][16] m/s
    float bound;           ///< maximum magnitude of each component, checked in empty lanes too
} wisp_strand_bound_args;

/// History of strands that integrate with BDF2. With h the length of a substep,
///   x = x_n + (x_n - x_{n-1}) / 3 + he v,   he = 2 h / 3
/// is implicit Euler of length he from a start that is shifted by a third of the last displacement. Kernels find the
/// shift in `low`. All null: implicit Euler.
///
/// `step` says between substeps what the history of a strand is good for: h of the last substep, 0 if there was none,
/// and below 0 if something else than forces moved the strand. Within a substep it is he; h in the first one; -h in
/// another one by Euler, and -2h if it is the history of the next one that is lost.
typedef struct wisp_strand_history
{
    float* displacement; ///< [row][3][16] m, of free vertices in the last substep; within one, the shift of its start
    float* before;       ///< [row][3][16] m/s, velocity at the start of the last substep
    float* step;         ///< [row][16] s, in the first row of each group
} wisp_strand_history;

/// Arguments of time integration of strands. Pinned vertices (inverse mass 0) have the velocity of their prescribed
/// motion. A vertex is at position + low. With `previous` positions are predicted, so that other passes can correct
/// them, and the end of the substep adds those corrections to velocities. Without it positions stay at the start of
/// the substep until its end.
typedef struct wisp_strand_motion_args
{
    const int32_t* group_row; ///< [group_count + 1] first row of each group
    float* position;          ///< [row][3][16] m
    float* previous;          ///< [row][3][16] m, at the start of the substep; null: only velocities change within it
    float* low;               ///< [row][3][16] m, what does not fit the digits of position
    float* velocity;          ///< [row][3][16] m/s
    const float* inverse_mass; ///< [row][16] 1/kg; 0: pinned, beyond the tip, or empty lane
    const float* root;         ///< [group][3][16] m, target position of pinned vertices in row 0; null: they stay
    const float* root_low;     ///< [group][3][16] m, what does not fit the digits of root; null with root
    wisp_vec3 acceleration;    ///< m/s^2
    const float* acceleration_scale; ///< [group][16] factor of the acceleration of each strand; null: 1
    float dt;                        ///< s
    const float* length;             ///< [row][16] m, of the segment to the next row; with `segment` only
    float* segment;                  ///< [row][3][16] m, vectors from the next row to this one, in and out
    float* speed;                    ///< [row][16] m^2/s^2, output of the prediction: squared speeds
    wisp_strand_history history;
} wisp_strand_motion_args;

/// Arguments of damping towards a rigid motion: v <- u + (v - u) / (1 + rate dt) with u = linear + angular x (p -
/// centre).
typedef struct wisp_strand_damp_args
{
    const int32_t* group_row;          ///< [group_count + 1] first row of each group
    const float* position;             ///< [row][3][16] m
    float* velocity;                   ///< [row][3][16] m/s
    const float* inverse_mass;         ///< [row][16] 1/kg
    float rate;                        ///< 1/s, >= 0
    wisp_vec3 linear, angular, centre; ///< m/s, rad/s, m
    float dt;                          ///< s
    wisp_strand_history history;
} wisp_strand_damp_args;

/// Arguments of air drag across a strand. Motion along the strand has no drag. Implicit in the velocity, so that
/// drag never reverses it.
typedef struct wisp_strand_air_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    const float* position;     ///< [row][3][16] m
    float* velocity;           ///< [row][3][16] m/s
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* length;       ///< [row][16] m, of the segment to the next row
    wisp_vec3 wind;            ///< m/s
    float drag;                ///< kg/m^2: 1/2 density C_d diameter
    float dt;                  ///< s
    wisp_strand_history history;
} wisp_strand_air_args;

/// Arguments of inextensible segments by a direct solve of the chain, repeated in Newton iterations. With C_s =
/// (|e_s|^2 - l_s^2) / 2 the system J W J^T dlambda = -C is tridiagonal and costs one division and no square root
/// per segment. Iterations end early when all strands of a group are exact to single precision, or to `tolerance`
/// where that is finer. A strand that is not within `tolerance` after the last iteration is reset to rest lengths
/// from the root: each segment keeps its direction, or takes that of the previous segment if it has none. A vertex
/// that the reset moves farther than the strand is long loses its velocity. Strands with pins beyond the root are
/// not reset.
typedef struct wisp_strand_stretch_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    float* position;           ///< [row][3][16] m; without `previous` it changes only in a reset
    float* previous;           ///< [row][3][16] m, moved with a vertex that loses velocity; null: as motion_args
    float* low;                ///< [row][3][16] m, what does not fit the digits of position
    float* velocity;           ///< [row][3][16] m/s, takes the corrections
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* length;      ///< [row][16] m, > 0: length of the segment from this row to the next; 0 beyond the tip
    float* tension;           ///< [row][16] N, of that segment, output; null: not computed
    bool accumulates_tension; ///< add to `tension` instead of starting at 0
    int iterations;           ///< maximum number of Newton iterations, >= 1
    float tolerance;          ///< maximum of |l/l0 - 1|
    float dt;                 ///< s
    float* scratch;           ///< WISP_STRAND_SCRATCH floats per row of the longest group
    float* segment;           ///< [row][3][16] m, vectors from the next row to this one, in and out
    const float* speed;       ///< [row][16] m^2/s^2, squared, as predicted; a reset gives no vertex a higher one
    wisp_vec3 acceleration;   ///< m/s^2, of the prediction, that tension did not balance yet; with history only
    wisp_strand_history history;
    bool
        is_held; ///< strands may be held at both ends: the diagonal grows by 1e-5, because that of a taut one is singular
    bool is_closed; ///< the last vertex of each strand is its first; not reset, and without history
} wisp_strand_stretch_args;

/// Floats of scratch per row of a strand kernel.
#define WISP_STRAND_SCRATCH ( 15 * WISP_LANES )

/// Arguments of distance constraints along strands in one sweep from the root, between rows `stride` apart (pbd,
/// xpbd: as wisp_link_args).
typedef struct wisp_strand_link_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    float* position;           ///< [row][3][16] m; with `previous` predicted, in and out
    const float* previous;     ///< [row][3][16] m, at the start of the substep; null: as wisp_strand_motion_args
    float* low;                ///< [row][3][16] m, what does not fit the digits of position
    float* velocity;           ///< [row][3][16] m/s, takes the corrections
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* rest; ///< [row][16] m, rest length between this row and the row `stride` after it; 0 or less: no
                       ///< link
    float* lambda;   ///< xpbd: [row][16] N s^2, multiplier of this substep; null: starts at 0, for a single iteration
    int stride;      ///< 1 or 2
    float stiffness; ///< pbd: fraction of the error removed, in [0, 1]
    float compliance;  ///< xpbd: m/N
    float inverse_dt2; ///< xpbd: 1/s^2; 0: pbd
    float dt;          ///< s
    float* segment;    ///< [row][3][16] m, vectors from the next row to this one, in and out
    wisp_strand_history history;
} wisp_strand_link_args;

/// Arguments of bending and twist of elastic rods, implicit in the positions. The bending energy of vertex i is
///   1/2 EI/L_i |C_i|^2,   C_i = (p_{i+1} - p_i)/l_i - (p_i - p_{i-1})/l_{i-1} - k_i.
/// It is quadratic while the frames that hold the rest vectors k_i are fixed. Then (M + dt^2 K) x = -dt^2 dE/dp is
/// one pentadiagonal system, the same for x, y and z, and its factors are kept. Frames are transported without
/// twist to the predicted segments (p less dt^2 acceleration). Then twist is brought to equilibrium by a
/// tridiagonal system. Segment -1 is the clamp at the root; a tip that is held has one behind its last segment.
typedef struct wisp_strand_rod_args
{
    const int32_t* group_row;    ///< [group_count + 1] first row of each group
    float* position;             ///< [row][3][16] m; with `previous` predicted, in and out
    const float* previous;       ///< [row][3][16] m, at the start of the substep; null: as wisp_strand_motion_args
    const float* low;            ///< [row][3][16] m, what does not fit the digits of previous
    float* velocity;             ///< [row][3][16] m/s, takes the displacements
    float* segment;              ///< [row][3][16] m, vectors from the next row to this one, in and out
    const float* inverse_mass;   ///< [row][16] 1/kg
    const float* inverse_length; ///< [row][16] 1/m, of the segment to the next row; 0 where there is none
    const float* stiffness;      ///< [row][16] N m, EI / L_i; 0: vertex i does not bend
    const float* factor; ///< [row][3][16] 1/pivot, L(i, i-1), L(i, i-2) of L D L^T = M + (dt^2 + damping dt) K
    const float* first_order_factor; ///< the same for h where `factor` is for he; null without history
    float* tension; ///< [row][16] N, of the last substep; applied again, so that a strand at rest does not move
    const float* max_tension; ///< [row][16] N, upper bound to which tension is clamped
    const float* root;        ///< [group][4][16] quaternion x y z w, rotation of the root from rest
    const float* clamp;       ///< [group][4][16] rest frame of the clamp; its z axis is the direction of growth
    float* frame; ///< [row][4][16] frame of the segment to the next row, z axis along the segment; null: rest shape
                  ///< is straight
    const float* rest; ///< [row][3][16] k_i in the frame halfway between the segments of vertex i; with frames only
    const float* rest_twist;         ///< [row][2][16] cosine and sine of half the rest twist; with frames only
    const float* twist_stiffness;    ///< [row][16] N m, GJ / L_i; with frames only
    float damping;                   ///< s, damping of bending: multiplies its rate of change
    wisp_vec3 acceleration;          ///< m/s^2, of the prediction
    const float* acceleration_scale; ///< [group][16] factor of the acceleration of each strand; null: 1
    float dt;                        ///< s
    float* scratch;                  ///< WISP_STRAND_SCRATCH floats per row of the longest group
    wisp_strand_history history;
    const float*
        tip; ///< [row][3][16] direction of a tip that is held, in the row of the tip, 0 elsewhere; `frame` of
             ///< that row is its frame. null: tips are free
    float
        flatness; ///< sqrt( 1 - EI / EI_edgewise ) of an elliptic section, which bends with EI about its y axis, the
                  ///< x axis being across the flat side; `stiffness` is that of EI_edgewise. 0: circular
    float* section_scratch; ///< WISP_STRAND_SECTION_SCRATCH floats per row of the longest group; with `flatness` or
                            ///< `response` only
    const float*
        response; ///< [row][2][16] of strands whose last vertex is their first, without the vertices 0 and 1,
                  ///< which have no factors: Z = F^-1 B, the response to a displacement of those; rows 0 and 1
                  ///< have S^-1 = (D - B^T Z)^-1. null: strands are open
} wisp_strand_rod_args;

/// Floats of scratch per row of rods with an elliptic section.
#define WISP_STRAND_SECTION_SCRATCH ( 8 * WISP_LANES )

/// Arguments of contact of strands with one body in closed form, with Coulomb friction; equations in
/// strand_contact.c. Vertices closer to the body than the thickness, at the end of the substep, are pushed out
/// along its normal there. Pinned vertices stay.
typedef struct wisp_strand_contact_args
{
    const int32_t* group_row; ///< [group_count + 1] first row of each group
    float* position;          ///< [row][3][16] m, in and out
    float* previous; ///< [row][3][16] m, at the start of the substep; moved with the position when initial overlap is
                     ///< resolved
    const float* inverse_mass; ///< [row][16] 1/kg
    float* allowed_depth; ///< [row][16] m, depth below the thickness that is tolerated; infinite: set to the depth at
                          ///< the start
    float* normal_correction; ///< [row][16] m, incremented by the push of the body; represents the normal impulse.
                              ///< Below 0: that of the last substep, negated, where no body has pushed in this one
    float* last_correction;   ///< [row][16] m, that of the last substep
    float* friction;          ///< [row][3][16] m, sum of the displacements that friction removed
    float* body;              ///< [row][16] number of the body that pushed; -1: several
    const float* length;      ///< [row][16] m, of segments
    float* remaining_depth;   ///< [row][16] m, raised to the depth below the thickness at which the vertex remains
    wisp_shape shape;
    wisp_transform before, after; ///< pose of the body at the start and at the end of the substep
    float thickness;              ///< m
    float static_friction, kinetic_friction;
    float body_number;  ///< >= 0
    bool starts;        ///< push by that of the last substep at least, with its friction
    bool gives_back;    ///< pushes may be taken back until their sum is 0
    float max_push_out; ///< m, maximum distance by which tolerated depth is reduced in this call
} wisp_strand_contact_args;

/// A row of sixteen vertices, seen from a body.
typedef struct wisp_strand_row
{
    float from[3][WISP_LANES], to[3][WISP_LANES]; ///< m, in its frame
    float path[WISP_LANES];                       ///< m
    float near[WISP_LANES];                       ///< m, what comes this near to `to` in the substep counts
} wisp_strand_row;

/// Bounds of the vertices of a group that are not pinned, at the start and at the end of the substep. Empty (lower
/// above upper) if all are pinned.
typedef struct wisp_strand_bounds
{
    wisp_vec3 lower, upper; ///< m
    float max_path;         ///< m, maximum distance from start to end
    float longest;          ///< m, of the segments
} wisp_strand_bounds;

/// Arguments of the table of values that all ghosts of a target share, per node, in rows of four floats. A node has
/// `stride` floats:
///   x, y, z, weight     position; sum of the elastic weight and tip_gain i / (n - 1)
///   x, y, z, cap        sway time times velocity, 0 at the root; m, maximum sway
///   x, y, z, w          quaternion, rotation of the frame from rest
///   x, y, z, reach      stride 16: velocity one step earlier; centre weight of the farthest ghost
/// The elastic weight is 1/2 - 1/2 cos(v, v0) with the velocities v now and v0 one step earlier, and 0 if either is below 1e-6 m/s.
/// The sway of all ghosts of a node is scaled by one factor that keeps the farthest of them within the cap, so that
/// the ratios between ghosts stay. The factor is in the sway already. For ghosts of several targets (is_blended),
/// weight omits the elastic weight, and the velocity is not multiplied by the sway time or by the factor.
typedef struct wisp_strand_target_args
{
    const int32_t* group_row;       ///< [group_count + 1] first row of each group
    const int32_t* lane_count;      ///< [group][16] nodes, 0 in an empty lane
    const int32_t* lane_node;       ///< [group][16] index in the table, in floats, of the first float of the root
    const float* position;          ///< [row][3][16] m
    const float* rest;              ///< [row][3][16] m
    const float* velocity;          ///< [row][3][16] m/s; null: 0
    const float* previous_velocity; ///< [row][3][16] m/s, one step earlier; null: equal to velocity
    const float* max_sway;          ///< [row][16] m, maximum sway of a node
    const float* reach;             ///< [row][16] centre weight of the farthest ghost of a node
    const float*
        root;     ///< [group][4][16] quaternion, rotation of the root from rest, transported along the strand by the
                  ///< smallest rotations; null: none
    float* table; ///< [node][stride] output
    int stride;   ///< floats per node: 12, blended 16
    bool is_blended;
    bool is_elastic; ///< false: the elastic weight is 0
    float sway_time; ///< s
    float tip_gain;
} wisp_strand_target_args;

#define WISP_MAX_GHOST_TARGETS 4

/// Arguments of ghost positions: y = x + R o + sway (weight + scale |o|).
typedef struct wisp_strand_ghost_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    const int32_t* lane_count; ///< [group_count][16] vertices of the strand, 0 in an empty lane
    const int32_t* lane_node; ///< [group][target][16] index in `table`, in floats, of the first float of the target's
                              ///< root
    const float* lane_fraction; ///< blend: [group][target][16] weight of the target; weights sum to 1
    const float* centre_scale;  ///< [group][16] 1/m
    const float* offset;        ///< [row][target][3][16] m, offset from the target at rest
    const float* table;         ///< output of strand_target
    int target_count;           ///< blend: targets per ghost, 1 .. WISP_MAX_GHOST_TARGETS; otherwise 1
    bool is_elastic;            ///< blend
    float sway_time;            ///< blend: s
    float* points;              ///< [row][3][16] m, output
} wisp_strand_ghost_args;

/// Arguments of smooth curves through the vertices of strands: one row for the first vertex, then `samples` rows
/// per segment.
typedef struct wisp_strand_curve_args
{
    const int32_t* group_row;     ///< [group + 1] first row of each group of curves
    const int32_t* lane_row;      ///< [group][16] index in `from`, in floats, of the first vertex of the strand
    const int32_t* lane_vertices; ///< [group][16] vertices of the strand, 0 in an empty lane
    const float* from;            ///< [row][3][16] m, vertices of the strands
    float* to;                    ///< [row][3][16] m, output
    const float* weight; ///< [samples][4] weights of the four points that a segment blends, at t = (k + 1) / samples
    int samples;
    bool
        shares_ends; ///< a segment spans the four vertices that it blends, with inner points next to a joint rotated about
                     ///< it onto one line; otherwise it spans two and blends their neighbours too
} wisp_strand_curve_args;

WISP_END_C
