// Charts of rows.
#include "bench_output.h"

#include <math.h>
#include <string.h>

// ---- numbers of a row ----

static double find( const results_values* values, const char* name )
{
    for ( int i = 0; i < values->count; ++i )
    {
        if ( strcmp( values->items[i].name, name ) == 0 )
        {
            return values->items[i].value;
        }
    }
    return NAN;
}

double rows_ms( const results_row* row )
{
    return row->ms_median;
}

static double rows_size( const results_row* row, const char* name )
{
    return find( &row->size, name );
}

double rows_error( const results_row* row, const char* name )
{
    return find( &row->error, name );
}

double rows_vertices( const results_row* row )
{
    return rows_size( row, "vertices" );
}

// ---- rows to points ----

static bool is_taken( const rows_chart* what, const results_row* row )
{
    return strcmp( row->name, what->name ) == 0 && ( what->workers == 0 || row->workers == what->workers );
}

// The points of a front belong to one series per worker count and have the names of variants themselves.
static void name_series( const rows_chart* what, const results_row* row, char* out, size_t size )
{
    int used = snprintf( out, size, "%s", what->is_front ? "" : row->variant );
    if ( what->also && !what->is_front && (size_t)used < size )
    {
        used += snprintf( out + used, size - (size_t)used, ", %g %s", rows_size( row, what->also ), what->also_unit );
    }
    if ( row->workers > 0 && ( what->workers == 0 || what->is_front ) && (size_t)used < size )
    {
        snprintf( out + used, size - (size_t)used, "%s%d worker%s", used > 0 ? ", " : "", row->workers,
                  row->workers == 1 ? "" : "s" );
    }
}

static int find_series( const rows_chart* what, const results_row* row, int number, results* out )
{
    char name[64];
    name_series( what, row, name, sizeof( name ) );
    const results_chart* chart = results_chart_at( out, number );
    for ( int i = 0; chart && i < chart->series_count; ++i )
    {
        if ( strcmp( chart->series[i].name, name ) == 0 )
        {
            return i;
        }
    }
    return results_add_series( out, number, name, !what->is_front );
}

static void add_chart_row( const rows_chart* what, const results_row* row, int number, results* out )
{
    bool is_whole = row->steps >= what->min_steps;
    results_point point = { .x = is_whole ? what->x( row ) : NAN, .y = what->y( row ) };
    if ( what->is_front )
    {
        snprintf( point.label, sizeof( point.label ), "%s", row->variant );
    }
    results_add_point( out, number, find_series( what, row, number, out ), point );
}

// ---- the front ----

static bool is_beaten( const results_chart* chart, const results_point* point )
{
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            const results_point* other = &chart->series[s].points[i];
            bool is_no_worse = other->x <= point->x && other->y <= point->y;
            if ( is_no_worse && ( other->x < point->x || other->y < point->y ) )
            {
                return true;
            }
        }
    }
    return false;
}

static void mark_front( results_chart* chart )
{
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            results_point* point = &chart->series[s].points[i];
            point->is_marked = isfinite( point->x ) && isfinite( point->y ) && !is_beaten( chart, point );
        }
    }
}

void rows_chart_add( const rows_chart* what, results* out )
{
    int number = results_add_chart( out, what->title, what->x_label, what->y_label );
    results_chart* chart = results_chart_at( out, number );
    if ( !chart )
    {
        return;
    }
    chart->x_log = !what->x_linear;
    chart->y_log = !what->y_linear;
    snprintf( chart->caption, sizeof( chart->caption ), "%s", what->caption ? what->caption : "" );
    for ( int i = what->first_row; i < out->row_count; ++i )
    {
        if ( is_taken( what, &out->rows[i] ) )
        {
            add_chart_row( what, &out->rows[i], number, out );
        }
    }
    if ( what->is_front )
    {
        mark_front( chart );
    }
}
