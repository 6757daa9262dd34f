// Tables, charts and rows of a merged sweep. They are the same for any number of shards, but for times.
#include "sweep_merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_COLUMNS = 24,
    MAX_PROCESSORS = 8, // whose times have columns
    MAX_FAILURES = 20,  // that are told
    MAX_CHART_LINES = 12,
};

// A column of numbers. @return NaN: the item has none
typedef double column_fn( const sweep_record* r );

static double error_of( const sweep_record* r )
{
    return 1e3 * r->values[SUITE_ERROR];
}
static double largest_of( const sweep_record* r )
{
    return 1e3 * r->compared.largest;
}
static double first_of( const sweep_record* r )
{
    return 1e3 * r->compared.at[0];
}
static double second_of( const sweep_record* r )
{
    return 1e3 * r->compared.at[1];
}
static double third_of( const sweep_record* r )
{
    return 1e3 * r->compared.at[2];
}
static double detail_of( const sweep_record* r )
{
    return r->compared.detail;
}
static double stretch_of( const sweep_record* r )
{
    return 100.0 * r->values[SUITE_STRETCH];
}
static double energy_of( const sweep_record* r )
{
    return 1e3 * r->values[SUITE_ENERGY];
}
static double penetration_of( const sweep_record* r )
{
    return 1e3 * r->values[SUITE_PENETRATION];
}
static double intersections_of( const sweep_record* r )
{
    return r->values[SUITE_INTERSECTIONS];
}
static double iterations_of( const sweep_record* r )
{
    return r->values[SUITE_SOLVER_ITERATIONS];
}
static double not_converged_of( const sweep_record* r )
{
    return r->values[SUITE_NOT_CONVERGED];
}
static double resets_of( const sweep_record* r )
{
    return r->values[SUITE_RESETS];
}
static double halted_of( const sweep_record* r )
{
    return r->values[SUITE_HALTED];
}
static double memory_of( const sweep_record* r )
{
    return r->values[SUITE_BYTES] / 1024.0;
}

typedef struct column
{
    const char *title, *name; ///< of tables, and of rows for programs
    column_fn* value;
    bool is_error;    ///< below the doubt of the reference it says nothing
    bool hides_zeros; ///< it is left out where all are 0
} column;

static const column COLUMNS[] = {
    { "error, mm", "rms_mm", error_of, true, false },
    { "largest distance, mm", "largest_mm", largest_of, false, false },
    { "error at 0.5 s, mm", "rms_mm_at_0.5_s", first_of, true, false },
    { "error at 1 s, mm", "rms_mm_at_1_s", second_of, true, false },
    { "error at 2 s, mm", "rms_mm_at_2_s", third_of, true, false },
    { "detail", "detail", detail_of, false, false },
    { "stretch mean, %", "stretch_percent", stretch_of, false, false },
    { "energy risen, mJ", "energy_risen_mJ", energy_of, false, false },
    { "penetration, mm", "penetration_mm", penetration_of, false, true },
    { "intersections", "intersections", intersections_of, false, false },
    { "linear iterations", "linear_iterations", iterations_of, false, false },
    { "not converged", "not_converged", not_converged_of, false, true },
    { "strand resets", "strand_resets", resets_of, false, true },
    { "halted", "halted", halted_of, false, true },
    { "memory, KiB", "memory_KiB", memory_of, false, false },
};

// What the report is made of.
typedef struct report
{
    const sweep_merge* merge;
    const sweep_header* header;
    results* out;
    char processors[MAX_PROCESSORS][160]; // that have times: model and instruction set
    int processor_count, left_out;
} report;

static bool is_named( const sweep_record* r, const char* name )
{
    return strcmp( r->name, name ) == 0;
}

// ---- times ----

// Times are of a processor with its instruction set; those of different ones are never in one column.
void sweep_processor( const sweep_header* h, char out[160] )
{
    snprintf( out, 160, "%s, %s", h->cpu, h->isa );
}

static int find_processor( const report* r, const sweep_merged* item )
{
    char name[160];
    sweep_processor( &r->merge->parts[item->timed_part].header, name );
    int i = 0;
    while ( i < r->processor_count && strcmp( r->processors[i], name ) != 0 )
    {
        ++i;
    }
    return i;
}

static void list_processors( report* r )
{
    for ( int i = 0; i < r->header->items; ++i )
    {
        const sweep_merged* item = r->merge->items + i;
        const bool is_new = item->timed != NULL && find_processor( r, item ) == r->processor_count;
        if ( is_new && r->processor_count < MAX_PROCESSORS )
        {
            sweep_processor( &r->merge->parts[item->timed_part].header, r->processors[r->processor_count++] );
        }
        else
        {
            r->left_out += is_new ? 1 : 0;
        }
    }
}

// ---- a table for each scene ----

typedef struct table_plan
{
    const char* name;
    const column* columns[MAX_COLUMNS];
    int column_count;
    bool has_verdicts;
    int time_columns; // of each processor: 0, 1, or 2
    char workers[24]; // of the second one
} table_plan;

static table_plan plan_table( const report* r, const char* name )
{
    table_plan plan = { .name = name };
    for ( int c = 0; c < WISP_COUNT( COLUMNS ); ++c )
    {
        bool any = false;
        for ( int i = 0; i < r->header->items && !any; ++i )
        {
            const sweep_record* record = r->merge->items[i].record;
            const double value = COLUMNS[c].value( record );
            any = is_named( record, name ) && !isnan( value ) && ( value != 0.0 || !COLUMNS[c].hides_zeros );
        }
        if ( any )
        {
            plan.columns[plan.column_count++] = COLUMNS + c;
        }
    }
    for ( int i = 0; i < r->header->items; ++i )
    {
        const sweep_merged* item = r->merge->items + i;
        if ( is_named( item->record, name ) )
        {
            plan.has_verdicts = plan.has_verdicts || item->record->verdict[0] || item->record->failure[0];
            const int times = item->timed != NULL ? item->timed->time_count : 0;
            plan.time_columns = times > plan.time_columns ? times : plan.time_columns;
            if ( times > 1 )
            {
                snprintf( plan.workers, sizeof plan.workers, "%d workers", item->timed->times[1].workers );
            }
        }
    }
    return plan;
}

static void put_number( const report* r, const column* c, double value, char out[64] )
{
    if ( isnan( value ) )
    {
        out[0] = '\0';
        return;
    }
    const bool is_below = c->is_error && value < 1e3 * r->header->doubt;
    snprintf( out, 64, is_below ? "below" : isinf( value ) ? "not finite" : "%.4g", value );
}

static void put_verdict( const sweep_record* record, char out[64] )
{
    snprintf( out, 64, "%s%s", record->failure[0] ? "could not be run" : record->verdict,
              record->verdict[0] && !record->is_known ? ", unexpected" : "" );
}

static void add_table( const report* r, const char* name )
{
    const table_plan plan = plan_table( r, name );
    char header[MAX_COLUMNS + 2 + 2 * MAX_PROCESSORS][64];
    const char* cells[MAX_COLUMNS + 2 + 2 * MAX_PROCESSORS] = { "setting" };
    int count = 1;
    for ( int c = 0; c < plan.column_count; ++c )
    {
        cells[count++] = plan.columns[c]->title;
    }
    for ( int p = 0; p < r->processor_count; ++p )
    {
        for ( int t = 0; t < plan.time_columns; ++t )
        {
            snprintf( header[count], sizeof header[count], r->processor_count > 1 ? "ms, %s, processor %d" : "ms, %s",
                      t == 0 ? "1 worker" : plan.workers, p + 1 );
            cells[count] = header[count];
            ++count;
        }
    }
    cells[count] = "verdict";
    count += plan.has_verdicts ? 1 : 0;
    const int table = results_add_table( r->out, name, count, cells );
    for ( int i = 0; i < r->header->items; ++i )
    {
        const sweep_merged* item = r->merge->items + i;
        if ( !is_named( item->record, name ) )
        {
            continue;
        }
        int at = 1;
        cells[0] = item->record->variant[0] ? item->record->variant : "as it is";
        for ( int c = 0; c < plan.column_count; ++c, ++at )
        {
            put_number( r, plan.columns[c], plan.columns[c]->value( item->record ), header[at] );
            cells[at] = header[at];
        }
        for ( int p = 0; p < r->processor_count; ++p )
        {
            for ( int t = 0; t < plan.time_columns; ++t, ++at )
            {
                const bool is_here =
                    item->timed != NULL && t < item->timed->time_count && find_processor( r, item ) == p;
                header[at][0] = '\0';
                if ( is_here )
                {
                    snprintf( header[at], sizeof header[at], "%.4g", item->timed->times[t].median );
                }
                cells[at] = header[at];
            }
        }
        put_verdict( item->record, header[at] );
        cells[at] = header[at];
        results_add_cells( r->out, table, cells );
    }
}

// ---- series ----

// Errors fall as a field grows, or as it shrinks.
static bool grows_with_error( const char* along )
{
    const char* dot = strrchr( along, '.' );
    const char* field = dot != NULL ? dot + 1 : along;
    return strcmp( field, "dt" ) == 0 || strstr( field, "spacing" ) != NULL || strstr( field, "tolerance" ) != NULL;
}

// The order between two settings of a series. @return NaN: an error is missing, or below the doubt
static double order_between( const report* r, const sweep_record* a, const sweep_record* b )
{
    const double e = a->values[SUITE_ERROR], f = b->values[SUITE_ERROR], doubt = fmax( r->header->doubt, 0.0 );
    const bool counts = e > doubt && f > doubt && isfinite( e ) && isfinite( f ) && a->along_value > 0.0 &&
                        b->along_value > 0.0 && a->along_value != b->along_value;
    const double order = counts ? log( e / f ) / log( b->along_value / a->along_value ) : NAN;
    return grows_with_error( a->along ) ? -order : order;
}

static void add_orders( const report* r )
{
    static const char* const header[] = { "series", "from", "to", "observed order", "promised" };
    int table = -1;
    for ( int i = 0; i + 1 < r->header->items; ++i )
    {
        const sweep_record *a = r->merge->items[i].record, *b = r->merge->items[i + 1].record;
        const double order = a->series[0] && strcmp( a->series, b->series ) == 0 ? order_between( r, a, b ) : NAN;
        char from[80], to[32], observed[32], promised[32] = "";
        if ( isnan( order ) )
        {
            continue;
        }
        table = table < 0 ? results_add_table( r->out, "Observed orders", WISP_COUNT( header ), header ) : table;
        snprintf( from, sizeof from, "%s = %.6g", a->along, a->along_value );
        snprintf( to, sizeof to, "%.6g", b->along_value );
        snprintf( observed, sizeof observed, "%.2f", order );
        if ( !isnan( a->order ) )
        {
            snprintf( promised, sizeof promised, "%.3g", a->order );
        }
        const char* const cells[] = { a->series, from, to, observed, promised };
        results_add_cells( r->out, table, cells );
    }
}

// Error against the field of the series, or against time.
static void add_chart( const report* r, const char* name, bool by_time )
{
    char title[160];
    snprintf( title, sizeof title, by_time ? "%s: error against time" : "%s: error", name );
    int chart = -1, line = -1, lines = 0;
    const char* last = "";
    for ( int i = 0; i < r->header->items; ++i )
    {
        const sweep_merged* item = r->merge->items + i;
        const sweep_record* record = item->record;
        const double error = error_of( record );
        const double x = !by_time ? record->along_value : item->timed != NULL ? item->timed->times[0].median : NAN;
        if ( !is_named( record, name ) || !record->series[0] || !isfinite( error ) || !isfinite( x ) ||
             ( by_time && find_processor( r, item ) != 0 ) )
        {
            continue;
        }
        if ( chart < 0 )
        {
            chart =
                results_add_chart( r->out, title, by_time ? "ms per step, 1 worker" : record->along, "error, mm" );
            results_chart* c = results_chart_at( r->out, chart );
            if ( c != NULL )
            {
                c->x_log = c->y_log = true;
                if ( by_time && r->processor_count > 1 )
                {
                    snprintf( c->caption, sizeof c->caption, "on %.150s", r->processors[0] );
                }
            }
        }
        if ( strcmp( record->series, last ) != 0 )
        {
            last = record->series;
            line = lines < MAX_CHART_LINES ? results_add_series( r->out, chart, record->series, true ) : -1;
            lines += 1;
        }
        if ( line >= 0 )
        {
            results_point point = { .x = x, .y = error };
            snprintf( point.label, sizeof point.label, "%s", record->variant );
            results_add_point( r->out, chart, line, point );
        }
    }
    if ( lines > MAX_CHART_LINES )
    {
        results_add_note( r->out, "%s: the chart has the first %d of %d series", name, MAX_CHART_LINES, lines );
    }
}

// ---- rows for programs ----

static void add_row( const report* r, const sweep_merged* item )
{
    const sweep_record* record = item->record;
    results_row* row = results_add_row( r->out, record->name, record->variant );
    if ( row == NULL )
    {
        return;
    }
    row->hash = record->hash;
    row->has_hash = record->failure[0] == '\0';
    snprintf( row->error_reference, sizeof row->error_reference, "%s", r->header->reference );
    for ( int c = 0; c < WISP_COUNT( COLUMNS ); ++c )
    {
        const double value = COLUMNS[c].value( record );
        if ( !isnan( value ) )
        {
            results_put( &row->error, COLUMNS[c].name, value );
        }
    }
    if ( item->timed != NULL )
    {
        results_put( &row->size, "vertices", item->timed->vertices );
        results_put( &row->size, "substeps", item->timed->substeps );
    }
    // times of several processors are not comparable, so rows have none then
    if ( item->timed != NULL && r->processor_count == 1 )
    {
        const sweep_time* time = item->timed->times + item->timed->time_count - 1;
        row->workers = time->workers;
        row->steps = time->steps;
        row->ms_median = time->median;
        row->ms_p10 = time->p10;
        row->ms_p90 = time->p90;
    }
}

// ---- what is said of all ----

static void add_failures( const report* r )
{
    int failures = 0, unexpected = 0;
    for ( int i = 0; i < r->header->items; ++i )
    {
        const sweep_record* record = r->merge->items[i].record;
        const bool fails = record->failure[0] != '\0', breaks = record->verdict[0] != '\0' && !record->is_known;
        failures += fails ? 1 : 0;
        unexpected += breaks ? 1 : 0;
        if ( ( fails || breaks ) && failures + unexpected <= MAX_FAILURES )
        {
            results_add_failure( r->out, "%s%s%s: %s", record->name, record->variant[0] ? ", " : "", record->variant,
                                 fails ? record->failure : record->verdict );
        }
    }
    if ( failures + unexpected > MAX_FAILURES )
    {
        results_add_failure( r->out, "and %d more", failures + unexpected - MAX_FAILURES );
    }
    char line[200];
    snprintf( line, sizeof line, "%s: %d item%s", r->header->title[0] ? r->header->title : r->header->suite,
              r->header->items, r->header->items == 1 ? "" : "s" );
    results_append_count( line, sizeof line, failures, "could not be run" );
    results_append_count( line, sizeof line, unexpected, "not as expected" );
    results_add_headline( r->out, "%s", line );
}

static void add_notes( const report* r )
{
    const sweep_header* h = r->header;
    if ( h->reference[0] != '\0' )
    {
        results_add_note( r->out, "errors are root mean square distances to %s", h->reference );
    }
    if ( h->doubt > 0.0 )
    {
        results_add_note( r->out, "the reference is uncertain by %.3g mm, and errors below that are not resolved",
                          1e3 * h->doubt );
    }
    if ( isfinite( h->parts_at ) )
    {
        results_add_note( r->out, "motion is chaotic from %.3g s on, and is not compared after that", h->parts_at );
    }
    if ( r->left_out > 0 )
    {
        results_add_note( r->out, "times of %d items are left out: they are of more than %d processors", r->left_out,
                          MAX_PROCESSORS );
    }
    for ( int p = 0; p < r->processor_count; ++p )
    {
        if ( r->processor_count > 1 )
        {
            results_add_note( r->out, "processor %d: %s", p + 1, r->processors[p] );
        }
    }
}

void sweep_report( const sweep_merge* merge, results* out )
{
    report r = { .merge = merge, .header = &merge->parts[0].header, .out = out };
    list_processors( &r );
    add_failures( &r );
    const char* name = "";
    for ( int i = 0; i < r.header->items; ++i )
    {
        const sweep_record* record = merge->items[i].record;
        bool is_first = strcmp( record->name, name ) != 0;
        for ( int k = 0; k < i && is_first; ++k )
        {
            is_first = !is_named( merge->items[k].record, record->name );
        }
        if ( is_first )
        {
            name = record->name;
            add_table( &r, name );
            add_chart( &r, name, false );
            add_chart( &r, name, true );
        }
        add_row( &r, merge->items + i );
    }
    add_orders( &r );
    sweep_add_models( merge, out );
    add_notes( &r );
}
