/// Broad phase: pairs of overlapping AABBs, found by uniform grids, one for boxes of about each size. Pairs are those whose boxes
/// overlap, compared in float, ordered by query, then by box.
#pragma once

#include "wisp/module/jobs.h"
#include "wisp/module/space.h"

WISP_BEGIN_C

typedef struct wisp_aabb_args
{
    const wisp_aabb* queries; ///< [query_count]; null: boxes against each other; a pair is listed at its lower box
    int query_count;
    const wisp_aabb* boxes; ///< [box_count]
    int box_count;
    size_t limit;                ///< most pairs, 0: INT32_MAX; beyond it the call fails and keeps nothing
    const wisp_kernels* kernels; ///< null: scalar C, with the same pairs in two to three times the time
    /// Reuse the last grid; only the queries changed. The last call must have succeeded with the same boxes.
    bool reuse;
    /// Null, or called for every query with pairs, by several workers at once, before pairs are stored and sorted: moves those to keep
    /// to the front, in any order. It must judge each pair independently.
    /// @param items [count] boxes that overlap the query, in any order @return how many to keep
    int ( *filter )( const void* context, int query, int32_t* items, int count );
    const void* filter_context;
} wisp_aabb_args;

/// Pairs. Zero-initialised is empty. The struct owns its arrays; they are valid until the next call.
typedef struct wisp_aabb_pairs
{
    int query_count;
    size_t pair_count;
    const int32_t* begin; ///< [query_count + 1] first pair of a query
    const int32_t* item;  ///< [pair_count] boxes, ascending within a query
    uint64_t tested;      ///< boxes compared in the last call
    wisp_buffer buffers[9];
} wisp_aabb_pairs;

/// Find all pairs. A call that fails keeps no pairs.
/// @return WISP_NO_MEMORY; WISP_BAD_INPUT more pairs than the limit (the message has both numbers)
WISP_API wisp_status wisp_aabb_pairs_find( wisp_aabb_pairs* pairs, const wisp_parallel* parallel,
                                           const wisp_aabb_args* args, wisp_error* error );
WISP_API void wisp_aabb_pairs_release( wisp_aabb_pairs* pairs, const wisp_allocator* allocator );
/// @return bytes that it holds of its allocator
WISP_API size_t wisp_aabb_pairs_bytes( const wisp_aabb_pairs* pairs );

WISP_END_C
