#include "cloth_levels_table.h"

#include "rows_chart.h"

#include <math.h>

static int begin( const cloth_plan* plan, const level_table* table, const char* title, results* out )
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
    if ( table->has_volume )
    {
        cells_put( &row, "volume error %%" );
    }
    else
    {
        cells_put( &row, "energy lost %%" );
    }
    cells_put( &row, "path error, m" );
    cells_put( &row, "front" );
    cells_put( &row, "hash" );
    return cells_begin_table( &row, title, out );
}

// The error by which lines are compared: of the path where there is a reference, else the mean stretch.
static double error_of( const level_table* table, const level_line* line )
{
    return table->reference_name ? line->stats.path : line->stats.stretch_mean;
}

static bool is_on_front( const level_table* table, const level_line* line, int implementation )
{
    double ms = line->stats.ms[implementation].median, error = error_of( table, line );
    if ( !isfinite( ms ) || !isfinite( error ) )
    {
        return false;
    }
    for ( int i = 0; i < table->line_count; ++i )
    {
        const level_line* other = &table->lines[i];
        if ( other->stats.ms[implementation].median < ms && error_of( table, other ) < error )
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
    if ( table->has_volume )
    {
        cells_put_number( &row, 100.0 * line->volume_error, 3 );
    }
    else
    {
        cells_put_number( &row, 100.0 * f->energy_lost, 2 );
    }
    put_scientific( &row, f->path );
    cells_put( &row, "%s", is_on_front( table, line, plan->worker_count - 1 ) ? "yes" : "no" );
    cells_put_hash( &row, f->hash[0] );
    cells_end_row( &row, number, out );
}

static void write_reference( const cloth_plan* plan, const level_table* table, int number, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%s", table->reference_name );
    for ( int e = 0; e < 2 * plan->worker_count + 2; ++e )
    {
        cells_put( &row, "-" );
    }
    cells_put_number( &row, table->has_volume ? NAN : 100.0 * table->reference_energy_lost, 2 );
    for ( int i = 0; i < 3; ++i )
    {
        cells_put( &row, i == 0 ? "0" : "-" );
    }
    cells_end_row( &row, number, out );
}

void level_table_write( const cloth_plan* plan, const level_table* table, const char* title, results* out )
{
    int number = begin( plan, table, title, out );
    for ( int i = 0; i < table->line_count; ++i )
    {
        write_line( plan, table, &table->lines[i], number, out );
    }
    if ( table->reference_name )
    {
        write_reference( plan, table, number, out );
    }
}

// ---- charts ----

static double mean_stretch_of( const results_row* row )
{
    return 100.0 * rows_error( row, "stretch_mean" );
}

static double path_of( const results_row* row )
{
    return rows_error( row, "path_rms_m" );
}

void level_table_charts( const cloth_plan* plan, const level_table* table, const char* rows, int first_row,
                         const char* where, results* out )
{
    char title[160];
    rows_chart chart = {
        .first_row = first_row,
        .name = rows,
        .workers = plan->workers[plan->worker_count - 1],
        .title = title,
        .x_label = "ms per step",
        .x = rows_ms,
        .is_front = true,
        .caption = "Ringed: no other way is both faster and more accurate.",
    };
    // An inflated skin is stretched because it is full.
    if ( !table->has_volume )
    {
        snprintf( title, sizeof( title ), "Levels and tethers, %s: mean stretch against time", where );
        chart.y_label = "mean stretch, %";
        chart.y = mean_stretch_of;
        rows_chart_add( &chart, out );
    }
    if ( table->reference_name )
    {
        snprintf( title, sizeof( title ), "Levels and tethers, %s: distance to the reference against time", where );
        chart.y_label = "path error, m";
        chart.y = path_of;
        rows_chart_add( &chart, out );
    }
}
