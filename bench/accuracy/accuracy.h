/// The case `accuracy`: the cost of accuracy in time. A scene runs with many settings; every run gives a time, an
/// error and a hash, the Pareto front is marked, and settings are compared at equal time and at equal error.
#pragma once

#include "bench.h"
#include "stats.h"
#include "suite.h"

#define ACCURACY_MEASURES_MAX 40
#define ACCURACY_WORKERS_MAX 2

/// Parameters of one setting, and its name. A scene has settings of any number of methods and parameters.
typedef struct accuracy_setting
{
    char name[192];   ///< as in the table: "xpbd, 10 substeps, tethers"; unique within a scene
    char series[192]; ///< settings that differ in `parameter` alone; empty: not in a series
    char
        method[192]; ///< settings compared as one candidate at equal error and equal time; empty: its series, or name
    char parameter_name[48]; ///< of a series: what tends to 0, with its unit: "substep, s", "spacing, m"
    double parameter;        ///< its value, above 0; the observed order is the slope of log error over log parameter
    double order;            ///< the order expected in theory; NaN: none
    int group;               ///< settings with one reference: they are rivals of each other, and of no others
    double doubt,
        until;   ///< of that reference, in the unit of `error`; s of motion compared. 0: those of the scene; not said
    bool is_cut; ///< motion is compared no longer because two converged runs part
    const double* measure_doubts; ///< of that reference; null: those of the scene
} accuracy_setting;

/// What a step is made of. The driver initialises it with 0: unknown.
typedef struct accuracy_work
{
    double strands, vertices; ///< of all that moves or is drawn
    double substeps;          ///< of a step
    double bytes;             ///< of world and fabrics, after all steps
} accuracy_work;

/// Results of one run of a setting. The driver initialises them with NaN.
typedef struct accuracy_run
{
    double error; ///< against the scene's reference, in the scene's unit; NaN if it was halted
    double measures[ACCURACY_MEASURES_MAX]; ///< further values that the scene measures, in its order
    uint64_t hash;                          ///< of the final state: the same for every worker count, sampled or not
    int halted_at;                          ///< step; 0: never
    double* ms; ///< of each step: fill with accuracy_keep_ms(); the first of a run is not counted
    int ms_count, ms_capacity;
    accuracy_work work;      ///< what a step is made of, if the scene says so
    profile_samples profile; ///< of all steps, if the scene gathers it; freed by the driver
} accuracy_run;

/// Keep the time of a step. @return WISP_NO_MEMORY
wisp_status accuracy_keep_ms( accuracy_run* run, double ms );

/// A scene with its reference and its settings. Made by an accuracy_scene_fn, which also makes or reads the
/// reference.
typedef struct accuracy_scene
{
    char reference[200]; ///< reference of the error: "closed form: ...", "16 times the substeps: ..."
    double
        uncertainty; ///< of the reference, in the unit of `error`, the largest of several; smaller errors are unresolved
    int group_count;     ///< of settings; 0: one
    const char* chaos;   ///< until when motion is compared, a sentence; null: until the end
    const char* note;    ///< note for readers of the tables, whole sentences; static; null: none
    char error_name[48]; ///< "distance to the reference"; empty: errors are not measured, and there are no rivals
    char error_unit[16]; ///< "mm", "%": of `error` as printed
    char ms_name[32];    ///< unit of a time, where steps have several lengths: "frame of 1/60 s"; empty: "step"
    const char* measure_names[ACCURACY_MEASURES_MAX]; ///< with their units; static texts
    double
        measure_doubts[ACCURACY_MEASURES_MAX]; ///< of those that are errors: smaller values are unresolved; 0: none
    int measure_count;
    int contact_measures;   ///< the last ones of them, which have a table of their own
    bool has_no_rivals;     ///< series are separate experiments: no front, and no tables at equal error or equal time
    const double* paper_ms; ///< [setting_count] of a step in the paper, 0: not in it; static; null: of no paper
    accuracy_setting* settings; ///< [setting_count] malloc'ed; freed by the driver, after destroy()
    int setting_count;
    void* context; ///< context of run()
    /// Run a setting from its start to its end and keep the time of every step.
    /// @param is_observed error and measures are requested; otherwise only times, hash and halted_at
    wisp_status ( *run )( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                          wisp_error* error );
    void ( *destroy )( void* context ); ///< null: nothing to do
} accuracy_scene;

/// @param subject of the entry
/// @param seconds approximate limit for all runs of the scene, including its reference
typedef wisp_status accuracy_scene_fn( const void* subject, const bench_options* options, double seconds,
                                       accuracy_scene* out, wisp_error* error );

/// A scene and its name.
typedef struct accuracy_entry
{
    const char* name;
    const char* title;       ///< one line
    accuracy_scene_fn* make; ///< null: the rows of `suite` are the settings
    const wisp_suite* suite;
    const void* subject; ///< for make(): one function makes several scenes; null: of one alone
} accuracy_entry;

/// Run the rows of a suite.
wisp_status suite_bench_rows( const wisp_suite* suite, const bench_options* options, results* out,
                              wisp_error* error );
wisp_status suite_bench( const char* path, const bench_options* options, results* out, wisp_error* error );

/// Run scenes and add all their tables.
/// @param seconds approximate limit for each scene
wisp_status accuracy_bench_run( const accuracy_entry* entries, int count, double seconds,
                                const bench_options* options, results* out, wisp_error* error );
