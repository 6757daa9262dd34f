#include "cells.h"

#include <math.h>
#include <stdarg.h>

void cells_put( cells* row, const char* format, ... )
{
    WISP_ASSERT( row->count < CELLS_MAX );
    char* text = row->text[row->count];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( text, sizeof( row->text[0] ), format, arguments );
    va_end( arguments );
    ++row->count;
}

void cells_put_number( cells* row, double value, int digits )
{
    if ( isfinite( value ) )
    {
        cells_put( row, "%.*f", digits, value );
    }
    else
    {
        cells_put( row, "-" );
    }
}

void cells_put_pair( cells* row, double first, int first_digits, double second, int second_digits )
{
    if ( isfinite( first ) && isfinite( second ) )
    {
        cells_put( row, "%.*f / %.*f", first_digits, first, second_digits, second );
    }
    else
    {
        cells_put( row, "-" );
    }
}

void cells_put_hash( cells* row, uint64_t hash )
{
    cells_put( row, "%016llx", (unsigned long long)hash );
}

static void point_at( const cells* row, const char* pointers[CELLS_MAX] )
{
    for ( int i = 0; i < row->count; ++i )
    {
        pointers[i] = row->text[i];
    }
}

int cells_begin_table( const cells* header, const char* title, results* out )
{
    const char* pointers[CELLS_MAX];
    point_at( header, pointers );
    return results_add_table( out, title, header->count, pointers );
}

void cells_end_row( const cells* row, int table, results* out )
{
    const char* pointers[CELLS_MAX];
    point_at( row, pointers );
    results_add_cells( out, table, pointers );
}
