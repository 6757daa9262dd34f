// `wisp merge`: make one result of the parts of a sweep.
#include "bench_commands.h"
#include "bench_texts.h"

#include "io_file.h"
#include "report.h"
#include "sweep_merge.h"

#include <string.h>

typedef struct merge_arguments
{
    const char* folder;
    bench_files files;
} merge_arguments;

static bool take( options_state* o, int key, const char* argument )
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
    options_parse( &merge_text, take, &a, argc, argv );
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
