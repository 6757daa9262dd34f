#include "stats.h"

#include <math.h>
#include <stdlib.h>

static int compare_doubles( const void* a, const void* b )
{
    double x = *(const double*)a, y = *(const double*)b;
    return ( x > y ) - ( x < y );
}

double stats_quantile( const double* rising, int count, double q )
{
    if ( count <= 0 )
    {
        return NAN;
    }
    double place = q * ( count - 1 );
    int below = (int)floor( place );
    int above = below + 1 < count ? below + 1 : below;
    return rising[below] + ( place - below ) * ( rising[above] - rising[below] );
}

stats_summary stats_summarise( double* samples, int count )
{
    if ( count > 0 )
    {
        qsort( samples, (size_t)count, sizeof( double ), compare_doubles );
    }
    return ( stats_summary ){
        .count = count,
        .median = stats_quantile( samples, count, 0.5 ),
        .p10 = stats_quantile( samples, count, 0.1 ),
        .p90 = stats_quantile( samples, count, 0.9 ),
        .minimum = count > 0 ? samples[0] : NAN,
    };
}

stats_line stats_fit_line( const double* x, const double* y, int count )
{
    double mean_x = 0.0, mean_y = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        mean_x += x[i] / count;
        mean_y += y[i] / count;
    }

    // Sums about the means: sums of squares of a million vertices would cancel.
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        double dx = x[i] - mean_x, dy = y[i] - mean_y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    if ( !( xx > 0.0 ) )
    {
        return ( stats_line ){ NAN, NAN, NAN };
    }
    double slope = xy / xx;

    // Equal y all the way is a line that explains everything there is.
    double r_squared = yy > 0.0 ? xy * xy / ( xx * yy ) : 1.0;
    return ( stats_line ){ mean_y - slope * mean_x, slope, r_squared };
}
