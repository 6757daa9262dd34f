/// The search of `wisp tune`: the cheapest configuration whose error is small enough, or the most accurate one within a time.
///
/// A *configuration* is one value for each *parameter*. The caller runs a configuration and returns its time and error. Times are meaningful
/// only on an idle machine.
#pragma once

#include "wisp/base.h"

#define TUNE_MAX_PARAMETERS 8
#define TUNE_MAX_VALUES 16     ///< of one parameter
#define TUNE_MAX_SETTINGS 4096 ///< choices that the parameters make together

/// A value to tune. The search relies on the order of the values: a finer one is taken to be slower and at least as accurate,
/// unless a run shows otherwise.
typedef struct tune_parameter
{
    const char* name;
    const double* values; ///< [value_count] from cheap and coarse to expensive and fine
    int value_count;      ///< 1 .. TUNE_MAX_VALUES
    bool is_unordered;    ///< the values have no order, such as on and off; takes more runs. Default false
} tune_parameter;

/// Measurements of one run.
typedef struct tune_sample
{
    double ms;      ///< median of a step, >= 0
    double error;   ///< in the host's unit, >= 0
    double largest; ///< the largest deviation behind the error, >= 0; not used by the search
    bool is_halted; ///< an entity was halted: the configuration is never chosen, its error is ignored
} tune_sample;

/// Runs one configuration. Candidates run again to repeat the measurement: only ms may then differ.
/// @param configuration [parameter_count] index of a value for each parameter
/// @return anything but WISP_OK ends the search, which returns it with its message
typedef wisp_status tune_run_fn( void* user, const int* configuration, tune_sample* out, wisp_error* error );

/// Called after every run. @return false to end the search: the best so far is the result
typedef bool tune_progress_fn( void* user, int run_count, int max_runs );

/// The target of a search and its limits. Need not outlive the call.
typedef struct tune_def
{
    const tune_parameter* parameters; ///< [parameter_count]
    int parameter_count;              ///< 1 .. TUNE_MAX_PARAMETERS
    double
        error; ///< > 0: find the cheapest configuration with at most this error. Exactly one of error and budget_ms is above 0
    double budget_ms; ///< > 0: find the most accurate configuration with at most this time, ms per step
    tune_run_fn* run;
    void* user;
    int max_runs;               ///< >= 1, repeated measurements included
    double max_seconds;         ///< > 0, s: no run starts later
    int repeats;                ///< >= 1, measurements of each finalist, interleaved; its time is the median
    tune_progress_fn* progress; ///< null: none
    void* progress_user;
} tune_def;

/// A configuration that was run.
typedef struct tune_trial
{
    int configuration[TUNE_MAX_PARAMETERS];
    tune_sample sample; ///< ms is the median of its runs, error the largest
    int run_count;      ///< runs of it
    bool is_pareto;     ///< no other trial without a halt is better in time or error and as good in the other
} tune_trial;

/// Result of a search. Release it with tune_release().
typedef struct tune_result
{
    bool meets_target;  ///< the configuration meets the target; if false it is the closest of all trials
    bool stopped_early; ///< a limit or the progress callback ended the search: a better configuration may exist
    int configuration[TUNE_MAX_PARAMETERS];
    double values[TUNE_MAX_PARAMETERS]; ///< of the configuration
    tune_sample achieved;               ///< of the configuration; halted only if every trial was
    tune_trial* trials;                 ///< [trial_count] in the order of their first run
    int trial_count;
    int run_count;
    double seconds; ///< wall time of the search
} tune_result;

/// Search for a configuration. Each run rules out others by the order of the values, and the rest is bisected. Then the
/// neighbours of the best one run, even if they were ruled out, until none is better. Candidates within the noise of their
/// times are measured again, interleaved. A configuration above the error target is never reported as meeting it. Equal
/// samples give equal results.
/// @param out receives the result; all zero on failure
/// @return WISP_BAD_INPUT a sample is NaN (the message names it); WISP_NO_MEMORY; or the status that `run` returned
wisp_status tune_find( const tune_def* def, tune_result* out, wisp_error* error );

/// Free a result. A zero result is allowed.
void tune_release( tune_result* result );
