// Stages that do not rely on the order of values, nor on a single measurement.
#include "tune.h"

#include "wisp/module/definition.h"

#define FINALISTS_MAX 4

// ---- neighbours ----

// Run a configuration unless it was run, or is out of range.
static wisp_status run_neighbour( tune_search* s, const int* configuration, wisp_error* error )
{
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        if ( configuration[k] < 0 || configuration[k] >= s->args->parameters[k].value_count )
        {
            return WISP_OK;
        }
    }
    const int setting = tune_setting_number( s, configuration );
    return s->settings[setting].trial < 0 && tune_may_run( s, s->reserve ) ? tune_visit( s, setting, error )
                                                                           : WISP_OK;
}

// One parameter changes: to the next values where they are ordered, to all others where they are not.
static wisp_status run_along( tune_search* s, const int* centre, int parameter, wisp_error* error )
{
    for ( int v = 0; v < s->args->parameters[parameter].value_count; ++v )
    {
        const int away = v - centre[parameter];
        if ( s->args->parameters[parameter].is_unordered || away == 1 || away == -1 )
        {
            int configuration[WISP_TUNE_MAX_PARAMETERS];
            for ( int k = 0; k < WISP_TUNE_MAX_PARAMETERS; ++k )
            {
                configuration[k] = k == parameter ? v : centre[k];
            }
            WISP_TRY( run_neighbour( s, configuration, error ) );
        }
    }
    return WISP_OK;
}

// One parameter becomes finer and another one coarser.
static wisp_status run_trade( tune_search* s, const int* centre, int finer, int rougher, wisp_error* error )
{
    const wisp_tune_parameter* parameters = s->args->parameters;
    if ( finer == rougher || parameters[finer].is_unordered || parameters[rougher].is_unordered )
    {
        return WISP_OK;
    }
    int configuration[WISP_TUNE_MAX_PARAMETERS];
    for ( int k = 0; k < WISP_TUNE_MAX_PARAMETERS; ++k )
    {
        configuration[k] = centre[k] + ( k == finer ) - ( k == rougher );
    }
    return run_neighbour( s, configuration, error );
}

// Continues from a better one at once, along the same parameter first: where one step helps, the next one often does.
static wisp_status run_all_along( tune_search* s, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        for ( int centre = -1; status == WISP_OK && centre != s->best; )
        {
            centre = s->best;
            status = run_along( s, s->trials[centre].configuration, k, error );
        }
    }
    return status;
}

static wisp_status run_all_trades( tune_search* s, const int* centre, wisp_error* error )
{
    const int count = s->args->parameter_count;
    for ( int pair = 0; pair < count * count; ++pair )
    {
        WISP_TRY( run_trade( s, centre, pair / count, pair % count, error ) );
    }
    return WISP_OK;
}

// With many parameters there are many trades, so they come after no single parameter improves the best.
wisp_status tune_search_around( tune_search* s, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int centre = -1; status == WISP_OK && centre != s->best; )
    {
        centre = s->best;
        status = run_all_along( s, error );
        if ( status == WISP_OK && centre == s->best )
        {
            status = run_all_trades( s, s->trials[centre].configuration, error );
        }
    }
    return status;
}

// ---- finalists ----

// Whether another measurement may make this one the best.
static bool may_win( const tune_search* s, const wisp_tune_sample* sample )
{
    const wisp_tune_def* args = s->args;
    const wisp_tune_sample* best = &s->trials[s->best].sample;
    const bool best_meets = tune_meets( args, best );
    if ( sample->is_halted || ( args->error > 0.0 && !best_meets ) )
    {
        return false; // errors have no noise
    }
    if ( args->error > 0.0 )
    {
        return tune_meets( args, sample ) && sample->ms <= TUNE_NOISE * best->ms;
    }
    return best_meets ? sample->error < best->error && sample->ms <= TUNE_NOISE * args->budget_ms
                      : sample->ms <= TUNE_NOISE * best->ms;
}

// The best, and the fastest of those that may become it. @return their number
static int find_finalists( const tune_search* s, int* finalists )
{
    int count = 0;
    finalists[count++] = s->best;
    for ( int v = 0; v < s->trial_count; ++v )
    {
        if ( v == s->best || !may_win( s, &s->trials[v].sample ) )
        {
            continue;
        }
        int place = count < FINALISTS_MAX ? count++ : FINALISTS_MAX;
        for ( ; place > 1 && s->trials[v].sample.ms < s->trials[finalists[place - 1]].sample.ms; --place )
        {
            if ( place < FINALISTS_MAX )
            {
                finalists[place] = finalists[place - 1];
            }
        }
        if ( place < FINALISTS_MAX )
        {
            finalists[place] = v;
        }
    }
    return count;
}

// In turns, so that a slow second of the machine affects all.
wisp_status tune_measure_again( tune_search* s, wisp_error* error )
{
    int finalists[FINALISTS_MAX];
    const int count = find_finalists( s, finalists );
    wisp_status status = WISP_OK;
    for ( int turn = 1; turn < s->args->repeats; ++turn )
    {
        for ( int i = 0; i < count && status == WISP_OK; ++i )
        {
            const wisp_tune_trial* trial = &s->trials[finalists[i]];
            if ( trial->run_count <= turn && tune_may_run( s, 0 ) )
            {
                status = tune_visit( s, tune_setting_number( s, trial->configuration ), error );
            }
        }
    }
    return status;
}

// ---- the front ----

static bool beats( const wisp_tune_sample* a, const wisp_tune_sample* b )
{
    return !a->is_halted && a->ms <= b->ms && a->error <= b->error && ( a->ms < b->ms || a->error < b->error );
}

void tune_mark_front( tune_search* s )
{
    for ( int v = 0; v < s->trial_count; ++v )
    {
        bool is_pareto = !s->trials[v].sample.is_halted;
        for ( int other = 0; other < s->trial_count && is_pareto; ++other )
        {
            is_pareto = !beats( &s->trials[other].sample, &s->trials[v].sample );
        }
        s->trials[v].is_pareto = is_pareto;
    }
}
