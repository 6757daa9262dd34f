/// `wisp bench cloth --compare`: one cloth, one material, three solvers: milliseconds per frame against the distance
/// to a converged run in double precision.
#pragma once

#include "bench.h"
#include "compare_reference.h"

#define COMPARE_VARIANTS_MAX 64
#define COMPARE_WORKERS_MAX 2

typedef enum compare_method
{
    COMPARE_PBD,
    COMPARE_XPBD,
    COMPARE_IMPLICIT,
    COMPARE_METHOD_COUNT,
} compare_method;

extern const char* const compare_method_names[COMPARE_METHOD_COUNT];

/// A solver setting.
typedef struct compare_variant
{
    char name[48];
    compare_method method;
    int substeps;    ///< pbd, xpbd: of a frame
    float stiffness; ///< pbd: of the edges, in (0, 1]
    int rate;        ///< implicit: steps per second
    float tolerance; ///< implicit: of a linear solve
    int repeats;     ///< implicit: linear solves per step
    bool bdf2;       ///< implicit
    bool is_limit;   ///< enough substeps that the remaining error is that of the model: left out of the summaries
    bool has_rest;   ///< continues until the scene is at rest
} compare_variant;

typedef struct compare_plan
{
    compare_scenario scenarios[COMPARE_SCENARIO_COUNT];
    int scenario_count;
    compare_variant variants[COMPARE_VARIANTS_MAX];
    int variant_count;
    int workers[COMPARE_WORKERS_MAX], worker_count;
    int rounds_max;               ///< of the window, each from the start; at least one is made
    double seconds;               ///< of all scenarios together: no new round after this
    const char* folder;           ///< of the reference files
    const bench_options* options; ///< for progress
} compare_plan;

compare_plan compare_default_plan( const bench_options* options );
/// Add a solver setting; more than COMPARE_VARIANTS_MAX is an assert. The name is filled in.
void compare_add_variant( compare_plan* plan, compare_variant variant );

/// Tables of all scenarios.
/// @return WISP_IO_ERROR, WISP_BAD_INPUT a reference file is missing, broken, or of another cloth
wisp_status compare_bench_run( const compare_plan* plan, results* out, wisp_error* error );

// ---- parts of the comparison ----

/// Results of a variant in one scenario.
typedef struct compare_stats
{
    stats_summary ms[COMPARE_WORKERS_MAX]; ///< per frame, of the steps after `timed_look`; NaN if it was halted
    double path;  ///< m, root mean square distance of all vertices to the reference in the window; NaN if halted
    double worst; ///< m, the same at the worst sample
    bool has_rest;
    compare_look rest;
    double rest_distance; ///< m, root mean square distance to the reference at rest
    uint64_t hash;        ///< after the window
    int halted_at;        ///< step; 0: never
} compare_stats;

/// A world with the cloth in it, at its start.
/// @param start [vertex_count]
wisp_status compare_enter( const compare_scene* scene, wisp_fabric* fabric, const compare_variant* variant,
                           const wisp_vec3* start, int workers, surface_implementation* out, wisp_error* error );
/// Cook the scene's mesh with the data of all solvers.
wisp_status compare_cook( const compare_scene* scene, wisp_fabric** out, wisp_error* error );

/// Run all variants through one scene, in turns.
/// @param seconds no new round after this time @param stats [variant_count]
wisp_status compare_scene_run( const compare_plan* plan, const compare_scene* scene,
                               const compare_reference* reference, double seconds, compare_stats* stats, results* out,
                               wisp_error* error );

/// The table of all variants, and one row for machines per worker count.
void compare_add_table( const compare_plan* plan, const compare_scene* scene, const compare_reference* reference,
                        const compare_stats* stats, results* out );
/// The error of each method at equal time, and its time at equal error.
void compare_add_summaries( const compare_plan* plan, const compare_scene* scene, const compare_stats* stats,
                            results* out );
