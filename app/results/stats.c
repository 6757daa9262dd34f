#include "stats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    stats_summary out = { .count = count, .cpu_fraction = NAN };
    out.kept_count = count < STATS_MAX_KEPT ? count : STATS_MAX_KEPT;
    for ( int i = 0; i < out.kept_count; ++i )
    {
        out.kept[i] = samples[(long long)i * count / out.kept_count];
    }
    if ( count > 0 )
    {
        qsort( samples, (size_t)count, sizeof( double ), compare_doubles );
    }
    out.median = stats_quantile( samples, count, 0.5 );
    out.p10 = stats_quantile( samples, count, 0.1 );
    out.p90 = stats_quantile( samples, count, 0.9 );
    out.minimum = count > 0 ? samples[0] : NAN;
    out.maximum = count > 0 ? samples[count - 1] : NAN;
    out.mean = count > 0 ? 0.0 : NAN;
    for ( int i = 0; i < count; ++i )
    {
        out.mean += samples[i] / count;
    }
    return out;
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

double stats_rank_sum( const double* a, int a_count, const double* b, int b_count )
{
    const double m = a_count, n = b_count, all = m + n;
    if ( a_count < 4 || b_count < 4 )
    {
        return 1.0;
    }
    // pairs in which a is larger, halves for ties; sets are small, so that counting beats sorting in length of code
    double larger = 0.0, ties = 0.0;
    for ( int i = 0; i < a_count; ++i )
    {
        for ( int k = 0; k < b_count; ++k )
        {
            larger += a[i] > b[k] ? 1.0 : a[i] == b[k] ? 0.5 : 0.0;
        }
    }
    // sum of t^3 - t over groups of t equal values is that of t^2 - 1 over values
    for ( int i = 0; i < a_count + b_count; ++i )
    {
        const double value = i < a_count ? a[i] : b[i - a_count];
        double equal = 0.0;
        for ( int k = 0; k < a_count + b_count; ++k )
        {
            equal += value == ( k < a_count ? a[k] : b[k - a_count] ) ? 1.0 : 0.0;
        }
        ties += equal * equal - 1.0;
    }
    const double variance = m * n / 12.0 * ( all + 1.0 - ties / ( all * ( all - 1.0 ) ) );
    if ( !( variance > 0.0 ) )
    {
        return 1.0;
    }
    const double distance = fmax( fabs( larger - 0.5 * m * n ) - 0.5, 0.0 );
    return erfc( distance / sqrt( 2.0 * variance ) );
}

void stats_holm( const double* p, int count, int tests, double level, bool* is_rejected )
{
    for ( int i = 0; i < count; ++i )
    {
        is_rejected[i] = false;
    }
    for ( int left = tests; left > 0; --left )
    {
        int best = -1;
        for ( int i = 0; i < count; ++i )
        {
            const bool takes_part = !isnan( p[i] ) && !is_rejected[i];
            best = takes_part && ( best < 0 || p[i] < p[best] ) ? i : best;
        }
        if ( best < 0 || p[best] > level / left )
        {
            return;
        }
        is_rejected[best] = true;
    }
}

// ---- the profile of a world over many steps ----

// Plans have few passes and are nearly always in the same order, so the expected position is tried first.
static profile_pass* find_pass( profile_samples* samples, const char* name, int expected )
{
    if ( expected < samples->pass_count && strcmp( samples->passes[expected].name, name ) == 0 )
    {
        return &samples->passes[expected];
    }
    for ( int i = 0; i < samples->pass_count; ++i )
    {
        if ( strcmp( samples->passes[i].name, name ) == 0 )
        {
            return &samples->passes[i];
        }
    }
    return NULL;
}

static profile_pass* add_pass( profile_samples* samples, const char* name )
{
    if ( samples->pass_count == samples->pass_capacity )
    {
        int capacity = samples->pass_capacity > 0 ? 2 * samples->pass_capacity : 16;
        profile_pass* grown = realloc( samples->passes, (size_t)capacity * sizeof( profile_pass ) );
        if ( !grown )
        {
            return NULL;
        }
        samples->passes = grown;
        samples->pass_capacity = capacity;
    }
    profile_pass* pass = &samples->passes[samples->pass_count++];
    *pass = ( profile_pass ){ 0 };
    snprintf( pass->name, sizeof( pass->name ), "%s", name );
    return pass;
}

static wisp_status add_sample( profile_pass* pass, double seconds )
{
    if ( pass->count == pass->capacity )
    {
        int capacity = pass->capacity > 0 ? 2 * pass->capacity : 64;
        double* grown = realloc( pass->seconds, (size_t)capacity * sizeof( double ) );
        if ( !grown )
        {
            return WISP_NO_MEMORY;
        }
        pass->seconds = grown;
        pass->capacity = capacity;
    }
    pass->seconds[pass->count++] = seconds;
    return WISP_OK;
}

wisp_status profile_samples_add( profile_samples* samples, wisp_profile profile )
{
    for ( int i = 0; i < profile.count; ++i )
    {
        const wisp_profile_line* line = &profile.lines[i];
        profile_pass* pass = find_pass( samples, line->pass, i );
        if ( !pass )
        {
            pass = add_pass( samples, line->pass );
        }
        if ( !pass || add_sample( pass, line->seconds ) != WISP_OK )
        {
            return WISP_NO_MEMORY;
        }
        pass->items = line->items;
    }
    return WISP_OK;
}

double profile_samples_median( profile_samples* samples, int pass )
{
    return stats_summarise( samples->passes[pass].seconds, samples->passes[pass].count ).median;
}

void profile_samples_free( profile_samples* samples )
{
    for ( int i = 0; i < samples->pass_count; ++i )
    {
        free( samples->passes[i].seconds );
    }
    free( samples->passes );
    *samples = ( profile_samples ){ 0 };
}
