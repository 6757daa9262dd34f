#include "balloon_bench.h"

#include "balloon_readings.h"

balloon_plan balloon_default_plan( const bench_options* options )
{
    return ( balloon_plan ){
        .levels = { 3, 4, 5, 6, 7 },
        .level_count = 5,
        .settle_steps = 120,
        .substeps_max = 1000,
        .seconds = 0.6 * bench_seconds( options ),
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
}

// ---- the table of substeps ----

typedef struct pressure_line
{
    int substeps, iterations;
} pressure_line;

static const pressure_line pressure_lines[] = {
    { 1, 20 }, { 1, 400 }, { 10, 2 }, { 10, 10 }, { 50, 1 }, { 100, 1 }, { 400, 1 }, { 1000, 1 },
};

static wisp_status settle( const balloon_plan* plan, const wisp_mesh* mesh, const pressure_line* line, int table,
                           results* out, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = 1.2f;
    setting.area_density = 0.05f;
    setting.damping = 45.0f;
    setting.substeps = line->substeps;
    setting.iterations = line->iterations;
    wisp_fabric* fabric = NULL;
    surface_implementation implementation = { 0 };
    balloon_readings read = { { 0 }, 0, 0 };
    wisp_status status = balloon_cook( mesh, &setting, &fabric, error );
    status = status == WISP_OK ? balloon_implementation_create( fabric, &setting, &implementation, error ) : status;
    double start = wisp_clock_seconds();
    for ( int s = 0; s < plan->settle_steps && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( &implementation, error );
    }
    double ms = 1e3 * ( wisp_clock_seconds() - start ) / plan->settle_steps;
    status = status == WISP_OK ? balloon_read_all( &implementation, &setting, &read, error ) : status;
    if ( status == WISP_OK )
    {
        cells row = { .count = 0 };
        cells_put( &row, "%d x %d", line->substeps, line->iterations );
        cells_put_number( &row, ms, 4 );
        cells_put_number( &row, read.pressure[WISP_BALLOON_PRESSURE_GAS], 0 );
        cells_put_number( &row, read.pressure[WISP_BALLOON_PRESSURE_MULTIPLIER], 0 );
        cells_put_number( &row, read.pressure[WISP_BALLOON_PRESSURE_VIRIAL], 0 );
        cells_put_number( &row, read.closed_form, 0 );
        cells_put_number( &row, 100.0 * ( read.pressure[WISP_BALLOON_PRESSURE_VIRIAL] / read.closed_form - 1.0 ), 1 );
        cells_put_number( &row, 100.0 * read.volume_error, 3 );
        cells_end_row( &row, table, out );
    }
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status balloon_pressures( const balloon_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = { "substeps x iterations", "1 worker ms",   "gas Pa",
                                          "multiplier Pa",         "virial Pa",     "closed form Pa",
                                          "virial's error %",      "volume error %" };
    int table = results_add_table( out,
                                   "Pressure of a sphere of 42 vertices, 0.15 m, filled to 1.2 times its volume, by "
                                   "the three readings",
                                   WISP_COUNT( header ), header );
    wisp_mesh mesh = { 0 };
    wisp_status status = balloon_mesh_sphere( 1, BALLOON_RADIUS, &mesh, error );
    for ( int i = 0; i < WISP_COUNT( pressure_lines ) && status == WISP_OK; ++i )
    {
        if ( pressure_lines[i].substeps <= plan->substeps_max )
        {
            status = settle( plan, &mesh, &pressure_lines[i], table, out, error );
        }
    }
    wisp_mesh_release( &mesh );
    results_add_note( out,
                      "Pressure: after %d steps of 1/60 s, 0.05 kg/m^2, k_edge 2000 N/m, damping 45/s, no gravity. "
                      "The closed form is that of the mesh scaled evenly to its computed volume.",
                      plan->settle_steps );
    results_add_note( out, "Pressure: substeps help more than iterations. The gas and multiplier readings are "
                           "meaningless below some hundred substeps." );
    return status;
}

wisp_status balloon_bench_run( const balloon_plan* plan, results* out, wisp_error* error )
{
    bench_progress( plan->options, 0.0, "balloon, sizes" );
    wisp_status status = balloon_sizes( plan, out, error );
    bench_progress( plan->options, 0.7, "balloon, pressure" );
    return status == WISP_OK ? balloon_pressures( plan, out, error ) : status;
}

wisp_status balloon_bench( const bench_options* options, results* out, wisp_error* error )
{
    balloon_plan plan = balloon_default_plan( options );
    return balloon_bench_run( &plan, out, error );
}
