/// Kernels that modules share: constraint projections, searches and integration over ranges, under their
/// mathematical names. The same source is compiled once per instruction set and called through a table. All tables
/// give the same bits.
#pragma once

#include "wisp/module/primitives.h"
#include "wisp/module/random.h"
#include "wisp/module/springs.h"
#include "wisp/module/particle_batch.h"
#include "wisp/shapes.h"
#include "wisp/variants.h"

WISP_BEGIN_C

/// Strand data is lane-interleaved: a group holds sixteen strands, one strand per lane and one vertex index per
/// row.
#define WISP_LANES 16
/// A slice is eight consecutive items, one per lane.
#define WISP_SLICE 8

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
    float epsilon;   ///< added to denominators, as the paper prints it; 0: omitted
    int dimension;   ///< 2: a straight strand bends about the z axis; 3: about a random perpendicular
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
    float radius;              ///< m, strands outside keep their bits
    bool chord;                ///< blend positions, as the paper prints it, instead of rotating by part of the angle
    bool from_root;            ///< strand direction is tip - root instead of tip - mean
    bool nearest;              ///< a strand is inside if any vertex is within radius, not only the tip
    int dimension;             ///< 2: a strand that points away from the target turns about the z axis
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

/// Arguments of the search for all items within a radius of eight queries, through the rows of a uniform grid.
typedef struct wisp_range_search_args
{
    const float *x, *y, *z;    ///< [slot] items sorted by cell, padded by 16
    const int32_t* owner;      ///< [slot] items with the owner of the query are skipped
    const int32_t* cell_begin; ///< [cell_count + 1] first slot of each cell
    float origin[3];           ///< m
    float inverse_cell[3];     ///< 1/m
    int dims[3], axis[3];      ///< as in wisp_grid
    int cell_reach[3];         ///< cells to search on each side, along axis[0], axis[1], axis[2]
    float near_radius;         ///< m, neighbours closer than this are near
    float skin_radius;         ///< m, neighbours from near_radius to here are in the skin; 0: no skin
    int limit;         ///< maximum number of near neighbours, and of skin neighbours; the first in order are kept
    const float* xyzw; ///< [query][4] x, y, z in m, and the owner as int bits
    bool planar;       ///< all z are equal
} wisp_range_search_args;

/// Entries that a list needs beyond the limit, because entries are written eight at a time.
#define WISP_SEARCH_PADDING 16

/// Results of eight queries. The caller owns the arrays.
typedef struct wisp_range_search_result
{
    int32_t* lists;             ///< [8][2 limit + padding] slots times 4: near neighbours, then skin neighbours
    int32_t* skin;              ///< [8][limit + padding] scratch of the search
    int near_count[WISP_SLICE]; ///< near neighbours in each lane's list
    int count[WISP_SLICE];      ///< near and skin neighbours in each lane's list
    int near_length, length;    ///< maximum of near_count and of count
    int capped;                 ///< incremented by the number of queries that exceeded the limit
} wisp_range_search_result;

/// Boxes as one array per component, sorted so that boxes tested together are stored together.
typedef struct wisp_aabb_stream
{
    const float *lower[3], *upper[3]; ///< [slot] m, padded by 8 boxes that overlap nothing
    const int32_t* item;              ///< [slot] index of the box, padded by 8
} wisp_aabb_stream;

/// Up to eight query boxes and the boxes that overlap them.
typedef struct wisp_aabb_group
{
    int count;                  ///< number of queries
    float box[WISP_SLICE][6];   ///< lower x, y, z, then upper x, y, z, in m
    int32_t above[WISP_SLICE];  ///< report only items with a higher index than this
    int32_t* found[WISP_SLICE]; ///< output lists; the caller sets the first, each other list starts 8 entries after
                                ///< the end of the previous one
    int found_count[WISP_SLICE];
} wisp_aabb_group;

/// Maximum number of slots that are compared with several queries at once.
#define WISP_MAX_SHARED_AABBS 1024

/// Neighbour lists, interleaved by slice: entry k of slice s is entries[8 (begin[s] + k) ..], one query per lane.
typedef struct wisp_neighbour_list
{
    const int32_t* begin;   ///< [slice_count] first entry
    const int32_t* length;  ///< [slice_count] entries per lane
    const int32_t* entries; ///< [entry][8] slots of the neighbours times 4; shorter lists are padded with the lane's
                            ///< own slot
} wisp_neighbour_list;

/// Distances of reference pairs, stored for the brake.
typedef struct wisp_reference_pairs
{
    float* distance;   ///< [entry][8] m, r0; larger than any radius in padding, so that g(r0) is 0
    float* weight_sum; ///< [slot] sum of g(r0)
    int32_t* near;     ///< [slice] number of pairs with a distance above 0 and below the radius
} wisp_reference_pairs;

/// Arguments of pairwise adhesion with a gap-keeping brake (Kim 2026, eq. 14-19): one Jacobi iteration in two
/// sweeps. Each lane adds its entries in list order, so sums do not depend on the lane width.
typedef struct wisp_adhesion_args
{
    const float* current;         ///< [slot][4] p(k)
    float* tentative;             ///< [slot][4] p(k) + Dp(k); output of the first sweep, input of the second
    float* displacement;          ///< [slice][3][8] Dp(k), after the guard
    float* next;                  ///< [slot][4] p(k+1)
    const float* search_position; ///< [slot][4] positions at the last search of the attracting lists
    const int32_t* owner;         ///< [slot] index of the strand
    const int32_t* vertex;        ///< [slot] index of the vertex in its strand; 0 is the root, which does not move
    wisp_neighbour_list attracting[2]; ///< lists of the first sweep, summed in this order
    int attracting_count;
    wisp_neighbour_list reference[2]; ///< lists of the second sweep: neighbours at the reference shape
    int reference_count;
    wisp_reference_pairs* pairs; ///< of reference[0]; null: the second sweep measures distances at `current`
    bool stores_pairs;           ///< the first sweep runs over reference[0] alone and fills `pairs`
    float search_margin;   ///< m, a vertex that has moved farther than this since the last search needs a new one
    uint8_t* needs_search; ///< [slice] one bit per lane, set by the second sweep, or by the first if there is no
                           ///< brake
    wisp_random_key key;
    uint32_t iteration;
    float radius;            ///< h, m
    float step;              ///< sigma, m
    float epsilon;           ///< m, added to r in the direction, as the paper prints it; 0: omitted
    float distance_min;      ///< r_min, m; minimum distance that the guard keeps between vertices of a pair
    float lambda_min;        ///< minimum of the brake's factor, reached where the distance changes by h
    bool min_distance_clamp; ///< enables the guard
    bool planar;             ///< all z are 0
    int gap;                 ///< a wisp_gap value
} wisp_adhesion_args;

/// Arguments of distance constraints between two particles (pbd: Mueller et al. 2007; xpbd: Macklin, Mueller and
/// Chentanez 2016, eq. 17-18). The links of a group of eight share no particle. Links of length 0 and links between
/// two pinned particles have no effect.
typedef struct wisp_link_args
{
    float* position;            ///< [slot][4] x, y, z in m, inverse mass in 1/kg
    const int32_t *a_x4, *b_x4; ///< [link] slots of the ends times 4
    const float* rest;          ///< [link] m, rest length
    const float* stiffness;     ///< [link] pbd: fraction of the error removed, in [0, 1]
    const float* compliance;    ///< [link] xpbd: m/N
    float* lambda;     ///< [link] xpbd: N s^2, multiplier of this substep; null: starts at 0, for a single iteration
    float inverse_dt2; ///< xpbd: 1/s^2
    float minimum, maximum; ///< strain limit: minimum and maximum length, as factors of the rest length
} wisp_link_args;

/// Arguments of bending constraints across an interior edge with ends i, j and opposite vertices k, l.
typedef struct wisp_hinge_args
{
    float* position;        ///< [slot][4]
    const int32_t* slot_x4; ///< [group][4][8] i, j, k, l, slots times 4
    const float* rest; ///< dihedral: [hinge] rad, rest angle between the normals, 0 is flat. Isometric: [group][4][8]
                       ///< the vector c of Q = c c^T / A, so that Q x = c (c . x) / A (Bergou et al. 2006)
    const float* scale;      ///< isometric: [hinge] 1 / A in 1/m^2 with A the area of both triangles
    const float* stiffness;  ///< pbd: [hinge] in [0, 1]; null for xpbd
    const float* compliance; ///< xpbd: [hinge] dihedral: rad^2/J; isometric: 1/J with the energy of curvature
    float* lambda;           ///< [hinge] multiplier of this substep; null: starts at 0, for a single iteration
    float inverse_dt2;       ///< xpbd: 1/s^2
} wisp_hinge_args;

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

/// Arguments of drag and lift of air on the triangles around vertices. Drag is implicit in the velocity.
typedef struct wisp_ring_air_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg; particles with inverse mass 0 keep their velocity
    const float* old_velocity;     ///< [slot][4] m/s, velocity before the kernel, read for neighbours
    float* velocity;               ///< [slot][4] m/s, output; the fourth component is copied from old_velocity
    const int32_t* ring_begin;     ///< [slice + 1] first entry of each slice
    const int32_t ( *ring_x4 )[8]; ///< [entry][8] neighbours in fan order, slots times 4
    wisp_vec3 wind;                ///< m/s
    float density;                 ///< kg/m^3
    float drag, lift;              ///< C_d, C_l
    float dt;                      ///< s
} wisp_ring_air_args;

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
    const float ( *normal_weights )[4]; ///< [point] weights of normals; null: same as `weights`
    float* xyzw;                        ///< [point][4] m, output; the fourth component is kept
    float* normals; ///< [point][4] output, the fourth component is 0. Where the sum is shorter than
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

/// Arguments of prolongation from a coarse level: p += sum of weights times the displacements of the parents.
typedef struct wisp_prolong_args
{
    float* position;           ///< [slot][4] m, of the children
    const float* displacement; ///< [slot][4] m, displacement of the level's vertices by all levels so far; the fourth
                               ///< component is 0
    const int32_t* child_x4;   ///< [slice][8] slots times 4
    const int32_t* parent_x4;  ///< [slice][4][8] slots times 4
    const float* weight;       ///< [slice][4][8]
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

/// Arguments of time integration of particles (Mueller et al. 2007, algorithm 1). Pinned particles keep their
/// position; their velocity is not changed.
typedef struct wisp_particle_args
{
    float* position;        ///< [slot][4] m, inverse mass in 1/kg
    float* previous;        ///< [slot][4] m, at the start of the substep
    float* velocity;        ///< [slot][4] m/s, the fourth component is 0
    wisp_vec3 acceleration; ///< m/s^2, of every particle that is not pinned
    float dt;               ///< s
} wisp_particle_args;

/// Arguments of the check that positions and velocities of particles are finite and bounded.
typedef struct wisp_bound_args
{
    const float* position; ///< [slot][4] m
    const float* velocity; ///< [slot][4] m/s
    float bound;           ///< maximum magnitude of x, y and z
} wisp_bound_args;

/// Arguments of the check that positions and velocities of strand vertices are finite and bounded.
typedef struct wisp_strand_bound_args
{
    const float* position; ///< [row][3][16] m
    const float* velocity; ///< [row][3][16] m/s
    float bound;           ///< maximum magnitude of each component, checked in empty lanes too
} wisp_strand_bound_args;

/// Arguments of time integration of strands. Pinned vertices (inverse mass 0) have the velocity of their prescribed
/// motion.
typedef struct wisp_strand_motion_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    float* position;           ///< [row][3][16] m
    float* previous;           ///< [row][3][16] m, at the start of the substep
    float* velocity;           ///< [row][3][16] m/s
    const float* inverse_mass; ///< [row][16] 1/kg; 0: pinned, beyond the tip, or empty lane
    const float* root;         ///< [group][3][16] m, target position of pinned vertices in row 0; null: they stay
    wisp_vec3 acceleration;    ///< m/s^2
    const float* acceleration_scale; ///< [group][16] factor of the acceleration of each strand; null: 1
    float dt;                        ///< s
} wisp_strand_motion_args;

/// Arguments of damping towards a rigid motion: v <- u + retained_fraction (v - u) with u = linear + angular x (p -
/// centre).
typedef struct wisp_strand_damp_args
{
    const int32_t* group_row;          ///< [group_count + 1] first row of each group
    const float* position;             ///< [row][3][16] m
    float* velocity;                   ///< [row][3][16] m/s
    const float* inverse_mass;         ///< [row][16] 1/kg
    float retained_fraction;           ///< in [0, 1]
    wisp_vec3 linear, angular, centre; ///< m/s, rad/s, m
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
    float* position;           ///< [row][3][16] m
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* length;      ///< [row][16] m, > 0: length of the segment from this row to the next; 0 beyond the tip
    float* tension;           ///< [row][16] N, of that segment, output; null: not computed
    bool accumulates_tension; ///< add to `tension` instead of starting at 0
    int iterations;           ///< maximum number of Newton iterations, >= 1
    float tolerance;          ///< maximum of |l/l0 - 1|
    float* previous;          ///< [row][3][16] m, moved with a vertex that loses its velocity
    const float* velocity;    ///< [row][3][16] m/s, predicted; a reset gives no vertex a higher speed. Null: no limit
    float dt;                 ///< s
    float* scratch;           ///< WISP_STRAND_SCRATCH floats per row of the longest group
} wisp_strand_stretch_args;

/// Floats of scratch per row of a strand kernel.
#define WISP_STRAND_SCRATCH ( 15 * WISP_LANES )

/// Arguments of distance constraints along strands in one sweep from the root, between rows `stride` apart (pbd,
/// xpbd: as wisp_link_args).
typedef struct wisp_strand_link_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    float* position;           ///< [row][3][16] m
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* rest; ///< [row][16] m, rest length between this row and the row `stride` after it; 0 or less: no
                       ///< link
    float* lambda;   ///< xpbd: [row][16] N s^2, multiplier of this substep; null: starts at 0, for a single iteration
    int stride;      ///< 1 or 2
    float stiffness; ///< pbd: fraction of the error removed, in [0, 1]
    float compliance;  ///< xpbd: m/N
    float inverse_dt2; ///< xpbd: 1/s^2; 0: pbd
} wisp_strand_link_args;

/// Arguments of follow the leader (Mueller, Kim and Chentanez 2012): each vertex is moved to rest length from the
/// previous vertex, which stays. Moving `previous` of the leader returns its part of the momentum when velocities
/// are computed.
typedef struct wisp_strand_follow_args
{
    const int32_t* group_row;  ///< [group_count + 1] first row of each group
    float* position;           ///< [row][3][16] m
    float* previous;           ///< [row][3][16] m, at the start of the substep
    const float* inverse_mass; ///< [row][16] 1/kg
    const float* length;       ///< [row][16] m, of the segment to the next row
    float leader_correction;   ///< s of the paper, in [0, 1]
} wisp_strand_follow_args;

/// Arguments of bending and twist of elastic rods, implicit in the positions. The bending energy of vertex i is
///   1/2 EI/L_i |C_i|^2,   C_i = (p_{i+1} - p_i)/l_i - (p_i - p_{i-1})/l_{i-1} - k_i.
/// It is quadratic while the frames that hold the rest vectors k_i are fixed. Then (M + dt^2 K) x = -dt^2 dE/dp is
/// one pentadiagonal system, the same for x, y and z, and its factors are kept. Frames are transported without
/// twist to the predicted segments (p less dt^2 acceleration). Then twist is brought to equilibrium by a
/// tridiagonal system. Segment -1 is the clamp at the root.
typedef struct wisp_strand_rod_args
{
    const int32_t* group_row;    ///< [group_count + 1] first row of each group
    float* position;             ///< [row][3][16] m, predicted positions; in and out
    const float* previous;       ///< [row][3][16] m, at the start of the substep
    const float* inverse_mass;   ///< [row][16] 1/kg
    const float* inverse_length; ///< [row][16] 1/m, of the segment to the next row; 0 where there is none
    const float* stiffness;      ///< [row][16] N m, EI / L_i; 0: vertex i does not bend
    const float* factor; ///< [row][3][16] 1/pivot, L(i, i-1), L(i, i-2) of L D L^T = M + (dt^2 + damping dt) K
    float* tension;      ///< [row][16] N, of the last substep; applied again, so that a strand at rest does not move
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
} wisp_strand_rod_args;

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
    float* normal_correction; ///< [row][16] m, incremented by the push of the body; represents the normal impulse
    float* remaining_depth;   ///< [row][16] m, raised to the depth below the thickness at which the vertex remains
    wisp_shape shape;
    wisp_transform before, after; ///< pose of the body at the start and at the end of the substep
    float thickness;              ///< m
    float static_friction, kinetic_friction;
    float max_push_out; ///< m, maximum distance by which tolerated depth is reduced in this call
} wisp_strand_contact_args;

/// Bounds of the vertices of a group that are not pinned, at the start and at the end of the substep. Empty (lower
/// above upper) if all are pinned.
typedef struct wisp_strand_bounds
{
    wisp_vec3 lower, upper; ///< m
    float max_path;         ///< m, maximum distance from start to end
} wisp_strand_bounds;

/// Weight of a change of velocity, from the velocity v now and v0 one step earlier.
typedef enum wisp_elastic
{
    WISP_ELASTIC_CHANGE,  ///< 1/2 - 1/2 cos(v, v0); 0 if either speed is below 1e-6 m/s
    WISP_ELASTIC_COSINE,  ///< 1/2 + 1/2 cos(v, v0); 1/2 if either speed is below 1e-6 m/s
    WISP_ELASTIC_PRODUCT, ///< 1/2 v . v0 + 1/2
    WISP_ELASTIC_NONE,    ///< 0
} wisp_elastic;

/// Arguments of the table of values that all ghosts of a target share, per node, in rows of four floats. A node has
/// `stride` floats:
///   x, y, z, weight     position; sum of the elastic weight and tip_gain i / (n - 1)
///   x, y, z, limit      sway time times velocity, 0 at the root; maximum weight that keeps the sway within the cap
///   x, y, z, w          stride 12 and 16: quaternion, rotation of the frame from rest
///   x, y, z, 0          stride 16: velocity one step earlier
/// For ghosts of several targets (is_blended), weight omits the elastic weight, the velocity is not multiplied by
/// the sway time, and limit is the cap in m.
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
    const float* root;              ///< [group][4][16] quaternion, rotation of the root from rest; null: none
    float* table;                   ///< [node][stride] output
    int stride;                     ///< floats per node: 8 without frames, 12 or 16 with frames
    bool transports_frames; ///< frames are transported from the root by the smallest rotations; otherwise all nodes
                            ///< have the frame of the root
    bool is_capped, is_blended;
    wisp_elastic elastic;
    float sway_time; ///< s
    float tip_gain;
} wisp_strand_target_args;

#define WISP_MAX_GHOST_TARGETS 4

/// Arguments of ghost positions: y = x + R o + sway (weight + scale |o|), with the factor of sway clamped to the
/// limit.
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
    int stride;                 ///< floats per node: 8 or 12; blend: 16
    int target_count;           ///< blend: targets per ghost, 1 .. WISP_MAX_GHOST_TARGETS; otherwise 1
    bool rotates_offsets;       ///< blend: offsets rotate with the frames
    wisp_elastic elastic;       ///< blend
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
    bool shares_ends; ///< a segment spans the four vertices that it blends; otherwise it spans two and blends their
                      ///< neighbours too
} wisp_strand_curve_args;

typedef struct wisp_kernels
{
    const char* isa; ///< "baseline", "avx2" or "avx512"; tests have two more
    void ( *strand_jitter )( const wisp_strand_jitter_args* args, int group_begin, int group_end );
    void ( *strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end );
    void ( *strand_unpack )( const wisp_strand_unpack_args* args, int group_begin, int group_end );
    /// Find neighbours of queries [8 slice, 8 slice + count), count <= 8.
    void ( *range_search )( const wisp_range_search_args* args, int slice, int count,
                            wisp_range_search_result* result );
    /// Interleave eight lists; shorter lists are padded with the query's own slot.
    /// @param lists [8][stride] as written by range_search; renamed in place
    /// @param rename [slot] index to report for a slot; null: the slot itself
    /// @param packed [longest][8] output, with longest the maximum of counts
    void ( *interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                          int32_t* packed );
    /// Find boxes that overlap the queries, touching included, among some runs of slots, in slot order. A group
    /// with one query appends to its list. Lists need room for all compared slots and 8 more.
    /// @param runs [run_count][2] first slot and the slot after the last. Whole groups of eight slots are compared,
    /// so the next run must not begin before the last group of this run ends
    void ( *box_overlap )( const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
                           wisp_aabb_group* group );
    /// Sort distinct non-negative integers in increasing order, in time quadratic in count.
    /// @param items [count] padded by 8, padding may be overwritten
    /// @param out another array, padded likewise
    void ( *sort_items )( int32_t* items, int count, int32_t* out );
    /// Run one sweep of adhesion.
    /// @return maximum distance of a vertex from its position at the last search, m; 0 for a first sweep that a
    /// brake follows
    float ( *adhesion_attract )( const wisp_adhesion_args* args, int slice_first, int slice_last );
    float ( *adhesion_brake )( const wisp_adhesion_args* args, int slice_first, int slice_last );

    // links [begin, end), multiples of 8
    void ( *link_pbd )( const wisp_link_args* args, int begin, int end );
    void ( *link_xpbd )( const wisp_link_args* args, int begin, int end );
    void ( *link_unilateral )( const wisp_link_args* args, int begin,
                               int end ); ///< resists stretching only, stiffness 1
    /// clamps the length to [minimum, maximum] times rest
    void ( *link_limit )( const wisp_link_args* args, int begin, int end );
    // hinges [begin, end), multiples of 8
    void ( *hinge_dihedral )( const wisp_hinge_args* args, int begin, int end );
    void ( *hinge_isometric )( const wisp_hinge_args* args, int begin, int end );
    // slices of eight slots
    void ( *ring_gradient )( const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums );
    void ( *ring_normal )( const wisp_ring_args* args, int begin,
                           int end ); ///< area-weighted unit normals, 0 if they cancel
    /// Compute the normalised mean of the unit normals of the incident triangles, regardless of their areas; 0 if
    /// they cancel. Triangles without area, and those with a corner that is not finite, are skipped.
    /// @param xyzw [slot][4] output, the fourth component is 0
    void ( *ring_mean_normal )( const wisp_ring_args* args, int begin, int end, float* xyzw );
    /// Apply drag and lift. Triangles without area, and those with a corner that is not finite, are skipped.
    void ( *ring_air )( const wisp_ring_air_args* args, int begin, int end );
    void ( *push )( const wisp_push_args* args, int begin, int end );
    // points, multiples of 8
    /// Compute weighted points and normals.
    /// @return number of points whose normal was kept, padding included
    int ( *blend_two )( const wisp_blend_args* args, int begin, int end ); ///< reads only the first two parents
    int ( *blend_three )( const wisp_blend_args* args, int begin, int end );
    // slices of eight elements
    void ( *check_edge_extents )( const wisp_extent_args* args, int begin, int end );
    void ( *check_triangle_extents )( const wisp_extent_args* args, int begin, int end );
    // groups of eight pairs
    void ( *closest_triangle )( const wisp_closest_args* args, int begin, int end );
    void ( *closest_segments )( const wisp_closest_args* args, int begin, int end );
    /// Compute edge vectors and centres of the primitives of packs [begin, end).
    /// @param points per primitive: 1, 2 or 3
    void ( *place_primitives )( const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end );
    /// Find pairs of edges that may be within max_distance: pairs without a common point that no plane
    /// perpendicular to the line through their centres separates by max_distance. No pair within the distance is
    /// missed, except for rounding. NaN and infinity count as within.
    /// @param count of batch, at most WISP_PRIMITIVE_BATCH
    /// @param to output
    /// @return number of pairs
    int ( *find_near_edges )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    /// Find pairs of points and triangles in the same way.
    int ( *find_near_points )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    // points, begin a multiple of 8
    /// Sum displacements; up to a thousand are summed in floats. A displacement with a component beyond 1e6 m or
    /// NaN is skipped.
    /// @param sum [3] m, output
    /// @return whether a point has inverse mass 0
    bool ( *sum_displacements )( const wisp_displacement_args* args, int begin, int end, double sum[3] );
    /// Compute displacements and their uncertainty. A displacement longer than 1e6 m, or NaN, adds nothing to the
    /// uncertainty.
    void ( *measure_displacements )( const wisp_displacement_args* args, int begin, int end );
    /// Test predicted positions.
    /// @return whether a point deviates from its prediction by more than the uncertainty; false for NaN
    bool ( *exceeds_prediction )( const wisp_displacement_args* args, int begin, int end );
    // pairs [begin, end), multiples of 8
    void ( *max_approach )( const wisp_approach_args* args, int begin, int end );
    /// Find pairs of [begin, end) that may meet; only begin is a multiple of 8. NaN counts as active.
    /// @return number of pairs
    int ( *find_active_pairs )( const wisp_separation_args* args, int begin, int end );
    /// Compute a lower bound of the distance between two sets of points.
    /// @return m, the largest gap along the given axes, at least -1; below 0 if no axis separates the sets. Points
    /// that are NaN are ignored
    float ( *separation )( const wisp_separating_axis_args* args );
    /// Compute the minimum and maximum of each component over some points, less those of other rows if `less` is
    /// given. NaN is ignored.
    /// @param point_x4 [count] points times 4, count a multiple of 8
    void ( *xyzw_range )( const float* xyzw, const float* less, const int32_t* point_x4, int count, float lower[4],
                          float upper[4] );
    // groups of eight particles
    void ( *half_space )( const wisp_half_space_args* args, int begin, int end );
    // slots, multiples of 8
    void ( *tether )( const wisp_tether_args* args, int begin, int end );
    void ( *accelerate )( const wisp_particle_args* args, int begin, int end ); ///< v += dt acceleration
    void ( *predict )( const wisp_particle_args* args, int begin, int end );    ///< previous = p, p += dt v
    void ( *velocity )( const wisp_particle_args* args, int begin, int end );   ///< v += (p - (previous + dt v)) / dt
    void ( *rigid_sums )( const wisp_rigid_args* args, int begin, int end, wisp_rigid_sums* sums ); ///< sums: output
    void ( *rigid_approach )( const wisp_rigid_args* args, int begin,
                              int end ); ///< v += fraction (linear + angular x r - v)
    /// Gather particles that move and are finite: inverse mass above 0, both positions within 1e9 m.
    /// @return number of particles
    int ( *gather_particles )( const wisp_gather_args* args, int begin, int end );
    /// Transform gathered particles to the frame of a body and keep those that may touch it.
    /// @return number of candidates
    int ( *cull_particles )( const wisp_cull_args* args, int count );
    /// Find slots that have moved farther from `place` than its fourth component.
    /// @param displaced [end - begin] output
    /// @return number of slots
    int ( *find_displaced )( const float* position, const float* place, int begin, int end, int32_t* displaced );
    /// Find a component that is NaN or beyond the bound.
    /// @return its slot, the first if there are several; `end` if there is none
    int ( *find_out_of_bounds )( const wisp_bound_args* args, int begin, int end );
    // groups of sixteen strands
    void ( *strand_predict )( const wisp_strand_motion_args* args, int begin, int end );
    /// Run strand_velocity of the last substep and strand_predict in one pass.
    void ( *strand_advance )( const wisp_strand_motion_args* args, int begin, int end );
    void ( *strand_velocity )( const wisp_strand_motion_args* args, int begin, int end );
    /// Find a component that is NaN or beyond the bound.
    /// @return its row, the first if there are several; `end` if there is none
    int ( *strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end );
    void ( *strand_damp )( const wisp_strand_damp_args* args, int begin, int end );
    void ( *strand_air )( const wisp_strand_air_args* args, int begin, int end );
    /// Make segments inextensible.
    /// @return number of strands that were reset to rest lengths from the root
    int ( *strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end );
    void ( *strand_link )( const wisp_strand_link_args* args, int begin, int end );
    void ( *strand_follow )( const wisp_strand_follow_args* args, int begin, int end );
    void ( *strand_rod )( const wisp_strand_rod_args* args, int begin, int end );
    /// Begin an iteration, before the first body: set depths, clear sums, and compute the bounds of the group.
    void ( *strand_contact_begin )( const wisp_strand_contact_args* args, int group, bool first_iteration,
                                    wisp_strand_bounds* reach );
    void ( *strand_contact )( const wisp_strand_contact_args* args, int begin, int end );
    void ( *strand_target )( const wisp_strand_target_args* args, int begin, int end );
    void ( *strand_ghost )( const wisp_strand_ghost_args* args, int begin, int end );
    void ( *strand_ghost_blend )( const wisp_strand_ghost_args* args, int begin, int end ); ///< of several targets
    void ( *strand_curve )( const wisp_strand_curve_args* args, int begin, int end );
    // slices of eight rows
    /// Assemble the system.
    /// @return number of links without a direction, counted at either end
    int ( *spring_assemble )( const wisp_spring_args* args, int begin, int end );
    double ( *spring_product )( const wisp_conjugate_args* args, int begin, int end ); ///< q = A c; @return c . q
    /// r -= step q, s = S P S r; @return r . s
    double ( *conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end );
    /// dv += step c, c = s + fraction c: completes a conjugate gradient iteration
    void ( *conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end );
    // slices of eight children
    void ( *prolong )( const wisp_prolong_args* args, int begin, int end );
} wisp_kernels;

WISP_END_C
