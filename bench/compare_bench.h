/// `wisp bench cloth --compare`: one cloth, one material, three solvers: milliseconds per frame against the distance
/// to a converged run in double precision.
#pragma once

#include "compare_plan.h"

/// Tables of all scenarios.
/// @return WISP_IO_ERROR, WISP_BAD_INPUT a reference file is missing, broken, or of another cloth
wisp_status compare_bench_run( const compare_plan* plan, results* out, wisp_error* error );

// ---- parts of the comparison ----

/// Results of a variant in one scenario.
typedef struct compare_stats
{
    stats_summary
        ms[COMPARE_WORKERS_MAX]; ///< per frame, of the steps after `timed_observation`; NaN if it was halted
    double path;  ///< m, root mean square distance of all vertices to the reference in the window; NaN if halted
    double worst; ///< m, the same at the worst sample
    bool has_rest;
    compare_observation rest;
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
