/// Shared by tests of oracles: closeness, and random numbers that are the same in every run.
#pragma once

#include "unit.h"

#include "oracle/double3.h"
#include "wisp/module/random.h"

static const double pi = 3.14159265358979323846;

/// Defined by the file that includes this one.
static const uint64_t random_seed;

static inline void assert_close( double a, double b, double tolerance )
{
    if ( !( fabs( a - b ) <= tolerance ) )
    {
        fail_msg( "%.17g and %.17g differ by %.3g, allowed %.3g", a, b, fabs( a - b ), tolerance );
    }
}

static inline void assert_ratio( double a, double b, double tolerance )
{
    assert_close( a / b, 1.0, tolerance );
}

static inline double random_between( int n, int m, double lower, double upper )
{
    const wisp_random_key key = wisp_random_make_key( random_seed, 0, 0 );
    return lower + ( upper - lower ) * wisp_random_unit( key, (uint32_t)n, (uint32_t)m, 0 );
}

/// Components in (-1, 1); n and m select the vector.
static inline double3 random_vector( int n, int m )
{
    return double3_make( random_between( n, 3 * m, -1.0, 1.0 ), random_between( n, 3 * m + 1, -1.0, 1.0 ),
                         random_between( n, 3 * m + 2, -1.0, 1.0 ) );
}
