#include "tune.h"

#include "alloc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t TUNE_JOB_MADE = 0x54554e45;

wisp_tune_job wisp_default_tune_job( void )
{
    return (
        wisp_tune_job ){ .max_runs = 100, .max_seconds = INFINITY, .repeats = 3, .made_by_default = TUNE_JOB_MADE };
}

// ---- what a job may say ----

static wisp_status check_knob( const wisp_tune_knob* knob, int number, wisp_error* error )
{
    if ( !knob->name || !knob->name[0] )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "parameter %d: got no name", number );
    }
    if ( knob->value_count < 1 || knob->value_count > WISP_TUNE_MAX_VALUES || !knob->values )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "parameter '%s': got %d values, expected 1 to %d", knob->name,
                          knob->values ? knob->value_count : 0, WISP_TUNE_MAX_VALUES );
    }
    return WISP_OK;
}

static wisp_status check_knobs( const wisp_tune_job* job, int* setting_count, wisp_error* error )
{
    if ( job->knob_count < 1 || job->knob_count > WISP_TUNE_MAX_KNOBS || !job->knobs )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got %d parameters, expected 1 to %d",
                          job->knobs ? job->knob_count : 0, WISP_TUNE_MAX_KNOBS );
    }
    *setting_count = 1;
    for ( int k = 0; k < job->knob_count; ++k )
    {
        wisp_status status = check_knob( &job->knobs[k], k, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        *setting_count *= job->knobs[k].value_count;
    }
    if ( *setting_count > WISP_TUNE_MAX_SETTINGS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got %d configurations, expected at most %d", *setting_count,
                          WISP_TUNE_MAX_SETTINGS );
    }
    return WISP_OK;
}

wisp_status tune_check_job( const wisp_tune_job* job, int* setting_count, wisp_error* error )
{
    WISP_ASSERT( job->made_by_default == TUNE_JOB_MADE );
    if ( !isfinite( job->error ) || !isfinite( job->budget_ms ) || job->error < 0.0 || job->budget_ms < 0.0 ||
         ( job->error > 0.0 ) == ( job->budget_ms > 0.0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "error, budget_ms: got %g and %g, expected one of them above 0 and the other 0", job->error,
                          job->budget_ms );
    }
    if ( job->max_runs < 1 || !( job->max_seconds > 0.0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "max_runs, max_seconds: got %d and %g, expected both above 0",
                          job->max_runs, job->max_seconds );
    }
    if ( job->repeats < 1 || job->repeats > WISP_TUNE_MAX_REPEATS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "repeats: got %d, expected 1 to %d", job->repeats,
                          WISP_TUNE_MAX_REPEATS );
    }
    if ( ( job->allocator.allocate == NULL ) != ( job->allocator.release == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "allocator: got one function, expected both or neither" );
    }
    return check_knobs( job, setting_count, error );
}

// ---- from a job to a result ----

static void number_settings( tune_search* s )
{
    for ( int i = 0; i < s->setting_count; ++i )
    {
        s->settings[i] = ( tune_setting ){ .is_open = true, .visit = -1 };
        int rest = i;
        for ( int k = s->job->knob_count; k-- > 0; )
        {
            s->settings[i].choice[k] = (int8_t)( rest % s->job->knobs[k].value_count );
            rest /= s->job->knobs[k].value_count;
        }
    }
}

static wisp_status search( tune_search* s, wisp_error* error )
{
    // Among many knobs ruling out takes more runs than there are. What it has found by then is far from the best, which
    // its neighbours lead to: a third of what there is is theirs.
    const int reserve = s->reserve;
    s->reserve += s->job->max_runs / 3;
    s->seconds = s->job->max_seconds * 2.0 / 3.0;
    wisp_status status = tune_bisect( s, error );
    s->reserve = reserve;
    s->seconds = s->job->max_seconds;
    status = status == WISP_OK ? tune_look_around( s, error ) : status;
    // A time that was measured again may have made another one the best, which has neighbours of its own.
    s->reserve = 0;
    for ( int last = -1; status == WISP_OK && s->best != last; )
    {
        last = s->best;
        status = tune_measure_again( s, error );
        status = status == WISP_OK && s->best != last ? tune_look_around( s, error ) : status;
    }
    return status;
}

// The visits move out of the search's room into a block whose size the result can tell when it is released.
static wisp_status hand_over( const tune_search* s, wisp_tune_result* out, wisp_error* error )
{
    const size_t bytes = (size_t)s->visit_count * sizeof( wisp_tune_visit );
    wisp_tune_visit* visits = base_allocate( &s->job->allocator, bytes, _Alignof( wisp_tune_visit ) );
    if ( !visits )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d trials", s->visit_count );
    }
    memcpy( visits, s->visits, bytes );
    const wisp_tune_visit* best = &s->visits[s->best];
    *out = ( wisp_tune_result ){ .is_met = tune_meets( s->job, &best->sample ),
                                 .is_cut = s->is_cut,
                                 .achieved = best->sample,
                                 .visits = visits,
                                 .visit_count = s->visit_count,
                                 .run_count = s->run_count,
                                 .seconds = wisp_clock_seconds() - s->start,
                                 .allocator = s->job->allocator };
    for ( int k = 0; k < s->job->knob_count; ++k )
    {
        out->choice[k] = best->choice[k];
        out->values[k] = s->job->knobs[k].values[best->choice[k]];
    }
    return WISP_OK;
}

static wisp_status search_with_room( tune_search* s, void* room, wisp_tune_result* out, wisp_error* error )
{
    const size_t count = (size_t)s->setting_count;
    s->times = room;
    s->visits = (wisp_tune_visit*)( s->times + count * (size_t)s->job->repeats );
    s->settings = (tune_setting*)( s->visits + count );
    number_settings( s );
    // A fourth of the runs at most waits for the finalists; a search that has none to spare measures once.
    const int wanted = 2 * ( s->job->repeats - 1 );
    s->reserve = wanted < s->job->max_runs / 4 ? wanted : s->job->max_runs / 4;
    wisp_status status = search( s, error );
    if ( status == WISP_OK )
    {
        tune_mark_front( s );
        status = hand_over( s, out, error );
    }
    return status;
}

wisp_status wisp_tune( const wisp_tune_job* job, wisp_tune_result* out, wisp_error* error )
{
    *out = ( wisp_tune_result ){ 0 };
    tune_search s = { .job = job, .best = -1, .start = wisp_clock_seconds() };
    wisp_status status = tune_check_job( job, &s.setting_count, error );
    if ( status == WISP_OK && !job->run )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "expected a callback that runs a configuration" );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    const size_t each = (size_t)job->repeats * sizeof( double ) + sizeof( wisp_tune_visit ) + sizeof( tune_setting );
    const size_t bytes = each * (size_t)s.setting_count;
    void* room = base_allocate( &job->allocator, bytes, BASE_BUFFER_ALIGNMENT );
    if ( !room )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to search %d configurations", s.setting_count );
    }
    status = search_with_room( &s, room, out, error );
    base_release( &job->allocator, room, bytes );
    return status;
}

void wisp_tune_release( wisp_tune_result* result )
{
    if ( result )
    {
        base_release( &result->allocator, result->visits, (size_t)result->visit_count * sizeof( wisp_tune_visit ) );
        *result = ( wisp_tune_result ){ 0 };
    }
}
