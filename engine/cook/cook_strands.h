/// Strands into lanes: the topology that every pass over strands walks.
#pragma once

#include "wisp/module/module.h"

/// A topology with its owner count. Never changed once made.
typedef struct cook_strands
{
    wisp_strand_topology topology; // first, so that a topology's address is its owner's
    const wisp_allocator* allocator;
    size_t bytes; // of the one block that holds this struct and all arrays
    int instances;
} cook_strands;

/// Cook strands: those of equal length side by side, sixteen a group, longest first, equals in the user's order.
/// Strands without vertices get no lane.
/// @param offsets [strand_count + 1], rising from 0 (checked by the caller)
/// @return null without memory, or if the lanes would need more than 2^31 rows
cook_strands* cook_strands_create( const wisp_allocator* allocator, const int32_t* offsets, int strand_count,
                                   int dimension );

void cook_strands_retain( cook_strands* strands );
/// Frees with the last instance; null is allowed.
void cook_strands_release( cook_strands* strands );

/// Copy the user's points into lanes: rows [row_count][3][16]. Lanes behind a strand's tip repeat the tip, lanes
/// without a strand stay 0, so that kernels need no masks to stay finite.
void cook_strands_pack( const wisp_strand_topology* strands, const wisp_vec3* points, float* rows );
