/// Broad phase: pairs of overlapping AABBs. The search changes only the time: pairs are those whose boxes overlap, compared in
/// float, ordered by query, then by box.
#pragma once

#include "wisp/module/jobs.h"
#include "wisp/module/space.h"
#include "wisp/variants.h"

WISP_BEGIN_C

/// @return true if two AABBs overlap; touching counts. Neither may be empty or NaN
static inline bool wisp_aabb_overlaps( const wisp_aabb* a, const wisp_aabb* b )
{
    bool is_apart = false;
    for ( int k = 0; k < 3; ++k )
    {
        is_apart |= a->lower[k] > b->upper[k] || b->lower[k] > a->upper[k];
    }
    return !is_apart;
}

/// Filters the pairs of a query: moves those to keep to the front, in any order.
/// @param items [count] boxes that overlap the query, in any order @return how many to keep
typedef int wisp_aabb_filter_fn( const void* context, int query, int32_t* items, int count );

typedef struct wisp_aabb_args
{
    const wisp_aabb* queries; ///< [query_count]; null: boxes against each other; a pair is listed at its lower box
    int query_count;
    const wisp_aabb* boxes; ///< [box_count]
    int box_count;
    wisp_pair_search search;
    size_t limit;                ///< most pairs, 0: INT32_MAX; beyond it the call fails and keeps nothing
    const wisp_kernels* kernels; ///< null: scalar C, with the same pairs in two to three times the time
    /// Reuse the last grid or tree; only the queries changed. The last call must have succeeded with the same boxes.
    bool reuse;
    /// Null, or called for every query with pairs, by several workers at once, before pairs are stored and sorted. It must
    /// judge each pair independently.
    wisp_aabb_filter_fn* filter;
    const void* filter_context;
} wisp_aabb_args;

/// Pairs. Zero-initialised is empty. The struct owns its arrays; they are valid until the next call.
typedef struct wisp_aabb_pairs
{
    int query_count;
    size_t pair_count;
    const int32_t* begin;                ///< [query_count + 1] first pair of a query
    const int32_t* item;                 ///< [pair_count] boxes, ascending within a query
    wisp_pair_search search;             ///< the search that was used
    uint64_t tested;                     ///< boxes compared in the last call
    int build_count, refit_count;        ///< of the tree
    double build_seconds, query_seconds; ///< of the last call: building grid or tree; queries and sorting
    wisp_buffer buffers[9];
    struct wisp_aabb_tree* tree; ///< null until a tree is used
} wisp_aabb_pairs;

/// Find all pairs. The tree of the last call is refitted if the same boxes are valid and it has not degraded (half again as many
/// boxes tested per result as when it was new).
/// A call that fails keeps no pairs.
/// @return WISP_NO_MEMORY; WISP_BAD_INPUT more pairs than the limit (the message has both numbers); WISP_CONFLICT
///         Embree cannot build a tree
WISP_API wisp_status wisp_aabb_pairs_find( wisp_aabb_pairs* pairs, const wisp_parallel* parallel,
                                           const wisp_aabb_args* args, wisp_error* error );
WISP_API void wisp_aabb_pairs_release( wisp_aabb_pairs* pairs, const wisp_allocator* allocator );
/// @return the search for some arguments. WISP_PAIR_SEARCH_AUTO is the grid: for 1000 to 100000 boxes, of one size or with sizes
/// 100 apart, it was measured to be 2 to 20 times as fast as the tree. Without Embree a tree is a grid too.
WISP_API wisp_pair_search wisp_aabb_pairs_choose( const wisp_aabb_args* args );
/// @param outside bytes that Embree holds of it are added
/// @return bytes that it holds of its allocator
WISP_API size_t wisp_aabb_pairs_bytes( const wisp_aabb_pairs* pairs, size_t* outside );

WISP_END_C
