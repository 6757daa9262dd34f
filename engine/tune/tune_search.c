// Choice of the next run. Configurations are partly ordered: one is below another if it is nowhere finer. The result
// of a run is assumed to hold for all above or below it, so one run closes many, and the open ones are divided as in
// bisection.
#include "tune.h"

static bool is_below( const wisp_tune_def* args, const tune_setting* lower, const tune_setting* upper )
{
    for ( int k = 0; k < args->parameter_count; ++k )
    {
        const int8_t a = lower->configuration[k], b = upper->configuration[k];
        if ( args->parameters[k].is_unordered ? a != b : a > b )
        {
            return false;
        }
    }
    return true;
}

// ---- configurations closed by a run ----

// Finer ones cannot win: they meet the error at a higher cost, or exceed the budget like this one.
static bool closes_above( const tune_search* s, const wisp_tune_sample* sample )
{
    const wisp_tune_sample* best = &s->trials[s->best].sample;
    if ( s->args->budget_ms > 0.0 )
    {
        return !tune_meets( s->args, sample );
    }
    return tune_meets( s->args, sample ) || ( tune_meets( s->args, best ) && sample->ms >= TUNE_NOISE * best->ms );
}

// Coarser ones cannot win: they miss the error like this one, or are no more accurate than the best within the
// budget.
static bool closes_below( const tune_search* s, const wisp_tune_sample* sample )
{
    const wisp_tune_sample* best = &s->trials[s->best].sample;
    if ( s->args->budget_ms > 0.0 )
    {
        return tune_meets( s->args, sample ) || ( tune_meets( s->args, best ) && sample->error >= best->error );
    }
    return !tune_meets( s->args, sample );
}

// All visits are evaluated again after every run, because a better best closes more.
static void close_settings( tune_search* s )
{
    for ( int i = 0; i < s->setting_count; ++i )
    {
        const tune_setting* run = &s->settings[i];
        if ( run->trial < 0 || s->trials[run->trial].sample.is_halted )
        {
            continue;
        }
        const bool above = closes_above( s, &s->trials[run->trial].sample );
        const bool below = closes_below( s, &s->trials[run->trial].sample );
        for ( int j = 0; j < s->setting_count; ++j )
        {
            tune_setting* other = &s->settings[j];
            if ( other->is_open &&
                 ( ( above && is_below( s->args, run, other ) ) || ( below && is_below( s->args, other, run ) ) ) )
            {
                other->is_open = false;
            }
        }
    }
}

// ---- choice of the next run ----

// Minimum number of open settings that a run closes, over its possible results.
static int worth_of( const tune_search* s, const tune_setting* candidate )
{
    int above = 0, below = 0;
    for ( int j = 0; j < s->setting_count; ++j )
    {
        const tune_setting* other = &s->settings[j];
        if ( other->is_open )
        {
            above += is_below( s->args, candidate, other );
            below += is_below( s->args, other, candidate );
        }
    }
    return above < below ? above : below;
}

// Ties go to the first, which is the cheaper one where they are ordered. @return -1: none is open
static int pick_setting( const tune_search* s )
{
    int best = -1, most = 0;
    for ( int i = 0; i < s->setting_count; ++i )
    {
        const int worth = s->settings[i].is_open ? worth_of( s, &s->settings[i] ) : 0;
        if ( worth > most )
        {
            most = worth;
            best = i;
        }
    }
    return best;
}

wisp_status tune_bisect( tune_search* s, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int next = pick_setting( s ); next >= 0 && status == WISP_OK && tune_may_run( s, s->reserve );
          next = pick_setting( s ) )
    {
        status = tune_visit( s, next, error );
        if ( status == WISP_OK )
        {
            close_settings( s );
        }
    }
    return status;
}
