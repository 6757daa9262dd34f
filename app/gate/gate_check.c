#include "gate_check.h"

#include "io_file.h"
#include "machine.h"
#include "report.h"
#include "report_data.h"
#include "results_write.h"
#include "text_tree.h"

#include "wisp/module/definition.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// ---- base files ----

enum
{
    MAX_BYTES = 16 << 20,
    MAX_REASONS = 1000,
};

void gate_compiler( char* out, size_t size )
{
    const machine_info machine = machine_describe( "" );
    snprintf( out, size, "%s, %s, %s", machine.compiler, machine.build_type, machine.flags );
}

void gate_today( char out[16] )
{
    const time_t now = time( NULL );
    struct tm parts;
    localtime_r( &now, &parts );
    strftime( out, 16, "%Y-%m-%d", &parts );
}

// @return null if the base has no such row
static const gate_base_row* find_base_row( const gate_base* base, const suite_row* row )
{
    for ( int i = 0; i < base->row_count; ++i )
    {
        if ( strcmp( base->rows[i].name, row->name ) == 0 && strcmp( base->rows[i].variant, row->variant ) == 0 )
        {
            return base->rows + i;
        }
    }
    return NULL;
}

void gate_base_release( gate_base* base )
{
    free( base->rows );
    free( base->accepted );
    *base = ( gate_base ){ 0 };
}

// ---- reading ----

static bool take_text( const json_t* object, const char* key, char* out, size_t size )
{
    const char* text = json_string_value( json_object_get( object, key ) );
    if ( text == NULL || strlen( text ) >= size )
    {
        return false;
    }
    strcpy( out, text );
    return true;
}

// A value that is null was not measured; one that is not there is an error, since files may be cut.
static bool take_values( const json_t* row, suite_measurement* out )
{
    const json_t* values = json_object_get( row, "values" );
    bool is_whole = json_object_size( values ) == SUITE_MEASURE_COUNT;
    for ( int m = 0; m < SUITE_MEASURE_COUNT && is_whole; ++m )
    {
        const json_t* value = json_object_get( values, suite_measures[m].name );
        is_whole = json_is_null( value ) || json_is_number( value );
        out->values[m] = json_is_number( value ) ? json_number_value( value ) : NAN;
        is_whole = is_whole && !( out->values[m] < 0.0 );
    }
    return is_whole;
}

static bool take_passes( const json_t* row, suite_measurement* out )
{
    json_t* passes = json_object_get( row, "passes" );
    const char* name;
    json_t* value;
    bool is_whole = json_is_object( passes ) && json_object_size( passes ) <= SUITE_MAX_PASSES;
    if ( is_whole )
    {
        json_object_foreach( passes, name, value )
        {
            suite_pass* pass = &out->passes[out->pass_count++];
            is_whole = is_whole && strlen( name ) < sizeof pass->name && json_is_number( value ) &&
                       json_number_value( value ) >= 0.0;
            snprintf( pass->name, sizeof pass->name, "%s", name );
            pass->instructions = json_number_value( value );
        }
    }
    return is_whole;
}

static bool take_row( const json_t* row, gate_base_row* out )
{
    const json_t* steps = json_object_get( row, "steps" );
    out->measured.steps = (int)json_integer_value( steps );
    return take_text( row, "name", out->name, sizeof out->name ) &&
           take_text( row, "variant", out->variant, sizeof out->variant ) && json_is_integer( steps ) &&
           results_json_take_hash( json_object_get( row, "hash" ), &out->measured.hash ) &&
           take_values( row, &out->measured ) && take_passes( row, &out->measured );
}

static bool take_reason( const json_t* reason, gate_reason* out )
{
    return take_text( reason, "date", out->date, sizeof out->date ) &&
           take_text( reason, "reason", out->text, sizeof out->text );
}

static wisp_status take_base( const json_t* root, const char* path, gate_base* out, wisp_error* error )
{
    const json_t *version = json_object_get( root, "wisp_gate" ), *rows = json_object_get( root, "rows" ),
                 *accepted = json_object_get( root, "accepted" );
    if ( !json_is_integer( version ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a base file of wisp gate, which has the key wisp_gate",
                          io_short_name( path ) );
    }
    if ( json_integer_value( version ) != GATE_VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got a base file of version %lld, expected %d; record it again",
                          io_short_name( path ), (long long)json_integer_value( version ), (int)GATE_VERSION );
    }
    const size_t count = json_array_size( rows ), reasons = json_array_size( accepted );
    if ( !take_text( root, "suite", out->suite, sizeof out->suite ) ||
         !take_text( root, "date", out->date, sizeof out->date ) ||
         !take_text( root, "version", out->version, sizeof out->version ) ||
         !take_text( root, "compiler", out->compiler, sizeof out->compiler ) || count == 0 ||
         count > SUITE_MAX_ROWS || !json_is_array( accepted ) || reasons > MAX_REASONS )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: expected suite, date, version, compiler, rows and accepted; the file was edited",
                          io_short_name( path ) );
    }
    out->rows = calloc( count, sizeof *out->rows );
    out->accepted = calloc( reasons + 1, sizeof *out->accepted );
    if ( out->rows == NULL || out->accepted == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %zu rows", io_short_name( path ), count );
    }
    for ( size_t i = 0; i < count; ++i )
    {
        if ( !take_row( json_array_get( rows, i ), out->rows + i ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: row %zu is not as it was recorded; record the file again",
                              io_short_name( path ), i + 1 );
        }
        out->row_count += 1;
    }
    for ( size_t i = 0; i < reasons; ++i )
    {
        if ( !take_reason( json_array_get( accepted, i ), out->accepted + i ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: reason %zu has no date or no text", io_short_name( path ),
                              i + 1 );
        }
        out->accepted_count += 1;
    }
    return WISP_OK;
}

wisp_status gate_base_parse( const char* text, size_t size, const char* path, gate_base* out, wisp_error* error )
{
    *out = ( gate_base ){ 0 };
    json_error_t place = { 0 };
    json_t* root = json_loadb( text, size, JSON_REJECT_DUPLICATES, &place );
    const wisp_status status = root ? take_base( root, path, out, error )
                                    : wisp_fail( error, WISP_BAD_INPUT, "%s:%d:%d: no JSON: %.160s",
                                                 io_short_name( path ), place.line, place.column, place.text );
    json_decref( root );
    return status;
}

wisp_status gate_base_read( const char* path, gate_base* out, wisp_error* error )
{
    *out = ( gate_base ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    if ( status == WISP_IO_ERROR && access( path, F_OK ) != 0 )
    {
        return wisp_fail( error, status, "%s: no such base file; `wisp gate record` of the suite makes it", path );
    }
    status = status == WISP_OK ? gate_base_parse( (const char*)bytes, size, path, out, error ) : status;
    free( bytes );
    return status;
}

// ---- writing ----

static json_t* row_of( const gate_base_row* row )
{
    json_t *out = json_object(), *values = json_object();
    json_object_set_new( out, "name", json_string( row->name ) );
    json_object_set_new( out, "variant", json_string( row->variant ) );
    json_object_set_new( out, "steps", json_integer( row->measured.steps ) );
    json_object_set_new( out, "hash", results_json_hash( row->measured.hash ) );
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        json_object_set_new( values, suite_measures[m].name, results_json_count( row->measured.values[m] ) );
    }
    json_object_set_new( out, "values", values );
    json_t* passes = json_object();
    for ( int i = 0; i < row->measured.pass_count; ++i )
    {
        if ( isfinite( row->measured.passes[i].instructions ) )
        {
            json_object_set_new( passes, row->measured.passes[i].name,
                                 results_json_count( row->measured.passes[i].instructions ) );
        }
    }
    json_object_set_new( out, "passes", passes );
    return out;
}

static json_t* root_of( const gate_base* base )
{
    json_t *root = json_object(), *rows = json_array(), *accepted = json_array();
    json_object_set_new( root, "wisp_gate", json_integer( GATE_VERSION ) );
    json_object_set_new( root, "suite", json_string( base->suite ) );
    json_object_set_new( root, "date", json_string( base->date ) );
    json_object_set_new( root, "version", json_string( base->version ) );
    json_object_set_new( root, "compiler", json_string( base->compiler ) );
    for ( int i = 0; i < base->row_count; ++i )
    {
        json_array_append_new( rows, row_of( base->rows + i ) );
    }
    json_object_set_new( root, "rows", rows );
    for ( int i = 0; i < base->accepted_count; ++i )
    {
        json_t* reason = json_object();
        json_object_set_new( reason, "date", json_string( base->accepted[i].date ) );
        json_object_set_new( reason, "reason", json_string( base->accepted[i].text ) );
        json_array_append_new( accepted, reason );
    }
    json_object_set_new( root, "accepted", accepted );
    return root;
}

// @return the file, for free()
static char* text_of( const gate_base* base )
{
    json_t* root = root_of( base );
    char* json = json_dumps( root, JSON_INDENT( 1 ) | JSON_REAL_PRECISION( 9 ) );
    char* text = text_alloc( strlen( json ) + 1 );
    sprintf( text, "%s\n", json );
    free( json );
    json_decref( root );
    return text;
}

wisp_status gate_base_write( const gate_base* base, const char* path, wisp_error* error )
{
    char* text = text_of( base );
    const wisp_status status = io_file_write( path, text, strlen( text ), error );
    free( text );
    return status;
}

// ---- patches ----

// @param text moves past the line @return its length with its line break; 0: the text ends
static int take_line( const char** text, const char* end, const char** line )
{
    const char* found = *text < end ? memchr( *text, '\n', (size_t)( end - *text ) ) : NULL;
    *line = *text;
    *text = found ? found + 1 : end;
    return (int)( *text - *line );
}

static int count_lines( const char* text, const char* end )
{
    const char* line;
    int count = 0;
    while ( take_line( &text, end, &line ) > 0 )
    {
        ++count;
    }
    return count;
}

// One hunk of the whole file: line against line, since both texts have the same keys in the same order.
static void write_hunk( const char* was, const char* was_end, const char* now, const char* now_end, FILE* out )
{
    const char *a, *b;
    fprintf( out, "@@ -1,%d +1,%d @@\n", count_lines( was, was_end ), count_lines( now, now_end ) );
    for ( int n = 1, m = 1; n > 0 || m > 0; )
    {
        n = take_line( &was, was_end, &a );
        m = take_line( &now, now_end, &b );
        const bool is_same = n == m && memcmp( a, b, (size_t)n ) == 0;
        fprintf( out, "%s%.*s", n == 0 ? "" : is_same ? " " : "-", n, a );
        fputs( n > 0 && a[n - 1] != '\n' ? "\n\\ No newline at end of file\n" : "", out );
        fprintf( out, "%s%.*s", m == 0 || is_same ? "" : "+", is_same ? 0 : m, b );
    }
}

wisp_status gate_write_patch( const gate_base* base, const char* path, const char* patch, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    io_output output;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    status = status == WISP_OK ? io_output_open( patch, &output, error ) : status;
    if ( status == WISP_OK )
    {
        char* text = text_of( base );
        const char* was = (const char*)bytes;
        path += strncmp( path, "./", 2 ) == 0 ? 2 : 0;
        fprintf( output.stream, "--- a/%s\n+++ b/%s\n", path, path );
        write_hunk( was, was + size, text, text + strlen( text ), output.stream );
        free( text );
        status = io_output_end( &output, WISP_OK, error );
    }
    free( bytes );
    return status;
}

// ---- the comparison ----

const char* const gate_state_names[GATE_STATE_COUNT] = { "same", "moved", "worse", "new" };

bool gate_counts_are_comparable( const gate_base* base )
{
    char compiler[sizeof base->compiler];
    gate_compiler( compiler, sizeof compiler );
    return strcmp( base->compiler, compiler ) == 0;
}

static void add_message( gate_row_check* out, suite_measure m, double base, double now, double most )
{
    const size_t used = strlen( out->message );
    char change[32] = "";
    if ( base > 0.0 )
    {
        snprintf( change, sizeof change, " (%+.2f %%)", 100.0 * ( now / base - 1.0 ) );
    }
    snprintf( out->message + used, sizeof out->message - used, "%s%s is %.6g, was %.6g%s, at most %.6g is allowed",
              used > 0 ? "; " : "", suite_measures[m].name, now, base, change, most );
}

// @return instructions of a pass; 0: it did not run or was not counted
static double pass_instructions( const suite_measurement* m, const char* name )
{
    for ( int i = 0; i < m->pass_count; ++i )
    {
        if ( strcmp( m->passes[i].name, name ) == 0 )
        {
            return isfinite( m->passes[i].instructions ) ? m->passes[i].instructions : 0.0;
        }
    }
    return 0.0;
}

// Name the passes behind a growth of instructions: those with a tenth of it or more, at most three, the largest first.
static void add_passes( gate_row_check* out, const suite_measurement* was )
{
    const suite_measurement* now = &out->now;
    const double growth = now->values[SUITE_INSTRUCTIONS] - was->values[SUITE_INSTRUCTIONS];
    double last = INFINITY;
    for ( int place = 0; place < 3; ++place )
    {
        double most = 0.1 * growth;
        const char* name = NULL;
        for ( int i = 0; i < now->pass_count; ++i )
        {
            const double more =
                pass_instructions( now, now->passes[i].name ) - pass_instructions( was, now->passes[i].name );
            if ( more >= most && more < last )
            {
                most = more;
                name = now->passes[i].name;
            }
        }
        const size_t used = strlen( out->message );
        if ( name )
        {
            const double base = pass_instructions( was, name );
            char change[32] = "which is new";
            if ( base > 0.0 )
            {
                snprintf( change, sizeof change, "%+.2f %%", 100.0 * most / base );
            }
            snprintf( out->message + used, sizeof out->message - used, "%s %s %s",
                      place == 0 ? ", most of it in" : ",", name, change );
            last = most;
        }
    }
}

void gate_check_row( const suite_row* row, const gate_base* base, bool compares_counts, const suite_measurement* now,
                     gate_row_check* out )
{
    *out = ( gate_row_check ){ .state = GATE_NEW, .now = *now, .base = find_base_row( base, row ) };
    if ( out->base == NULL )
    {
        snprintf( out->message, sizeof out->message, "the base does not have this row; record or accept it" );
        return;
    }
    const suite_measurement* was = &out->base->measured;
    out->state = now->hash == was->hash ? GATE_SAME : GATE_MOVED;
    if ( now->steps != was->steps )
    {
        out->state = GATE_WORSE;
        snprintf( out->message, sizeof out->message, "%d steps were made, and %d of the base; record or accept it",
                  now->steps, was->steps );
        return;
    }
    if ( out->state == GATE_MOVED && row->budgets[SUITE_HASH].relative < 1.0 )
    {
        out->state = GATE_WORSE;
        snprintf( out->message, sizeof out->message, "hash is %016llx, was %016llx, and no other bits are allowed",
                  (unsigned long long)now->hash, (unsigned long long)was->hash );
    }
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        const double most = was->values[m] * ( 1.0 + row->budgets[m].relative ) + row->budgets[m].absolute;
        const bool is_known = isfinite( was->values[m] ) && !isnan( now->values[m] );
        const bool is_counted = m == SUITE_INSTRUCTIONS || m == SUITE_CYCLES;
        if ( is_known && ( !is_counted || compares_counts ) && now->values[m] > most )
        {
            out->worse[m] = true;
            out->state = GATE_WORSE;
            add_message( out, (suite_measure)m, was->values[m], now->values[m], most );
            if ( m == SUITE_INSTRUCTIONS )
            {
                add_passes( out, was );
            }
        }
    }
}

int gate_count_missing( const gate_base* base, const suite_row* rows, int row_count )
{
    int found = 0;
    for ( int i = 0; i < row_count; ++i )
    {
        found += find_base_row( base, rows + i ) != NULL ? 1 : 0;
    }
    return base->row_count - found;
}

// ---- the report ----

// Return the change from the base as a fraction; NaN: not known, or from 0. Files have nine digits.
static double change_of( const gate_row_check* check, suite_measure m )
{
    const double now = check->now.values[m], base = check->base ? check->base->measured.values[m] : NAN;
    const double change = base > 0.0 ? now / base - 1.0 : now == base ? 0.0 : NAN;
    return fabs( change ) < 1e-8 ? 0.0 : change;
}

static void format_value( const gate_row_check* check, suite_measure m, char* out, size_t size )
{
    const double now = check->now.values[m], change = change_of( check, m );
    if ( !isfinite( now ) )
    {
        snprintf( out, size, "-" );
    }
    else if ( !isfinite( change ) || change == 0.0 )
    {
        snprintf( out, size, "%.9g", now );
    }
    else
    {
        snprintf( out, size, "%.9g %+.2f %%", now, 100.0 * change );
    }
}

// The measure of accuracy that changed most for the worse, or most at all.
static void format_accuracy( const gate_row_check* check, char* out, size_t size )
{
    double most = 0.0;
    snprintf( out, size, "as in the base" );
    for ( int m = SUITE_ERROR; m < SUITE_MEASURE_COUNT; ++m )
    {
        const double change = change_of( check, (suite_measure)m );
        const bool is_from_zero = check->base && check->base->measured.values[m] == 0.0 && check->now.values[m] > 0.0;
        if ( is_from_zero || change > most || ( most == 0.0 && change < 0.0 ) )
        {
            most = is_from_zero ? INFINITY : fmax( change, 0.0 );
            snprintf( out, size, is_from_zero ? "%s %.3g" : "%s %+.2f %%", suite_measures[m].name,
                      is_from_zero ? check->now.values[m] : 100.0 * change );
        }
    }
}

// A row for machines: values, the base's with `base_` before their names, and whether one is worse.
static void add_row( const suite_row* row, const gate_row_check* check, results* out )
{
    results_row* r = results_add_row( out, row->name, row->variant );
    if ( r == NULL )
    {
        return; // the results report it
    }
    r->workers = 1;
    r->steps = check->now.steps;
    r->hash = check->now.hash;
    r->has_hash = true;
    results_put( &r->size, "is_same", check->state == GATE_SAME ? 1.0 : 0.0 );
    results_put( &r->size, "is_worse", check->state == GATE_WORSE ? 1.0 : 0.0 );
    results_put( &r->size, "is_new", check->state == GATE_NEW ? 1.0 : 0.0 );
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        char name[64];
        results_put( &r->size, suite_measures[m].name, check->now.values[m] );
        snprintf( name, sizeof name, "base_%s", suite_measures[m].name );
        results_put( &r->size, name, check->base ? check->base->measured.values[m] : NAN );
    }
}

void gate_report( const wisp_suite* suite, const gate_row_check* checks, results* out )
{
    int counts[GATE_STATE_COUNT] = { 0 };
    suite_horizon horizon = { 0 };
    const int table =
        results_begin_table( out, "Rows", "row\tverdict\tinstructions\tcycles\tbytes\tallocations\taccuracy" );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        char name[SUITE_MAX_LABEL], cells[4][40], accuracy[64];
        suite_label( suite->rows + i, name );
        for ( int m = SUITE_INSTRUCTIONS; m <= SUITE_ALLOCATIONS; ++m )
        {
            format_value( checks + i, (suite_measure)m, cells[m], sizeof cells[m] );
        }
        format_accuracy( checks + i, accuracy, sizeof accuracy );
        results_add_line( out, table, "%s\t%s\t%s\t%s\t%s\t%s\t%s", name, gate_state_names[checks[i].state], cells[0],
                          cells[1], cells[2], cells[3], checks[i].base ? accuracy : "-" );
        counts[checks[i].state] += 1;
        suite_horizon_add( &horizon, checks[i].now.compared.until, checks[i].now.compared.parts );
        add_row( suite->rows + i, checks + i, out );
    }
    for ( int i = 0; i < suite->row_count; ++i )
    {
        char name[SUITE_MAX_LABEL];
        suite_label( suite->rows + i, name );
        if ( checks[i].state == GATE_WORSE )
        {
            results_add_failure( out, "%s: %s", name, checks[i].message );
        }
        else if ( checks[i].message[0] )
        {
            results_add_note( out, "%s: %s", name, checks[i].message );
        }
    }
    char line[200], until[100];
    suite_horizon_text( &horizon, until, sizeof until );
    snprintf( line, sizeof line, "gate %.80s: %s: %d rows", suite->name,
              counts[GATE_WORSE] > 0 ? "regression"
              : counts[GATE_NEW] > 0 ? "inconclusive"
                                     : "pass",
              suite->row_count );
    for ( int i = 0; i < GATE_STATE_COUNT; ++i )
    {
        results_append_count( line, sizeof line, counts[i], i == GATE_SAME ? "the same" : gate_state_names[i] );
    }
    results_add_headline( out, "%s%s", line, until );
}

// ---- JUnit ----

static void write_case( FILE* out, const wisp_suite* suite, int i, const gate_row_check* check )
{
    char name[SUITE_MAX_LABEL];
    suite_label( suite->rows + i, name );
    fputs( "    <testcase classname=\"wisp.gate.", out );
    report_put_text( suite->name, out );
    fputs( "\" name=\"", out );
    report_put_text( name, out );
    if ( check->state != GATE_WORSE && check->state != GATE_NEW )
    {
        fputs( "\"/>\n", out );
        return;
    }
    fputs( check->state == GATE_WORSE ? "\">\n      <failure message=\"" : "\">\n      <skipped message=\"", out );
    report_put_text( check->message, out );
    fputs( "\"/>\n    </testcase>\n", out );
}

wisp_status gate_write_junit( const wisp_suite* suite, const gate_row_check* checks, const char* path,
                              wisp_error* error )
{
    int worse = 0, unknown = 0;
    for ( int i = 0; i < suite->row_count; ++i )
    {
        worse += checks[i].state == GATE_WORSE ? 1 : 0;
        unknown += checks[i].state == GATE_NEW ? 1 : 0;
    }
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    FILE* out = output.stream;
    fprintf( out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"wisp gate " );
    report_put_text( suite->name, out );
    fprintf( out, "\" tests=\"%d\" failures=\"%d\" errors=\"0\" skipped=\"%d\">\n", suite->row_count, worse,
             unknown );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        write_case( out, suite, i, checks + i );
    }
    fputs( "  </testsuite>\n</testsuites>\n", out );
    return io_output_end( &output, WISP_OK, error );
}

// ---- annotations ----

// A percent sign or a line break would end the message.
static void print_escaped( const char* text )
{
    for ( ; *text; ++text )
    {
        if ( *text == '%' || *text == '\n' || *text == '\r' )
        {
            printf( "%%%02X", (unsigned char)*text );
        }
        else
        {
            putchar( *text );
        }
    }
}

void gate_print_annotations( const wisp_suite* suite, const gate_row_check* checks, const char* path )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        if ( checks[i].state == GATE_WORSE || checks[i].state == GATE_NEW )
        {
            char name[SUITE_MAX_LABEL];
            suite_label( suite->rows + i, name );
            printf( "::%s file=", checks[i].state == GATE_WORSE ? "error" : "warning" );
            print_escaped( path );
            printf( ",title=wisp gate::" );
            print_escaped( name );
            printf( ": " );
            print_escaped( checks[i].message );
            putchar( '\n' );
        }
    }
}

// ---- the page ----

enum
{
    MAX_PASS_CHARTS = 12, ///< rows whose passes are drawn
    MAX_BARS = 24,        ///< passes of a row, the largest
};

static const char* const sides[] = { "before", "after" };

// Add a line of bars, before and after, in millions.
static void add_bars( results* out, int chart, const int series[2], int line, const char* label, double before,
                      double after )
{
    const double values[] = { before, after };
    for ( int side = 0; side < 2; ++side )
    {
        results_point point = { .x = line, .y = 1e-6 * values[side] };
        snprintf( point.label, sizeof point.label, "%.191s", label );
        results_add_point( out, chart, series[side], point );
    }
}

static int begin_chart( results* out, const char* title, int series[2] )
{
    const int number = results_add_chart( out, title, "", "million instructions" );
    for ( int side = 0; side < 2; ++side )
    {
        series[side] = results_add_series( out, number, sides[side], false );
    }
    results_chart* chart = results_chart_at( out, number );
    if ( chart )
    {
        chart->is_bars = true;
    }
    return number;
}

static bool is_counted( const gate_row_check* check )
{
    return check->base && isfinite( check->base->measured.values[SUITE_INSTRUCTIONS] ) &&
           isfinite( check->now.values[SUITE_INSTRUCTIONS] );
}

static double growth_of( const gate_row_check* check )
{
    return check->now.values[SUITE_INSTRUCTIONS] / check->base->measured.values[SUITE_INSTRUCTIONS];
}

static void add_rows_chart( const wisp_suite* suite, const gate_row_check* checks, results* out )
{
    int series[2], line = 0;
    const int chart = begin_chart( out, "Instructions of all steps, before and after", series );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        if ( is_counted( checks + i ) )
        {
            char label[SUITE_MAX_LABEL];
            suite_label( suite->rows + i, label );
            add_bars( out, chart, series, line++, label, checks[i].base->measured.values[SUITE_INSTRUCTIONS],
                      checks[i].now.values[SUITE_INSTRUCTIONS] );
        }
    }
}

// The largest pass that is not done. @return -1: there is none
static int next_pass( const suite_measurement* now, const bool* is_done )
{
    int next = -1;
    for ( int i = 0; i < now->pass_count; ++i )
    {
        if ( !is_done[i] && now->passes[i].instructions > 0.0 &&
             ( next < 0 || now->passes[i].instructions > now->passes[next].instructions ) )
        {
            next = i;
        }
    }
    return next;
}

static void add_pass_chart( const suite_row* row, const gate_row_check* check, results* out )
{
    char title[160], label[SUITE_MAX_LABEL];
    bool is_done[SUITE_MAX_PASSES] = { false };
    int series[2], line = 0;
    suite_label( row, label );
    snprintf( title, sizeof title, "%.140s, by pass", label );
    const int chart = begin_chart( out, title, series );
    for ( int i = next_pass( &check->now, is_done ); i >= 0 && line < MAX_BARS;
          i = next_pass( &check->now, is_done ) )
    {
        const suite_pass* pass = &check->now.passes[i];
        add_bars( out, chart, series, line++, pass->name, pass_instructions( &check->base->measured, pass->name ),
                  pass->instructions );
        is_done[i] = true;
    }
}

// Passes of the rows that changed most, either way.
static void add_pass_charts( const wisp_suite* suite, const gate_row_check* checks, results* out )
{
    bool is_done[SUITE_MAX_ROWS] = { false };
    for ( int drawn = 0; drawn < MAX_PASS_CHARTS; ++drawn )
    {
        int next = -1;
        for ( int i = 0; i < suite->row_count; ++i )
        {
            if ( !is_done[i] && is_counted( checks + i ) &&
                 ( next < 0 || fabs( log( growth_of( checks + i ) ) ) > fabs( log( growth_of( checks + next ) ) ) ) )
            {
                next = i;
            }
        }
        if ( next < 0 )
        {
            return;
        }
        is_done[next] = true;
        add_pass_chart( suite->rows + next, checks + next, out );
    }
}

wisp_status gate_write_page( const wisp_suite* suite, const gate_row_check* checks, results* report, const char* path,
                             wisp_error* error )
{
    char what[SUITE_MAX_NAME + 16];
    const report_run run = { .what = what, .how = report->options };
    bool has_counts = false;
    for ( int i = 0; i < suite->row_count; ++i )
    {
        has_counts = has_counts || is_counted( checks + i );
    }
    snprintf( what, sizeof what, "gate %s", suite->name );
    if ( has_counts )
    {
        add_rows_chart( suite, checks, report );
        add_pass_charts( suite, checks, report );
    }
    return report_write_file( report, &run, path, error );
}
