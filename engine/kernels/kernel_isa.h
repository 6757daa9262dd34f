/// Each file of kernel_sources is compiled once per instruction set, named by WISP_KERNEL_ISA. The same function
/// has one symbol per table. Helpers stay static.
#pragma once

#include "lane_vec.h"

#include "wisp/fabric.h"
#include "wisp/skin.h"
#include "wisp/module/kernels.h"

#include <float.h>

#define KERNEL( name ) LANE_JOIN( name##_, WISP_KERNEL_ISA )

/// Minimum squared length of a vector with a direction. Below it the vector loses significant digits.
#define KERNEL_MIN_SQUARED 1e-30f

// Load eight vectors of three arrays.
LANE_INLINE lane8v load_three( const float* const from[3], int at )
{
    return ( lane8v ){ lane8_loadu( from[0] + at ), lane8_loadu( from[1] + at ), lane8_loadu( from[2] + at ) };
}

// Store the lanes whose bits are set, packed. Most often all are.
LANE_INLINE void pack_lanes( float* to, lane8 v, uint32_t bits )
{
    if ( bits == 255u )
    {
        lane8_storeu( to, v );
    }
    else
    {
        lane8_compress_store( to, v, bits );
    }
}

LANE_INLINE void pack_three( float* const to[3], int at, lane8v v, uint32_t bits )
{
    pack_lanes( to[0] + at, v.x, bits );
    pack_lanes( to[1] + at, v.y, bits );
    pack_lanes( to[2] + at, v.z, bits );
}

#define WISP_KERNEL( result, name, ... ) result KERNEL( name )( __VA_ARGS__ );
#include "wisp/module/kernel_list.h"
