#include "gate_check.h"

#include "io_file.h"

#include <math.h>
#include <string.h>

const char* const gate_state_names[GATE_STATE_COUNT] = { "same", "moved", "worse", "new" };
const char* const gate_verdict_names[GATE_VERDICT_COUNT] = { "pass", "inconclusive", "regression" };

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

double gate_pass_instructions( const suite_measurement* m, const char* name )
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
            const double more = gate_pass_instructions( now, now->passes[i].name ) -
                                gate_pass_instructions( was, now->passes[i].name );
            if ( more >= most && more < last )
            {
                most = more;
                name = now->passes[i].name;
            }
        }
        const size_t used = strlen( out->message );
        if ( name )
        {
            const double base = gate_pass_instructions( was, name );
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
    *out = ( gate_row_check ){ .state = GATE_NEW, .now = *now, .base = gate_base_find( base, row ) };
    if ( out->base == NULL )
    {
        snprintf( out->message, sizeof out->message, "the base does not have this row; record or accept it" );
        return;
    }
    const suite_measurement* was = &out->base->measured;
    out->state = now->hash == was->hash && now->steps == was->steps ? GATE_SAME : GATE_MOVED;
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
        found += gate_base_find( base, rows + i ) != NULL ? 1 : 0;
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

void gate_row_label( const suite_row* row, char* out, size_t size )
{
    snprintf( out, size, "%s%s%s", row->name, row->variant[0] ? ", " : "", row->variant );
}

gate_verdict gate_verdict_of( const wisp_suite* suite, const gate_row_check* checks )
{
    gate_verdict verdict = GATE_PASS;
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const gate_verdict one = checks[i].state == GATE_WORSE ? GATE_REGRESSION
                                 : checks[i].state == GATE_NEW ? GATE_INCONCLUSIVE
                                                               : GATE_PASS;
        verdict = one > verdict ? one : verdict;
    }
    return verdict;
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
    const char* const header[] = { "row", "verdict", "instructions", "cycles", "bytes", "allocations", "accuracy" };
    int counts[GATE_STATE_COUNT] = { 0 };
    const int table = results_add_table( out, "Rows", WISP_COUNT( header ), header );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2], cells[4][40], accuracy[64];
        gate_row_label( suite->rows + i, name, sizeof name );
        for ( int m = SUITE_INSTRUCTIONS; m <= SUITE_ALLOCATIONS; ++m )
        {
            format_value( checks + i, (suite_measure)m, cells[m], sizeof cells[m] );
        }
        format_accuracy( checks + i, accuracy, sizeof accuracy );
        results_add_cells( out, table,
                           ( const char* const[] ){ name, gate_state_names[checks[i].state], cells[0], cells[1],
                                                    cells[2], cells[3], checks[i].base ? accuracy : "-" } );
        counts[checks[i].state] += 1;
        add_row( suite->rows + i, checks + i, out );
    }
    for ( int i = 0; i < suite->row_count; ++i )
    {
        char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2];
        gate_row_label( suite->rows + i, name, sizeof name );
        if ( checks[i].state == GATE_WORSE )
        {
            results_add_failure( out, "%s: %s", name, checks[i].message );
        }
        else if ( checks[i].message[0] )
        {
            results_add_note( out, "%s: %s", name, checks[i].message );
        }
    }
    static const struct
    {
        gate_state state;
        const char* what;
    } told[] = { { GATE_SAME, "the same" }, { GATE_MOVED, "moved" }, { GATE_WORSE, "worse" }, { GATE_NEW, "new" } };
    char line[200];
    snprintf( line, sizeof line, "gate %.80s: %s: %d rows", suite->name,
              gate_verdict_names[gate_verdict_of( suite, checks )], suite->row_count );
    for ( int i = 0; i < WISP_COUNT( told ); ++i )
    {
        results_append_count( line, sizeof line, counts[told[i].state], told[i].what );
    }
    results_add_headline( out, "%s", line );
}

// ---- JUnit ----

static void write_escaped( FILE* out, const char* text )
{
    for ( ; *text; ++text )
    {
        const char* entity = *text == '<'   ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '&' ? "&amp;"
                             : *text == '"' ? "&quot;"
                                            : NULL;
        if ( entity )
        {
            fputs( entity, out );
        }
        else
        {
            fputc( *text, out );
        }
    }
}

static void write_case( FILE* out, const wisp_suite* suite, int i, const gate_row_check* check )
{
    char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2];
    gate_row_label( suite->rows + i, name, sizeof name );
    fputs( "    <testcase classname=\"wisp.gate.", out );
    write_escaped( out, suite->name );
    fputs( "\" name=\"", out );
    write_escaped( out, name );
    if ( check->state != GATE_WORSE && check->state != GATE_NEW )
    {
        fputs( "\"/>\n", out );
        return;
    }
    fputs( check->state == GATE_WORSE ? "\">\n      <failure message=\"" : "\">\n      <skipped message=\"", out );
    write_escaped( out, check->message );
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
    const wisp_status status = io_output_open( path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    FILE* out = output.stream;
    fprintf( out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"wisp gate " );
    write_escaped( out, suite->name );
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
            char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2];
            gate_row_label( suite->rows + i, name, sizeof name );
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
