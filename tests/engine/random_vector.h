/// Random vectors in double precision.
#pragma once

#include "support.h"

#include "double3.h"

/// Components within `size`, the same in every run; (a, b) select the vector.
static inline double3 random_vector( int a, int b, double size )
{
    const float most = (float)size;
    return double3_make( (double)test_random_float( a, 3 * b, -most, most ),
                         (double)test_random_float( a, 3 * b + 1, -most, most ),
                         (double)test_random_float( a, 3 * b + 2, -most, most ) );
}
