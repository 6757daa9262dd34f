/// Tuning: the cheapest setting whose error is small enough, or the most accurate one within a time, found by running
/// settings on the machine at hand.
///
/// A setting is a choice of one value for each *parameter*. wisp_tune() searches them for any host that can run a choice and
/// tell what it took and how wrong it was; wisp_tune_worlds() does the running and the comparing for hosts that can
/// build a world of a choice. Nothing else may load the machine meanwhile, or times mean little.
#pragma once

#include "wisp/base.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

#define WISP_TUNE_MAX_PARAMETERS 8
#define WISP_TUNE_MAX_VALUES 16     ///< of one parameter
#define WISP_TUNE_MAX_SETTINGS 4096 ///< choices that the parameters make together
#define WISP_TUNE_MAX_REPEATS 99    ///< measurements of one choice

/// Something that may be set. The search concludes from the order of the values: it takes a finer one for dearer, and not
/// less accurate, as long as no run tells otherwise.
typedef struct wisp_tune_parameter
{
    const char* name;
    const double* values; ///< [value_count] from cheap and rough to dear and fine
    int value_count;      ///< 1 .. WISP_TUNE_MAX_VALUES
    bool is_unordered;    ///< nothing is concluded from one value about another; takes more runs. Default false
} wisp_tune_parameter;

/// What a run of a choice has shown.
typedef struct wisp_tune_sample
{
    double ms;      ///< median of a step, >= 0
    double error;   ///< in the host's unit, >= 0
    double largest; ///< the largest deviation behind the error, >= 0; only handed on
    bool is_halted; ///< something left its bounds: never chosen, the error is ignored
} wisp_tune_sample;

/// Run one choice. A choice that may win is run again to measure it again: only ms may then differ.
/// @param choice [parameter_count] index of a value for each parameter
/// @return anything but WISP_OK ends the search, which hands it on with its message
typedef wisp_status wisp_tune_run_fn( void* user, const int* configuration, wisp_tune_sample* out,
                                      wisp_error* error );

/// Called after every run. @return false to end the search: the best so far is the result
typedef bool wisp_tune_progress_fn( void* user, int run_count, int max_runs );

/// What is asked for, and how long it may take. Fill from wisp_default_tune_def(); may die after the call.
typedef struct wisp_tune_def
{
    const wisp_tune_parameter* parameters; ///< [parameter_count]
    int parameter_count;                   ///< 1 .. WISP_TUNE_MAX_PARAMETERS
    double error;          ///< > 0: the cheapest choice with at most this error. Exactly one of the two is above 0
    double budget_ms;      ///< > 0: the most accurate choice with at most these milliseconds a step
    wisp_tune_run_fn* run; ///< not of wisp_tune_worlds(), which has its own
    void* user;
    int max_runs;       ///< >= 1, those that measure again included; default 100
    double max_seconds; ///< > 0, no run begins later; default infinity
    int repeats; ///< 1 .. WISP_TUNE_MAX_REPEATS, how often each finalist is measured, in turns; its time is the median. Default 3
    wisp_tune_progress_fn* progress; ///< default null
    void* progress_user;
    wisp_allocator allocator; ///< default: the C library
    uint32_t cookie;          ///< set by wisp_default_tune_def(), asserted on use
} wisp_tune_def;

WISP_API wisp_tune_def wisp_default_tune_def( void );

/// A choice that was run.
typedef struct wisp_tune_trial
{
    int configuration[WISP_TUNE_MAX_PARAMETERS];
    wisp_tune_sample sample; ///< its ms is the median of all its runs, its error the largest
    int run_count;           ///< how often it was run
    bool
        is_pareto; ///< none that was run, and did not halt, is better in one of time and error, and as good in the other
} wisp_tune_trial;

/// What was found. To be released with wisp_tune_release().
typedef struct wisp_tune_result
{
    bool meets_target;  ///< the choice meets what was asked for; else it is what comes nearest of all that was run
    bool stopped_early; ///< a limit or the progress callback ended the search early: there may be better
    int configuration[WISP_TUNE_MAX_PARAMETERS];
    double values[WISP_TUNE_MAX_PARAMETERS]; ///< of the choice
    wisp_tune_sample achieved;               ///< of the choice; halted only if every run was
    wisp_tune_trial* trials;                 ///< [visit_count] in the order of their first run
    int trial_count;
    int run_count;
    double seconds; ///< of wall time that the search took
    wisp_allocator allocator;
} wisp_tune_result;

/// Find a choice. Every run rules out as many others as the order of the values allows; what is left is halved again and
/// again. Then the neighbours of the best are run whatever was ruled out, until none is better, and those that may win
/// by the noise of their times are measured again, in turns. No choice whose error misses is ever told as one that meets.
/// The same samples lead to the same result.
/// @param out receives the result; all zero on failure
/// @return WISP_BAD_INPUT the job is wrong or a sample is not a number (the message names it); WISP_NO_MEMORY; or what
///         `run` returned
WISP_API wisp_status wisp_tune( const wisp_tune_def* args, wisp_tune_result* out, wisp_error* error );

/// Null and a zero result are allowed.
WISP_API void wisp_tune_release( wisp_tune_result* result );

// ---- worlds ----

/// Points that are compared: of an entity, in the user's order.
typedef struct wisp_tune_points
{
    wisp_entity entity;
    wisp_component component; ///< WISP_SURFACE_POINTS or WISP_STRAND_POINTS; tuning asks for it
} wisp_tune_points;

/// A world of a choice.
typedef struct wisp_tune_world
{
    wisp_world* world;
    const wisp_tune_points* points; ///< [point_count] the host's, good until the world is let go
    int point_count;                ///< entities, >= 1; the same for every choice
    void* host;                     ///< whatever the host wants to know again
} wisp_tune_world;

/// How worlds are made and run. Fill from wisp_default_tune_worlds_def().
typedef struct wisp_tune_worlds_def
{
    /// Build the world of a choice, with its substeps multiplied by a factor: 1, or reference_factor for the reference.
    /// @param out zero; on failure nothing may be left in it
    wisp_status ( *build )( void* user, const int* configuration, int substep_factor, wisp_tune_world* out,
                            wisp_error* error );
    /// One step; null: wisp_world_step() of dt. For hosts that carry pins or heads.
    wisp_status ( *step )( void* user, wisp_tune_world* world, int step, wisp_error* error );
    void ( *let_go )( void* user, wisp_tune_world* world ); ///< null: wisp_world_destroy()
    void* user;
    float dt;         ///< s, > 0, default 1/60
    int step_count;   ///< >= 1, default 120
    int sample_count; ///< 1 .. step_count, how often points are compared, the last time after the last step; default 12
    int reference_factor; ///< >= 2, default 16
    uint32_t cookie;
} wisp_tune_worlds_def;

WISP_API wisp_tune_worlds_def wisp_default_tune_worlds_def( void );

/// wisp_tune() for worlds. The reference is the world of the last value of every parameter with reference_factor times the substeps, run
/// once. The error of a choice is the root mean square, over all looks and all points, of the distance in m from where the
/// reference has the point; `largest` is the largest distance. Times are of the steps alone.
/// @return also WISP_CONFLICT: the reference halts, or two worlds do not have the same points
WISP_API wisp_status wisp_tune_worlds( const wisp_tune_def* args, const wisp_tune_worlds_def* def,
                                       wisp_tune_result* out, wisp_error* error );

WISP_END_C
