/// Tuning: find the cheapest configuration whose error is small enough, or the most accurate one within a time, by running
/// configurations on this machine.
///
/// A *configuration* is one value for each *parameter*. wisp_tune() searches for any host that can run a configuration and
/// return its time and error, such as the distance of its points to those of a converged run. Times are meaningful only on
/// an idle machine.
///
///     static const double substeps[] = { 1, 2, 4, 8, 16 };
///     const wisp_tune_parameter parameter = { .name = "substeps", .values = substeps, .value_count = 5 };
///     wisp_tune_def def = wisp_default_tune_def();
///     def.parameters = &parameter, def.parameter_count = 1, def.error = 1e-3;   // m
///     def.run = run_and_compare, def.user = &host;                              // the host's
///     wisp_tune_result found;
///     wisp_error error = { 0 };
///     if ( wisp_tune( &def, &found, &error ) == WISP_OK )
///         printf( "%g substeps, %g ms per step\n", found.values[0], found.achieved.ms );
///     wisp_tune_release( &found );
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

#define WISP_TUNE_MAX_PARAMETERS 8
#define WISP_TUNE_MAX_VALUES 16     ///< of one parameter
#define WISP_TUNE_MAX_SETTINGS 4096 ///< choices that the parameters make together
#define WISP_TUNE_MAX_REPEATS 99    ///< measurements of one choice

/// A value to tune. The search relies on the order of the values: a finer one is taken to be slower and at least as accurate,
/// unless a run shows otherwise.
typedef struct wisp_tune_parameter
{
    const char* name;
    const double* values; ///< [value_count] from cheap and coarse to expensive and fine
    int value_count;      ///< 1 .. WISP_TUNE_MAX_VALUES
    bool is_unordered;    ///< the values have no order, such as on and off; takes more runs. Default false
} wisp_tune_parameter;

/// Measurements of one run.
typedef struct wisp_tune_sample
{
    double ms;      ///< median of a step, >= 0
    double error;   ///< in the host's unit, >= 0
    double largest; ///< the largest deviation behind the error, >= 0; not used by the search
    bool is_halted; ///< an entity was halted: the configuration is never chosen, its error is ignored
} wisp_tune_sample;

/// Runs one configuration. Candidates run again to repeat the measurement: only ms may then differ.
/// @param configuration [parameter_count] index of a value for each parameter
/// @return anything but WISP_OK ends the search, which returns it with its message
typedef wisp_status wisp_tune_run_fn( void* user, const int* configuration, wisp_tune_sample* out,
                                      wisp_error* error );

/// Called after every run. @return false to end the search: the best so far is the result
typedef bool wisp_tune_progress_fn( void* user, int run_count, int max_runs );

/// The target of a search and its limits. Fill from wisp_default_tune_def(). Need not outlive the call.
typedef struct wisp_tune_def
{
    uint32_t size;                         ///< bytes; set by wisp_default_tune_def()
    const wisp_tune_parameter* parameters; ///< [parameter_count]
    int parameter_count;                   ///< 1 .. WISP_TUNE_MAX_PARAMETERS
    double
        error; ///< > 0: find the cheapest configuration with at most this error. Exactly one of error and budget_ms is above 0
    double budget_ms;      ///< > 0: find the most accurate configuration with at most this time, ms per step
    wisp_tune_run_fn* run; ///< required
    void* user;
    int max_runs;       ///< >= 1, repeated measurements included; default 100
    double max_seconds; ///< > 0, s: no run starts later; default infinity
    int repeats; ///< 1 .. WISP_TUNE_MAX_REPEATS, measurements of each finalist, interleaved; its time is the median. Default 3
    wisp_tune_progress_fn* progress; ///< default null
    void* progress_user;
    wisp_allocator allocator; ///< default: the C library
} wisp_tune_def;

WISP_DEFINITION( tune_def );

/// A configuration that was run.
typedef struct wisp_tune_trial
{
    int configuration[WISP_TUNE_MAX_PARAMETERS];
    wisp_tune_sample sample; ///< ms is the median of its runs, error the largest
    int run_count;           ///< runs of it
    bool is_pareto;          ///< no other trial without a halt is better in time or error and as good in the other
} wisp_tune_trial;

/// Result of a search. Release it with wisp_tune_release().
typedef struct wisp_tune_result
{
    bool meets_target;  ///< the configuration meets the target; if false it is the closest of all trials
    bool stopped_early; ///< a limit or the progress callback ended the search: a better configuration may exist
    int configuration[WISP_TUNE_MAX_PARAMETERS];
    double values[WISP_TUNE_MAX_PARAMETERS]; ///< of the configuration
    wisp_tune_sample achieved;               ///< of the configuration; halted only if every trial was
    wisp_tune_trial* trials;                 ///< [trial_count] in the order of their first run
    int trial_count;
    int run_count;
    double seconds; ///< wall time of the search
    wisp_allocator allocator;
} wisp_tune_result;

/// Search for a configuration. Each run rules out others by the order of the values, and the rest is bisected. Then the
/// neighbours of the best one run, even if they were ruled out, until none is better. Candidates within the noise of their
/// times are measured again, interleaved. A configuration above the error target is never reported as meeting it. Equal
/// samples give equal results.
/// @param out receives the result; all zero on failure
/// @return WISP_BAD_INPUT the definition is wrong or a sample is NaN (the message names it); WISP_NO_MEMORY; or the
///         status that `run` returned
WISP_API wisp_status wisp_tune( const wisp_tune_def* def, wisp_tune_result* out, wisp_error* error );

/// Free a result. Null and a zero result are allowed.
WISP_API void wisp_tune_release( wisp_tune_result* result );

WISP_END_C
