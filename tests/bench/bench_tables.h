/// Access to the results of a case: tables by the beginning of their titles, cells by the names of their columns.
#pragma once

#include "unit.h"

#include "results_write.h"

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

static inline const char* cell( const results_table* table, int row, int column )
{
    return table->cells[row * table->column_count + column];
}

static inline int column_of( const results_table* table, const char* heading )
{
    for ( int c = 0; c < table->column_count; ++c )
    {
        if ( strcmp( cell( table, 0, c ), heading ) == 0 )
        {
            return c;
        }
    }
    fail_msg( "'%s' has no column '%s'", table->title, heading );
    return 0;
}

/// @param row 0: the header
static inline const char* named_cell( const results_table* table, int row, const char* heading )
{
    return cell( table, row, column_of( table, heading ) );
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

/// Number of rows for machines with this name and variant.
static inline int count_rows( const results* all, const char* name, const char* variant )
{
    int count = 0;
    for ( int i = 0; i < all->row_count; ++i )
    {
        count += strcmp( all->rows[i].name, name ) == 0 && strcmp( all->rows[i].variant, variant ) == 0 ? 1 : 0;
    }
    return count;
}

static inline double value_of( const results_values* values, const char* name )
{
    for ( int i = 0; i < values->count; ++i )
    {
        if ( strcmp( values->items[i].name, name ) == 0 )
        {
            return values->items[i].value;
        }
    }
    fail_msg( "there is no value '%s'", name );
    return NAN;
}

static inline bool has_note( const results* all, const char* part )
{
    bool found = false;
    for ( int i = 0; i < all->note_count; ++i )
    {
        found = found || strstr( all->notes[i], part ) != NULL;
    }
    return found;
}

/// Fail with the first check that failed in a run.
static inline void expect_good( const results* all )
{
    for ( int i = 0; i < all->note_count; ++i )
    {
        if ( strncmp( all->notes[i], "FAILED", 6 ) == 0 )
        {
            fail_msg( "%s", all->notes[i] );
        }
    }
    assert_false( all->failed );
}

/// Teardown of a group whose state are results.
static inline int free_results( void** state )
{
    results_free( *state );
    return 0;
}

/// Write all tables as text, which must fit a terminal.
static inline void assert_fits_terminal( const results* all )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_non_null( stream );
    for ( int t = 0; t < all->table_count; ++t )
    {
        results_write_text_table( &all->tables[t], stream );
    }
    fclose( stream );
    for ( const char* line = text; *line; line += strcspn( line, "\n" ) + 1 )
    {
        if ( strcspn( line, "\n" ) > RESULTS_TEXT_WIDTH )
        {
            fail_msg( "a line of %zu characters: %.60s", strcspn( line, "\n" ), line );
        }
    }
    free( text );
}
