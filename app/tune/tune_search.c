// Two orders nearly always hold: a configuration that is nowhere finer is not slower, and one that is nowhere coarser is not less accurate.
// So one run rules out many others. Where an order fails they are ruled out wrongly: a third of the runs goes to neighbours of the best.
#include "tune_search.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Two measurements of one configuration, on a machine with occasional other load, may differ by this factor: smaller
/// differences decide nothing.
#define TUNE_NOISE 1.25
#define FINALISTS_MAX 4

/// A configuration by its number: digits in the mixed base of the value counts, the last parameter counting fastest.
typedef struct tune_setting
{
    int8_t configuration[TUNE_MAX_PARAMETERS];
    bool is_open; // not ruled out, and not run
    int trial;    // -1: not run
} tune_setting;

typedef struct tune_search
{
    const tune_def* args;
    tune_setting* settings; // [setting_count]
    int setting_count;
    tune_trial* trials; // [visit_count], capacity setting_count
    double* times;      // [visit][repeats] ms, of the first runs of each
    int trial_count;
    int best; // a visit, -1: none
    int run_count;
    double start;       // s, of the clock
    double seconds;     // no run of the stage begins later after the start
    int reserve;        // runs reserved for later stages
    bool is_stopped;    // the host has stopped the search
    bool stopped_early; // a run of the search was refused
} tune_search;

// ---- comparison of samples ----

static bool meets_target( const tune_def* args, const tune_sample* sample )
{
    return !sample->is_halted && ( args->error > 0.0 ? sample->error <= args->error : sample->ms <= args->budget_ms );
}

static bool is_better( const tune_def* args, const tune_sample* a, const tune_sample* b )
{
    if ( a->is_halted || b->is_halted )
    {
        return !a->is_halted && b->is_halted;
    }
    const bool meets = meets_target( args, a );
    if ( meets != meets_target( args, b ) )
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
        if ( s->best < 0 || is_better( s->args, &s->trials[v].sample, &s->trials[s->best].sample ) )
        {
            s->best = v;
        }
    }
}

// ---- runs ----

static bool may_run( tune_search* s, int reserve )
{
    const tune_def* args = s->args;
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

static double median_of( double* times, int count )
{
    qsort( times, (size_t)count, sizeof( double ), compare_times );
    return 0.5 * ( times[( count - 1 ) / 2] + times[count / 2] );
}

static wisp_status check_sample( const tune_search* s, const int* configuration, const tune_sample* sample,
                                 wisp_error* error )
{
    const bool is_good = isfinite( sample->ms ) && sample->ms >= 0.0 &&
                         ( sample->is_halted || ( isfinite( sample->error ) && sample->error >= 0.0 ) );
    if ( is_good )
    {
        return WISP_OK;
    }
    const tune_parameter* parameter = &s->args->parameters[0];
    return wisp_fail( error, WISP_BAD_INPUT,
                      "run %d, with '%s' at %g: got %g ms and error %g, expected finite numbers of at least 0",
                      s->run_count, parameter->name, parameter->values[configuration[0]], sample->ms, sample->error );
}

// A run that halts once, or misses once, is not repeated.
static void take_down( tune_search* s, tune_trial* trial, const tune_sample* sample )
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
    trial->sample.ms = median_of( times, trial->run_count );
}

static wisp_status visit( tune_search* s, int setting, wisp_error* error )
{
    tune_setting* place = &s->settings[setting];
    int configuration[TUNE_MAX_PARAMETERS] = { 0 };
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        configuration[k] = place->configuration[k];
    }
    tune_sample sample = { 0 };
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
        s->trials[place->trial] = ( tune_trial ){ 0 };
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

static int setting_number( const tune_search* s, const int* configuration )
{
    int number = 0;
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        number = number * s->args->parameters[k].value_count + configuration[k];
    }
    return number;
}

// ---- choice of the next run ----
//
// Configurations are partly ordered: one is below another if it is nowhere finer. The result of a run is assumed to hold for all above or
// below it, so one run closes many, and the open ones are divided as in bisection.

static bool is_below( const tune_def* args, const tune_setting* lower, const tune_setting* upper )
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
static bool closes_above( const tune_search* s, const tune_sample* sample )
{
    const tune_sample* best = &s->trials[s->best].sample;
    if ( s->args->budget_ms > 0.0 )
    {
        return !meets_target( s->args, sample );
    }
    return meets_target( s->args, sample ) ||
           ( meets_target( s->args, best ) && sample->ms >= TUNE_NOISE * best->ms );
}

// Coarser ones cannot win: they miss the error like this one, or are no more accurate than the best within the
// budget.
static bool closes_below( const tune_search* s, const tune_sample* sample )
{
    const tune_sample* best = &s->trials[s->best].sample;
    if ( s->args->budget_ms > 0.0 )
    {
        return meets_target( s->args, sample ) || ( meets_target( s->args, best ) && sample->error >= best->error );
    }
    return !meets_target( s->args, sample );
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

static wisp_status bisect( tune_search* s, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int next = pick_setting( s ); next >= 0 && status == WISP_OK && may_run( s, s->reserve );
          next = pick_setting( s ) )
    {
        status = visit( s, next, error );
        if ( status == WISP_OK )
        {
            close_settings( s );
        }
    }
    return status;
}

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
    const int setting = setting_number( s, configuration );
    return s->settings[setting].trial < 0 && may_run( s, s->reserve ) ? visit( s, setting, error ) : WISP_OK;
}

// One parameter changes: to the next values where they are ordered, to all others where they are not.
static wisp_status run_along( tune_search* s, const int* centre, int parameter, wisp_error* error )
{
    for ( int v = 0; v < s->args->parameters[parameter].value_count; ++v )
    {
        const int away = v - centre[parameter];
        if ( s->args->parameters[parameter].is_unordered || away == 1 || away == -1 )
        {
            int configuration[TUNE_MAX_PARAMETERS];
            for ( int k = 0; k < TUNE_MAX_PARAMETERS; ++k )
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
    const tune_parameter* parameters = s->args->parameters;
    if ( finer == rougher || parameters[finer].is_unordered || parameters[rougher].is_unordered )
    {
        return WISP_OK;
    }
    int configuration[TUNE_MAX_PARAMETERS];
    for ( int k = 0; k < TUNE_MAX_PARAMETERS; ++k )
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
static wisp_status search_around( tune_search* s, wisp_error* error )
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
static bool may_win( const tune_search* s, const tune_sample* sample )
{
    const tune_def* args = s->args;
    const tune_sample* best = &s->trials[s->best].sample;
    const bool best_meets = meets_target( args, best );
    if ( sample->is_halted || ( args->error > 0.0 && !best_meets ) )
    {
        return false; // errors have no noise
    }
    if ( args->error > 0.0 )
    {
        return meets_target( args, sample ) && sample->ms <= TUNE_NOISE * best->ms;
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
static wisp_status measure_again( tune_search* s, wisp_error* error )
{
    int finalists[FINALISTS_MAX];
    const int count = find_finalists( s, finalists );
    wisp_status status = WISP_OK;
    for ( int turn = 1; turn < s->args->repeats; ++turn )
    {
        for ( int i = 0; i < count && status == WISP_OK; ++i )
        {
            const tune_trial* trial = &s->trials[finalists[i]];
            if ( trial->run_count <= turn && may_run( s, 0 ) )
            {
                status = visit( s, setting_number( s, trial->configuration ), error );
            }
        }
    }
    return status;
}

// ---- the front ----

static bool beats( const tune_sample* a, const tune_sample* b )
{
    return !a->is_halted && a->ms <= b->ms && a->error <= b->error && ( a->ms < b->ms || a->error < b->error );
}

static void mark_front( tune_search* s )
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
    wisp_status status = bisect( s, error );
    s->reserve = reserve;
    s->seconds = s->args->max_seconds;
    status = status == WISP_OK ? search_around( s, error ) : status;
    // A repeated measurement may have made another one the best, which has neighbours of its own.
    s->reserve = 0;
    for ( int last = -1; status == WISP_OK && s->best != last; )
    {
        last = s->best;
        status = measure_again( s, error );
        status = status == WISP_OK && s->best != last ? search_around( s, error ) : status;
    }
    return status;
}

static void hand_over( tune_search* s, tune_result* out )
{
    const tune_trial* best = &s->trials[s->best];
    *out = ( tune_result ){ .meets_target = meets_target( s->args, &best->sample ),
                            .stopped_early = s->stopped_early,
                            .achieved = best->sample,
                            .trials = s->trials,
                            .trial_count = s->trial_count,
                            .run_count = s->run_count,
                            .seconds = wisp_clock_seconds() - s->start };
    for ( int k = 0; k < s->args->parameter_count; ++k )
    {
        out->configuration[k] = best->configuration[k];
        out->values[k] = s->args->parameters[k].values[best->configuration[k]];
    }
    s->trials = NULL;
}

static wisp_status search_settings( tune_search* s, tune_result* out, wisp_error* error )
{
    const size_t count = (size_t)s->setting_count;
    s->times = malloc( count * (size_t)s->args->repeats * sizeof *s->times );
    s->trials = malloc( count * sizeof *s->trials );
    s->settings = malloc( count * sizeof *s->settings );
    if ( s->times == NULL || s->trials == NULL || s->settings == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to search %d configurations", s->setting_count );
    }
    number_settings( s );
    // At most a fourth of the runs is reserved for the finalists; a search without spare runs measures once.
    const int requested = 2 * ( s->args->repeats - 1 );
    s->reserve = requested < s->args->max_runs / 4 ? requested : s->args->max_runs / 4;
    WISP_TRY( search( s, error ) );
    mark_front( s );
    hand_over( s, out );
    return WISP_OK;
}

wisp_status tune_find( const tune_def* args, tune_result* out, wisp_error* error )
{
    *out = ( tune_result ){ 0 };
    tune_search s = { .args = args, .best = -1, .start = wisp_clock_seconds(), .setting_count = 1 };
    for ( int k = 0; k < args->parameter_count; ++k )
    {
        s.setting_count *= args->parameters[k].value_count;
    }
    WISP_ASSERT( s.setting_count >= 1 && s.setting_count <= TUNE_MAX_SETTINGS );
    WISP_ASSERT( ( args->error > 0.0 ) != ( args->budget_ms > 0.0 ) && args->max_runs >= 1 && args->repeats >= 1 );
    const wisp_status status = search_settings( &s, out, error );
    free( s.times );
    free( s.trials );
    free( s.settings );
    return status;
}

void tune_release( tune_result* result )
{
    free( result->trials );
    *result = ( tune_result ){ 0 };
}
