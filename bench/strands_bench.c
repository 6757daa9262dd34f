#include "strands_bench.h"

#include <math.h>

// Below this time in seconds fewer steps lead up to the times.
#define FULL_SECONDS 40.0

strands_plan strands_default_plan( const bench_options* options )
{
    bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    return ( strands_plan ){
        .sizes = { 100, 300, 500, 2000, 10000, 50000 },
        .size_count = 6,
        .scenario_steps = is_full ? 60 : STRANDS_REFERENCE_STEPS,
        .scenario_strands = 2000,
        .few_settings_strands = is_full ? 10000 : 2000,
        .few_settings = is_full ? 3 : 1,
        .plain_strands = is_full ? 50000 : 10000,
        .comparison_seconds = ( is_full ? 0.5 : 0.1 ) * bench_seconds( options ),
        .head_sides = { 44, is_full ? 224 : 128 }, // of 20 vertices: a million
        .head_count = 2,
        .head_ratios_min = 16,
        .large_first_worker = is_full || options->workers == 1 ? 0 : 1,
        .head_steps = is_full ? 60 : 20,
        .settle_seconds = 8.0,
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
}

wisp_status strands_bench_run( const strands_plan* plan, results* out, wisp_error* error )
{
    static const struct
    {
        wisp_status ( *make )( const strands_plan* plan, results* out, wisp_error* error );
        const char* what;
        double fraction; // of the case that is done when it begins
    } tables[] = {
        { strands_comparison, "strands against scalar C", 0.0 },
        { strands_closed_forms, "strands against closed forms", 0.6 },
        { strands_independence, "strands at other rates", 0.65 },
        { strands_energy, "stretch and energy", 0.7 },
        { strands_guides, "guides and ghosts", 0.75 },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( tables ) && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, tables[i].fraction, tables[i].what );
        status = tables[i].make( plan, out, error );
    }
    return status;
}

wisp_status strands_bench( const bench_options* options, results* out, wisp_error* error )
{
    strands_plan plan = strands_default_plan( options );
    return strands_bench_run( &plan, out, error );
}
