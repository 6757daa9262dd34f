#include "results.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

// Return the items with room for one more; the array may move. Without memory the capacity stays at their count.
static void* with_room( results* all, void* items, int count, int* capacity, size_t item_size )
{
    if ( count < *capacity )
    {
        return items;
    }
    const int requested = *capacity > 0 ? 2 * *capacity : 8;
    void* grown = realloc( items, (size_t)requested * item_size );
    all->incomplete = all->incomplete || grown == NULL;
    *capacity = grown != NULL ? requested : *capacity;
    return grown != NULL ? grown : items;
}

static char* copy_text( results* all, const char* text )
{
    size_t size = strlen( text ) + 1;
    char* copy = malloc( size );
    if ( !copy )
    {
        all->incomplete = true;
        return NULL;
    }
    return memcpy( copy, text, size );
}

results_row* results_add_row( results* all, const char* name, const char* variant )
{
    all->rows = with_room( all, all->rows, all->row_count, &all->row_capacity, sizeof( results_row ) );
    if ( all->row_count == all->row_capacity )
    {
        return NULL;
    }
    results_row* row = &all->rows[all->row_count++];
    *row = ( results_row ){ .ms_median = NAN, .ms_p10 = NAN, .ms_p90 = NAN, .cpu_fraction = NAN };
    snprintf( row->name, sizeof( row->name ), "%s", name );
    snprintf( row->variant, sizeof( row->variant ), "%s", variant );
    return row;
}

void results_put_options( results* all, int argc, char* const* argv )
{
    size_t used = 0;
    for ( int i = 0; i < argc && used < sizeof all->options; ++i )
    {
        used +=
            (size_t)snprintf( all->options + used, sizeof all->options - used, "%s%s", i > 0 ? " " : "", argv[i] );
    }
}

void results_put_times( results_row* row, const stats_summary* ms )
{
    row->ms_median = ms->median;
    row->ms_p10 = ms->p10;
    row->ms_p90 = ms->p90;
    row->steps = ms->count;
    row->cpu_fraction = ms->cpu_fraction;
    row->sample_count = ms->kept_count;
    memcpy( row->samples_ms, ms->kept, sizeof row->samples_ms );
}

void results_put( results_values* values, const char* name, double value )
{
    WISP_ASSERT( values->count < RESULTS_MAX_VALUES );
    if ( values->count < RESULTS_MAX_VALUES )
    {
        results_value* item = &values->items[values->count++];
        snprintf( item->name, sizeof( item->name ), "%s", name );
        item->value = value;
    }
}

int results_add_table( results* all, const char* title, int column_count, const char* const* header )
{
    all->tables = with_room( all, all->tables, all->table_count, &all->table_capacity, sizeof( results_table ) );
    if ( all->table_count == all->table_capacity )
    {
        return -1;
    }
    results_table* table = &all->tables[all->table_count];
    *table = ( results_table ){ .column_count = column_count };
    snprintf( table->title, sizeof( table->title ), "%s", title );
    results_add_cells( all, all->table_count++, header );
    return all->table_count - 1;
}

void results_add_cells( results* all, int number, const char* const* cells )
{
    if ( number < 0 )
    {
        return;
    }
    results_table* table = &all->tables[number];
    size_t columns = (size_t)table->column_count;
    table->cells = with_room( all, table->cells, table->row_count, &table->row_capacity, columns * sizeof( char* ) );
    if ( table->row_count == table->row_capacity )
    {
        return;
    }
    char** row = table->cells + (size_t)table->row_count++ * columns;
    for ( size_t i = 0; i < columns; ++i )
    {
        row[i] = copy_text( all, cells[i] );
    }
}

// Divide a text at its tabs; a number that is not finite becomes "-". @param parts [most] @return how many there are
static int divide( char* text, const char** parts, int most )
{
    int count = 0;
    for ( char* next = text; next != NULL && count < most; )
    {
        const char* cell = next;
        next = count + 1 < most ? strchr( next, '\t' ) : NULL;
        if ( next != NULL )
        {
            *next++ = '\0';
        }
        const char* digits = cell + ( *cell == '-' );
        parts[count++] = strcmp( digits, "nan" ) == 0 || strcmp( digits, "inf" ) == 0 ? "-" : cell;
    }
    return count;
}

int results_begin_table( results* all, const char* title, const char* header )
{
    char text[1024];
    const char* parts[CELLS_MAX];
    snprintf( text, sizeof text, "%s", header );
    const int count = divide( text, parts, CELLS_MAX );
    return results_add_table( all, title, count, parts );
}

void results_add_line( results* all, int table, const char* format, ... )
{
    char text[4096];
    const char* parts[CELLS_MAX];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( text, sizeof text, format, arguments );
    va_end( arguments );
    if ( table >= 0 )
    {
        const int count = divide( text, parts, all->tables[table].column_count );
        WISP_ASSERT( count == all->tables[table].column_count );
        results_add_cells( all, count == all->tables[table].column_count ? table : -1, parts );
    }
}

void cells_put( results_cells* row, const char* format, ... )
{
    char text[sizeof row->text];
    const char* parts[CELLS_MAX];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( text, sizeof text, format, arguments );
    va_end( arguments );
    WISP_ASSERT( row->count < CELLS_MAX );
    const int count = divide( text, parts, CELLS_MAX - row->count );
    for ( int i = 0; i < count; ++i )
    {
        snprintf( row->text[row->count++], sizeof row->text[0], "%s", parts[i] );
    }
}

static const char* const* point_at( const results_cells* row, const char** pointers )
{
    for ( int i = 0; i < row->count; ++i )
    {
        pointers[i] = row->text[i];
    }
    return pointers;
}

int cells_begin_table( const results_cells* header, const char* title, results* out )
{
    const char* pointers[CELLS_MAX];
    return results_add_table( out, title, header->count, point_at( header, pointers ) );
}

void cells_end_row( const results_cells* row, int table, results* out )
{
    const char* pointers[CELLS_MAX];
    results_add_cells( out, table, point_at( row, pointers ) );
}

const char* results_cell( const results_table* table, int row, int column )
{
    const char* text = table->cells[row * table->column_count + column];
    return text ? text : "";
}

// "-" stands for a missing number.
bool results_is_numeric_column( const results_table* table, int column )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        if ( !strchr( "0123456789+-.", results_cell( table, row, column )[0] ) )
        {
            return false;
        }
    }
    return table->row_count > 1;
}

int results_add_chart( results* all, const char* title, const char* x_label, const char* y_label )
{
    all->charts = with_room( all, all->charts, all->chart_count, &all->chart_capacity, sizeof( results_chart ) );
    if ( all->chart_count == all->chart_capacity )
    {
        return -1;
    }
    results_chart* chart = &all->charts[all->chart_count++];
    *chart = ( results_chart ){ 0 };
    snprintf( chart->title, sizeof( chart->title ), "%s", title );
    snprintf( chart->x_label, sizeof( chart->x_label ), "%s", x_label );
    snprintf( chart->y_label, sizeof( chart->y_label ), "%s", y_label );
    return all->chart_count - 1;
}

results_chart* results_chart_at( results* all, int chart )
{
    return chart < 0 ? NULL : &all->charts[chart];
}

int results_add_series( results* all, int number, const char* name, bool is_joined )
{
    results_chart* chart = results_chart_at( all, number );
    if ( !chart )
    {
        return -1;
    }
    chart->series =
        with_room( all, chart->series, chart->series_count, &chart->series_capacity, sizeof( results_series ) );
    if ( chart->series_count == chart->series_capacity )
    {
        return -1;
    }
    results_series* series = &chart->series[chart->series_count++];
    *series = ( results_series ){ .is_joined = is_joined };
    snprintf( series->name, sizeof( series->name ), "%s", name );
    return chart->series_count - 1;
}

void results_add_point( results* all, int chart, int number, results_point point )
{
    if ( chart < 0 || number < 0 )
    {
        return;
    }
    results_series* series = &all->charts[chart].series[number];
    series->points = with_room( all, series->points, series->count, &series->capacity, sizeof( results_point ) );
    if ( series->count < series->capacity )
    {
        series->points[series->count++] = point;
    }
}

void results_append_count( char* line, size_t size, int count, const char* what )
{
    const size_t used = strlen( line );
    if ( count > 0 )
    {
        snprintf( line + used, size - used, ", %d %s", count, what );
    }
}

void results_add_headline( results* all, const char* format, ... )
{
    WISP_ASSERT( all->headline_count < RESULTS_MAX_HEADLINES );
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( all->headlines[all->headline_count++], sizeof( all->headlines[0] ), format, arguments );
    va_end( arguments );
}

static void add_note( results* all, const char* before, const char* format, va_list arguments )
{
    char text[1000];
    int start = snprintf( text, sizeof( text ), "%s", before );
    vsnprintf( text + start, sizeof( text ) - (size_t)start, format, arguments );

    all->notes = with_room( all, all->notes, all->note_count, &all->note_capacity, sizeof( char* ) );
    char* copy = all->note_count < all->note_capacity ? copy_text( all, text ) : NULL;
    if ( copy )
    {
        all->notes[all->note_count++] = copy;
    }
}

void results_add_note( results* all, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    add_note( all, "", format, arguments );
    va_end( arguments );
}

void results_add_failure( results* all, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    add_note( all, "FAILED: ", format, arguments );
    va_end( arguments );
    all->failed = true;
}

void results_add_claim( results* all, bool meets_target, const char* claim, double measured, const char* unit )
{
    all->claim_count += 1;
    all->claims_met += meets_target ? 1 : 0;
    results_add_note( all, "Claim: %s. Measured %.3g%s: %s.", claim, measured, unit,
                      meets_target ? "met" : "claim not met on this machine" );
}

void results_free( results* all )
{
    for ( int t = 0; t < all->table_count; ++t )
    {
        results_table* table = &all->tables[t];
        for ( int i = 0; i < table->row_count * table->column_count; ++i )
        {
            free( table->cells[i] );
        }
        free( table->cells );
    }
    for ( int c = 0; c < all->chart_count; ++c )
    {
        for ( int i = 0; i < all->charts[c].series_count; ++i )
        {
            free( all->charts[c].series[i].points );
        }
        free( all->charts[c].series );
    }
    for ( int i = 0; i < all->note_count; ++i )
    {
        free( all->notes[i] );
    }
    free( all->charts );
    free( all->rows );
    free( all->tables );
    free( all->notes );
    *all = ( results ){ 0 };
}
