#include "validate_overview.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_SOLVERS = 32, // of a case
};

// In the unit of a case, mostly %.
static const double NEAR = 5.0;

// A solver is the part of a setting before its first comma. Its settings differ in mesh, substeps, or how they are measured.
typedef struct line
{
    char solver[64];
    const results_row* best; // of the settings with an error; null: none
    double least, largest;
    int count, without; // settings; those without an error
} line;

static void find_solver( const results_row* row, char* text, size_t size )
{
    snprintf( text, size, "%.*s", (int)strcspn( row->variant, "," ), row->variant );
}

// The error is the first value of a row that has all of them; one that is not finite is not there.
static const char* find_error_name( const results* all, int first_row )
{
    const results_row* fullest = NULL;
    for ( int i = first_row; i < all->row_count; ++i )
    {
        const results_row* row = all->rows + i;
        fullest = fullest == NULL || row->error.count > fullest->error.count ? row : fullest;
    }
    return fullest != NULL && fullest->error.count > 0 ? fullest->error.items[0].name : "";
}

static bool is_same_setting( const results* all, int a, int b )
{
    return strcmp( all->rows[a].variant, all->rows[b].variant ) == 0;
}

static void add_setting( line* l, const results_row* row, const char* error_name )
{
    const bool is_measured = row->error.count > 0 && strcmp( row->error.items[0].name, error_name ) == 0;
    const double error = is_measured ? row->error.items[0].value : NAN;
    l->count += 1;
    l->without += is_measured ? 0 : 1;
    if ( is_measured && ( l->best == NULL || error < l->least ) )
    {
        l->best = row;
        l->least = error;
    }
    l->largest = is_measured && !( l->largest > error ) ? error : l->largest;
}

static line* find_line( line lines[MAX_SOLVERS], int* count, const results_row* row )
{
    char solver[64];
    find_solver( row, solver, sizeof solver );
    int i = 0;
    while ( i < *count && strcmp( lines[i].solver, solver ) != 0 )
    {
        ++i;
    }
    if ( i == *count && i < MAX_SOLVERS )
    {
        lines[i] = ( line ){ .largest = NAN };
        memcpy( lines[i].solver, solver, sizeof solver );
        *count += 1;
    }
    return i < MAX_SOLVERS ? lines + i : NULL;
}

// Below the doubt of its reference an error says nothing more.
static bool is_below( const results_row* row )
{
    const size_t length = strlen( row->error.items[0].name );
    return row->error.count > 1 && strncmp( row->error.items[1].name, row->error.items[0].name, length ) == 0 &&
           strstr( row->error.items[1].name, "below" ) != NULL;
}

static void put_line( int table, const char* name, const line* l, results* out )
{
    char least[40] = "-", largest[60] = "-", ms[40] = "-";
    if ( l->best != NULL )
    {
        snprintf( least, sizeof least, is_below( l->best ) ? "%.3g, below the doubt" : "%.3g", l->least );
        snprintf( largest, sizeof largest, "%.3g", l->largest );
        snprintf( ms, sizeof ms, "%.3g", l->best->ms_median );
    }
    if ( l->without > 0 )
    {
        const size_t length = strlen( largest );
        snprintf( largest + length, sizeof largest - length, "; %d of %d without", l->without, l->count );
    }
    const char* const cells[] = { name, l->solver, least, largest, ms, l->best != NULL ? l->best->variant : "-" };
    results_add_cells( out, table, cells );
}

int validate_begin_overview( results* out )
{
    const char* const header[] = { "case", "solver", "least error", "largest", "ms a step", "setting of the least" };
    return results_add_table( out,
                              "Overview: how near each solver comes to theory, in the unit of the case, mostly %",
                              WISP_COUNT( header ), header );
}

void validate_add_to_overview( int table, const char* name, int first_row, results* out )
{
    line lines[MAX_SOLVERS];
    int count = 0;
    const char* error_name = find_error_name( out, first_row );
    for ( int i = first_row; i < out->row_count; ++i )
    {
        // rows of one setting with several workers follow each other, and have one error
        line* l =
            i > first_row && is_same_setting( out, i, i - 1 ) ? NULL : find_line( lines, &count, out->rows + i );
        if ( l != NULL )
        {
            add_setting( l, out->rows + i, error_name );
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        put_line( table, name, lines + i, out );
    }
}

// Columns of the overview.
enum
{
    CASE = 0,
    SOLVER = 1,
    LEAST = 2,
};

void validate_end_overview( int table, results* out, char* summary, size_t size )
{
    char far[480] = "";
    int near_count = 0, count = 0, unnamed = 0;
    for ( int row = 1; table >= 0 && row < out->tables[table].row_count; ++row )
    {
        const results_table* t = out->tables + table;
        const char* least = results_cell( t, row, LEAST );
        const bool is_near = least[0] != '-' && atof( least ) <= NEAR;
        const size_t length = strlen( far );
        count += 1;
        near_count += is_near ? 1 : 0;
        if ( is_near == false && sizeof far - length < 120 )
        {
            unnamed += 1;
        }
        else if ( is_near == false )
        {
            snprintf( far + length, sizeof far - length, "%s`%s` by %s (%s)", length > 0 ? ", " : "; not ",
                      results_cell( t, row, CASE ), results_cell( t, row, SOLVER ), least );
        }
    }
    results_append_count( far, sizeof far, unnamed, "more" );
    snprintf( summary, size, "%d of %d lines of the overview have a setting within %g %% or points of the answer%s.",
              near_count, count, NEAR, far );
    results_add_headline( out, "%s", summary );
}
