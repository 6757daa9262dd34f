/// Shared by the closed forms of frozen hair.
#pragma once

#include "frozen_hair_engine_fixture.h"

static const double u = HAIR_ROUNDING;

/// The largest distance from the origin: coordinates round by this times u.
static inline double extent( const wisp_vec3* points, int count )
{
    double most = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        most = fmax( most, double3_length( double3_widen( points[v] ) ) );
    }
    return most;
}

/// The number that the first command draws with the default seed.
static inline double draw( uint64_t stream, int strand, int vertex )
{
    const wisp_random_key key = wisp_random_make_key( 1, stream, 0 );
    return wisp_random_unit( key, (uint32_t)strand, (uint32_t)vertex, 0 );
}
