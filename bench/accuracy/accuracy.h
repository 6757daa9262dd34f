/// The case `accuracy`: what accuracy costs in time. A scene is run by many settings; every run has its time, its
/// error and its hash, the Pareto front is marked, and settings are compared at equal time and at equal error.
#pragma once

#include "bench_options.h"

#define ACCURACY_MEASURES_MAX 8
#define ACCURACY_WORKERS_MAX 2

/// What can be turned, and what to call it. A scene has settings of any number of methods and parameters.
typedef struct accuracy_setting
{
    char name[64];   ///< as the table has it: "xpbd, 10 substeps, tethers"; no two of a scene are the same
    char series[48]; ///< settings that differ in `knob` alone; empty: of no series
    char method[48]; ///< settings that are one candidate at equal error and at equal time; empty: its series, or name
    char parameter_name[32]; ///< of a series: what goes to 0, with its unit: "substep, s", "spacing, m"
    double parameter;        ///< its value, above 0; the observed order is the slope of log error over log parameter
    double order;            ///< the order that theory promises; NaN: none is promised
} accuracy_setting;

/// What one run of a setting showed. The driver makes it with NaN everywhere.
typedef struct accuracy_run
{
    double error; ///< against the scene's reference, in the scene's unit; NaN if it was halted
    double measures[ACCURACY_MEASURES_MAX]; ///< what the scene looks at besides, in its order
    uint64_t hash;                          ///< of the final state: the same for every worker count, sampled or not
    int halted_at;                          ///< step; 0: never
    double* ms; ///< of each step: fill with accuracy_keep_ms(); the first of a run is not counted
    int ms_count, ms_capacity;
} accuracy_run;

/// Keep the time of a step. @return WISP_NO_MEMORY
wisp_status accuracy_keep_ms( accuracy_run* run, double ms );

/// A scene with its reference and its settings. Made by an accuracy_scene_fn, which also makes or reads the
/// reference.
typedef struct accuracy_scene
{
    char reference[200]; ///< what the error is measured against: "closed form: ...", "16 times the substeps: ..."
    double doubt;        ///< of the reference, in the unit of `error`: what is nearer has not been measured; 0: none
    const char* note;    ///< what a reader of the tables should know, whole messages; static; null: nothing
    char error_name[48]; ///< "distance to the reference"
    char error_unit[16]; ///< "mm", "%": of `error` as it is printed
    char ms_name[32];    ///< what a time is of, where steps have several lengths: "frame of 1/60 s"; empty: "step"
    const char* measure_names[ACCURACY_MEASURES_MAX]; ///< with their units; static texts
    int measure_count;
    bool
        has_no_rivals; ///< its series are experiments of their own: no front, and nothing at equal error or equal time
    accuracy_setting* settings; ///< [setting_count] malloc'ed; freed by the driver, after destroy()
    int setting_count;
    void* context; ///< what run() needs
    /// Run a setting from its start to its end, keeping the time of every step.
    /// @param is_looked_at error and measures are requested; otherwise only times, hash and halted_at
    wisp_status ( *run )( void* context, int setting, int workers, bool is_looked_at, accuracy_run* out,
                          wisp_error* error );
    void ( *destroy )( void* context ); ///< null: nothing to do
} accuracy_scene;

/// @param seconds about how long all runs of the scene may take, its reference included
typedef wisp_status accuracy_scene_fn( const bench_options* options, double seconds, accuracy_scene* out,
                                       wisp_error* error );

/// A scene as scenes.inc lists it.
typedef struct accuracy_entry
{
    const char* name;
    const char* title; ///< one line
    accuracy_scene_fn* make;
} accuracy_entry;

/// The scenes of scenes.inc in their order.
const accuracy_entry* accuracy_entries( int* count );

/// All tables of some scenes.
/// @param seconds about how long each of them may take
wisp_status accuracy_bench_run( const accuracy_entry* entries, int count, double seconds,
                                const bench_options* options, results* out, wisp_error* error );
