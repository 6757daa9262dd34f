/// Assignment of strands to lanes: the topology that all passes over strands use.
#pragma once

#include "wisp/module/module.h"

/// A topology with its reference count. Immutable after creation.
typedef struct cook_strands
{
    wisp_strand_topology topology; // first, so that both have the same address
    const wisp_allocator* allocator;
    size_t bytes; // size of the single block that holds this struct and all arrays
    int instances;
} cook_strands;

/// Cook strands: sort by decreasing length, ties in the user's order, and form groups of sixteen. Strands without
/// vertices get no lane.
/// @param offsets [strand_count + 1] non-decreasing from 0 (checked by the caller)
/// @return null if out of memory, or if the lanes would need more than 2^31 rows
cook_strands* cook_strands_create( const wisp_allocator* allocator, const int32_t* offsets, int strand_count,
                                   int dimension );

void cook_strands_retain( cook_strands* strands );
/// Release one reference; the last one frees the topology. Null is allowed.
void cook_strands_release( cook_strands* strands );

/// Copy the user's points into lanes: rows [row_count][3][16]. Lanes repeat the tip beyond the end of their strand,
/// and empty lanes stay 0, so that kernels stay finite without masks.
void cook_strands_pack( const wisp_strand_topology* strands, const wisp_vec3* points, float* rows );
