// The cases of `wisp validate`, and the overview of how near solvers come to their answers.
#include "validate/validate.h"

#include "io_file.h"
#include "program_data.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define X( name ) &validate_##name,
static const validate_case* const all_cases[] = { VALIDATE_CASES( X ) };
#undef X

const validate_case* const* validate_cases( int* count )
{
    *count = WISP_COUNT( all_cases );
    return all_cases;
}

// ---- the overview ----

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

// ---- running cases ----

static const double CASE_SECONDS = 20.0, CASE_SECONDS_QUICK = 3.0;

wisp_status validate_read( text_node** out, wisp_error* error )
{
    char path[1024];
    unsigned char* bytes = NULL;
    size_t size = 0;
    *out = NULL;
    program_data_path( "suites/validate/cases.yaml", path, sizeof path );
    wisp_status status = io_file_read( path, 1 << 20, &bytes, &size, error );
    status = status == WISP_OK ? text_parse( (const char*)bytes, size, path, out, error ) : status;
    free( bytes );
    return status;
}

static void describe( const validate_case* c, const text_node* said, results* out )
{
    static const char* const keys[] = { "tests", "leaves out", "theory", "source" };
    const char* const header[] = { "case", c->title };
    char title[160];
    snprintf( title, sizeof title, "Case `%s`", c->name );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    for ( int i = 0; i < WISP_COUNT( keys ); ++i )
    {
        const char* const cells[] = { keys[i], text_at( said, keys[i] ) };
        results_add_cells( out, table, cells );
    }
}

static void hold_to_limits( const char* name, const text_node* limits, int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = out->rows + i;
        const double error = row->error.count > 0 ? row->error.items[0].value : (double)NAN;
        double most;
        // written so that a NaN fails
        if ( text_is_number( text_find( limits, row->variant ), &most ) && !( error <= most ) )
        {
            results_add_failure( out, "validate, %s, %s: an error of %.4g, expected at most %g", name, row->variant,
                                 error, most );
        }
    }
}

wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error )
{
    int count;
    const validate_case* const* cases = validate_cases( &count );
    text_node* said;
    wisp_status status = validate_read( &said, error );
    const int overview = validate_begin_overview( out );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        if ( chosen != 0 && ( chosen >> i & 1 ) == 0 )
        {
            continue;
        }
        const accuracy_entry entry = { cases[i]->name, cases[i]->title, validate_make, NULL, cases[i] };
        const double seconds = options->seconds > 0.0 ? options->seconds
                               : options->quick       ? CASE_SECONDS_QUICK
                                                      : CASE_SECONDS;
        const int first_row = out->row_count;
        const text_node* about = text_find( said, cases[i]->name );
        describe( cases[i], about, out );
        status = accuracy_bench_run( &entry, 1, seconds, options, out, error );
        validate_add_to_overview( overview, cases[i]->name, first_row, out );
        hold_to_limits( cases[i]->name, text_find( about, "limits" ), first_row, out );
    }
    validate_end_overview( overview, out, summary, size );
    text_release( said );
    return status;
}
