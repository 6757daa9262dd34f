#include "report_data.h"

#include "results_write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void report_write_number( double value, char* out, size_t size )
{
    json_t* number = isfinite( value ) ? results_json_count( value ) : NULL;
    const size_t used = json_dumpb( number, out, size - 1, JSON_ENCODE_ANY | JSON_REAL_PRECISION( 4 ) );
    json_decref( number );
    snprintf( out + used, size - used, "%s", used == 0 ? "-" : "" );
}

// ---- tables ----

// Sixteen hexadecimal digits, as every case writes a hash.
static bool is_hash( const char* cell )
{
    return strlen( cell ) == 16 && strspn( cell, "0123456789abcdef" ) == 16;
}

static void put_cell( const results_table* table, int row, int column, FILE* stream )
{
    const char* cell = results_cell( table, row, column );
    fputs( row == 0 ? "<th scope=\"col\"" : "<td", stream );
    const bool is_number = results_is_numeric_column( table, column );
    fputs( is_hash( cell ) ? " class=\"hash\">" : is_number ? " class=\"n\">" : ">", stream );
    report_put_prose( cell, stream );
    fputs( row == 0 ? "</th>" : "</td>", stream );
}

static void put_rows( const results_table* table, FILE* stream )
{
    fputs( "<table class=\"data\">\n<thead>\n", stream );
    for ( int row = 0; row < table->row_count; ++row )
    {
        fputs( row == 1 ? "</thead>\n<tbody>\n<tr>" : "<tr>", stream );
        for ( int column = 0; column < table->column_count; ++column )
        {
            put_cell( table, row, column, stream );
        }
        fputs( "</tr>\n", stream );
    }
    fputs( table->row_count > 1 ? "</tbody>\n</table>\n" : "</thead>\n</table>\n", stream );
}

void report_put_table( const results_table* table, int number, FILE* stream )
{
    fprintf( stream, "<section class=\"table\">\n<h3 id=\"table-%d\">", number );
    report_put_text( table->title, stream );
    // A region that scrolls has a name and can be reached by the keyboard.
    fprintf( stream, "</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"table-%d\">\n",
             number );
    put_rows( table, stream );
    fputs( "</div>\n</section>\n", stream );
}

// ---- charts ----

// The points of a chart for a reader without script.
static void put_points( const results_chart* chart, FILE* stream )
{
    // Bars are numbered by x, which has no meaning for a reader.
    const int columns = chart->is_bars ? 3 : 4;
    results made = { .failed = false };
    const int table = results_add_table(
        &made, "", columns, ( const char* const[] ){ "series", "point", chart->y_label, chart->x_label } );
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            const results_point* point = &chart->series[s].points[i];
            char x[40], y[40];
            report_write_number( point->x, x, sizeof x );
            report_write_number( point->y, y, sizeof y );
            results_add_cells( &made, table, ( const char* const[] ){ chart->series[s].name, point->label, y, x } );
        }
    }
    if ( !made.incomplete )
    {
        fputs( "<noscript>\n<div class=\"scroll\">\n", stream );
        put_rows( made.tables + table, stream );
        fputs( "</div>\n</noscript>\n", stream );
    }
    results_free( &made );
}

void report_put_chart( const results_chart* chart, int number, FILE* stream )
{
    fprintf( stream, "<figure class=\"card\" id=\"chart-%d\">\n<figcaption><h3>", number );
    report_put_text( chart->title, stream );
    fputs( "</h3></figcaption>\n", stream );
    put_points( chart, stream );
    if ( chart->caption[0] )
    {
        fputs( "<p class=\"caption\">", stream );
        report_put_text( chart->caption, stream );
        fputs( "</p>\n", stream );
    }
    fputs( "</figure>\n", stream );
}

// ---- data of the script ----

static json_t* points_array( const results_series* series )
{
    json_t* points = json_array();
    for ( int i = 0; i < series->count; ++i )
    {
        const results_point* point = &series->points[i];
        json_t* object = json_object();
        json_object_set_new( object, "x", results_json_count( point->x ) );
        json_object_set_new( object, "y", results_json_count( point->y ) );
        if ( point->label[0] )
        {
            json_object_set_new( object, "label", results_json_text( point->label ) );
        }
        if ( point->is_marked )
        {
            json_object_set_new( object, "marked", json_true() );
        }
        json_array_append_new( points, object );
    }
    return points;
}

static json_t* series_array( const results_chart* chart )
{
    json_t* all = json_array();
    for ( int s = 0; s < chart->series_count; ++s )
    {
        const results_series* series = &chart->series[s];
        json_t* object = json_object();
        json_object_set_new( object, "name", results_json_text( series->name ) );
        json_object_set_new( object, "joined", json_boolean( series->is_joined ) );
        json_object_set_new( object, "points", points_array( series ) );
        json_array_append_new( all, object );
    }
    return all;
}

static json_t* chart_object( const results_chart* chart )
{
    json_t* object = json_object();
    json_object_set_new( object, "title", results_json_text( chart->title ) );
    json_object_set_new( object, "x", results_json_text( chart->x_label ) );
    json_object_set_new( object, "y", results_json_text( chart->y_label ) );
    json_object_set_new( object, "xLog", json_boolean( chart->x_log ) );
    json_object_set_new( object, "yLog", json_boolean( chart->y_log ) );
    json_object_set_new( object, "bars", json_boolean( chart->is_bars ) );
    json_object_set_new( object, "series", series_array( chart ) );
    return object;
}

bool report_put_chart_data( const results* all, FILE* stream )
{
    json_t* charts = json_array();
    for ( int i = 0; i < all->chart_count; ++i )
    {
        json_array_append_new( charts, chart_object( &all->charts[i] ) );
    }
    char* text = json_dumps( charts, JSON_COMPACT | JSON_REAL_PRECISION( 9 ) );
    json_decref( charts );
    if ( !text )
    {
        return false;
    }
    fputs( "<script type=\"application/json\" id=\"chart-data\">", stream );
    results_json_put_script( text, stream );
    fputs( "</script>\n", stream );
    free( text );
    return true;
}
