// `wisp merge`: make one result of the parts of a sweep. Tables, charts and rows are the same for any number of shards, but for times.
#include "bench_commands.h"

#include "bench_output.h"
#include "sweep_merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_FAILURES = 20, // that are told
    MAX_CHART_LINES = 12,
};

// What the report is made of.
typedef struct merged
{
    const sweep_row *rows, *like;
    int count;
    bool has_processors; // times are of several
    results* out;
} merged;

static bool is_of( const sweep_row* row, const char* name )
{
    return strcmp( row->name, name ) == 0;
}

// Times of different processors, or instruction sets, are not compared.
static bool has_several_processors( const sweep_row* rows, int count )
{
    const sweep_row* first = NULL;
    bool has = false;
    for ( int i = 0; i < count; ++i )
    {
        first = first == NULL && rows[i].workers > 0 ? rows + i : first;
        has = has || ( rows[i].workers > 0 && ( strcmp( rows[i].machine.cpu, first->machine.cpu ) != 0 ||
                                                strcmp( rows[i].machine.isa, first->machine.isa ) != 0 ) );
    }
    return has;
}

// ---- a table for each scene ----

typedef struct table_plan
{
    bool has_value[SWEEP_VALUE_COUNT], has_verdicts, has_counts;
    int workers; // of times; 0: there are none
} table_plan;

static table_plan plan_table( const merged* r, const char* name )
{
    table_plan plan = { .workers = 0 };
    for ( int i = 0; i < r->count; ++i )
    {
        const sweep_row* row = r->rows + i;
        for ( int v = 0; v < SWEEP_VALUE_COUNT && is_of( row, name ); ++v )
        {
            const bool is_shown =
                !isnan( row->values[v] ) && ( row->values[v] != 0.0 || !sweep_values[v].hides_zeros );
            plan.has_value[v] = plan.has_value[v] || is_shown;
        }
        if ( is_of( row, name ) )
        {
            plan.has_verdicts = plan.has_verdicts || row->verdict[0] || row->failure[0];
            plan.has_counts = plan.has_counts || row->vertices > 0;
            plan.workers = row->workers > plan.workers ? row->workers : plan.workers;
        }
    }
    return plan;
}

static int begin_table( const merged* r, const table_plan* plan, const char* name )
{
    results_cells header = { .count = 0 };
    cells_put( &header, "setting" );
    for ( int i = 0; i < 3 && plan->has_counts; ++i )
    {
        cells_put( &header, "%s", i == 0 ? "strands" : i == 1 ? "vertices" : "substeps" );
    }
    for ( int i = 0; i < 2 && i < plan->workers; ++i )
    {
        cells_put( &header, i == 0 ? "ms, 1 worker" : "ms, %d workers", plan->workers );
        cells_put( &header, "p90\tFPS" );
    }
    for ( int v = 0; v < SWEEP_VALUE_COUNT; ++v )
    {
        if ( plan->has_value[v] )
        {
            cells_put( &header, "%s", sweep_values[v].title );
        }
        if ( plan->has_value[0] && v == 1 )
        {
            cells_put( &header, "doubt, mm\tuntil, s" );
        }
    }
    if ( plan->workers > 0 && r->has_processors )
    {
        cells_put( &header, "processor" );
    }
    if ( plan->has_verdicts )
    {
        cells_put( &header, "verdict" );
    }
    return cells_begin_table( &header, name, r->out );
}

static void put_number( results_cells* line, double value )
{
    char text[32] = "";
    if ( !isnan( value ) )
    {
        snprintf( text, sizeof text, isinf( value ) ? "not finite" : "%.4g", value );
    }
    cells_put( line, "%s", text );
}

static void put_time( results_cells* line, const sweep_time* time, bool is_timed )
{
    put_number( line, is_timed ? time->median : NAN );
    put_number( line, is_timed ? time->p90 : NAN );
    cells_put( line, "%.1f", is_timed ? 1e3 / time->median : NAN );
}

static void add_line( const merged* r, const table_plan* plan, const sweep_row* row, int table )
{
    results_cells line = { .count = 0 };
    const int counts[] = { row->strands, row->vertices, row->substeps };
    cells_put( &line, "%s", row->variant[0] ? row->variant : "as it is" );
    for ( int i = 0; i < 3 && plan->has_counts; ++i )
    {
        cells_put( &line, "%d", counts[i] );
    }
    for ( int i = 0; i < 2 && i < plan->workers; ++i )
    {
        put_time( &line, i == 0 ? &row->alone : &row->together, row->workers > 0 );
    }
    for ( int v = 0; v < SWEEP_VALUE_COUNT; ++v )
    {
        if ( plan->has_value[v] && sweep_values[v].is_error && row->values[v] < 1e3 * row->doubt )
        {
            cells_put( &line, "below" );
        }
        else if ( plan->has_value[v] )
        {
            put_number( &line, row->values[v] );
        }
        if ( plan->has_value[0] && v == 1 )
        {
            put_number( &line, 1e3 * row->doubt );
            put_number( &line, row->until > 0.0 ? row->until : NAN );
        }
    }
    if ( plan->workers > 0 && r->has_processors )
    {
        const bool is_timed = row->workers > 0;
        cells_put( &line, "%s%s%s", is_timed ? row->machine.cpu : "", is_timed ? ", " : "",
                   is_timed ? row->machine.isa : "" );
    }
    if ( plan->has_verdicts )
    {
        cells_put( &line, "%s%s", row->failure[0] ? "could not be run" : row->verdict,
                   row->verdict[0] && !row->is_known ? ", unexpected" : "" );
    }
    cells_end_row( &line, table, r->out );
}

static void add_table( const merged* r, const char* name )
{
    const table_plan plan = plan_table( r, name );
    const int table = begin_table( r, &plan, name );
    for ( int i = 0; i < r->count; ++i )
    {
        if ( is_of( r->rows + i, name ) )
        {
            add_line( r, &plan, r->rows + i, table );
        }
    }
}

// ---- series ----

// The order between two settings of a series. @return NaN: an error is missing, or below the doubt
static double order_between( const sweep_row* a, const sweep_row* b )
{
    const double e = a->values[0], f = b->values[0], doubt = 1e3 * fmax( fmax( a->doubt, b->doubt ), 0.0 );
    const bool counts = e > doubt && f > doubt && isfinite( e ) && isfinite( f ) && a->along_value > 0.0 &&
                        b->along_value > 0.0 && a->along_value != b->along_value;
    const double order = counts ? log( e / f ) / log( b->along_value / a->along_value ) : NAN;
    return suite_error_grows( a->along ) ? -order : order;
}

static void add_orders( const merged* r )
{
    int table = -1;
    for ( int i = 0; i + 1 < r->count; ++i )
    {
        const sweep_row *a = r->rows + i, *b = a + 1;
        const double order = a->series[0] && strcmp( a->series, b->series ) == 0 ? order_between( a, b ) : NAN;
        if ( !isnan( order ) )
        {
            results_cells line = { .count = 0 };
            table = table < 0 ? results_begin_table( r->out, "Observed orders",
                                                     "series\tfrom\tto\tobserved order\tpromised" )
                              : table;
            cells_put( &line, "%s\t%s = %.6g\t%.6g\t%.2f", a->series, a->along, a->along_value, b->along_value,
                       order );
            put_number( &line, a->order );
            cells_end_row( &line, table, r->out );
        }
    }
}

// Error against the field of the series.
static void add_chart( const merged* r, const char* name )
{
    char title[160];
    snprintf( title, sizeof title, "%s: error", name );
    int chart = -1, line = -1, lines = 0;
    const char* last = "";
    for ( int i = 0; i < r->count; ++i )
    {
        const sweep_row* row = r->rows + i;
        if ( !is_of( row, name ) || !row->series[0] || !isfinite( row->values[0] ) || !isfinite( row->along_value ) )
        {
            continue;
        }
        if ( chart < 0 )
        {
            chart = results_add_chart( r->out, title, row->along, "error, mm" );
            results_chart* c = results_chart_at( r->out, chart );
            if ( c != NULL )
            {
                c->x_log = c->y_log = true;
            }
        }
        if ( strcmp( row->series, last ) != 0 )
        {
            last = row->series;
            line = lines < MAX_CHART_LINES ? results_add_series( r->out, chart, row->series, true ) : -1;
            lines += 1;
        }
        if ( line >= 0 )
        {
            results_point point = { .x = row->along_value, .y = row->values[0] };
            snprintf( point.label, sizeof point.label, "%s", row->variant );
            results_add_point( r->out, chart, line, point );
        }
    }
    if ( lines > MAX_CHART_LINES )
    {
        results_add_note( r->out, "%s: the chart has the first %d of %d series", name, MAX_CHART_LINES, lines );
    }
}

// ---- rows for programs ----

// @param time null: none
static void add_row( const merged* r, const sweep_row* row, int workers, const sweep_time* time )
{
    results_row* out = results_add_row( r->out, row->name, row->variant );
    if ( out == NULL )
    {
        return;
    }
    out->hash = row->hash;
    out->has_hash = row->failure[0] == '\0';
    snprintf( out->error_reference, sizeof out->error_reference, "%s", row->reference );
    for ( int v = 0; v < SWEEP_VALUE_COUNT; ++v )
    {
        if ( !isnan( row->values[v] ) )
        {
            results_put( &out->error, sweep_values[v].name, row->values[v] );
        }
    }
    if ( row->vertices > 0 )
    {
        results_put( &out->size, "strands", row->strands );
        results_put( &out->size, "vertices", row->vertices );
        results_put( &out->size, "substeps", row->substeps );
    }
    if ( row->until > 0.0 && isfinite( row->doubt ) )
    {
        results_put( &out->error, "doubt_mm", 1e3 * row->doubt );
        results_put( &out->error, "until_s", row->until );
    }
    if ( time != NULL )
    {
        out->workers = workers;
        out->steps = row->steps;
        out->ms_median = time->median;
        out->ms_p10 = time->p10;
        out->ms_p90 = time->p90;
    }
}

// A row for each number of workers that was timed.
static void add_rows( const merged* r, const sweep_row* row )
{
    const bool is_timed = row->workers > 0 && !r->has_processors;
    add_row( r, row, 1, is_timed ? &row->alone : NULL );
    if ( is_timed && row->workers > 1 )
    {
        add_row( r, row, row->workers, &row->together );
    }
}

// ---- what is said of all ----

static void add_failures( const merged* r )
{
    int failures = 0, unexpected = 0;
    suite_horizon horizon = { 0 };
    for ( int i = 0; i < r->count; ++i )
    {
        const sweep_row* row = r->rows + i;
        const bool fails = row->failure[0] != '\0', breaks = row->verdict[0] != '\0' && !row->is_known;
        failures += fails ? 1 : 0;
        unexpected += breaks ? 1 : 0;
        suite_horizon_add( &horizon, row->until,
                           !isnan( row->values[SWEEP_LATE_HEIGHT] ) || !isnan( row->values[SWEEP_LATE_HEIGHT + 2] ) );
        if ( ( fails || breaks ) && failures + unexpected <= MAX_FAILURES )
        {
            results_add_failure( r->out, "%s%s%s: %s", row->name, row->variant[0] ? ", " : "", row->variant,
                                 fails ? row->failure : row->verdict );
        }
    }
    if ( failures + unexpected > MAX_FAILURES )
    {
        results_add_failure( r->out, "and %d more", failures + unexpected - MAX_FAILURES );
    }
    char line[200], until[100];
    suite_horizon_text( &horizon, until, sizeof until );
    snprintf( line, sizeof line, "%s: %d item%s", r->like->suite, r->count, r->count == 1 ? "" : "s" );
    results_append_count( line, sizeof line, failures, "could not be run" );
    results_append_count( line, sizeof line, unexpected, "not as expected" );
    results_add_headline( r->out, "%s%s", line, until );
}

static void add_notes( const merged* r )
{
    const sweep_row* like = r->like;
    if ( like->reference[0] != '\0' )
    {
        results_add_note( r->out, "errors are root mean square distances to %s", like->reference );
    }
}

static void report_merged( const sweep_merge* merge, results* out )
{
    const merged r = { .rows = merge->rows,
                       .like = &merge->like,
                       .count = merge->like.items,
                       .has_processors = has_several_processors( merge->rows, merge->like.items ),
                       .out = out };
    add_failures( &r );
    for ( int i = 0; i < r.count; ++i )
    {
        bool is_first = true;
        for ( int k = i - 1; k >= 0 && is_first; --k )
        {
            is_first = !is_of( r.rows + k, r.rows[i].name );
        }
        if ( is_first )
        {
            add_table( &r, r.rows[i].name );
            add_chart( &r, r.rows[i].name );
        }
        add_rows( &r, r.rows + i );
    }
    add_orders( &r );
    add_notes( &r );
}

// ---- the command ----

typedef struct merge_arguments
{
    const char* folder;
    bench_files files;
} merge_arguments;

static const option_row merge_rows[] = {
    BENCH_FILE_ROWS( merge_arguments ),
};

const command_text merge_text = {
    .name = "merge",
    .operands = "FOLDER",
    .noun = "folder",
    .summary = "make one result of the parts of a sweep",
    .about = "Make one result of the parts that 'wisp sweep' has written to a folder.",
    .notes = "Nothing is merged if a part or a row is missing, if parts are of different suites or versions, or if\n"
             "two runs of a row have different bits. Errors come from any machine. Times come from runs with\n"
             "--exclusive alone; where they are of several processors, a column names these.",
    .examples = "wisp merge results\n"
                "wisp merge results --report sweep.html --format csv -o sweep.csv",
    .unmet = "a row could not be run, or breaks a check that it should not",
    .rows = merge_rows,
    .row_count = WISP_COUNT( merge_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, merge_arguments, folder, "/" ),
};

static void check_merge_options( const options_state* o )
{
    bench_check_names( o, &( (const merge_arguments*)o->input )->files );
}

// The machine of all rows, or that there are several.
static void describe_machines( sweep_merge* merge, results* out )
{
    sweep_row* all = &merge->like;
    sweep_row_take_times( all, merge->rows );
    for ( int i = 1; i < all->items; ++i )
    {
        sweep_row_join_machines( all, merge->rows + i );
    }
    out->machine = all->machine;
    snprintf( out->machine.host, sizeof out->machine.host, "unknown" );
}

int command_merge( int argc, char** argv )
{
    merge_arguments a = { .folder = NULL };
    options_parse( &merge_text, check_merge_options, &a, argc, argv );
    results out = { .is_result_first = true };
    sweep_merge merge;
    wisp_error error = { 0 };
    wisp_status status = sweep_merge_folder( a.folder, &merge, &error );
    status = status == WISP_OK ? bench_check_files( &a.files, &error ) : status;
    if ( status == WISP_OK )
    {
        describe_machines( &merge, &out );
        report_merged( &merge, &out );
        if ( merge.run_twice > 0 )
        {
            fprintf( stderr, "%d item%s run by two shards, with the same bits\n", merge.run_twice,
                     merge.run_twice == 1 ? " was" : "s were" );
        }
        const report_run page = { .what = merge.like.suite, .how = "wisp sweep" };
        status = bench_write_files( &a.files, &page, &out, &error );
    }
    const bool failed = out.failed;
    results_free( &out );
    sweep_merge_release( &merge );
    return status != WISP_OK ? command_fail( &error ) : failed ? STATUS_UNMET : STATUS_GOOD;
}
