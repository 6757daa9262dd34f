#include "bench_commands.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "report.h"
#include "sweep_item.h"
#include "sweep_merge.h"
#include "wisp/wisp.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

// `wisp sweep`: run the rows of a suite, or a share of them, and keep what they give in a part file.

typedef struct sweep_arguments
{
    const char *suite, *folder;
    int shard, shards, workers;
    bool is_exclusive, only_list;
} sweep_arguments;

static void take_shard( const options_state* o, const char* argument )
{
    sweep_arguments* a = o->input;
    wisp_error error;
    if ( sweep_shard_parse( argument, &a->shard, &a->shards, &error ) != WISP_OK )
    {
        options_fail( o, "%s", error.message );
    }
}

static const option_row sweep_rows[] = {
    OPTION_TITLE( "What is run:" ),
    { "output", 'o', "FOLDER", "Folder of the parts, made if it is not there; required",
      OPTION_TEXT( sweep_arguments, folder, "/" ) },
    { "shard", 0, "K/N", "The share K of N, from 1/N to N/N; default: all", OPTION_TAKEN( take_shard ) },
    { "list", 'l', NULL, "Print the numbers, hashes and names of the items, and run none",
      OPTION_FLAG( sweep_arguments, only_list ) },
    OPTION_TITLE( "Times:" ),
    { "exclusive", 0, NULL, "Nothing else runs on this machine: measure times too",
      OPTION_FLAG( sweep_arguments, is_exclusive ) },
    { "workers", 'w', "N", "Time with one worker and with N, 1 to 64, default 1",
      OPTION_WHOLE( sweep_arguments, workers, 1, WISP_MAX_WORKERS ) },
};

const command_text sweep_text = {
    .name = "sweep",
    .operands = "SUITE",
    .noun = "suite",
    .summary = "run a suite in shares, on one or many machines",
    .about = "Run the rows of a suite, or a share of them, and keep the errors, hashes and measures of each in a\n"
             "part file. 'wisp merge' makes one result of all parts. docs/scaling.md shows how clusters run it.",
    .notes = "Rows go to shares by the hash of their settings; one in a hundred is run by two of them, and must\n"
             "have the same bits. A part gets a line for each row, so a process that is killed loses the row\n"
             "that it ran. The same command goes on: rows that are there are not run again.",
    .examples = "wisp sweep suite.yaml -o results\n"
                "wisp sweep suite.yaml -o results --shard 2/8\n"
                "sbatch --array=1-8 --wrap 'wisp sweep s.yaml -o out --shard $SLURM_ARRAY_TASK_ID/8'",
    .unmet = "a row could not be run, or breaks a check that it should not",
    .rows = sweep_rows,
    .row_count = WISP_COUNT( sweep_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, sweep_arguments, suite, ".yaml .yml .json" ),
};

static void check_sweep_options( const options_state* o )
{
    const sweep_arguments* a = o->input;
    if ( a->folder == NULL && a->only_list == false )
    {
        options_fail( o, "expected a folder for the part, such as -o results" );
    }
    if ( a->workers > 1 && a->is_exclusive == false )
    {
        options_fail( o, "--workers: only runs with --exclusive are timed" );
    }
}

static void list_items( const sweep_arguments* a, const wisp_suite* suite )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const uint64_t key = sweep_key( suite->rows + i );
        char label[SUITE_MAX_LABEL];
        if ( sweep_runs( key, a->shard, a->shards ) )
        {
            suite_label( suite->rows + i, label );
            printf( "%5d  %016llx  %s\n", i + 1, (unsigned long long)key, label );
        }
    }
}

// What all rows of this run have.
static void describe( const sweep_arguments* a, const wisp_suite* suite, const char* reference,
                      const machine_info* machine, sweep_row* out )
{
    *out = ( sweep_row ){ .sweep = sweep_suite_key( suite ),
                          .items = suite->row_count,
                          .shard = a->shard,
                          .shards = a->shards,
                          .machine = *machine };
    for ( int i = 0; i < suite->row_count; ++i )
    {
        out->share += sweep_runs( sweep_key( suite->rows + i ), a->shard, a->shards ) ? 1 : 0;
    }
    snprintf( out->suite, sizeof out->suite, "%s", suite->title[0] ? suite->title : suite->name );
    snprintf( out->reference, sizeof out->reference, "%s", reference );
}

// A part that rows are appended to.
typedef struct part
{
    char path[1024];
    FILE* stream;
} part;

// Read what a process before has written, and cut off the line in which it was stopped.
static wisp_status open_part( const char* folder, const sweep_row* like, part* out, sweep_merge* found,
                              wisp_error* error )
{
    size_t whole = 0;
    snprintf( out->path, sizeof out->path, "%.900s/part-%04d-of-%04d.jsonl", folder, like->shard, like->shards );
    out->stream = fopen( out->path, "a" );
    if ( out->stream == NULL )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_short_name( out->path ), strerror( errno ) );
    }
    // a file system without locks leaves it to the user that no two processes run one shard
    if ( flock( fileno( out->stream ), LOCK_EX | LOCK_NB ) != 0 && errno == EWOULDBLOCK )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: another process writes it", io_short_name( out->path ) );
    }
    const wisp_status status = sweep_merge_part( out->path, found, &whole, error );
    return status == WISP_OK && ftruncate( fileno( out->stream ), (off_t)whole ) != 0
               ? wisp_fail( error, WISP_IO_ERROR, "%s: cannot be cut: %s", io_short_name( out->path ),
                            strerror( errno ) )
               : status;
}

// From then on the line survives the end of this process.
static wisp_status append( const part* p, const sweep_row* row, wisp_error* error )
{
    char* line = sweep_row_write( row );
    const bool good =
        line != NULL && fputs( line, p->stream ) >= 0 && fputc( '\n', p->stream ) != EOF && fflush( p->stream ) == 0;
    free( line );
    return good ? WISP_OK
                : wisp_fail( error, WISP_IO_ERROR, "%s: cannot be written: %s", io_short_name( p->path ),
                             strerror( errno ) );
}

// An item with checks, or that could not be run, has no times.
static bool is_there( const sweep_row* row, int workers )
{
    return row->item > 0 && ( workers == 0 || row->workers > 0 || row->verdict[0] || row->failure[0] );
}

static wisp_status run_items( const sweep_settings* settings, const part* p, sweep_merge* all, int* found,
                              wisp_error* error )
{
    const wisp_suite* suite = settings->suite;
    const sweep_row* like = settings->like;
    wisp_status status = WISP_OK;
    int done = 0;
    progress bar = progress_begin();
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        char label[SUITE_MAX_LABEL];
        sweep_row row;
        const bool is_mine = sweep_runs( sweep_key( suite->rows + i ), like->shard, like->shards );
        *found += is_mine && is_there( all->rows + i, settings->workers ) ? 1 : 0;
        done += is_mine ? 1 : 0;
        if ( is_mine && !is_there( all->rows + i, settings->workers ) )
        {
            suite_label( suite->rows + i, label );
            progress_show( &bar, (double)( done - 1 ) / like->share, label );
            status = sweep_run_item( settings, i, &row, error );
            status = status == WISP_OK ? append( p, &row, error ) : status;
            status = status == WISP_OK ? sweep_merge_add( &row, "this run", all, error ) : status;
        }
    }
    progress_end( &bar );
    return status;
}

// @return whether an item could not be run, or is not as expected
static bool say( const sweep_row* like, const sweep_merge* all, int found )
{
    int failed = 0, unexpected = 0;
    char line[300];
    for ( int i = 0; i < like->items; ++i )
    {
        failed += all->rows[i].failure[0] != '\0' ? 1 : 0;
        unexpected += all->rows[i].verdict[0] != '\0' && !all->rows[i].is_known ? 1 : 0;
    }
    snprintf( line, sizeof line, "shard %d of %d: %d of %d item%s", like->shard, like->shards, all->count,
              like->share, like->share == 1 ? "" : "s" );
    results_append_count( line, sizeof line, found, "from before" );
    results_append_count( line, sizeof line, failed, "could not be run" );
    results_append_count( line, sizeof line, unexpected, "not as expected" );
    fprintf( stderr, "%s%s\n", line, all->count < like->share ? "; the same command goes on" : "" );
    return failed + unexpected > 0;
}

static wisp_status run_shard( const sweep_arguments* a, const wisp_suite* suite, bool* is_unmet, wisp_error* error )
{
    suite_twins twins = { 0 };
    suite_references references = { 0 };
    sweep_merge all = { 0 };
    sweep_row like;
    machine_info machine;
    part p = { .stream = NULL };
    wisp_status status = bench_describe_machine( &machine, error );
    status = status == WISP_OK ? io_folder_make( a->folder, error ) : status;
    status = status == WISP_OK ? suite_references_find( suite, &references, error ) : status;
    if ( status == WISP_OK )
    {
        describe( a, suite, references.description, &machine, &like );
        like.workers = a->is_exclusive ? a->workers : 0;
        status = sweep_merge_begin( &like, "what is to be run; choose another folder", &all, error );
        status = status == WISP_OK ? open_part( a->folder, &like, &p, &all, error ) : status;
    }
    if ( status == WISP_OK )
    {
        const sweep_settings settings = { suite, &references, &twins, &like, like.workers };
        int found = 0;
        like.workers = 0;
        status = run_items( &settings, &p, &all, &found, error );
        *is_unmet = say( &like, &all, found );
    }
    if ( p.stream != NULL )
    {
        fclose( p.stream );
    }
    sweep_merge_release( &all );
    suite_references_release( &references );
    suite_twins_release( &twins );
    return status;
}

int command_sweep( int argc, char** argv )
{
    sweep_arguments a = { .workers = 1, .shard = 1, .shards = 1 };
    options_parse( &sweep_text, check_sweep_options, &a, argc, argv );
    interruption_begin();
    wisp_error error = { 0 };
    wisp_suite suite = { .rows = NULL };
    bool is_unmet = false;
    wisp_status status = suite_read( a.suite, &suite, &error );
    if ( status == WISP_OK && suite.compares_overlap )
    {
        status = wisp_fail( &error, WISP_BAD_INPUT, "%s: errors by overlap are measured by `wisp bench` alone",
                            io_short_name( a.suite ) );
    }
    if ( status == WISP_OK && a.only_list )
    {
        list_items( &a, &suite );
    }
    else if ( status == WISP_OK )
    {
        status = run_shard( &a, &suite, &is_unmet, &error );
    }
    suite_release( &suite );
    return status != WISP_OK ? command_fail( &error ) : interruption_status( is_unmet ? STATUS_UNMET : STATUS_GOOD );
}
