// Trials: one run of the host's callback, what is kept of it, and which sample is preferred.
#include "tune.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- which sample is preferred ----

bool tune_meets( const wisp_tune_job* job, const wisp_tune_sample* sample )
{
    return !sample->is_halted && ( job->error > 0.0 ? sample->error <= job->error : sample->ms <= job->budget_ms );
}

bool tune_is_better( const wisp_tune_job* job, const wisp_tune_sample* a, const wisp_tune_sample* b )
{
    if ( a->is_halted || b->is_halted )
    {
        return !a->is_halted && b->is_halted;
    }
    const bool meets = tune_meets( job, a );
    if ( meets != tune_meets( job, b ) )
    {
        return meets;
    }
    // Those that meet an error compete by time, those that miss it by error; of a budget it is the other way round.
    const bool by_time = ( job->error > 0.0 ) == meets;
    const double first = by_time ? a->ms - b->ms : a->error - b->error;
    const double second = by_time ? a->error - b->error : a->ms - b->ms;
    return first < 0.0 || ( first == 0.0 && second < 0.0 );
}

static void find_best( tune_search* s )
{
    s->best = -1;
    for ( int v = 0; v < s->visit_count; ++v )
    {
        if ( s->best < 0 || tune_is_better( s->job, &s->visits[v].sample, &s->visits[s->best].sample ) )
        {
            s->best = v;
        }
    }
}

// ---- runs ----

bool tune_may_run( tune_search* s, int reserve )
{
    const wisp_tune_job* job = s->job;
    // The first run is owed to the host however little time there is: a result without a choice helps nobody.
    const bool may = s->run_count == 0 || ( !s->is_stopped && s->run_count + reserve < job->max_runs &&
                                            wisp_clock_seconds() - s->start < s->seconds );
    s->is_cut |= !may;
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

static wisp_status check_sample( const tune_search* s, const int* choice, const wisp_tune_sample* sample,
                                 wisp_error* error )
{
    const bool is_good = isfinite( sample->ms ) && sample->ms >= 0.0 &&
                         ( sample->is_halted || ( isfinite( sample->error ) && sample->error >= 0.0 ) );
    if ( is_good )
    {
        return WISP_OK;
    }
    const wisp_tune_knob* knob = &s->job->knobs[0];
    return wisp_fail( error, WISP_BAD_INPUT,
                      "run %d, with '%s' at %g: got %g ms and error %g, expected finite numbers of at least 0",
                      s->run_count, knob->name, knob->values[choice[0]], sample->ms, sample->error );
}

// A run that halts once, or misses once, has done so for good.
static void take_down( tune_search* s, wisp_tune_visit* visit, const wisp_tune_sample* sample )
{
    double* times = s->times + ( visit - s->visits ) * s->job->repeats;
    WISP_ASSERT( visit->run_count < s->job->repeats );
    times[visit->run_count] = sample->ms;
    if ( visit->run_count == 0 )
    {
        visit->sample = *sample;
    }
    else
    {
        visit->sample.error = fmax( visit->sample.error, sample->error );
        visit->sample.largest = fmax( visit->sample.largest, sample->largest );
        visit->sample.is_halted |= sample->is_halted;
    }
    ++visit->run_count;
    visit->sample.ms = tune_median( times, visit->run_count );
}

wisp_status tune_visit( tune_search* s, int setting, wisp_error* error )
{
    tune_setting* place = &s->settings[setting];
    int choice[WISP_TUNE_MAX_KNOBS] = { 0 };
    for ( int k = 0; k < s->job->knob_count; ++k )
    {
        choice[k] = place->choice[k];
    }
    wisp_tune_sample sample = { 0 };
    wisp_status status = s->job->run( s->job->user, choice, &sample, error );
    ++s->run_count;
    status = status == WISP_OK ? check_sample( s, choice, &sample, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( place->visit < 0 )
    {
        place->visit = s->visit_count++;
        place->is_open = false;
        s->visits[place->visit] = ( wisp_tune_visit ){ 0 };
        memcpy( s->visits[place->visit].choice, choice, sizeof( choice ) );
    }
    take_down( s, &s->visits[place->visit], &sample );
    find_best( s );
    if ( s->job->progress && !s->job->progress( s->job->progress_user, s->run_count, s->job->max_runs ) )
    {
        s->is_stopped = true;
    }
    return WISP_OK;
}

int tune_setting_number( const tune_search* s, const int* choice )
{
    int number = 0;
    for ( int k = 0; k < s->job->knob_count; ++k )
    {
        number = number * s->job->knobs[k].value_count + choice[k];
    }
    return number;
}
