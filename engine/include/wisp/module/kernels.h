/// Projections and range kernels shared by modules, by their mathematical name. One source, compiled once per
/// instruction set, reached through a table; every table gives the same bits.
#pragma once

#include "wisp/module/primitives.h"
#include "wisp/module/random.h"
#include "wisp/module/springs.h"
#include "wisp/module/particle_batch.h"
#include "wisp/shapes.h"
#include "wisp/variants.h"

WISP_BEGIN_C

/// Strands are lane-interleaved: sixteen strands a group, lane = strand, row = vertex.
#define WISP_LANES 16
/// Pairwise sums run over slices of eight consecutive items.
#define WISP_SLICE 8

/// Jitter of segment lengths and directions along strands (Kim 2026, eq. 2-7). In place, from root to tip.
typedef struct wisp_strand_jitter_args
{
    const int32_t* group_row;   ///< [group_count + 1] first row of a group
    const int32_t* lane_strand; ///< [group_count][16] the strand's number, keys the random numbers
    const float* rest;          ///< [row][3][16] m, gives the rest lengths
    float* position;            ///< [row][3][16] m, base shape in, deformed shape out
    const float* stretch;       ///< [group_count][16] stretching stiffness k_s > 0
    const float* bend;          ///< [group_count][16] bending stiffness k_b > 0
    wisp_random_key length_key, angle_key, axis_key;
    float angle_max; ///< rad, the largest angle at stiffness 1
    float epsilon;   ///< added to denominators as printed; 0 is the resolved form
    int dimension;   ///< 2: bends about the z axis where a strand is straight; 3: about a random perpendicular
} wisp_strand_jitter_args;

/// Rotation of whole strands about their roots towards a target (Kim 2026, eq. 8-13). In place.
typedef struct wisp_strand_align_args
{
    const int32_t* group_row;  ///< [group_count + 1]
    const int32_t* lane_count; ///< [group_count][16] vertices of the strand, 0 in an empty lane
    float* position;           ///< [row][3][16] m
    const float* intensity;    ///< [group_count][16] weight x at the root, in [0, 1]
    wisp_vec3 target;          ///< m
    float radius;              ///< m, strands outside are left as they are, bit for bit
    bool chord;                ///< blend positions (printed) instead of turning by part of the angle
    bool from_root;            ///< direction tip - root instead of tip - mean
    bool nearest;              ///< inside if any vertex is within radius, not only the tip
    int dimension;             ///< 2: an antiparallel strand turns about the z axis
} wisp_strand_align_args;

/// Copy strands out of their lanes into the user's order, or items for a grid.
typedef struct wisp_strand_unpack_args
{
    const int32_t* group_row;
    const int32_t* lane_strand;
    const int32_t* lane_count;
    const int32_t* offsets; ///< [strand_count + 1] the user's order
    const float* position;  ///< [row][3][16]
    float* points;          ///< [vertex_count][3] m
} wisp_strand_unpack_args;

/// All items within a radius of eight queries, through the rows of a uniform grid.
typedef struct wisp_range_search_args
{
    const float *x, *y, *z;    ///< [slot] items sorted by cell, padded by 16
    const int32_t* owner;      ///< [slot] items of the query's own owner are left out
    const int32_t* cell_begin; ///< [cell_count + 1]
    float origin[3];           ///< m
    float inverse_cell[3];     ///< 1/m
    int dims[3], axis[3];      ///< as in wisp_grid
    int cell_reach[3];         ///< cells to search on each side, along axis[0], axis[1], axis[2]
    float near_radius;         ///< m, below it a neighbour is near
    float skin_radius;         ///< m, from the near radius to here it is in the shell; 0: no shell
    int limit;                 ///< most near neighbours, and most in the shell: the first in order
    const float* xyzw;         ///< [query][4] x y z, owner as int bits
    bool planar;               ///< every z is the same
} wisp_range_search_args;

/// Lists have room for this many entries beyond the limit, because they are written eight at a time.
#define WISP_SEARCH_PADDING 16

/// What eight queries found. Arrays are the caller's.
typedef struct wisp_range_search_result
{
    int32_t* lists; ///< [8][2 limit + slack] 4 times the numbers: the near ones, and the shell behind them
    int32_t* skin;  ///< [8][limit + slack] for the search alone
    int near_count[WISP_SLICE]; ///< of a lane's list
    int count[WISP_SLICE];      ///< with the shell
    int near_length, length;    ///< the longest of the eight
    int capped;                 ///< grows by the queries that ran into the limit
} wisp_range_search_result;

/// Boxes as streams, sorted so that boxes that are tested together are stored together.
typedef struct wisp_aabb_stream
{
    const float *lower[3], *upper[3]; ///< [slot] m, padded by 8 that overlap nothing
    const int32_t* item;              ///< [slot] the box's number, padded by 8
} wisp_aabb_stream;

/// Query boxes, and the boxes that overlap them.
typedef struct wisp_aabb_group
{
    int count;                  ///< of queries
    float box[WISP_SLICE][6];   ///< low x, y, z, high x, y, z
    int32_t above[WISP_SLICE];  ///< only items of a higher number
    int32_t* found[WISP_SLICE]; ///< lists; the first is the caller's, each other lies 8 entries behind the one before
    int found_count[WISP_SLICE];
} wisp_aabb_group;

/// So many slots are compared with several queries at most.
#define WISP_MAX_SHARED_AABBS 1024

/// Lists of slices: entry k of slice s is entries[8 (begin[s] + k) ..], one query a lane.
typedef struct wisp_neighbour_list
{
    const int32_t* begin;   ///< [slice_count]
    const int32_t* length;  ///< [slice_count] entries a lane
    const int32_t* entries; ///< [entry][8] 4 times the numbers of neighbours; a lane's own number pads
} wisp_neighbour_list;

/// What the brake remembers of the pairs of a list at the reference shape.
typedef struct wisp_reference_pairs
{
    float* distance;   ///< [entry][8] m, r0; beyond any radius for padding, so that g(r0) is 0
    float* weight_sum; ///< [slot]
    int32_t* near;     ///< [slice] pairs above 0 and below the radius
} wisp_reference_pairs;

/// Pairwise adhesion with a gap-keeping brake (Kim 2026, eq. 14-19), one Jacobi iteration in two sweeps.
/// Sums run over a slice's entries in their order, lane by lane, so they do not depend on the lane width.
typedef struct wisp_adhesion_args
{
    const float* current;              ///< [slot][4] p(k)
    float* tentative;                  ///< [slot][4] p(k) + Dp(k); the first sweep writes it, the second reads it
    float* displacement;               ///< [slice][3][8] Dp(k), guarded
    float* next;                       ///< [slot][4] p(k+1)
    const float* search_position;      ///< [slot][4] where the attracting lists were searched
    const int32_t* owner;              ///< [slot] strand
    const int32_t* vertex;             ///< [slot] index in the strand; 0 does not move
    wisp_neighbour_list attracting[2]; ///< the first sweep's lists, added one after the other
    int attracting_count;
    wisp_neighbour_list reference[2]; ///< the second sweep's lists: neighbours at the reference shape
    int reference_count;
    wisp_reference_pairs* pairs; ///< of reference[0]; null: the second sweep measures at `current`
    bool stores_pairs;           ///< the first sweep, over reference[0] alone, fills `pairs`
    float search_margin;         ///< m, a vertex farther than this from its position at the search needs a new search
    uint8_t* needs_search; ///< [slice] a bit a lane, of the sweep that moves: the second, the first without brake
    wisp_random_key key;
    uint32_t iteration;
    float radius;       ///< h, m
    float step;         ///< sigma, m
    float epsilon;      ///< m, added to r in the direction as printed; 0 is the resolved form
    float distance_min; ///< r_min, m; the guard keeps pairs at least so far apart
    float lambda_min;   ///< the brake's floor where the distance changes by h
    bool min_distance_clamp;
    bool planar; ///< every z is 0
    int gap;     ///< wisp_gap
} wisp_adhesion_args;

/// Distances between two particles (pbd: Mueller et al. 2007; xpbd: Macklin, Mueller and Chentanez 2016, eq.
/// 17-18). Groups of eight slots share no particle. Links of length 0 and links between two pinned ends do nothing.
typedef struct wisp_link_args
{
    float* position;            ///< [slot][4] x, y, z in m, inverse mass in 1/kg
    const int32_t *a_x4, *b_x4; ///< [link] slots times 4
    const float* rest;          ///< [link] m
    const float* stiffness;     ///< [link] pbd: share of the error taken away, in [0, 1]
    const float* compliance;    ///< [link] xpbd: m/N
    float* lambda;              ///< [link] xpbd: N s^2, of this substep; null: one iteration, so it starts at 0
    float inverse_dt2;          ///< xpbd: 1/s^2
    float minimum, maximum;     ///< strain limit: shortest and longest length allowed, times the rest length
} wisp_link_args;

/// Bending over an interior edge: ends i, j and opposite vertices k, l.
typedef struct wisp_hinge_args
{
    float* position;        ///< [slot][4]
    const int32_t* slot_x4; ///< [group][4][8] i, j, k, l, slots times 4
    const float* rest; ///< dihedral: [hinge] rad, rest angle between the normals, 0 is flat. Isometric: [group][4][8]
                       ///< the vector c of Q = c c^T / A, so that Q x = c (c . x) / A (Bergou et al. 2006)
    const float* scale;      ///< isometric: [hinge] 1 / A in 1/m^2 with A the area of both triangles
    const float* stiffness;  ///< pbd: [hinge] in [0, 1]; null for xpbd
    const float* compliance; ///< xpbd: [hinge] dihedral: rad^2/J; isometric: 1/J with the energy of curvature
    float* lambda;           ///< [hinge], null: one iteration
    float inverse_dt2;
} wisp_hinge_args;

/// Area vectors and volume around vertices (docs/methods.md, volume and its gradient), vertex by vertex over ordered one-rings.
typedef struct wisp_ring_args
{
    const float* position;         ///< [slot][4]; slice s holds the slots from 8 s
    const int32_t* ring_begin;     ///< [slice + 1]
    const int32_t ( *ring_x4 )[8]; ///< [entry] fans of neighbours
    wisp_vec3 origin;              ///< m, volumes are summed about it; near the body keeps digits
    float* gradient; ///< [slice - first_slice][3][8] m^2, dV/dp = a sixth of the sum of (a - p) x (b - p);
                     ///< ring_normal: unit normals
    float* area;     ///< [slice - first_slice][8] m^2, a third of the triangles' areas; may be null
    int first_slice; ///< where gradient and area begin
} wisp_ring_args;

/// Drag and lift of air on the triangles around vertices, implicit in how fast it takes them along.
typedef struct wisp_ring_air_args
{
    const float* position;         ///< [slot][4] m, inverse mass; what has none keeps its velocity
    const float* old_velocity;     ///< [slot][4] m/s, of before: neighbours must not see what was changed
    float* velocity;               ///< [slot][4] receives; the fourth is that of before
    const int32_t* ring_begin;     ///< [slice + 1]
    const int32_t ( *ring_x4 )[8]; ///< [entry] fans of neighbours
    wisp_vec3 wind;                ///< m/s
    float density;                 ///< kg/m^3
    float drag, lift;              ///< C_d, C_l
    float dt;                      ///< s
} wisp_ring_air_args;

/// Sums over a range of slices, each in double from eight ordered lanes of floats.
typedef struct wisp_ring_sums
{
    double volume;   ///< m^3, sum of (p - origin) . gradient / 3
    double weighted; ///< m^4/kg, sum of w |gradient|^2
} wisp_ring_sums;

/// Points that stand between three parents, or two, by weights: y = sum of w x, and the unit normal along the sum of w n.
typedef struct wisp_blend_args
{
    const float* position;              ///< [slot][4] m
    const float* normal;                ///< [slot][4] unit, the fourth 0; null: points get none
    const int32_t ( *parents )[4];      ///< [point] slots times 4; padded to a multiple of 8, as are all of points
    const float ( *weights )[4];        ///< [point]
    const float ( *normal_weights )[4]; ///< [point] of normals; null: `weights`
    float* xyzw;                        ///< [point][4] m; the fourth stays as it is
    float* normals; ///< [point][4] the fourth is 0; where the sum is shorter than WISP_MIN_BLEND_LENGTH
                    ///< the normal stays as it is, and its fourth becomes 1
} wisp_blend_args;

/// Unit normals are true to about 1e-7 a number, so a shorter sum of opposite ones is a direction of rounding alone.
#define WISP_MIN_BLEND_LENGTH 1e-6f

/// Which edges and triangles still have the extents, over the spacing, that their counts of points stand for? Only a sure
/// yes is a yes: rounding is in the bounds.
typedef struct wisp_extent_args
{
    const float* position;              ///< [slot][4] m
    const int32_t ( *pair_x4 )[2][8];   ///< edges: [slice] slots times 4 of the ends
    const int32_t ( *corner_x4 )[3][8]; ///< triangles: [slice] a, b, c, slots times 4; a to b is the shortest side
    float spacing;                      ///< m
    const float* element_spacing;       ///< [element] m; null: `spacing` for all
    const float *lower, *upper;         ///< [element] of length over spacing, of a triangle's base over spacing
    const float *lower_height, *upper_height; ///< [triangle] of height over spacing
    uint8_t* unchanged;                       ///< [slice] out: a bit an element
} wisp_extent_args;

/// Closest points of pairs, eight pairs at a time: a point and a triangle, or two segments. Triangles may be flat and
/// segments without length. A pair with a number that is not finite, or one wider than 1e18 m, has a distance that is not
/// finite; its weights and its normal are then of no use.
typedef struct wisp_closest_args
{
    const float* xyzw; ///< [point][4] m; the fourth number is not looked at; 16-byte aligned
    const int32_t*
        point_x4[4]; ///< [pair] points times 4: p, a, b, c, or the ends a, b of one segment and c, d of the other
    float* distance; ///< [pair] out, m; 0 below 1e-19 m
    /// [group] out, barycentric, those of the second side negative; null: not wanted. The weights of a side sum to 1
    /// without rounding, so that they mean the same anywhere.
    float ( *weight )[4][8];
    /// [group] out, unit, from the second side to the first; 0 where the distance is 0; null with weight. The plane
    /// across it parts the sides as far as they are from each other.
    float ( *normal )[3][8];
} wisp_closest_args;

/// Move particles along a gradient: p += w factor gradient.
typedef struct wisp_push_args
{
    float* position;       ///< [slot][4]
    const float* gradient; ///< [slice][3][8]
    float factor;
} wisp_push_args;

/// Keep particles within a distance of their attachments. Only the particle moves, and only if the attachment is pinned, so
/// that each particle may go through all layers before the next one.
typedef struct wisp_tether_args
{
    float* position;          ///< [slot][4]
    const int32_t* anchor_x4; ///< [layer][slot_count] the fabric's tethers
    const float* rest;        ///< [layer][slot_count] m
    int layer_count, slot_count;
    float slack; ///< times the rest length, >= 1
} wisp_tether_args;

/// Carry the displacement of a coarse level to its children: p += sum of weights times the displacements of the parents.
typedef struct wisp_prolong_args
{
    float* position; ///< [slot][4]
    const float*
        displacement; ///< [slot][4] m, how far the level's vertices were moved by all levels so far; the fourth is 0
    const int32_t* child_x4;  ///< [slice][8]
    const int32_t* parent_x4; ///< [slice][4][8]
    const float* weight;      ///< [slice][4][8]
} wisp_prolong_args;

/// Half spaces that particles must stay in, one of each, with Coulomb friction: half_space.c has the equations. A row of 16
/// floats is: a point of the surface, its unit normal away from the body, its motion in the substep, the gap to be kept
/// (m); what was pushed along the normal and rubbed across it so far (m), in and out; static and kinetic friction.
typedef struct wisp_half_space_args
{
    float* position;            ///< [slot][4] in and out
    const float* previous;      ///< [slot][4] at the start of the substep
    float* rows;                ///< [..][16], aligned to 16 bytes
    const int32_t* particle_x4; ///< four times the particle. Twice among eight only with the same row, as padding
    const int32_t* row_x16;     ///< 16 times its row
} wisp_half_space_args;

/// Time integration of particles (Mueller et al. 2007, algorithm 1). Pinned particles have no velocity of their own and keep their place.
typedef struct wisp_particle_args
{
    float* position;        ///< [slot][4]
    float* previous;        ///< [slot][4] position at the start of the substep
    float* velocity;        ///< [slot][4] m/s, the fourth is 0
    wisp_vec3 acceleration; ///< m/s^2, of every particle that is not pinned
    float dt;               ///< s
} wisp_particle_args;

/// Are particles where and as fast as particles can be?
typedef struct wisp_bound_args
{
    const float* position; ///< [slot][4] m
    const float* velocity; ///< [slot][4] m/s
    float bound;           ///< of the magnitude of each of their first three numbers
} wisp_bound_args;

/// Are vertices where and as fast as vertices can be?
typedef struct wisp_strand_bound_args
{
    const float* position; ///< [row][3][16] m
    const float* velocity; ///< [row][3][16] m/s
    float bound;           ///< of the magnitude of each number, lanes without a strand included
} wisp_strand_bound_args;

/// Strands in time, lane = strand. Pinned vertices (inverse mass 0) have the velocity of their motion.
typedef struct wisp_strand_motion_args
{
    const int32_t* group_row;
    float* position;           ///< [row][3][16] m
    float* previous;           ///< [row][3][16] m, position at the start of the substep
    float* velocity;           ///< [row][3][16] m/s
    const float* inverse_mass; ///< [row][16] inverse mass in 1/kg; 0: pinned, behind the tip, or no strand
    const float* root;         ///< [group][3][16] m, where pinned vertices of row 0 go; null: they stay
    wisp_vec3 acceleration;
    const float* acceleration_scale; ///< [group][16] of the acceleration that a strand feels; null: all of it
    float dt;                        ///< s
} wisp_strand_motion_args;

/// Damping of what moves against a rigid motion: v <- u + keep (v - u) with u = linear + angular x (p - centre).
typedef struct wisp_strand_damp_args
{
    const int32_t* group_row;
    const float* position;     ///< [row][3][16]
    float* velocity;           ///< [row][3][16]
    const float* inverse_mass; ///< [row][16]
    float retained_fraction;   ///< in [0, 1]
    wisp_vec3 linear, angular, centre;
} wisp_strand_damp_args;

/// Drag of air across a strand: what moves along it feels nothing. Implicit in the speed, so it never turns it round.
typedef struct wisp_strand_air_args
{
    const int32_t* group_row;
    const float* position;     ///< [row][3][16]
    float* velocity;           ///< [row][3][16]
    const float* inverse_mass; ///< [row][16]
    const float* length;       ///< [row][16] m
    wisp_vec3 wind;            ///< m/s
    float drag;                ///< kg/m^2: 1/2 density C_d diameter
    float dt;
} wisp_strand_air_args;

/// Segments of rest length by one direct solve of the chain, Newton pass by Newton pass: with C_s = (|e_s|^2 - l_s^2) / 2 the
/// system J W J^T dlambda = -C is tridiagonal, and costs one quotient a segment and no root. Passes end early when all
/// strands of a group are exact to single precision, or to `tolerance` where that is finer. A strand that is not within
/// `tolerance` after the last pass is laid out from the root, each segment in its direction (or, without one, in that of the
/// segment before it); if that carries a vertex farther than the strand is long, the vertex loses its velocity. Strands with
/// further pins are not laid out.
typedef struct wisp_strand_stretch_args
{
    const int32_t* group_row;
    float* position;           ///< [row][3][16]
    const float* inverse_mass; ///< [row][16]
    const float* length;       ///< [row][16] m, > 0: of the segment from this row to the next; 0 behind the tip
    float* tension;            ///< [row][16] N, of that segment; null: not wanted
    bool accumulates_tension;  ///< add to what is there instead of beginning at 0
    int iterations;            ///< >= 1
    float tolerance;           ///< of |l/l0 - 1|
    float* previous;           ///< [row][3][16], moved along where a vertex loses velocity
    const float* velocity;     ///< [row][3][16] m/s, predicted: what is laid out gets no faster; null: it may
    float dt;
    float* scratch; ///< WISP_STRAND_SCRATCH floats a row of the longest group
} wisp_strand_stretch_args;

/// Floats a row that a strand kernel may use.
#define WISP_STRAND_SCRATCH ( 15 * WISP_LANES )

/// Distances along strands in one sweep from the root, between rows `stride` apart (pbd, xpbd: as wisp_link_args).
typedef struct wisp_strand_link_args
{
    const int32_t* group_row;
    float* position;
    const float* inverse_mass;
    const float* rest; ///< [row][16] m, between this row and the one `stride` behind it; 0 or less: no link
    float* lambda;     ///< xpbd: [row][16] N s^2 of this substep; null: one iteration
    int stride;        ///< 1 or 2
    float stiffness;   ///< pbd: share of the error taken away, in [0, 1]
    float compliance;  ///< xpbd: m/N
    float inverse_dt2; ///< xpbd: 1/s^2; 0: pbd
} wisp_strand_link_args;

/// Follow the leader: each vertex is put at rest length from the one before it, which does not move for it (Mueller, Kim
/// and Chentanez 2012). Moving `previous` along gives the leader its share of the momentum back when velocities are read.
typedef struct wisp_strand_follow_args
{
    const int32_t* group_row;
    float* position;
    float* previous;
    const float* inverse_mass;
    const float* length;
    float leader_correction; ///< s of the paper, in [0, 1]
} wisp_strand_follow_args;

/// Bending and twist of elastic rods, implicit in the positions. Vertex i bends with the energy
///   1/2 EI/L_i |C_i|^2,   C_i = (p_{i+1} - p_i)/l_i - (p_i - p_{i-1})/l_{i-1} - k_i,
/// which is quadratic while the frames that carry the rest vectors k_i stay: (M + dt^2 K) x = -dt^2 dE/dp is one
/// pentadiagonal system for x, y and z alike, whose factors are kept. Frames are carried along without twist, to where the
/// strand goes by itself (p less dt^2 acceleration); then the twist takes its balance, a tridiagonal system. Segment -1 is
/// the clamp at the root.
typedef struct wisp_strand_rod_args
{
    const int32_t* group_row;
    float* position;             ///< [row][3][16] m, predicted; in and out
    const float* previous;       ///< [row][3][16] m
    const float* inverse_mass;   ///< [row][16]
    const float* inverse_length; ///< [row][16] 1/m of the segment to the next row; 0 where there is none
    const float* stiffness;      ///< [row][16] N m, EI / L_i; 0: vertex i does not bend
    const float* factor;      ///< [row][3][16] 1/pivot, L(i, i-1), L(i, i-2) of L D L^T = M + (dt^2 + damping dt) K
    float* tension;           ///< [row][16] N, of the substep before: it pulls along, so that at rest nothing moves
    const float* max_tension; ///< [row][16] N: no more than that pulls, and tension is cut to it
    const float* root;        ///< [group][4][16] quaternion x y z w: how the root is turned from rest
    const float* clamp;       ///< [group][4][16] rest frame of the clamp; its z axis is the direction of growth
    float* frame;             ///< [row][4][16] frame of the segment to the next row, z axis along it; null: straight
    const float* rest;        ///< [row][3][16] k_i in the middle frame of vertex i; with frames only
    const float* rest_twist;  ///< [row][2][16] cosine and sine of half the rest twist; with frames only
    const float* twist_stiffness;    ///< [row][16] N m, GJ / L_i; with frames only
    float damping;                   ///< s, of the bending's rate
    wisp_vec3 acceleration;          ///< m/s^2, of the prediction
    const float* acceleration_scale; ///< [group][16] of it that a strand feels; null: all of it
    float dt;
    float* scratch; ///< WISP_STRAND_SCRATCH floats a row of the longest group
} wisp_strand_rod_args;

/// Strands kept out of one body in closed form, with Coulomb friction. Vertices nearer to it than the thickness, where it is
/// at the end of the substep, are pushed out along its normal there; pinned ones stay. strand_contact.c has the equations.
typedef struct wisp_strand_contact_args
{
    const int32_t* group_row;
    float* position; ///< [row][3][16] m, in and out
    float* previous; ///< [row][3][16] m, position at the start of the substep; goes along with what is healed
    const float* inverse_mass; ///< [row][16]
    float* allowed_depth; ///< [row][16] m, how much nearer than the thickness a vertex may be; infinite: as it began
    float* normal_correction; ///< [row][16] m, grows by what the body pushed: stands for the normal impulse
    float* remaining_depth;   ///< [row][16] m, grows to how much nearer than the thickness a vertex was let be
    wisp_shape shape;
    wisp_transform before, after; ///< the body at the start and at the end of the substep
    float thickness;              ///< m
    float static_friction, kinetic_friction;
    float max_push_out; ///< m, how far what may be deep is moved out in this call
} wisp_strand_contact_args;

/// Where the vertices of a group that move are, and were when the substep began. Empty (low above high) if none moves.
typedef struct wisp_strand_bounds
{
    wisp_vec3 lower, upper; ///< m
    float max_path;         ///< m, the longest from then to now
} wisp_strand_bounds;

/// How a change of velocity weighs, from the velocity v now and v0 a step before.
typedef enum wisp_elastic
{
    WISP_ELASTIC_CHANGE,  ///< 1/2 - 1/2 cos(v, v0); 0 where one of them is slower than 1e-6 m/s
    WISP_ELASTIC_COSINE,  ///< 1/2 + 1/2 cos(v, v0); 1/2 where one of them is slower
    WISP_ELASTIC_PRODUCT, ///< 1/2 v . v0 + 1/2
    WISP_ELASTIC_NONE,    ///< 0
} wisp_elastic;

/// Table of what all ghosts of a target share, node by node, in rows of four floats. A node has `stride` floats:
///   x, y, z, weight     where it is; the sum of the elastic weight and tip_gain i / (n - 1)
///   x, y, z, limit      time times its velocity, 0 at the root; the largest weight that keeps the sway within the cap
///   x, y, z, w          stride 12 and 16: quaternion, how its frame is turned from rest
///   x, y, z, 0          stride 16: the velocity before
/// Blended, the weight lacks the elastic one, the velocity is not times the time, and the limit is the cap in m.
typedef struct wisp_strand_target_args
{
    const int32_t* group_row;
    const int32_t* lane_count;      ///< [group][16] nodes, 0 in an empty lane
    const int32_t* lane_node;       ///< [group][16] float of the table where the rows of the root begin
    const float* position;          ///< [row][3][16] m
    const float* rest;              ///< [row][3][16] m
    const float* velocity;          ///< [row][3][16] m/s; null: at rest
    const float* previous_velocity; ///< [row][3][16] m/s, a step before; null: as now
    const float* max_sway;          ///< [row][16] m, what the sway of a node must not exceed
    const float* root;              ///< [group][4][16] quaternion, how roots are turned from rest; null: not
    float* table;
    int stride;             ///< 8: no frames, 12 or 16
    bool transports_frames; ///< from the root on by the smallest rotations, else all nodes have the root's
    bool is_capped, is_blended;
    wisp_elastic elastic;
    float sway_time; ///< s
    float tip_gain;
} wisp_strand_target_args;

#define WISP_MAX_GHOST_TARGETS 4

/// Places of ghosts: y = x + R o + sway (weight + scale |o|), the weight within the limit.
typedef struct wisp_strand_ghost_args
{
    const int32_t* group_row;
    const int32_t* lane_count;
    const int32_t* lane_node;   ///< [group][link][16] float of the table where the target's root begins
    const float* lane_fraction; ///< blend: [group][link][16] weight of the target, sum 1
    const float* centre_scale;  ///< [group][16] 1/m
    const float* offset;        ///< [row][link][3][16] m, at rest
    const float* table;
    int stride;           ///< 8 or 12; blend: 16
    int target_count;     ///< blend: targets a ghost, 1 .. WISP_MAX_GHOST_TARGETS; else 1
    bool rotates_offsets; ///< blend: offsets turn with the frames
    wisp_elastic elastic; ///< blend
    float sway_time;      ///< blend: s
    float* points;        ///< [row][3][16] m
} wisp_strand_ghost_args;

/// Curves through the vertices of strands: a row for the first vertex, then `samples` rows a segment.
typedef struct wisp_strand_curve_args
{
    const int32_t* group_row;     ///< of the curves
    const int32_t* lane_row;      ///< [group][16] float of `from` where the strand's first vertex is
    const int32_t* lane_vertices; ///< [group][16] vertices of the strand, 0 in an empty lane
    const float* from;            ///< [row][3][16] m, the strands
    float* to;                    ///< [row][3][16] m
    const float* weight;          ///< [samples][4] of the four points that a segment blends, at t = (k + 1) / samples
    int samples;
    bool shares_ends; ///< a segment spans four vertices and blends them; else two, and it blends their neighbours too
} wisp_strand_curve_args;

typedef struct wisp_kernels
{
    const char* isa; ///< "baseline", "avx2", "avx512"; tests know two more
    void ( *strand_jitter )( const wisp_strand_jitter_args* args, int group_begin, int group_end );
    void ( *strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end );
    void ( *strand_unpack )( const wisp_strand_unpack_args* args, int group_begin, int group_end );
    /// Neighbours of queries [8 slice, 8 slice + count), count <= 8.
    void ( *range_search )( const wisp_range_search_args* args, int slice, int count,
                            wisp_range_search_result* result );
    /// Lay eight lists side by side, a query's own number behind the shorter ones.
    /// @param lists [8][stride] as range_search wrote them; renamed in place
    /// @param rename [slot] what to report for a slot, null for the slot itself
    /// @param packed [longest][8], longest that of counts
    void ( *interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                          int32_t* packed );
    /// Find the boxes of some runs of slots that overlap the queries, touching included, in the order of slots. A lone query
    /// adds to its list. Lists have room for all that is compared and 8 more.
    /// @param runs [run_count][2] first slot, and the one behind the last. Slots are compared in whole eights, so that the
    ///             next run must not begin before the eights of this one end
    void ( *box_overlap )( const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
                           wisp_aabb_group* group );
    /// Put different numbers, none negative, in rising order. Takes time with the square of the count.
    /// @param items [count] padded by 8, which may be overwritten @param out another array, padded likewise
    void ( *sort_items )( int32_t* items, int count, int32_t* out );
    /// @return how far a vertex is at most from where it was searched, m; 0 of a first sweep that a brake follows
    float ( *adhesion_attract )( const wisp_adhesion_args* args, int slice_first, int slice_last );
    float ( *adhesion_brake )( const wisp_adhesion_args* args, int slice_first, int slice_last );

    // links [begin, end), multiples of 8
    void ( *link_pbd )( const wisp_link_args* args, int begin, int end );
    void ( *link_xpbd )( const wisp_link_args* args, int begin, int end );
    void ( *link_unilateral )( const wisp_link_args* args, int begin,
                               int end );                                   ///< resists stretching only, stiffness 1
    void ( *link_limit )( const wisp_link_args* args, int begin, int end ); ///< into [minimum, maximum] times rest
    // hinges [begin, end), multiples of 8
    void ( *hinge_dihedral )( const wisp_hinge_args* args, int begin, int end );
    void ( *hinge_isometric )( const wisp_hinge_args* args, int begin, int end );
    // slices of eight slots
    void ( *ring_gradient )( const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums );
    void ( *ring_normal )( const wisp_ring_args* args, int begin,
                           int end ); ///< area-weighted unit normals, 0 if they cancel
    /// Mean of the unit normals of the triangles around a vertex, normalised, whatever their areas; 0 if they cancel.
    /// Triangles without area, and those with a corner that is not finite, add nothing. xyzw [slot][4], the fourth is 0
    void ( *ring_mean_normal )( const wisp_ring_args* args, int begin, int end, float* xyzw );
    /// Triangles without area, and those with a corner that is not finite, feel nothing.
    void ( *ring_air )( const wisp_ring_air_args* args, int begin, int end );
    void ( *push )( const wisp_push_args* args, int begin, int end );
    // points, multiples of 8
    /// @return points without a normal, padding included
    int ( *blend_two )( const wisp_blend_args* args, int begin, int end ); ///< reads the first two parents alone
    int ( *blend_three )( const wisp_blend_args* args, int begin, int end );
    // slices of eight elements
    void ( *check_edge_extents )( const wisp_extent_args* args, int begin, int end );
    void ( *check_triangle_extents )( const wisp_extent_args* args, int begin, int end );
    // groups of eight pairs
    void ( *closest_triangle )( const wisp_closest_args* args, int begin, int end );
    void ( *closest_segments )( const wisp_closest_args* args, int begin, int end );
    /// Compute the places of the primitives of packs [begin, end). @param points per primitive: 1, 2 or 3
    void ( *place_primitives )( const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end );
    /// Find pairs of edges without a common point that a plane across the line through their centres does not separate by
    /// max_distance. No pair within the distance is missing, except for rounding. NaN and infinity count as within.
    /// @param count of batch, at most WISP_PRIMITIVE_BATCH @param to out @return number of pairs
    int ( *find_near_edges )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    /// Find pairs of points and triangles in the same way.
    int ( *find_near_points )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    // points, begin a multiple of 8
    /// Sum displacements; up to a thousand are added as floats. A component longer than 1e6 m, or NaN, adds nothing.
    /// @param sum [3] m, out @return whether a point has inverse mass 0
    bool ( *sum_displacements )( const wisp_displacement_args* args, int begin, int end, double sum[3] );
    /// Compute displacements and their uncertainty, to which a displacement longer than 1e6 m, or NaN, adds nothing.
    void ( *measure_displacements )( const wisp_displacement_args* args, int begin, int end );
    /// @return whether a point is farther from its predicted position than the uncertainty; NaN is not
    bool ( *exceeds_prediction )( const wisp_displacement_args* args, int begin, int end );
    // pairs [begin, end), multiples of 8
    void ( *max_approach )( const wisp_approach_args* args, int begin, int end );
    /// Find pairs of [begin, end) that may meet; only begin is a multiple of 8. NaN counts as active. @return their number
    int ( *find_active_pairs )( const wisp_separation_args* args, int begin, int end );
    /// @return m, the distance of the sets along the best of the axes, at least -1; below 0 if no axis separates them. Points
    ///         that are NaN are ignored
    float ( *separation )( const wisp_separating_axis_args* args );
    /// Find the minimum and maximum of each component of some rows, minus those of other rows if there are any. NaN is
    /// ignored. @param point_x4 [count] points times 4, count a multiple of 8
    void ( *xyzw_range )( const float* xyzw, const float* less, const int32_t* point_x4, int count, float lower[4],
                          float upper[4] );
    // groups of eight particles
    void ( *half_space )( const wisp_half_space_args* args, int begin, int end );
    // slots, multiples of 8
    void ( *tether )( const wisp_tether_args* args, int begin, int end );
    void ( *accelerate )( const wisp_particle_args* args, int begin, int end ); ///< v += dt acceleration
    void ( *predict )( const wisp_particle_args* args, int begin, int end );    ///< previous = p, p += dt v
    void ( *velocity )( const wisp_particle_args* args, int begin, int end );   ///< v += (p - (previous + dt v)) / dt
    void ( *rigid_sums )( const wisp_rigid_args* args, int begin, int end, wisp_rigid_sums* sums ); ///< sums: out
    void ( *rigid_approach )( const wisp_rigid_args* args, int begin,
                              int end ); ///< v += fraction (linear + angular x r - v)
    /// Gather particles that move and are finite: inverse mass above 0, both positions within 1e9 m. @return their number
    int ( *gather_particles )( const wisp_gather_args* args, int begin, int end );
    /// Transform gathered particles to the frame of a body. @return number of candidates
    int ( *cull_particles )( const wisp_cull_args* sight, int count );
    /// @param strays [end - begin] out: slots farther from `place` than its fourth component @return their number
    int ( *find_displaced )( const float* position, const float* place, int begin, int end, int32_t* strays );
    /// @return the first slot with a component that is NaN or beyond the bound; `end` if there is none
    int ( *find_out_of_bounds )( const wisp_bound_args* args, int begin, int end );
    // groups of sixteen strands
    void ( *strand_predict )( const wisp_strand_motion_args* args, int begin, int end );
    /// strand_velocity of the substep before and strand_predict in one
    void ( *strand_advance )( const wisp_strand_motion_args* args, int begin, int end );
    void ( *strand_velocity )( const wisp_strand_motion_args* args, int begin, int end );
    /// @return the first row of [begin, end) with a number that is NaN or beyond the bound, else end
    int ( *strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end );
    void ( *strand_damp )( const wisp_strand_damp_args* args, int begin, int end );
    void ( *strand_air )( const wisp_strand_air_args* args, int begin, int end );
    /// @return number of strands that were reset to rest lengths from the root
    int ( *strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end );
    void ( *strand_link )( const wisp_strand_link_args* args, int begin, int end );
    void ( *strand_follow )( const wisp_strand_follow_args* args, int begin, int end );
    void ( *strand_rod )( const wisp_strand_rod_args* args, int begin, int end );
    /// Begin an iteration, before its bodies: depths, sums of 0, and the bounds of the group.
    void ( *strand_contact_begin )( const wisp_strand_contact_args* args, int group, bool first_iteration,
                                    wisp_strand_bounds* reach );
    void ( *strand_contact )( const wisp_strand_contact_args* args, int begin, int end );
    void ( *strand_target )( const wisp_strand_target_args* args, int begin, int end );
    void ( *strand_ghost )( const wisp_strand_ghost_args* args, int begin, int end );
    void ( *strand_ghost_blend )( const wisp_strand_ghost_args* args, int begin, int end ); ///< of several targets
    void ( *strand_curve )( const wisp_strand_curve_args* args, int begin, int end );
    // slices of eight rows
    /// @return links without a direction, counted at either end
    int ( *spring_assemble )( const wisp_spring_args* args, int begin, int end );
    double ( *spring_product )( const wisp_conjugate_args* args, int begin, int end ); ///< q = A c; @return c . q
    /// r -= step q, s = S P S r; @return r . s
    double ( *conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end );
    /// dv += step c, c = s + fraction c: the rest of a conjugate gradient iteration
    void ( *conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end );
    // slices of eight children
    void ( *prolong )( const wisp_prolong_args* args, int begin, int end );
} wisp_kernels;

WISP_END_C
