// Narrow phase: which primitives of active pairs of clusters may reach their gap in this substep.
#pragma once

#include "broad_phase.h"
#include "contact_mesh.h"

#include "wisp/module/kernels.h"
#include "wisp/module/primitives.h"

/// Up to a batch of pairs of one kind.
typedef struct contact_primitives
{
    int32_t point_x4[4][CONTACT_BATCH]; // points times 4
    float distance[CONTACT_BATCH];      // m, out
    bool are_edges;
} contact_primitives;

static inline void contact_put_primitives( contact_primitives* primitives, int at, const int32_t points[4] )
{
    for ( int k = 0; k < 4; ++k )
    {
        primitives->point_x4[k][at] = points[k] * 4;
    }
}

/// Measure distances, closest points and directions.
/// @param xyzw [point][4] m, positions
/// @param weight, normal [group of eight] as wisp_closest_args has them, or both null
/// @return [count] m, the same bits either way
const float* contact_measure_primitives( const contact_work* work, const float* xyzw, contact_primitives* primitives,
                                         int count, float ( *weight )[4][WISP_SLICE],
                                         float ( *normal )[3][WISP_SLICE] );

enum
{
    CONTACT_MAX_PAIRS =
        24 * 24,       // of primitives of one kind in two clusters, or of the points of either with triangles
    CONTACT_TESTS = 6, // pairs of clusters in a batch
    CONTACT_ROOM = CONTACT_TESTS * CONTACT_MAX_PAIRS + WISP_SLICE,
};

/// A point and a triangle, or two edges.
typedef struct contact_pair
{
    int32_t a, b;
    float gap; // m, the distance to keep: never more than the pair has at rest
} contact_pair;

/// An active pair, and for primitives what was measured.
typedef struct contact_active
{
    contact_pair pair;
    float distance, closing, weight[4], normal[3]; // as contact_row has them
} contact_active;

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
    contact_active* items;
    int count, most;
    wisp_buffer buffer;
} contact_near;

typedef struct contact_primitive_pairs
{
    contact_near near[CONTACT_KIND_COUNT];
} contact_primitive_pairs;

/// Pairs of one kind that the search of some pairs of clusters found.
typedef struct contact_batch
{
    int count;
    int32_t first[CONTACT_ROOM], second[CONTACT_ROOM], point_x4[4][CONTACT_ROOM];
    int32_t of[CONTACT_ROOM];                                               // the pair of clusters
    int32_t selected[CONTACT_ROOM];                                         // indices of those that pass a test
    float gap[CONTACT_ROOM], distance[CONTACT_ROOM], closing[CONTACT_ROOM]; // m
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

/// Find the active pairs of primitives, in any order.
/// @param missed_only only of clusters that have a missed point
wisp_status contact_find_near( const contact_work* work, bool missed_only, wisp_error* error );
