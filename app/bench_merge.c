// `wisp merge`: make one result of the parts of a sweep.
#include "bench_accuracy.h"
#include "bench_texts.h"

#include "io_file.h"
#include "report.h"
#include "sweep_merge.h"

#include <string.h>

typedef struct merge_arguments
{
    const char *folder, *output, *report;
    results_format format;
} merge_arguments;

static bool take( options_state* o, int key, const char* argument )
{
    merge_arguments* a = o->input;
    switch ( key )
    {
        case BENCH_KEY_FORMAT:
            a->format = (results_format)option_word( o, argument );
            return true;
        case BENCH_KEY_OUTPUT:
            a->output = argument;
            return true;
        case BENCH_KEY_REPORT:
            a->report = argument;
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &a->folder );
            if ( bench_writes_twice( a->report, a->output ) )
            {
                options_fail( o, "--report and --output both write to '%s'", a->report );
            }
            return true;
        default:
            return option_input( o, key, argument, &a->folder );
    }
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
    snprintf( m->host, sizeof m->host, "%s", first->host );
    snprintf( m->isa, sizeof m->isa, "%s", first->isa );
    for ( int i = 1; i < merge->part_count; ++i )
    {
        const sweep_header* h = &merge->parts[i].header;
        if ( strcmp( h->cpu, first->cpu ) != 0 || strcmp( h->isa, first->isa ) != 0 )
        {
            snprintf( m->cpu, sizeof m->cpu, "several processors" );
            snprintf( m->isa, sizeof m->isa, "several" );
        }
        if ( strcmp( h->os, first->os ) != 0 )
        {
            snprintf( m->os, sizeof m->os, "several systems" );
        }
    }
}

static wisp_status write_results( const merge_arguments* a, const sweep_merge* merge, const results* out,
                                  wisp_error* error )
{
    const report_run run = { .what = merge->parts[0].header.suite, .how = "wisp sweep" };
    wisp_error later = { 0 };
    const wisp_status reported = a->report != NULL ? report_write_file( out, &run, a->report, error ) : WISP_OK;
    const wisp_status written = results_write_file( out, a->format, a->output, reported == WISP_OK ? error : &later );
    return reported == WISP_OK ? written : reported;
}

int bench_merge( int argc, char** argv )
{
    merge_arguments a = { .folder = NULL };
    options_parse( &merge_text, take, &a, argc, argv );
    results out = { .is_result_first = true };
    sweep_merge merge;
    wisp_error error = { 0 };
    wisp_status status = sweep_merge_read( a.folder, &merge, &error );
    status = status == WISP_OK ? command_check_writable( a.output, &error ) : status;
    status = status == WISP_OK ? command_check_writable( a.report, &error ) : status;
    if ( status == WISP_OK )
    {
        describe_machines( &merge, &out );
        sweep_report( &merge, &out );
        if ( merge.run_twice > 0 )
        {
            fprintf( stderr, "%d item%s run by two shards, with the same bits\n", merge.run_twice,
                     merge.run_twice == 1 ? " was" : "s were" );
        }
        status = write_results( &a, &merge, &out, &error );
    }
    const bool failed = out.failed;
    results_free( &out );
    sweep_merge_release( &merge );
    return status != WISP_OK ? command_fail( &error ) : failed ? STATUS_UNMET : STATUS_GOOD;
}
