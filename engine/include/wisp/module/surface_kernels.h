/// Arguments of the kernels of surfaces: constraints, coarse levels, planes and boundary particles (kernels.h).
#pragma once

#include "wisp/fabric.h"
#include "wisp/base.h"

WISP_BEGIN_C

/// @return what is at a slot of links: 0 an edge, 1 a bend link, -1 nothing, where both ends are the dummy of the tile
static inline int wisp_fabric_link_kind( const wisp_fabric* fabric, int slot )
{
    return fabric->link_a_x4[slot] == fabric->link_b_x4[slot] ? -1 : fabric->link_bends[slot / 8] >> slot % 8 & 1;
}

/// Find the corners i, j, k, l of a hinge by its slot.
static inline void wisp_fabric_hinge_corners( const wisp_fabric* fabric, int slot, int32_t corner[4] )
{
    for ( int k = 0; k < 4; ++k )
    {
        corner[k] = fabric->hinge_slot_x4[slot / 8 * 32 + 8 * k + slot % 8] / 4;
    }
}

/// Arguments of distance constraints between two particles (pbd: Mueller et al. 2007; xpbd: Macklin, Mueller and
/// Chentanez 2016, eq. 17-18). The links of a group of eight share no particle. Links of length 0 and links between
/// two pinned particles have no effect.
typedef struct wisp_link_args
{
    float* position;            ///< [slot][4] x, y, z in m, inverse mass in 1/kg
    const int32_t *a_x4, *b_x4; ///< [link] slots of the ends times 4
    const float* rest;          ///< [link] m, rest length
    const float* own;           ///< [link] pbd: fraction of the error removed, in [0, 1]; xpbd: compliance, m/N
    float alike[2];             ///< without `own`: of edges and of bend links
    const uint8_t* bends;       ///< [link / 8] bits of bend links; with folded or `alike`, and for the virial
    uint8_t* folded; ///< [link / 8] 0; receives the bits of bend links shorter than half their rest length, which are
                     ///< not projected. Null: all links are projected
    float* lambda;   ///< [link] xpbd: N s^2, multiplier of this substep; null: starts at 0, for a single iteration
    float inverse_dt2;      ///< xpbd: 1/s^2
    float minimum, maximum; ///< strain limit: minimum and maximum length, as factors of the rest length
} wisp_link_args;

/// Arguments of bending constraints across an interior edge with ends i, j and opposite vertices k, l.
typedef struct wisp_hinge_args
{
    float* position;        ///< [slot][4]
    const int32_t* slot_x4; ///< [group][4][8] i, j, k, l, slots times 4
    const float* rest; ///< dihedral: [hinge] rad, rest angle between the normals, 0 is flat. Isometric: [group][4][8]
                       ///< the vector c of Q = c c^T / A, so that Q x = c (c . x) / A (Bergou et al. 2006)
    const float* stiffness;  ///< pbd: [hinge] in [0, 1]; null for xpbd, which isometric hinges do not have
    const float* compliance; ///< xpbd: [hinge] rad^2/J
    float* lambda;           ///< [hinge] multiplier of this substep; null: starts at 0, for a single iteration
    float inverse_dt2;       ///< xpbd: 1/s^2
} wisp_hinge_args;

/// Arguments of the search for sharp folds, hinges as in wisp_hinge_args.
typedef struct wisp_fold_args
{
    const float* position;  ///< [slot][4] m
    const int32_t* slot_x4; ///< [group][4][8] i, j, k, l, slots times 4
    const float* span2;     ///< [hinge] m^2, squared distance of k and l at rest; 0 pads
    uint8_t* folded;        ///< [hinge / 8] receives the bits of hinges whose k and l are nearer than half of that
} wisp_fold_args;

/// A symmetric matrix whose rows sum to zero, by slices of eight rows: ( Q x )_i = sum of weight ( x_i - x_j ) over the entries of
/// row i. Cooked by plate.h.
typedef struct wisp_plate_rows
{
    int slice_count;
    const int32_t* begin;           ///< [slice_count + 1] first entry of a slice
    const int32_t ( *other_x4 )[8]; ///< [entry] rows times 4; a lane's own row pads. Null: near_x4 has them
    const float ( *weight )[8];     ///< [entry] 1/m^2; 0 pads
    const int16_t (
        *near_x4 )[8]; ///< [entry] rows times 4, relative to the first row of the slice; null: other_x4 has them
} wisp_plate_rows;

/// Moments of hinges from their angles, by groups of eight hinges: moment = - D sum of weight angle; and the triangles on which they
/// act, by groups of eight triangles that share no particle. Cooked by plate.h.
typedef struct wisp_plate_turns
{
    const int32_t* begin;        ///< [group + 1] first entry of a group
    const int32_t ( *other )[8]; ///< [entry] hinges, the own one too. Null: `near` has them
    const uint16_t ( *near )[8]; ///< [entry] hinges; null: `other` has them
    const float ( *weight )[8];  ///< [entry] no unit; 0 pads
    const float*
        steepest; ///< [hinge] 1/m^2: the moment is scaled down where the squared gradients of the angle at the
                  ///< opposite vertices exceed this
    const float* least_height;             ///< [slot] m, of the triangles at a vertex
    const struct wisp_schedule* triangles; ///< of the groups of triangles (wisp/fabric.h)
    const int32_t* corner_x4;              ///< [group of triangles][3][8] slots times 4
    const int32_t*
        moment_of; ///< [group of triangles][3][8] the hinge opposite to a corner; the number of hinges: none
} wisp_plate_turns;

/// Arguments of moments of angles, groups of eight hinges, and of impulses, groups of eight triangles.
typedef struct wisp_plate_angle_args
{
    wisp_plate_turns turns;
    const int32_t* slot_x4; ///< [group][4][8] i, j, k, l, slots times 4
    const float* rest;      ///< [hinge] rad, rest angle between the normals, 0 is flat
    const float* position;  ///< [slot][4] m; inverse mass, 1/kg
    float* angle;           ///< [hinge] rad, beyond the rest angle
    float* moment;  ///< [hinge + 1] kg m: times the square of the substep, over the length of the edge; the last is 0
    float* impulse; ///< [slot][4] kg m, to which the forces of moments are added
    float rate;     ///< kg m^2: rigidity times the square of the substep
} wisp_plate_angle_args;

/// Arguments of an implicit step of bending by a Chebyshev recurrence, slices of eight rows. Rows are slots. With A = r W Q, W the
/// inverse masses, it approaches y = ( 1 + A )^-1 W b, and is exact for long waves after any number of stages.
typedef struct wisp_plate_args
{
    wisp_plate_rows rows;
    const float* position; ///< [row][4] m; inverse mass, 1/kg
    float* impulse;        ///< [row][4] kg m: b = - r Q x
    float* newer;   ///< [row][4] m, y of the stage before; 0 behind it. plate_begin: y of the first stage, output
    float* older;   ///< [row][4] m, y of the one before that; replaced by y of this stage. plate_begin: 0, output
    float rate;     ///< kg m^2: r, rigidity times the square of the substep
    float momentum; ///< y += momentum ( newer - older )
    float gain;     ///< y += gain W ( b - r Q newer )
} wisp_plate_args;

/// Arguments of what comes before and after those stages, slices of eight slots.
typedef struct wisp_plate_move_args
{
    const float* position; ///< [slot][4] m; inverse mass, 1/kg
    const float* target;   ///< [slot][4] m, where pinned and its fourth component is not 0; may be the position
    float* predicted;      ///< [slot][4] m, where gravity and velocities lead; inverse mass. plate_predict: output
    float* impulse;        ///< [slot][4] plate_predict makes it 0
    float* velocity;       ///< [slot][4] m/s; 0
    const float* moved;    ///< [slot][4] m; 0
    const float* least_height; ///< [slot] m
    wisp_vec3 gravity;         ///< m/s^2
    float dt, to_target;       ///< s; fraction of the way to a target
    float scale;               ///< of moves
} wisp_plate_move_args;

/// Arguments of triangles of a thin neo-Hookean solid that keeps its volume, by groups of eight triangles that share no particle. With the
/// deformation gradient F = (f1 f2) of a triangle, its principal stretches s1, s2 and G the shear modulus times the thickness, the
/// energy is E = A G / 2 (s1^2 + s2^2 + 1 / (s1 s2)^2 - 3) (Treloar 1943). Cooked by elastic_triangles.h.
typedef struct wisp_elastic_triangle_args
{
    float* position;        ///< [slot][4] m; inverse mass, 1/kg
    const int32_t* slot_x4; ///< [group][3][8] corners, slots times 4
    /// [group][4][8] 1/m, m^2: b11, b12, b22 and the area A at rest, f1 = b11 e1, f2 = b12 e1 + b22 e2 with the edges e1, e2 from
    /// the first corner. 0: a triangle that is too thin, or none
    const float* shape;
    /// [group][3][8] kg m^2: with F = R U, dE/dU of this substep times the square of its length, as xx, yy, xy; null: starts at 0, for
    /// a single iteration
    float* stress;
    float stiffness;    ///< N/m: G
    float dt2;          ///< s^2
    bool tension_field; ///< true: a triangle wrinkles instead of holding compression (Pipkin 1986)
} wisp_elastic_triangle_args;

/// Arguments of kernels over ordered one-rings: area vectors, volume and normals at vertices (docs/methods.md,
/// volume and its gradient).
typedef struct wisp_ring_args
{
    const float* position;         ///< [slot][4] m; slice s holds slots 8 s to 8 s + 7
    const int32_t* ring_begin;     ///< [slice + 1] first entry of each slice
    const int32_t ( *ring_x4 )[8]; ///< [entry][8] neighbours in fan order, slots times 4
    wisp_vec3 origin;              ///< m, reference point of the volume; a point near the body reduces rounding
    float* gradient; ///< [slice - first_slice][3][8] m^2, dV/dp = 1/6 of the sum of (a - p) x (b - p); ring_normal:
                     ///< unit normals
    float* area;     ///< [slice - first_slice][8] m^2, a third of the areas of the incident triangles; may be null
    int first_slice; ///< slice of the first element of gradient and area
} wisp_ring_args;

/// Arguments of drag and lift of air on triangles. Drag is implicit in the velocity.
typedef struct wisp_strip_air_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg; particles with inverse mass 0 keep their velocity
    float* velocity;       ///< [slot][4] m/s
    float* sum;            ///< [slot][4] over triangles, zero before the first one; `blow` applies it
    wisp_strips strips;
    wisp_vec3 wind;           ///< m/s
    float density;            ///< kg/m^3
    float drag, lift;         ///< C_d, C_l
    float dt;                 ///< s
    const float* drag_factor; ///< [slot] factor of C_d, of which a triangle has the mean; null: 1
    const float* lift_factor; ///< [slot] of C_l; null: 1
} wisp_strip_air_args;

/// Arguments of drag of air at rest on vertices, by max( 0, cos ) of the angle between velocity and area vector. A vertex at rest, or whose area vector cancels, has none.
typedef struct wisp_vertex_drag_args
{
    const float* position;   ///< [slot][4] m, inverse mass in 1/kg
    float* velocity;         ///< [slot][4] m/s, the fourth component is kept
    const float* vectors;    ///< [slice][3][8] m^2, area vectors, as from ring_gradient
    const float* areas;      ///< [slot] m^2
    float half_density_drag; ///< 1/2 rho C_d, kg/m^3
    float dt;                ///< s
} wisp_vertex_drag_args;

/// Sums over a range of slices. Each is a double, summed from eight ordered float lanes.
typedef struct wisp_ring_sums
{
    double volume;   ///< m^3, sum of (p - origin) . gradient / 3
    double weighted; ///< m^4/kg, sum of w |gradient|^2 with w the inverse mass
} wisp_ring_sums;

/// Arguments of weighted points: y = sum of w x over two or three parents, and the unit normal along the sum of w
/// n.
typedef struct wisp_blend_args
{
    const float* position; ///< [slot][4] m
    const float* normal;   ///< [slot][4] unit normal, the fourth component is 0; null: no normals are computed
    const int32_t ( *parents )[4]; ///< [point] slots times 4; this and all arrays per point are padded to a multiple
                                   ///< of 8
    const float ( *weights )[4];   ///< [point] weights of positions
    float* xyzw;                   ///< [point][4] m, output; the fourth component is kept
    float* normals;                ///< [point][4] output, the fourth component is 0. Where the sum is shorter than
                                   ///< WISP_MIN_BLEND_LENGTH, the normal is kept and its fourth component becomes 1
} wisp_blend_args;

/// Minimum length of a sum of normals. Components of unit normals are accurate to about 1e-7, so the direction of a
/// shorter sum is rounding error.
#define WISP_MIN_BLEND_LENGTH 1e-6f

/// Arguments of the test whether edges and triangles still have the sampled number of points: their extents,
/// divided by the spacing, are compared with bounds. The bounds allow for rounding, so an element is marked only if
/// that is certain.
typedef struct wisp_extent_args
{
    const float* position;              ///< [slot][4] m
    const int32_t ( *pair_x4 )[2][8];   ///< edges: [slice] slots of the ends times 4
    const int32_t ( *corner_x4 )[3][8]; ///< triangles: [slice] slots of a, b, c times 4; a to b is the shortest side
    float spacing;                      ///< m
    const float* element_spacing;       ///< [element] m; null: `spacing` for all elements
    const float *lower, *upper; ///< [element] bounds of the length, or of a triangle's base, divided by the spacing
    const float *lower_height, *upper_height; ///< [triangle] bounds of the height divided by the spacing
    uint8_t* unchanged;                       ///< [slice] output, one bit per element
} wisp_extent_args;

/// Arguments of closest points of pairs: a point and a triangle, or two segments. Triangles may be degenerate and
/// segments may have length 0. If a coordinate of a pair is not finite, or the pair is wider than 1e18 m, its
/// distance is not finite and its weights and normal are undefined.
typedef struct wisp_closest_args
{
    const float* xyzw; ///< [point][4] m; the fourth component is not read; 16-byte aligned
    const int32_t*
        point_x4[4]; ///< [pair] points times 4: p, a, b, c, or the ends a, b of one segment and c, d of the other
    float* distance; ///< [pair] output, m; 0 below 1e-19 m
    /// [group] output, barycentric weights, negative on the second side; null: not computed. The weights of a side
    /// sum to exactly 1, so that they give the same point far from the origin.
    float ( *weight )[4][8];
    /// [group] output, unit normal from the second side to the first, 0 where the distance is 0; null if weight is
    /// null. The plane perpendicular to the normal separates the sides by their distance.
    float ( *normal )[3][8];
} wisp_closest_args;

/// Arguments of moving particles along a gradient: p += w factor gradient, with w the inverse mass.
typedef struct wisp_push_args
{
    float* position;       ///< [slot][4] m, inverse mass in 1/kg
    const float* gradient; ///< [slice][3][8]
    float factor;
} wisp_push_args;

/// Arguments of rigid motions of particles.
typedef struct wisp_frame_motion_args
{
    float turn[9];    ///< row by row: the rotation less the identity, so that a small motion keeps its digits
    wisp_vec3 origin; ///< m, what is rotated about
    wisp_vec3 shift;  ///< m, of the origin
} wisp_frame_motion_args;

/// Arguments of tethers, which limit the distance of particles from their attachments. Only the particle moves, and
/// only if the attachment is pinned, so that all layers of a particle can be processed before the next particle.
typedef struct wisp_tether_args
{
    float* position;             ///< [slot][4]
    const int32_t* anchor_x4;    ///< [layer][slot_count] slot of the attachment times 4
    const float* rest;           ///< [layer][slot_count] m, rest length
    int layer_count, slot_count; ///< tethers per particle, and slots per layer
    float slack;                 ///< maximum distance as a factor of the rest length, >= 1
} wisp_tether_args;

/// How a motion constraint responds to an error. By xpbd the stiffness is 1, by pbd the compliance is 0.
typedef struct wisp_motion_response
{
    float stiffness;  ///< fraction of the error that a projection removes, in [0, 1]
    float compliance; ///< 1/kg, compliance over the squared length of a substep
} wisp_motion_response;

/// Arguments of targets. Rows of vectors are [slot / 8][3][8]. Pinned particles stay.
typedef struct wisp_motion_constraint_args
{
    float* position;                    ///< [slot][4] m, inverse mass in 1/kg
    const float* bound;                 ///< [slot][4] as of motion_targets
    const float *target, *displacement; ///< m, at the end of the step, and in the step
    const float* max_distance;          ///< [slot] m, >= 0; infinite: free
    const float *normal,
        *normal_change; ///< at the end of the step, and in the step; any length, 0: none. Null: no backstops
    const float* backstop_distance; ///< [slot] m behind the target, >= 0; infinite: none
    const float* curvature;         ///< [slot] 1/m, of the sphere; 0: a plane
    float* lambda;                  ///< [slot / 8][2][8] N s^2 of distances and of backstops; null: not kept
    float* velocity;                ///< [slot][4] m/s, receives the displacement over the time; null: not changed
    float inverse_dt;               ///< 1/s, of the substep; for `velocity`
    float left;                     ///< fraction of the step's displacement that follows this substep
    wisp_motion_response distance, backstop;
} wisp_motion_constraint_args;

/// Arguments of motion_targets, for a step.
typedef struct wisp_motion_target_args
{
    float *target, *displacement;  ///< m, in: of the last step, out: of this one
    const float* next;             ///< m, targets at the end of this step
    float *normal, *normal_change; ///< likewise; null: no backstops
    const float* next_normal;
    const float *max_distance, *backstop_distance; ///< [slot] m
    float* bound; ///< [slot][4] m, out: middle of the path; half the edge of a cube around it in which none of the
                  ///< group of eight is constrained in the whole step, negative: there is none
    float left;   ///< fraction of the last displacement that the last step left
} wisp_motion_target_args;

/// Arguments of links of a coarse sheet, by xpbd. A link longer than its rest length pulls, and one shorter than its lower length
/// pushes; between the two it is slack. Links of length 0 and links between two pinned rows have no effect.
typedef struct wisp_level_link_args
{
    float* position;            ///< [row][4] m, inverse mass in 1/kg
    const int32_t *a_x4, *b_x4; ///< [link] rows times 4; those of a group of eight are different
    const float* rest;          ///< [link] m
    const float* compliance;    ///< [link] m/N
    float* lower;               ///< [link] m, at most the rest length
    float* lambda;              ///< [link] N s^2, in and out; level_prepare makes it 0
    float* factor;              ///< [link] kg, of level_prepare
    float inverse_dt2;          ///< 1/s^2
    float relaxation;           ///< of a projection, below 2

    // of level_band, which finds `lower` from the chains of mesh edges along the links
    const float *start, *particle;  ///< [row][4], [slot][4] m, where the substep begins
    float held;                     ///< fraction of its rest length by which a link may not shorten in the substep
    const int32_t* chain_begin;     ///< [link / 8 + 1]
    const int32_t ( *chain_x4 )[8]; ///< [entry] slots times 4
    const float* chain_rest;        ///< [link] m
} wisp_level_link_args;

/// Arguments of the rows of the coarsest sheet in a substep of it; equations in passes/levels.c.
typedef struct wisp_level_rows_args
{
    float* position;                    ///< [row][4] m, inverse mass in 1/kg
    float* start;                       ///< [row][4] m, where the substep begins
    float *velocity, *change, *lag;     ///< [row][4] m/s, m/s^2
    const float *acceleration, *target; ///< [row][4] m/s^2; m, where pinned rows end
    float dt, solve_dt;                 ///< s, of the substep, and with which links are projected
    float progress;                     ///< fraction of the way of pinned rows that is left
    float most_change, most_added;      ///< m/s^2, m/s, beyond which what is remembered and added is shortened
    bool is_second_order;
} wisp_level_rows_args;

/// Arguments of what second order adds to the velocities of the coarsest rows.
typedef struct wisp_level_added_args
{
    const float* surface;         ///< [slot][4] m/s, velocity
    const int32_t* slot_x4;       ///< [row] slots times 4
    const float *end, *mean;      ///< [row][4] m/s, of the sheet: at the end of the substep, and over it
    float *change, *lag, *before; ///< [row][4] m/s^2; m/s of the surface, in: a substep ago, out: now
    float *added, *sum;           ///< [row][4] m/s, out; scratch
    const int32_t *a_x4, *b_x4;   ///< [link] rows times 4; those of a group of eight are different
    const float* fraction;        ///< [link]
    int link_count;               ///< a multiple of 8
} wisp_level_added_args;

/// Arguments of prolongation from a coarse sheet: target += sum of weights times values of the parents, for rows that move.
typedef struct wisp_prolong_args
{
    float* target;            ///< [row][4]
    const float* position;    ///< [row][4] a fourth component of 0 is pinned; may be the target
    const float* value;       ///< [parent row][4] the fourth component is 0
    const int32_t* parent_x4; ///< [slice][WISP_FABRIC_PARENTS][8] rows times 4
    const float* weight;      ///< [slice][WISP_FABRIC_PARENTS][8]
} wisp_prolong_args;

/// Arguments of contact of particles with half spaces, with Coulomb friction; equations in half_space.c. A row of
/// 16 floats is: a point of the surface; the unit normal away from the body; the motion of the surface in the
/// substep; the gap to keep (m); the accumulated normal and tangential corrections (m), in and out; static and
/// kinetic friction.
typedef struct wisp_half_space_args
{
    float* position;            ///< [slot][4] m, in and out
    const float* previous;      ///< [slot][4] m, at the start of the substep
    float* rows;                ///< [row][16], 16-byte aligned
    const int32_t* particle_x4; ///< slot of each particle times 4. A group of eight repeats a particle only with the
                                ///< same row, as padding
    const int32_t* row_x16;     ///< row of each particle times 16
} wisp_half_space_args;

// ---- arguments of the kernels of skinning. All arrays as in wisp/skin.h ----

/// Arguments of skinning of groups of eight points that follow the same number of bones.
typedef struct wisp_skin_args
{
    const float* xyz;            ///< [group][3][8] m, the bind pose, aligned to 32 bytes
    const int32_t* point;        ///< [group][8] where a point goes
    const int32_t ( *bones )[4]; ///< [group][8] bones of a point
    const float ( *weights )[4]; ///< [group][8] sum to 1, the first is the largest; aligned to 16 bytes
    const float* rows;           ///< [bone][16] of wisp_skin_pose, aligned to 16 bytes
    wisp_vec3* out;              ///< [point] m
    int influence_count;         ///< 1 .. 4 bones that a point follows
} wisp_skin_args;

WISP_END_C
