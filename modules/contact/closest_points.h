// Closest points of primitives: a point and a triangle, or two edges.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/kernels.h"

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
