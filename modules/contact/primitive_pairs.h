// Pairs of primitives: which of those that the narrow phase measured may reach their gap in this substep.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/kernels.h"
#include "wisp/module/primitives.h"

enum
{
    CONTACT_MAX_PAIRS =
        24 * 24,         // of primitives of one kind in two clusters, or of the points of either with triangles
    CONTACT_ROOM = 6144, // pairs in a narrow batch
};

/// A point and a triangle, or two edges.
typedef struct contact_pair
{
    int32_t a, b;
    float gap; // m, the distance to keep: never more than the pair has at rest
} contact_pair;

/// Kinds of pairs.
typedef enum contact_kind
{
    CONTACT_POINTS, // a point and a triangle
    CONTACT_EDGES,
    CONTACT_KIND_COUNT,
} contact_kind;

/// Active pairs of one kind, in any order.
typedef struct contact_near
{
    contact_pair* items;
    int count, most;
    wisp_buffer buffer;
} contact_near;

typedef struct contact_primitive_pairs
{
    contact_near near[CONTACT_KIND_COUNT];
} contact_primitive_pairs;

/// Pairs of one kind that a worker measures together.
typedef struct contact_batch
{
    int count;
    int32_t first[CONTACT_ROOM], second[CONTACT_ROOM], point_x4[4][CONTACT_ROOM];
    int32_t of[CONTACT_ROOM];                                               // the pair of clusters
    int32_t selected[CONTACT_ROOM];                                         // indices of those that pass a test
    float gap[CONTACT_ROOM], distance[CONTACT_ROOM], closing[CONTACT_ROOM]; // m
    contact_pair found[CONTACT_ROOM];
} contact_batch;

/// Point a kernel's output behind the pairs of a batch.
static inline void contact_take_room( contact_batch* batch, wisp_primitive_pairs* out )
{
    out->id = batch->of + batch->count;
    out->first = batch->first + batch->count;
    out->second = batch->second + batch->count;
    for ( int k = 0; k < 4; ++k )
    {
        out->point_x4[k] = batch->point_x4[k] + batch->count;
    }
}

/// Return whether a batch has room for all pairs of one call of the kernel.
static inline bool contact_has_room( const contact_batch* batch )
{
    return batch->count + WISP_PRIMITIVE_BATCH * CONTACT_MAX_PAIRS + WISP_SLICE <= CONTACT_ROOM;
}

/// Measure all pairs of a batch at the intersection-free positions.
void contact_measure_batch( const contact_work* work, contact_kind kind, contact_batch* batch );

/// Append the active ones of the pairs in `selected` to `near`, as far as it has room.
/// @param total counts all of them
void contact_select_active( const contact_work* work, contact_kind kind, contact_batch* batch, int selected,
                            _Atomic int* total );

/// Make room in `near`.
/// @return false without memory
bool contact_reserve_near( const contact_work* work, contact_kind kind, int count );
