/// Reading what a case has measured: its tables by the beginning of their titles, cells by the names of their columns.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "results.h"

#include <string.h>

static inline const results_table* find_table( const results* all, const char* beginning )
{
    for ( int t = 0; t < all->table_count; ++t )
    {
        if ( strncmp( all->tables[t].title, beginning, strlen( beginning ) ) == 0 )
        {
            return &all->tables[t];
        }
    }
    fail_msg( "there is no table '%s'", beginning );
    return NULL;
}

/// @param row 0: the header
static inline const char* named_cell( const results_table* table, int row, const char* column )
{
    for ( int c = 0; c < table->column_count; ++c )
    {
        if ( strcmp( table->cells[c], column ) == 0 )
        {
            return table->cells[row * table->column_count + c];
        }
    }
    fail_msg( "'%s' has no column '%s'", table->title, column );
    return NULL;
}

/// The first row whose first cell is this.
static inline int row_of( const results_table* table, const char* first )
{
    for ( int r = 1; r < table->row_count; ++r )
    {
        if ( strcmp( table->cells[r * table->column_count], first ) == 0 )
        {
            return r;
        }
    }
    fail_msg( "'%s' has no row '%s'", table->title, first );
    return 0;
}

static inline void assert_column( const results_table* table, const char* column, const char* text )
{
    assert_true( table->row_count > 1 );
    for ( int r = 1; r < table->row_count; ++r )
    {
        assert_string_equal( named_cell( table, r, column ), text );
    }
}
