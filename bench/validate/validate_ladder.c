#include "validate_ladder.h"

#include <math.h>

static const double HALF = 0.3; // of the ladder, in critical loads

static double half_rung( int count )
{
    return HALF / ( count - 1 );
}

double validate_rung( int i, int count )
{
    return 1.0 - HALF + 2.0 * half_rung( count ) * i;
}

double validate_ladder_doubt( int count )
{
    return 100.0 * half_rung( count );
}

double validate_measure_ladder( const bool* has_lost, int count, double critical, double measures[2] )
{
    int first = 0;
    while ( first < count && !has_lost[first] )
    {
        ++first;
    }
    const bool is_beyond = first == 0 || first == count;
    const double lost_at = is_beyond ? (double)NAN : validate_rung( first, count ) - half_rung( count );
    measures[0] = lost_at * critical;
    measures[1] = critical;
    return 100.0 * ( is_beyond ? HALF : fabs( lost_at - 1.0 ) );
}
