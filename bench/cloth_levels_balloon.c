// Levels only resist stretching, and a balloon is stretched on purpose: this table shows their effect on one.
#include "cloth_bench.h"

#include "balloon_scene.h"
#include "rows_chart.h"

#include <math.h>

typedef struct skin_setting
{
    const char* name;
    int substeps;
    bool levels;
    wisp_solve_order solve_order;
} skin_setting;

static const skin_setting settings[] = {
    { "10 x 2", 10, false, WISP_SOLVE_ORDER_COLOUR },
    { "10 x 2, list sweep", 10, false, WISP_SOLVE_ORDER_LIST },
    { "2 x 2", 2, false, WISP_SOLVE_ORDER_COLOUR },
    { "40 x 2", 40, false, WISP_SOLVE_ORDER_COLOUR },
    { "1 x 2 + levels", 1, true, WISP_SOLVE_ORDER_COLOUR },
    { "2 x 2 + levels", 2, true, WISP_SOLVE_ORDER_COLOUR },
    { "3 x 2 + levels", 3, true, WISP_SOLVE_ORDER_COLOUR },
    { "10 x 2 + levels", 10, true, WISP_SOLVE_ORDER_COLOUR },
};

#define ROWS "cloth.levels.balloon" // of all settings
#define FILL 1.2f
// Substeps of the converged run in those of the first setting.
#define REFERENCE_FACTOR 16
// The gas starts at full volume in a skin at rest, and without damping the skin would oscillate for long.
#define DAMPING 30.0f // 1/s
// Held at its feet, the lowest part of its height, so that the path shows the shape and not a drift.
#define FEET 0.03f
#define FEET_MAX 256

typedef struct level_line
{
    const char* name;
    scenario_stats stats;
    double volume_error; // |V / V_0 - 1| at the end
} level_line;

typedef struct level_table
{
    level_line lines[WISP_COUNT( settings )];
    int line_count;
    const char* reference_name; // of the converged run
} level_table;

// ---- the table ----

static int begin( const cloth_plan* plan, const char* title, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "substeps" );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        cells_put( &row, "%d %s ms", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "p10 .. p90" );
    }
    cells_put( &row, "stretch %%, max / mean" );
    cells_put( &row, "kinetic J" );
    cells_put( &row, "volume error %%" );
    cells_put( &row, "path error, m" );
    cells_put( &row, "front" );
    cells_put( &row, "hash" );
    return cells_begin_table( &row, title, out );
}

static bool is_on_front( const level_table* table, const level_line* line, int implementation )
{
    double ms = line->stats.ms[implementation].median, error = line->stats.path;
    if ( !isfinite( ms ) || !isfinite( error ) )
    {
        return false;
    }
    for ( int i = 0; i < table->line_count; ++i )
    {
        const level_line* other = &table->lines[i];
        if ( other->stats.ms[implementation].median < ms && other->stats.path < error )
        {
            return false;
        }
    }
    return true;
}

static void put_scientific( cells* row, double value )
{
    if ( isfinite( value ) )
    {
        cells_put( row, "%.2e", value );
    }
    else
    {
        cells_put( row, "-" );
    }
}

static void write_line( const cloth_plan* plan, const level_table* table, const level_line* line, int number,
                        results* out )
{
    const scenario_stats* f = &line->stats;
    cells row = { .count = 0 };
    cells_put( &row, "%s", line->name );
    scenario_put_times( f, plan->worker_count, &row );
    cells_put_pair( &row, 100.0 * f->stretch_max, 1, 100.0 * f->stretch_mean, 3 );
    put_scientific( &row, f->kinetic );
    cells_put_number( &row, 100.0 * line->volume_error, 3 );
    put_scientific( &row, f->path );
    cells_put( &row, "%s", is_on_front( table, line, plan->worker_count - 1 ) ? "yes" : "no" );
    cells_put_hash( &row, f->hash[0] );
    cells_end_row( &row, number, out );
}

static void write_reference( const cloth_plan* plan, const level_table* table, int number, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%s", table->reference_name );
    for ( int e = 0; e < 2 * plan->worker_count + 3; ++e )
    {
        cells_put( &row, "-" );
    }
    for ( int i = 0; i < 3; ++i )
    {
        cells_put( &row, i == 0 ? "0" : "-" );
    }
    cells_end_row( &row, number, out );
}

static void write_table( const cloth_plan* plan, const level_table* table, const char* title, results* out )
{
    int number = begin( plan, title, out );
    for ( int i = 0; i < table->line_count; ++i )
    {
        write_line( plan, table, &table->lines[i], number, out );
    }
    write_reference( plan, table, number, out );
}

static double path_of( const results_row* row )
{
    return rows_error( row, "path_rms_m" );
}

static void add_chart( const cloth_plan* plan, int first_row, const char* where, results* out )
{
    char title[160];
    snprintf( title, sizeof( title ), "Levels, %s: distance to the reference against time", where );
    const rows_chart chart = {
        .first_row = first_row,
        .name = ROWS,
        .workers = plan->workers[plan->worker_count - 1],
        .title = title,
        .x_label = "ms per step",
        .x = rows_ms,
        .y_label = "path error, m",
        .y = path_of,
        .is_front = true,
        .caption = "Ringed: no other way is both faster and more accurate.",
    };
    rows_chart_add( &chart, out );
}

// ---- runs ----

typedef struct held_figure
{
    wisp_mesh mesh;
    const char* name;
    int32_t feet[FEET_MAX];
    int foot_count;
} held_figure;

static void find_feet( held_figure* figure )
{
    const wisp_mesh* mesh = &figure->mesh;
    float lower = INFINITY, upper = -INFINITY;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        lower = fminf( lower, mesh->points[i].y );
        upper = fmaxf( upper, mesh->points[i].y );
    }
    for ( int i = 0; i < mesh->vertex_count && figure->foot_count < FEET_MAX; ++i )
    {
        if ( mesh->points[i].y <= lower + FEET * ( upper - lower ) )
        {
            figure->feet[figure->foot_count++] = i;
        }
    }
}

static wisp_status enter( const held_figure* figure, const skin_setting* skin, int workers, wisp_fabric** fabric,
                          surface_implementation* out, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = FILL;
    setting.damping = DAMPING;
    setting.substeps = skin->substeps;
    setting.levels = skin->levels;
    setting.solve_order = skin->solve_order;
    setting.workers = workers;
    setting.pins = figure->feet;
    setting.pin_count = figure->foot_count;
    wisp_status status = *fabric ? WISP_OK : balloon_cook( &figure->mesh, &setting, fabric, error );
    return status == WISP_OK ? balloon_implementation_create( *fabric, &setting, out, error ) : status;
}

static wisp_status volume_error( surface_implementation* implementation, const wisp_mesh* mesh, double* out,
                                 wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status == WISP_OK )
    {
        double requested = (double)FILL * balloon_volume( mesh, mesh->points );
        *out = balloon_volume( mesh, points ) / requested - 1.0;
    }
    return status;
}

// @param record path to fill, or null @param reference path to compare with, or null
static wisp_status run_setting( const cloth_plan* plan, const held_figure* figure, const skin_setting* skin,
                                int worker_count, const path_record* reference, path_record* record, level_line* line,
                                results* out, wisp_error* error )
{
    surface_implementation implementations[SCENARIO_IMPLEMENTATIONS_MAX] = { { 0 } };
    wisp_fabric* fabric = NULL;
    wisp_status status = WISP_OK;
    *line = ( level_line ){ .name = skin->name, .volume_error = NAN };
    for ( int e = 0; e < worker_count && status == WISP_OK; ++e )
    {
        status = enter( figure, skin, plan->workers[e], &fabric, &implementations[e], error );
    }
    if ( status == WISP_OK )
    {
        status =
            scenario_run( implementations, worker_count, &plan->scenario, reference, record, &line->stats, error );
    }
    if ( status == WISP_OK )
    {
        status = volume_error( &implementations[0], &figure->mesh, &line->volume_error, error );
    }
    if ( status == WISP_OK && reference )
    {
        char what[100];
        snprintf( what, sizeof( what ), "balloon, %s", skin->name );
        scenario_check_hashes( implementations, worker_count, line->stats.hash, what, out );
        scenario_add_rows( implementations, worker_count, &line->stats, ROWS, skin->name, "converged run", out );
    }
    for ( int e = 0; e < worker_count; ++e )
    {
        surface_implementation_destroy( &implementations[e] );
    }
    wisp_fabric_release( fabric );
    return status;
}

static wisp_status compare( const cloth_plan* plan, const held_figure* figure, results* out, wisp_error* error )
{
    path_record reference = { 0 };
    const int first_row = out->row_count;
    char reference_name[40], title[160];
    level_table table = { .reference_name = reference_name };
    skin_setting converged = settings[0];
    converged.substeps *= REFERENCE_FACTOR;
    snprintf( reference_name, sizeof( reference_name ), "%d x 2, engine", converged.substeps );
    converged.name = reference_name;
    wisp_status status = path_record_create( figure->mesh.vertex_count, scenario_path_observations( &plan->scenario ),
                                             &reference, error );
    level_line line;
    if ( status == WISP_OK )
    {
        status = run_setting( plan, figure, &converged, 1, NULL, &reference, &line, out, error );
    }
    for ( int i = 0; i < WISP_COUNT( settings ) && status == WISP_OK; ++i )
    {
        status = run_setting( plan, figure, &settings[i], plan->worker_count, &reference, NULL,
                              &table.lines[table.line_count++], out, error );
    }
    if ( status == WISP_OK )
    {
        snprintf( title, sizeof( title ), "Levels on a balloon: %s, %d vertices, filled to %.1f times its volume",
                  figure->name, figure->mesh.vertex_count, (double)FILL );
        write_table( plan, &table, title, out );
        add_chart( plan, first_row, figure->name, out );
        results_add_note( out,
                          "Levels on a balloon: the reference is Wisp with %d substeps; its volume differs by %.3f "
                          "%% from the gas's volume V_0, as it should, because the skin resists.",
                          converged.substeps, 100.0 * line.volume_error );
        results_add_note(
            out, "Levels on a balloon: levels only resist stretching, so they hold an inflated skin back. The body "
                 "is held by its feet so that they cannot carry it away; a balloon has no switch for levels." );
    }
    path_record_destroy( &reference );
    return status;
}

wisp_status cloth_levels_of_balloon( const cloth_plan* plan, results* out, wisp_error* error )
{
    held_figure figure = { .name = NULL };
    wisp_status status = balloon_mesh_figure( &figure.mesh, &figure.name, error );
    if ( status == WISP_OK )
    {
        find_feet( &figure );
        status = compare( plan, &figure, out, error );
    }
    wisp_mesh_release( &figure.mesh );
    return status;
}
