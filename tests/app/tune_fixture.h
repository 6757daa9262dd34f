/// Synthetic functions of time and error, and a search over them.
#pragma once

#include "support.h"

#include "tune_search.h"

#define CHOICES_MAX 400

/// Time and error of every configuration of three parameters, and the requests of the search.
typedef struct surface
{
    int counts[3];
    double ms[CHOICES_MAX], error[CHOICES_MAX];
    bool is_halted[CHOICES_MAX];
    double noise; ///< times have errors of up to this fraction
    int queried[CHOICES_MAX];
    int run_count;
    int fail_at; ///< run that fails, from 1; 0: none
} surface;

static const double VALUES[TUNE_MAX_VALUES] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16 };

static inline double random_unit( uint64_t seed, int event, int element )
{
    return wisp_random_unit( wisp_random_make_key( seed, 7, 0 ), (uint32_t)event, (uint32_t)element, 0 );
}

static inline int number_of( const surface* s, const int* configuration )
{
    return ( configuration[0] * s->counts[1] + configuration[1] ) * s->counts[2] + configuration[2];
}

static inline int size_of( const surface* s )
{
    return s->counts[0] * s->counts[1] * s->counts[2];
}

// Each finer value multiplies the time and divides the error by factors of its own.
static inline surface make_surface( uint64_t seed, int a, int b, int c )
{
    surface s = { .counts = { a, b, c } };
    double dear[3][TUNE_MAX_VALUES], fine[3][TUNE_MAX_VALUES];
    for ( int k = 0; k < 3; ++k )
    {
        dear[k][0] = fine[k][0] = 1.0;
        for ( int v = 1; v < s.counts[k]; ++v )
        {
            dear[k][v] = dear[k][v - 1] * ( 1.05 + random_unit( seed, k, v ) );
            fine[k][v] = fine[k][v - 1] / ( 1.05 + 2.0 * random_unit( seed, k + 3, v ) );
        }
    }
    for ( int i = 0; i < size_of( &s ); ++i )
    {
        const int configuration[3] = { i / ( b * c ), i / c % b, i % c };
        s.ms[i] = dear[0][configuration[0]] * dear[1][configuration[1]] * dear[2][configuration[2]];
        s.error[i] = 0.1 * fine[0][configuration[0]] * fine[1][configuration[1]] * fine[2][configuration[2]];
    }
    return s;
}

// Every sample has a different error, so that values are no longer in order.
static inline void make_bumpy( surface* s, uint64_t seed, double fraction )
{
    for ( int i = 0; i < size_of( s ); ++i )
    {
        s->ms[i] *= 1.0 + fraction * ( 2.0 * random_unit( seed, 20, i ) - 1.0 );
        s->error[i] *= 1.0 + fraction * ( 2.0 * random_unit( seed, 21, i ) - 1.0 );
    }
}

static inline wisp_status run_surface( void* user, const int* configuration, tune_sample* out, wisp_error* error )
{
    surface* s = user;
    const int i = number_of( s, configuration );
    ++s->queried[i];
    if ( ++s->run_count == s->fail_at )
    {
        return wisp_fail( error, WISP_IO_ERROR, "the host has lost its disk" );
    }
    const double off = 1.0 + s->noise * ( 2.0 * random_unit( 99, s->run_count, i ) - 1.0 );
    *out = ( tune_sample ){ s->ms[i] * off, s->error[i], 2.0 * s->error[i], s->is_halted[i] };
    return WISP_OK;
}

typedef struct searched
{
    tune_parameter parameters[3];
    tune_def args;
} searched;

static inline searched search_of( surface* s, double error, double budget_ms )
{
    searched out = { .parameters = { { "substeps", VALUES, s->counts[0], false },
                                     { "iterations", VALUES, s->counts[1], false },
                                     { "third", VALUES, s->counts[2], false } },
                     .args = { .max_seconds = INFINITY } };
    out.args.parameter_count = 3;
    out.args.error = error;
    out.args.budget_ms = budget_ms;
    out.args.run = run_surface;
    out.args.user = s;
    out.args.max_runs = 1000;
    out.args.repeats = 1;
    return out;
}

// A failure leaves the result zero.
static inline tune_result find( searched* s )
{
    s->args.parameters = s->parameters;
    tune_result result;
    wisp_error error = { 0 };
    assert_ok( tune_find( &s->args, &result, &error ), error );
    return result;
}

// Targets that some configurations meet and some do not.
static inline double between( const double* numbers, int count, double fraction )
{
    double lower = numbers[0], upper = numbers[0];
    for ( int i = 1; i < count; ++i )
    {
        lower = fmin( lower, numbers[i] );
        upper = fmax( upper, numbers[i] );
    }
    return lower * pow( upper / lower, fraction );
}
