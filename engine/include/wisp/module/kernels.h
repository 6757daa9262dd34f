/// Kernels that modules share: constraint projections, searches and integration over ranges, under their
/// mathematical names. The same source is compiled once per instruction set and called through a table. All tables
/// give the same bits.
#pragma once

#include "wisp/module/instances.h"
#include "wisp/module/primitives.h"
#include "wisp/module/random.h"
#include "wisp/module/springs.h"
#include "wisp/module/strand_kernels.h"
#include "wisp/module/surface_kernels.h"
#include "wisp/module/particle_batch.h"
#include "wisp/module/shapes.h"

WISP_BEGIN_C

/// A slice is eight consecutive items, one per lane.
#define WISP_SLICE 8

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
    wisp_neighbour_list reference; ///< list of the second sweep: neighbours at the reference shape
    wisp_reference_pairs* pairs;   ///< of `reference`
    bool stores_pairs;             ///< the first sweep runs over `reference` alone and fills `pairs`
    float search_margin;   ///< m, a vertex that has moved farther than this since the last search needs a new one
    uint8_t* needs_search; ///< [slice] one bit per lane, set by the second sweep, or by the first if there is no
                           ///< brake
    wisp_random_key key;
    uint32_t iteration;
    float radius;       ///< h, m
    float step;         ///< sigma, m
    float distance_min; ///< r_min, m; minimum distance that the guard keeps between vertices of a pair
    float lambda_min;   ///< minimum of the brake's factor, reached where the distance changes by h
    bool planar;        ///< all z are 0
    bool in_plane;      ///< vertices move along x and y only
    bool brakes;        ///< there is a second sweep
} wisp_adhesion_args;

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

/// Arguments of moments of particles at two times.
typedef struct wisp_moment_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg
    const float* previous; ///< [slot][4] m, at the other time; may be the position
    const float* velocity; ///< [slot][4] m/s
    wisp_vec3 origin;      ///< m, reference point of all moments; a point near the body reduces rounding
} wisp_moment_args;

/// Sums over particles with inverse masses above 0, with p from the origin to the position, x to the previous one.
typedef struct wisp_moments
{
    double mass;                ///< kg
    double pinned;              ///< number of the other particles
    double first[3];            ///< kg m, m p
    double previous[3];         ///< kg m, m x
    double momentum[3];         ///< kg m/s, m v
    double angular_momentum[3]; ///< kg m^2/s, m x x v
    double mixed[3][3];         ///< kg m^2, m p_a x_b
} wisp_moments;

/// Arguments of a small rotation: row += angle x (position - centre), rounded once. Particles with inverse mass 0 keep theirs.
typedef struct wisp_turn_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg
    float* rows;           ///< [slot][4] positions or velocities; the fourth component is kept
    double angle[3];       ///< rad, or rad/s for velocities
    double centre[3];      ///< m
} wisp_turn_args;

/// Arguments of the check that positions and velocities of particles are finite and bounded.
typedef struct wisp_bound_args
{
    const float* position; ///< [slot][4] m
    const float* velocity; ///< [slot][4] m/s
    float bound;           ///< maximum magnitude of x, y and z
} wisp_bound_args;

typedef struct wisp_kernels
{
    const char* isa; ///< "baseline", "avx2" or "avx512"; tests have two more
#define WISP_KERNEL( result, name, ... ) result ( *name )( __VA_ARGS__ );
#include "wisp/module/kernel_list.h"
} wisp_kernels;

WISP_END_C
