#include "boundary_bench.h"

boundary_plan boundary_default_plan( const bench_options* options )
{
    const double seconds = bench_seconds( options );
    return ( boundary_plan ){
        .spacings = { 0.2f, 0.1f, 0.05f, 0.025f, 0.0125f },
        .spacing_count = 5,
        .segments = { 8, 15, 30, 60, 120 },
        .sphere_count = 5,
        .pulse_steps = 2 * LAYER_PERIOD,
        .settle_steps = 120,
        .hang_seconds = 4.0,
        .cost_seconds = 0.4 * seconds,
        .pulse_seconds = 0.15 * seconds,
        .adaptive_seconds = 0.1 * seconds,
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .picture_side = 420,
        .options = options,
    };
}

wisp_status boundary_bench_run( const boundary_plan* plan, results* out, wisp_error* error )
{
    static const struct
    {
        boundary_fn* run;
        const char* name;
        double fraction; // of the case that is done before
    } tables[] = {
        { boundary_inflate, "boundary, inflation", 0.0 },  { boundary_volumes, "boundary, volumes", 0.05 },
        { boundary_counts, "boundary, counts", 0.1 },      { boundary_normals, "boundary, normals", 0.12 },
        { boundary_costs, "boundary, costs", 0.15 },       { boundary_adaptive, "boundary, curvature", 0.6 },
        { boundary_pulses, "boundary, pulses", 0.7 },      { boundary_steps, "boundary, steps", 0.85 },
        { boundary_pictures, "boundary, pictures", 0.95 },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( tables ) && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, tables[i].fraction, tables[i].name );
        status = tables[i].run( plan, out, error );
    }
    return status;
}

wisp_status boundary_bench( const bench_options* options, results* out, wisp_error* error )
{
    boundary_plan plan = boundary_default_plan( options );
    return boundary_bench_run( &plan, out, error );
}
