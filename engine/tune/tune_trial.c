// Trials: one run of the host's callback, its recorded results, and the comparison of samples.
#include "tune.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- comparison of samples ----

bool tune_meets( const wisp_tune_def* args, const wisp_tune_sample* sample )
{
    return !sample->is_halted && ( args->error > 0.0 ? sample->error <= args->error : sample->ms <= args->budget_ms );
}

bool tune_is_better( const wisp_tune_def* args, const wisp_tune_sample* a, const wisp_tune_sample* b )
{
    if ( a->is_halted || b->is_halted )
    {
        return !a->is_halted && b->is_halted;
    }
    const bool meets = tune_meets( args, a );
    if ( meets != tune_meets( args, b ) )
    {
        return meets;
    }
    // Samples that meet an error compare by time, others by error; with a budget it is the other way round.
    const bool by_time = ( args->error > 0.0 ) == meets;
    const double first = by_time ? a->ms - b->ms : a->error - b->error;
    const double second = by_time ? a->error - b->error : a->ms - b->ms;
    return first < 0.0 || ( first == 0.0 && second < 0.0 );
}

static void find_best( tune_search* s )
{
    s->best = -1;
    for ( int v = 0; v < s->trial_count; ++v )
    {
        if ( s->best < 0 || tune_is_better( s->args, &s->trials[v].sample, &s->trials[s->best].sample ) )
        {
            s->best = v;
        }
    }
}

// ---- runs ----

bool tune_may_run( tune_search* s, int reserve )
{
    const wisp_tune_def* args = s->args;
    // The first run is always allowed, however little time there is: a result without a configuration is useless.
    const bool may = s->run_count == 0 || ( !s->is_stopped && s->run_count + reserve < args->max_runs &&
                                            wisp_clock_seconds() - s->start < s->seconds );
    s->stopped_early |= !may;
    return may;
}

static int compare_times( const void* a, const void* b )
{
    const double x = *(const double*)a, y = *(const double*)b;
    return ( x > y ) - ( x < y );
}

double tune_median( double* times, int count )
{
    qsort( times, (size_t)count, sizeof( double ), compare_times );
    return 0.5 * ( times[( count - 1 ) / 2] + times[count / 2] );
}

static wisp_status check_sample( const tune_search* s, const int* configuration, const wisp_tune_sample* sample,
                                 wisp_error* error )
{
    const bool is_good = isfinite( sample->ms ) && sample->ms >= 0.0 &&
                         ( sample->is_halted || ( isfinite( sample->error ) && sample->error >= 0.0 ) );
    if ( is_good )
    {
        return WISP_OK;
    }
    const wisp_tune_parameter* parameter = &s->args->parameters[0];
    return wisp_fail( error, WISP_BAD_INPUT,
                      "run %d, with '%s' at %g: got %g ms and error %g, expected finite numbers of at least 0",
                      s->run_count, parameter->name, parameter->values[configuration[0]], sample->ms, sample->error );
}

// A run that halts once, or misses once, is not repeated.
static void take_down( tune_search* s, wisp_tune_trial* trial, const wisp_tune_sample* sample )
{
    double* times = s->times + ( trial - s->trials ) * s->args->repeats;
    WISP_ASSERT( trial->run_count < s->args->repeats );
    times[trial->run_count] = sample->ms;
    if ( trial->run_count == 0 )
    {
        trial->sample = *sample;
    }
    else
    {
        trial->sample.error = fmax( trial->sample.error, sample->error );
        trial->sample.largest = fmax( trial->sample.largest, sample->largest );
        trial->sample.is_halted |= sample->is_halted;
    }
    ++trial->run_count;
    trial->sample.ms = tune_median( times, trial->run_count );
}

wisp_status tune_visit( tune_search* s, int setting, wisp_error* error )
{
    tune_setting* place = &s->settings[setting];
    int configuration[WISP_TUNE_MAX_PARAMETERS] = { 0 };
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        configuration[k] = place->configuration[k];
    }
    wisp_tune_sample sample = { 0 };
    wisp_status status = s->args->run( s->args->user, configuration, &sample, error );
    ++s->run_count;
    status = status == WISP_OK ? check_sample( s, configuration, &sample, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( place->trial < 0 )
    {
        place->trial = s->trial_count++;
        place->is_open = false;
        s->trials[place->trial] = ( wisp_tune_trial ){ 0 };
        memcpy( s->trials[place->trial].configuration, configuration, sizeof( configuration ) );
    }
    take_down( s, &s->trials[place->trial], &sample );
    find_best( s );
    if ( s->args->progress && !s->args->progress( s->args->progress_user, s->run_count, s->args->max_runs ) )
    {
        s->is_stopped = true;
    }
    return WISP_OK;
}

int tune_setting_number( const tune_search* s, const int* configuration )
{
    int number = 0;
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        number = number * s->args->parameters[k].value_count + configuration[k];
    }
    return number;
}
