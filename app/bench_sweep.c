#include "bench_commands.h"

#include "bench_texts.h"
#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "report.h"
#include "sweep_item.h"
#include "sweep_merge.h"
#include "sweep_part.h"
#include "wisp/wisp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- `wisp sweep` ----

// `wisp sweep`: run the rows of a suite, or a share of them, and keep what they give in a part file.

typedef struct sweep_arguments
{
    const char *suite, *folder, *shard;
    int workers;
    bool resumes, is_exclusive, only_list;
} sweep_arguments;

static bool take_sweep_option( options_state* o, int key, const char* argument )
{
    sweep_arguments* a = o->input;
    switch ( key )
    {
        case BENCH_KEY_OUTPUT:
            a->folder = argument;
            return true;
        case BENCH_KEY_SHARD:
            a->shard = argument;
            return true;
        case BENCH_KEY_RESUME:
            a->resumes = true;
            return true;
        case BENCH_KEY_EXCLUSIVE:
            a->is_exclusive = true;
            return true;
        case BENCH_KEY_WORKERS:
            a->workers = option_whole( o, argument, 1, WISP_MAX_WORKERS );
            return true;
        case BENCH_KEY_LIST:
            a->only_list = true;
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &a->suite );
            if ( a->folder == NULL && a->only_list == false )
            {
                options_fail( o, "expected a folder for the part, such as -o results" );
            }
            if ( a->workers > 1 && a->is_exclusive == false )
            {
                options_fail( o, "--workers: only runs with --exclusive are timed" );
            }
            return true;
        default:
            return option_input( o, key, argument, &a->suite );
    }
}

static int count_items( const wisp_suite* suite, const sweep_shard* shard )
{
    int count = 0;
    for ( int i = 0; i < suite->row_count; ++i )
    {
        count += sweep_runs( shard, sweep_key( suite->rows + i ) ) ? 1 : 0;
    }
    return count;
}

static void list_items( const wisp_suite* suite, const sweep_shard* shard )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const uint64_t key = sweep_key( suite->rows + i );
        char label[SUITE_MAX_LABEL];
        if ( sweep_runs( shard, key ) )
        {
            suite_label( suite->rows + i, label );
            printf( "%5d  %016llx  %s\n", i + 1, (unsigned long long)key, label );
        }
    }
}

static void describe( const sweep_arguments* a, const wisp_suite* suite, const sweep_shard* shard,
                      const suite_reference* reference, sweep_header* out )
{
    snprintf( out->suite, sizeof out->suite, "%s", suite->name );
    snprintf( out->title, sizeof out->title, "%s", suite->title );
    snprintf( out->reference, sizeof out->reference, "%s",
              reference->is_start ? "where every vertex starts" : reference->description );
    out->key = sweep_suite_key( suite );
    out->items = suite->row_count;
    out->shard = shard->index;
    out->shards = shard->count;
    out->is_exclusive = a->is_exclusive;
    out->workers = a->is_exclusive ? a->workers : 0;
    out->doubt = reference->doubt.distance;
    out->parts_at = reference->parts_at;
}

// What a run of a shard has done.
typedef struct tally
{
    int items, found, run, failed, unexpected;
} tally;

static void add_to( tally* t, const sweep_record* record )
{
    t->failed += record->failure[0] != '\0' ? 1 : 0;
    t->unexpected += record->verdict[0] != '\0' && record->is_known == false ? 1 : 0;
}

static wisp_status run_items( const sweep_settings* settings, const sweep_shard* shard, const sweep_part* found,
                              sweep_writer* writer, tally* t, wisp_error* error )
{
    const wisp_suite* suite = settings->suite;
    bool* is_there = calloc( (size_t)suite->row_count, sizeof *is_there );
    wisp_status status = is_there != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for items" );
    for ( int i = 0; i < found->count && status == WISP_OK; ++i )
    {
        is_there[found->records[i].item] = true;
        add_to( t, found->records + i );
    }
    progress bar = progress_begin();
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        char label[SUITE_MAX_LABEL];
        if ( is_there[i] || sweep_runs( shard, sweep_key( suite->rows + i ) ) == false )
        {
            continue;
        }
        suite_label( suite->rows + i, label );
        progress_show( &bar, (double)( t->found + t->run ) / t->items, label );
        sweep_record record;
        status = sweep_run_item( settings, i, &record, error );
        status = status == WISP_OK ? sweep_writer_add( writer, &record, error ) : status;
        if ( status == WISP_OK )
        {
            t->run += 1;
            add_to( t, &record );
        }
    }
    progress_end( &bar );
    free( is_there );
    return status;
}

static void say( const sweep_shard* shard, const tally* t, bool is_whole )
{
    char line[300];
    snprintf( line, sizeof line, "shard %d of %d: %d of %d item%s", shard->index + 1, shard->count, t->found + t->run,
              t->items, t->items == 1 ? "" : "s" );
    results_append_count( line, sizeof line, t->found, "from before" );
    results_append_count( line, sizeof line, t->failed, "could not be run" );
    results_append_count( line, sizeof line, t->unexpected, "not as expected" );
    fprintf( stderr, "%s%s\n", line, is_whole ? "" : "; --resume goes on" );
}

// @param status WISP_OK the suite was read
static wisp_status run_shard( const sweep_arguments* a, const wisp_suite* suite, const sweep_shard* shard, tally* t,
                              wisp_error* error )
{
    suite_twins twins = { 0 };
    suite_reference reference = { 0 };
    sweep_part found = { 0 };
    sweep_header header = { 0 };
    machine_info machine;
    sweep_writer writer = { .file = -1 };
    wisp_status status = bench_describe_machine( &machine, error );
    status = status == WISP_OK ? io_folder_make( a->folder, error ) : status;
    status = status == WISP_OK ? suite_reference_make( suite, &reference, error ) : status;
    if ( status == WISP_OK )
    {
        sweep_describe_machine( machine.isa, &header );
        describe( a, suite, shard, &reference, &header );
        status = sweep_writer_open( a->folder, &header, a->resumes, &writer, &found, error );
    }
    t->items = count_items( suite, shard );
    t->found = found.count;
    if ( status == WISP_OK && writer.is_done && t->found < t->items )
    {
        status = wisp_fail( error, WISP_BAD_INPUT,
                            "%s: lacks %d of the %d items of its shard; remove it to run them again",
                            io_short_name( writer.done ), t->items - t->found, t->items );
    }
    if ( status == WISP_OK )
    {
        const sweep_settings settings = { suite, &reference, &twins, a->is_exclusive ? a->workers : 0 };
        status = run_items( &settings, shard, &found, &writer, t, error );
        const bool is_whole = status == WISP_OK;
        status = is_whole && writer.is_done == false ? sweep_writer_finish( &writer, error ) : status;
        say( shard, t, is_whole );
    }
    sweep_writer_close( &writer );
    sweep_part_release( &found );
    suite_reference_release( &reference );
    suite_twins_release( &twins );
    return status;
}

int bench_sweep( int argc, char** argv )
{
    sweep_arguments a = { .workers = 1 };
    options_parse( &sweep_text, take_sweep_option, &a, argc, argv );
    interruption_begin();
    wisp_error error = { 0 };
    wisp_suite suite = { .rows = NULL };
    sweep_shard shard = { 0, 1 };
    tally t = { 0 };
    wisp_status status = a.shard ? sweep_shard_parse( a.shard, &shard, &error ) : WISP_OK;
    status = status == WISP_OK ? suite_read( a.suite, &suite, &error ) : status;
    if ( status == WISP_OK && suite.compares_overlap )
    {
        status = wisp_fail( &error, WISP_BAD_INPUT, "%s: errors by overlap are measured by `wisp bench` alone",
                            io_short_name( a.suite ) );
    }
    if ( status == WISP_OK && a.only_list )
    {
        list_items( &suite, &shard );
    }
    else if ( status == WISP_OK )
    {
        status = run_shard( &a, &suite, &shard, &t, &error );
    }
    suite_release( &suite );
    return status != WISP_OK ? command_fail( &error )
                             : interruption_status( t.failed + t.unexpected > 0 ? STATUS_UNMET : STATUS_GOOD );
}

// ---- `wisp merge` ----

// `wisp merge`: make one result of the parts of a sweep.

typedef struct merge_arguments
{
    const char* folder;
    bench_files files;
} merge_arguments;

static bool take_merge_option( options_state* o, int key, const char* argument )
{
    merge_arguments* a = o->input;
    const bool is_file = bench_take_file( o, key, argument, &a->files );
    return key == OPTIONS_END || is_file == false ? option_input( o, key, argument, &a->folder ) : true;
}

// The machine of all parts, or that there are several.
static void describe_machines( const sweep_merge* merge, results* out )
{
    const sweep_header* first = &merge->parts[0].header;
    machine_info* m = &out->machine;
    *m = ( machine_info ){
        .cores = first->cores,
        .memory_bytes = first->memory_bytes,
        .version = first->version,
        .commit = first->commit,
        .compiler = first->compiler,
        .flags = first->flags,
        .build_type = first->build_type,
    };
    snprintf( m->cpu, sizeof m->cpu, "%s", first->cpu );
    snprintf( m->os, sizeof m->os, "%s", first->os );
    snprintf( m->host, sizeof m->host, "unknown" );
    snprintf( m->isa, sizeof m->isa, "%s", first->isa );
    bool is_one = true, is_build = true;
    for ( int i = 1; i < merge->part_count; ++i )
    {
        const sweep_header* h = &merge->parts[i].header;
        is_one = is_one && strcmp( h->cpu, first->cpu ) == 0 && strcmp( h->isa, first->isa ) == 0 &&
                 strcmp( h->os, first->os ) == 0 && h->cores == first->cores &&
                 h->memory_bytes == first->memory_bytes;
        is_build = is_build && strcmp( h->compiler, first->compiler ) == 0 && strcmp( h->flags, first->flags ) == 0 &&
                   strcmp( h->build_type, first->build_type ) == 0;
    }
    if ( is_one == false )
    {
        snprintf( m->cpu, sizeof m->cpu, "several machines" );
        snprintf( m->isa, sizeof m->isa, "several" );
        snprintf( m->os, sizeof m->os, "several" );
        m->cores = 0;
        m->memory_bytes = 0.0;
    }
    if ( is_build == false )
    {
        m->compiler = m->flags = m->build_type = "several";
    }
}

int bench_merge( int argc, char** argv )
{
    merge_arguments a = { .folder = NULL };
    options_parse( &merge_text, take_merge_option, &a, argc, argv );
    results out = { .is_result_first = true };
    sweep_merge merge;
    wisp_error error = { 0 };
    wisp_status status = sweep_merge_read( a.folder, &merge, &error );
    status = status == WISP_OK ? bench_check_files( &a.files, &error ) : status;
    if ( status == WISP_OK )
    {
        describe_machines( &merge, &out );
        sweep_report( &merge, &out );
        if ( merge.run_twice > 0 )
        {
            fprintf( stderr, "%d item%s run by two shards, with the same bits\n", merge.run_twice,
                     merge.run_twice == 1 ? " was" : "s were" );
        }
        const report_run page = { .what = merge.parts[0].header.suite, .how = "wisp sweep" };
        status = bench_write_files( &a.files, &page, &out, &error );
    }
    const bool failed = out.failed;
    results_free( &out );
    sweep_merge_release( &merge );
    return status != WISP_OK ? command_fail( &error ) : failed ? STATUS_UNMET : STATUS_GOOD;
}
