// Broad phase: pairs of clusters that may come near each other before the next search.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"

typedef struct contact_broad_phase
{
    wisp_aabb* boxes; // [cluster] around its predicted motion
    wisp_buffer box_buffer;
    wisp_aabb_pairs overlaps;
    int searches;  // in this step
    bool is_short; // margins were cut to bound the number of pairs: displacements must stay within them
} contact_broad_phase;

/// Search for all pairs.
wisp_status contact_search( const contact_work* work, wisp_error* error );

/// A pair of primitives that was near when its clusters were searched. Before those of two clusters stands one with their number in `a`,
/// and in `b` how many there are.
typedef struct contact_listed
{
    int32_t a, b; // a point and a triangle, or two edges with a < b
    float gap;    // m, the distance to keep: never more than the pair has at rest
    float key;    // m: its distance, less the gap, is at least this and the bound of pairs that are not listed
} contact_listed;

/// Return the key of a pair at a distance, less its rounding. @param bound m, of pairs that are not listed
static inline float contact_key_of( float distance, float gap, float bound )
{
    return 0.9999f * distance - gap - bound;
}

/// The pairs of primitives of two clusters: points and triangles, then edges.
typedef struct contact_list
{
    int32_t first;          // in `listed`
    uint16_t points, edges; // how many
    float beyond;           // m, the bound of pairs that are not listed, less that of all
} contact_list;

/// Pairs of clusters that may come near each other. Those of a cluster are contiguous: itself first, then others in
/// rising order.
typedef struct contact_cluster_pairs
{
    int32_t* begin;     // [cluster + 1]
    int32_t* cluster;   // [pair], padded to a multiple of eight
    int32_t* other;     // [pair]
    float* slack;       // [pair] m: lower bound of the distance of any two of their primitives, less the gap
    contact_list* list; // [pair]
    int count;
} contact_cluster_pairs;

enum
{
    CONTACT_BOUND_BEGIN,
    CONTACT_BOUND_CLUSTER,
    CONTACT_BOUND_OTHER,
    CONTACT_BOUND_SLACK,
    CONTACT_BOUND_LIST,
    CONTACT_BOUND_LISTED,
    CONTACT_BOUND_ACTIVE,
    CONTACT_BOUND_SEARCHED,
    CONTACT_BOUND_ACTIVE_COUNT,
    CONTACT_BOUND_ARRAY_COUNT,
};

typedef struct contact_cached_bounds
{
    contact_cluster_pairs pairs;
    contact_listed* listed; // pairs of primitives, with those of past searches between them
    int listed_count, listed_most, last_length;
    int32_t* active;   // [pair] those that may reach their gap in this substep
    int32_t* searched; // [pair] of these, those whose lists do not hold for it
    int searched_count;
    int32_t* active_count; // [block of pairs]
    wisp_buffer buffers[CONTACT_BOUND_ARRAY_COUNT];
} contact_cached_bounds;

/// Replace the list by the overlaps that a broad phase found. Pairs that were listed before keep their bounds.
/// @param is_known the list before holds for these positions
/// @return false without memory
bool contact_list_cluster_pairs( const contact_work* work, const wisp_aabb_pairs* found, bool is_known );

/// Move the pairs of primitives of all lists together, and make room for more.
/// @return false without memory
bool contact_make_room_for_listed( const contact_work* work, int more );

/// Lower the bounds by the approach of the last substep, and collect the pairs that may reach their gap in this one.
/// @param missed_only only pairs with a cluster that has a missed point; bounds stay
/// @return the length of `active`
int contact_find_active_clusters( const contact_work* work, bool missed_only );
