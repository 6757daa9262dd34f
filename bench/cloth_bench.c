#include "cloth_bench.h"

#include <math.h>

// Below this time in seconds the largest comparison and levels are left out, the irregular mesh is coarser, fewer
// steps are measured and converged runs have half the substeps.
#define FULL_SECONDS 40.0

cloth_plan cloth_default_plan( const bench_options* options )
{
    bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    cloth_plan plan = {
        .comparison_sizes = { 32, 64, 128, 256, 512 },
        .comparison_count = is_full ? 5 : 4,
        .hang_sizes = { 32, 64, 128, 256 },
        .hang_count = 4,
        .level_sizes = { 64, 128 },
        .level_count = is_full ? 2 : 1,
        .irregular_size = is_full ? 64 : 32,
        .has_balloon = true,
        .sweep_size = 64,
        .scenario = { .warm_steps = 60, .measured_steps = is_full ? 100 : 40, .turn_steps = 10 },
        .reference_factor = is_full ? 16 : 8,
        .reference_vertices_max = is_full ? 128 * 128 : 64 * 64,
        .oracle_vertices_max = 128 * 128,
        .comparison_seconds = ( is_full ? 0.2 : 0.1 ) * bench_seconds( options ),
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
    return plan;
}

wisp_status cloth_bench_run( const cloth_plan* plan, results* out, wisp_error* error )
{
    static const struct
    {
        wisp_status ( *make )( const cloth_plan* plan, results* out, wisp_error* error );
        const char* what;
        double fraction; // of the case that is done when it begins
    } tables[] = {
        { cloth_comparison, "cloth against scalar C", 0.0 },
        { cloth_hang, "hanging cloth", 0.3 },
        { cloth_levels, "cloth with levels and tethers", 0.5 },
        { cloth_levels_of_balloon, "balloon with levels", 0.8 },
        { cloth_sweeps, "sweeps", 0.95 },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( tables ) && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, tables[i].fraction, tables[i].what );
        status = tables[i].make( plan, out, error );
    }
    return status;
}

wisp_status cloth_bench( const bench_options* options, results* out, wisp_error* error )
{
    cloth_plan plan = cloth_default_plan( options );
    const wisp_status status = cloth_bench_run( &plan, out, error );
    if ( status == WISP_OK && bench_seconds( options ) < FULL_SECONDS )
    {
        results_add_note( out,
                          "Cloth: short of time, the comparison of 512 per side and the levels of 128 are left out. "
                          "The irregular mesh has %d per side instead of 64, %d steps are measured instead of 100, "
                          "and references have %d times the substeps instead of 16.",
                          plan.irregular_size, plan.scenario.measured_steps, plan.reference_factor );
    }
    return status;
}
