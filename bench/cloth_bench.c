#include "cloth_bench.h"

#include "suite/suite_folder.h"

// Below this time in seconds the largest comparison is left out, and fewer steps are measured.
#define FULL_SECONDS 40.0

cloth_plan cloth_default_plan( const bench_options* options )
{
    bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    cloth_plan plan = {
        .comparison_sizes = { 32, 64, 128, 256, 512 },
        .comparison_count = is_full ? 5 : 4,
        .scenario = { .warm_steps = 60, .measured_steps = is_full ? 100 : 40, .turn_steps = 10 },
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
    const cloth_plan plan = cloth_default_plan( options );
    wisp_status status = cloth_bench_run( &plan, out, error );
    if ( status == WISP_OK && bench_seconds( options ) < FULL_SECONDS )
    {
        results_add_note(
            out,
            "Cloth: short of time, the comparison of 512 per side is left out, and %d steps of balloons "
            "are measured instead of 100.",
            plan.scenario.measured_steps );
    }
    bench_progress( options, 0.4, "suites of cloth" );
    return status == WISP_OK ? suite_bench_folder( "cloth", 0.6 * bench_seconds( options ), options, out, error )
                             : status;
}
