#include "accuracy_compare.h"

#include "stats.h"

#include <math.h>

// Below this slope an error is considered constant: half the parameter reduces it by less than an eighth.
#define FLOOR_SLOPE 0.2

// Limit of points per series.
#define SERIES_POINTS_MAX 64

void accuracy_front( const double* error, const double* ms, int count, bool* on_front )
{
    for ( int i = 0; i < count; ++i )
    {
        on_front[i] = isfinite( error[i] ) && isfinite( ms[i] );
        for ( int k = 0; k < count && on_front[i]; ++k )
        {
            const bool is_better = error[k] <= error[i] && ms[k] <= ms[i] && ( error[k] < error[i] || ms[k] < ms[i] );
            on_front[i] = !is_better;
        }
    }
}

// ---- order ----

typedef struct series_points
{
    double parameter[SERIES_POINTS_MAX], error[SERIES_POINTS_MAX];
    int count;
} series_points;

// The coarsest first.
static void insert_point( series_points* all, double parameter, double error )
{
    int place = all->count++;
    for ( ; place > 0 && all->parameter[place - 1] < parameter; --place )
    {
        all->parameter[place] = all->parameter[place - 1];
        all->error[place] = all->error[place - 1];
    }
    all->parameter[place] = parameter;
    all->error[place] = error;
}

// Whether the error of a point is clearly smaller than that of every coarser one.
static bool still_falls( const series_points* all, int point )
{
    double least = INFINITY;
    for ( int i = 0; i < point; ++i )
    {
        least = fmin( least, all->error[i] );
    }
    return all->error[point] < least * pow( all->parameter[point] / all->parameter[point - 1], FLOOR_SLOPE );
}

accuracy_order accuracy_observed_order( const double* parameter, const double* error, int count )
{
    series_points all = { .count = 0 };
    for ( int i = 0; i < count && all.count < SERIES_POINTS_MAX; ++i )
    {
        if ( isfinite( error[i] ) && error[i] > 0.0 && isfinite( parameter[i] ) && parameter[i] > 0.0 )
        {
            insert_point( &all, parameter[i], error[i] );
        }
    }
    accuracy_order order = { .used = all.count, .count = all.count };
    while ( order.used > 1 && !still_falls( &all, order.used - 1 ) )
    {
        --order.used;
    }

    for ( int i = 0; i < order.used; ++i )
    {
        all.parameter[i] = log( all.parameter[i] );
        all.error[i] = log( all.error[i] );
    }
    order.slope = stats_fit_line( all.parameter, all.error, order.used ).slope;
    return order;
}

// ---- levels ----

// The round numbers in their order: number 0 is 1, 1 is 2, 2 is 5, 3 is 10, -1 is 0.5.
static double round_number( int number )
{
    static const double mantissas[3] = { 1.0, 2.0, 5.0 };
    const int decade = number >= 0 ? number / 3 : -( ( 2 - number ) / 3 );
    const double mantissa = mantissas[number - 3 * decade];
    // 10^-n is no double, but a division by 10^n rounds once
    return decade >= 0 ? mantissa * pow( 10.0, decade ) : mantissa / pow( 10.0, -decade );
}

static int first_not_below( double value )
{
    int number = 3 * ( (int)floor( log10( value ) ) - 1 );
    while ( round_number( number ) < value )
    {
        ++number;
    }
    return number;
}

int accuracy_levels( const double* values, int count, double* levels )
{
    double least = INFINITY, most = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        if ( isfinite( values[i] ) && values[i] > 0.0 )
        {
            least = fmin( least, values[i] );
            most = fmax( most, values[i] );
        }
    }
    if ( most == 0.0 )
    {
        return 0;
    }
    const int first = first_not_below( least ), last = first_not_below( most );
    const int found = last - first + 1, kept = found < ACCURACY_LEVELS_MAX ? found : ACCURACY_LEVELS_MAX;
    for ( int i = 0; i < kept; ++i )
    {
        const double fraction = kept > 1 ? (double)i / ( kept - 1 ) : 0.0;
        levels[i] = round_number( first + (int)lround( fraction * ( found - 1 ) ) );
    }
    return kept;
}

int accuracy_best_within( const double* cost, const double* limited, double limit, const bool* takes_part, int count )
{
    int best = -1;
    for ( int i = 0; i < count; ++i )
    {
        const bool can = ( !takes_part || takes_part[i] ) && limited[i] <= limit && isfinite( cost[i] );
        if ( can && ( best < 0 || cost[i] < cost[best] ) )
        {
            best = i;
        }
    }
    return best;
}
