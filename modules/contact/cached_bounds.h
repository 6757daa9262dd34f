// Pairs of clusters with a lower bound of their separation, which is carried from substep to substep.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"

/// Pairs of clusters that may come near each other. Those of a cluster are contiguous: itself first, then others in
/// rising order.
typedef struct contact_cluster_pairs
{
    int32_t* begin;   // [cluster + 1]
    int32_t* cluster; // [pair], padded to a multiple of eight
    int32_t* other;   // [pair]
    float* slack;     // [pair] m: lower bound of the distance of any two of their primitives, less the gap
    int count;
} contact_cluster_pairs;

enum
{
    CONTACT_BOUND_BEGIN, // of two lists, which take turns
    CONTACT_BOUND_CLUSTER = CONTACT_BOUND_BEGIN + 2,
    CONTACT_BOUND_OTHER = CONTACT_BOUND_CLUSTER + 2,
    CONTACT_BOUND_SLACK = CONTACT_BOUND_OTHER + 2,
    CONTACT_BOUND_ACTIVE = CONTACT_BOUND_SLACK + 2,
    CONTACT_BOUND_ACTIVE_COUNT,
    CONTACT_BOUND_ARRAY_COUNT,
};

typedef struct contact_cached_bounds
{
    contact_cluster_pairs pairs[2]; // the current list, and the one before
    int turn;                       // whose buffers the current list has
    int32_t* active;                // [pair] those that may reach their gap in this substep
    int32_t* active_count;          // [block of pairs]
    wisp_buffer buffers[CONTACT_BOUND_ARRAY_COUNT];
} contact_cached_bounds;

/// Replace the list by the overlaps that a broad phase found. Pairs that were listed before keep their bounds.
/// @param is_known the list before holds for these positions
/// @return false without memory
bool contact_list_cluster_pairs( const contact_work* work, const wisp_aabb_pairs* found, bool is_known );

/// Lower the bounds by the approach of the last substep, and collect the pairs that may reach their gap in this one.
/// @param missed_only only pairs with a cluster that has a missed point; bounds stay
/// @return the length of `active`
int contact_find_active_clusters( const contact_work* work, bool missed_only );
