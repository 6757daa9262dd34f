/// The reference of a scene, which is that of `wisp accuracy`, and the search of `wisp tune`, for programs and bindings.
#pragma once

#include "suite_motion.h"
#include "tune_parameters.h"

typedef struct tune_scene_def
{
    const char* path;               ///< of the scene, as messages have it
    suite_given given;              ///< the scene
    double length;                  ///< of motion that is compared; 0: as `wisp accuracy` has it
    const suite_observer* observer; ///< of all runs; may be null. A failure of it ends them
    wisp_log_fn* log;               ///< receives the warnings of the scene; null: stderr
    void* log_user;
} tune_scene_def;

/// A scene and its reference. Must stay where it is.
typedef struct tune_scene
{
    tune_scene_def def;
    wisp_suite suite; ///< that of `wisp accuracy`
    suite_references references;
    const suite_reference* reference; ///< of the scene as written
} tune_scene;

/// Read or make the reference.
/// @param def what it points to must stay until tune_scene_close() @param out to be closed, after a failure too
wisp_status tune_scene_open( const tune_scene_def* def, tune_scene* out, wisp_error* error );
void tune_scene_close( tune_scene* scene );

/// How a run is timed.
typedef struct tune_machine
{
    int workers;     ///< 0: those of the scene
    const char* isa; ///< null: the best available
} tune_machine;

/// Run a scene of the same bodies as long as the reference, compare and time it.
/// @param measured the comparison is skipped if it has steps already, which leaves the time
wisp_status tune_scene_run( const tune_scene* scene, const suite_given* given, const tune_machine* machine,
                            suite_measurement* measured, tune_sample* out, wisp_error* error );

typedef struct tune_scene_search_def
{
    const wisp_scene* scene; ///< as it was read
    const tune_parameters* parameters;
    double error, budget_ms; ///< m, ms; one of them
    double limit;            ///< s of wall time
    tune_machine machine;
    tune_progress_fn* progress; ///< called after every run; null: not
    void* progress_user;
} tune_scene_search_def;

/// @param measured receives what a run measured @param out to be released
wisp_status tune_scene_search( const tune_scene* scene, const tune_scene_search_def* def, suite_measurement* measured,
                               tune_result* out, wisp_error* error );
