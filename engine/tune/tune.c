#include "tune.h"

#include "alloc.h"
#include "wisp/module/definition.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const wisp_field TUNE_FIELDS[] = {
    WISP_FIELD( wisp_tune_def, error, WISP_FIELD_DOUBLE, 0, DBL_MAX, 0, NULL, 0 ),
    WISP_FIELD( wisp_tune_def, budget_ms, WISP_FIELD_DOUBLE, 0, DBL_MAX, 0, "ms", 0 ),
    WISP_WHOLE( wisp_tune_def, max_runs, 100, 1, INT32_MAX ),
    WISP_FIELD( wisp_tune_def, max_seconds, WISP_FIELD_DOUBLE, DBL_MIN, INFINITY, DBL_MIN, "s", INFINITY ),
    WISP_WHOLE( wisp_tune_def, repeats, 3, 1, WISP_TUNE_MAX_REPEATS ),
};
WISP_DEFINE( tune_def, "tune", TUNE_FIELDS )

// ---- checks of a definition ----

static wisp_status check_parameter( const wisp_tune_parameter* parameter, int number, wisp_error* error )
{
    if ( !parameter->name || !parameter->name[0] )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "parameter %d: got no name", number );
    }
    if ( parameter->value_count < 1 || parameter->value_count > WISP_TUNE_MAX_VALUES || !parameter->values )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "parameter '%s': got %d values, expected 1 to %d", parameter->name,
                          parameter->values ? parameter->value_count : 0, WISP_TUNE_MAX_VALUES );
    }
    return WISP_OK;
}

static wisp_status check_parameters( const wisp_tune_def* args, int* setting_count, wisp_error* error )
{
    if ( args->parameter_count < 1 || args->parameter_count > WISP_TUNE_MAX_PARAMETERS || !args->parameters )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got %d parameters, expected 1 to %d",
                          args->parameters ? args->parameter_count : 0, WISP_TUNE_MAX_PARAMETERS );
    }
    *setting_count = 1;
    for ( int k = 0; k < args->parameter_count; ++k )
    {
        WISP_TRY( check_parameter( &args->parameters[k], k, error ) );
        *setting_count *= args->parameters[k].value_count;
    }
    if ( *setting_count > WISP_TUNE_MAX_SETTINGS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got %d configurations, expected at most %d", *setting_count,
                          WISP_TUNE_MAX_SETTINGS );
    }
    return WISP_OK;
}

wisp_status tune_check_def( const wisp_tune_def* args, int* setting_count, wisp_error* error )
{
    if ( ( args->error > 0.0 ) == ( args->budget_ms > 0.0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "error, budget_ms: got %g and %g, expected one of them above 0 and the other 0",
                          args->error, args->budget_ms );
    }
    if ( ( args->allocator.allocate == NULL ) != ( args->allocator.release == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "allocator: got one function, expected both or neither" );
    }
    return check_parameters( args, setting_count, error );
}

// ---- result ----

static void number_settings( tune_search* s )
{
    for ( int i = 0; i < s->setting_count; ++i )
    {
        s->settings[i] = ( tune_setting ){ .is_open = true, .trial = -1 };
        int rest = i;
        for ( int k = s->args->parameter_count; k-- > 0; )
        {
            s->settings[i].configuration[k] = (int8_t)( rest % s->args->parameters[k].value_count );
            rest /= s->args->parameters[k].value_count;
        }
    }
}

static wisp_status search( tune_search* s, wisp_error* error )
{
    // With many parameters, ruling out takes more runs than there are. The best so far is then far from the best of
    // all, which is reached through neighbours: a third of the runs is reserved for them.
    const int reserve = s->reserve;
    s->reserve += s->args->max_runs / 3;
    s->seconds = s->args->max_seconds * 2.0 / 3.0;
    wisp_status status = tune_bisect( s, error );
    s->reserve = reserve;
    s->seconds = s->args->max_seconds;
    status = status == WISP_OK ? tune_search_around( s, error ) : status;
    // A repeated measurement may have made another one the best, which has neighbours of its own.
    s->reserve = 0;
    for ( int last = -1; status == WISP_OK && s->best != last; )
    {
        last = s->best;
        status = tune_measure_again( s, error );
        status = status == WISP_OK && s->best != last ? tune_search_around( s, error ) : status;
    }
    return status;
}

// The visits move from the search's buffer into a block whose size the result can derive when it is released.
static wisp_status hand_over( const tune_search* s, wisp_tune_result* out, wisp_error* error )
{
    const size_t bytes = (size_t)s->trial_count * sizeof( wisp_tune_trial );
    wisp_tune_trial* trials = base_allocate( &s->args->allocator, bytes, _Alignof( wisp_tune_trial ) );
    if ( !trials )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d trials", s->trial_count );
    }
    memcpy( trials, s->trials, bytes );
    const wisp_tune_trial* best = &s->trials[s->best];
    *out = ( wisp_tune_result ){ .meets_target = tune_meets( s->args, &best->sample ),
                                 .stopped_early = s->stopped_early,
                                 .achieved = best->sample,
                                 .trials = trials,
                                 .trial_count = s->trial_count,
                                 .run_count = s->run_count,
                                 .seconds = wisp_clock_seconds() - s->start,
                                 .allocator = s->args->allocator };
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        out->configuration[k] = best->configuration[k];
        out->values[k] = s->args->parameters[k].values[best->configuration[k]];
    }
    return WISP_OK;
}

static wisp_status search_with_room( tune_search* s, void* room, wisp_tune_result* out, wisp_error* error )
{
    const size_t count = (size_t)s->setting_count;
    s->times = room;
    s->trials = (wisp_tune_trial*)( s->times + count * (size_t)s->args->repeats );
    s->settings = (tune_setting*)( s->trials + count );
    number_settings( s );
    // At most a fourth of the runs is reserved for the finalists; a search without spare runs measures once.
    const int requested = 2 * ( s->args->repeats - 1 );
    s->reserve = requested < s->args->max_runs / 4 ? requested : s->args->max_runs / 4;
    WISP_TRY( search( s, error ) );
    tune_mark_front( s );
    return hand_over( s, out, error );
}

wisp_status wisp_tune( const wisp_tune_def* given, wisp_tune_result* out, wisp_error* error )
{
    if ( out == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "out: got null, expected where to store the result" );
    }
    *out = ( wisp_tune_result ){ 0 };
    wisp_tune_def values;
    const wisp_tune_def* args = &values;
    WISP_TRY( wisp_def_read( &wisp_tune_def_fields, &values, given, error ) );
    tune_search s = { .args = args, .best = -1, .start = wisp_clock_seconds() };
    WISP_TRY( tune_check_def( args, &s.setting_count, error ) );
    if ( !args->run )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "expected a callback that runs a configuration" );
    }
    const size_t each = (size_t)args->repeats * sizeof( double ) + sizeof( wisp_tune_trial ) + sizeof( tune_setting );
    const size_t bytes = each * (size_t)s.setting_count;
    void* room = base_allocate( &args->allocator, bytes, BASE_BUFFER_ALIGNMENT );
    if ( !room )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to search %d configurations", s.setting_count );
    }
    wisp_status status = search_with_room( &s, room, out, error );
    base_release( &args->allocator, room, bytes );
    return status;
}

void wisp_tune_release( wisp_tune_result* result )
{
    if ( result )
    {
        base_release( &result->allocator, result->trials, (size_t)result->trial_count * sizeof( wisp_tune_trial ) );
        *result = ( wisp_tune_result ){ 0 };
    }
}
