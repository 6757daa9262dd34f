#include "cloth_levels_table.h"

#include "rows_chart.h"

#include <math.h>

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

void level_table_write( const cloth_plan* plan, const level_table* table, const char* title, results* out )
{
    int number = begin( plan, title, out );
    for ( int i = 0; i < table->line_count; ++i )
    {
        write_line( plan, table, &table->lines[i], number, out );
    }
    write_reference( plan, table, number, out );
}

// ---- charts ----

static double path_of( const results_row* row )
{
    return rows_error( row, "path_rms_m" );
}

void level_table_chart( const cloth_plan* plan, const char* rows, int first_row, const char* where, results* out )
{
    char title[160];
    snprintf( title, sizeof( title ), "Levels, %s: distance to the reference against time", where );
    const rows_chart chart = {
        .first_row = first_row,
        .name = rows,
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
