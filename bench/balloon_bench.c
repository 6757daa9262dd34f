#include "balloon_bench.h"

#include "oracle/balloon_oracle.h"

#include <math.h>

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

// ---- pressure ----

double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def )
{
    double sum = 0.0;
    for ( int slot = 0; slot < fabric->link_order.slot_count; ++slot )
    {
        int link = fabric->link_order.constraint[slot];
        double rest = (double)fabric->link_rest[slot];
        double stiffness = (double)( link < fabric->edge_count ? def->edge_stiffness : def->bend_link_stiffness );
        sum += link >= 0 ? stiffness * rest * rest : 0.0;
    }
    return sum;
}

// Every link of the mesh is s times as long: sum(k l^2) (s - 1) / (3 V_rest s^2).
static double closed_form( const wisp_fabric* fabric, const wisp_balloon_def* def, const wisp_balloon_stats* seen )
{
    return balloon_oracle_true_scaled_pressure( balloon_stiffness_sum( fabric, def ), seen->rest_volume,
                                                cbrt( seen->volume / seen->rest_volume ) );
}

wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error )
{
    wisp_balloon_def def = setting->def;
    wisp_balloon_stats seen = { 0 };
    wisp_status status = WISP_OK;
    for ( int reading = 0; reading < WISP_BALLOON_PRESSURE_COUNT && status == WISP_OK; ++reading )
    {
        def.pressure = (wisp_balloon_pressure)reading;
        status = wisp_set_balloon( implementation->world, implementation->entity, &def );
        if ( status == WISP_OK )
        {
            status = wisp_request_balloon_stats( implementation->world, implementation->entity, true );
        }
        if ( status != WISP_OK )
        {
            return bench_world_fail( implementation->world, status, error );
        }
        status = surface_implementation_step( implementation, error );
        status = status == WISP_OK ? balloon_implementation_read( implementation, &seen, error ) : status;
        out->pressure[reading] = seen.pressure;
    }
    out->volume_error = seen.volume / seen.target_volume - 1.0;
    out->closed_form = closed_form( implementation->fabric, &def, &seen );
    return status;
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
