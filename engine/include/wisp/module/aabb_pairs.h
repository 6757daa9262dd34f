/// Which boxes overlap: candidates for touching. What searches only changes the time: the pairs are those whose boxes
/// overlap, compared in float, and come in the order of the queries, then of the boxes.
#pragma once

#include "wisp/jobs.h"
#include "wisp/module/space.h"
#include "wisp/variants.h"

WISP_BEGIN_C

/// Do two boxes overlap, neither of which is empty or without a number? Touching is overlapping.
static inline bool wisp_aabb_overlaps( const wisp_aabb* a, const wisp_aabb* b )
{
    bool is_apart = false;
    for ( int k = 0; k < 3; ++k )
    {
        is_apart |= a->lower[k] > b->upper[k] || b->lower[k] > a->upper[k];
    }
    return !is_apart;
}

/// Which pairs of an query count: moves those that do to the front, in any order.
/// @param items [count] boxes that overlap the query's, in any order @return how many count
typedef int wisp_aabb_filter_fn( const void* context, int query, int32_t* items, int count );

typedef struct wisp_aabb_args
{
    const wisp_aabb* queries; ///< [query_count]; null: the boxes ask each other, and a pair is named by the lower one
    int query_count;
    const wisp_aabb* boxes; ///< [box_count]
    int box_count;
    wisp_pair_search search;
    size_t limit; ///< pairs at most, 0: as many as an int32_t can count; beyond it the call refuses and keeps nothing
    const wisp_kernels* kernels; ///< null: plain C, which takes two to three times as long for the same pairs
    /// The boxes are those of the last call with these pairs, which succeeded: others ask, and neither grid nor tree is made
    /// anew. With queries.
    bool again;
    /// Null: all pairs count. Else it is called for every query that has some, by several workers at once, before anything is
    /// kept or put in order: what is a pair by more than its boxes costs least there. It must judge each pair by itself.
    wisp_aabb_filter_fn* filter;
    const void* filter_context;
} wisp_aabb_args;

/// Pairs. Zero-initialised is empty; arrays belong to it and are valid until the next call.
typedef struct wisp_aabb_pairs
{
    int query_count;
    size_t pair_count;
    const int32_t* begin;                ///< [query_count + 1] first pair of an query
    const int32_t* item;                 ///< [pair_count] boxes, rising within an query
    wisp_pair_search search;             ///< what searched
    uint64_t tested;                     ///< boxes compared in the last call
    int build_count, refit_count;        ///< of the tree since it was made
    double build_seconds, query_seconds; ///< of the last call: grid or tree; asking and sorting
    wisp_buffer buffers[9];
    struct wisp_aabb_tree* tree; ///< null until one is asked for
} wisp_aabb_pairs;

/// Find all pairs. The tree of the last call is refitted where the same boxes can overlap anything and it has not decayed
/// (half again as many boxes compared for an answer as when it was new; every pair is an answer, and every query one more).
/// A call that fails keeps no pairs.
/// @return WISP_NO_MEMORY; WISP_BAD_INPUT more pairs than the limit (the message has both numbers); WISP_CONFLICT
///         Embree cannot make a tree
WISP_API wisp_status wisp_aabb_pairs_find( wisp_aabb_pairs* pairs, const wisp_parallel* parallel,
                                           const wisp_aabb_args* args, wisp_error* error );
WISP_API void wisp_aabb_pairs_release( wisp_aabb_pairs* pairs, const wisp_allocator* allocator );
/// What searches for a job. WISP_PAIR_SEARCH_AUTO is the grid: from 1000 to 100000 boxes, of one size or of sizes spread
/// by 100, it was measured to be 2 to 20 times as fast as the tree. A tree without Embree is the grid too.
WISP_API wisp_pair_search wisp_aabb_pairs_choose( const wisp_aabb_args* args );
/// Bytes that it holds, Embree's included.
WISP_API size_t wisp_aabb_pairs_bytes( const wisp_aabb_pairs* pairs );

WISP_END_C
