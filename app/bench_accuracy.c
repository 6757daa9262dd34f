// `wisp accuracy`: what accuracy costs in a scene of the user's.
#include "bench_accuracy.h"

#include "bench_texts.h"

#include "accuracy/accuracy.h"
#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "report.h"
#include "suite_of_scene.h"
#include "wisp/wisp.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

typedef struct accuracy_arguments
{
    bench_options options;
    results_format format;
    const char *scene, *output, *report, *suite;
    double length;
} accuracy_arguments;

static bool take( options_state* o, int key, const char* argument )
{
    accuracy_arguments* a = o->input;
    switch ( key )
    {
        case BENCH_KEY_LENGTH:
            a->length = option_positive( o, argument, 1e6 );
            return true;
        case BENCH_KEY_SECONDS:
            a->options.seconds = option_positive( o, argument, 1e6 );
            return true;
        case BENCH_KEY_WORKERS:
            a->options.workers = option_whole( o, argument, 1, WISP_MAX_WORKERS );
            return true;
        case BENCH_KEY_QUICK:
            a->options.quick = true;
            return true;
        case BENCH_KEY_FORMAT:
            a->format = (results_format)option_word( o, argument );
            return true;
        case BENCH_KEY_OUTPUT:
            a->output = argument;
            return true;
        case BENCH_KEY_REPORT:
            a->report = argument;
            return true;
        case BENCH_KEY_SUITE:
            a->suite = argument;
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &a->scene );
            if ( bench_writes_twice( a->report, a->output ) )
            {
                options_fail( o, "--report and --output both write to '%s'", a->report );
            }
            if ( a->suite && io_is_standard( a->scene ) )
            {
                options_fail( o, "--suite: expected a scene in a file, which the suite names" );
            }
            return true;
        default:
            return option_input( o, key, argument, &a->scene );
    }
}

static void show_progress( void* user, double fraction, const char* what )
{
    progress_show( user, fraction, what );
}

static wisp_status write_text( const char* text, const char* path, wisp_error* error )
{
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    if ( status == WISP_OK )
    {
        fputs( text, output.stream );
        status = io_output_commit( &output, error );
    }
    return status;
}

static wisp_status run_suite( accuracy_arguments* a, const char* text, results* out, wisp_error* error )
{
    wisp_suite suite;
    progress bar = progress_begin();
    a->options.progress = show_progress;
    a->options.progress_user = &bar;
    wisp_status status = suite_parse( text, strlen( text ), a->scene, &suite, error );
    status = status == WISP_OK ? suite_bench_rows( &suite, &a->options, out, error ) : status;
    progress_end( &bar );
    suite_release( &suite );
    return bench_keep_interrupted( out, status );
}

static wisp_status write_results( const accuracy_arguments* a, const results* out, wisp_error* error )
{
    const report_run run = { .what = io_input_name( a->scene ), .how = "wisp accuracy" };
    wisp_error later = { 0 };
    const wisp_status reported = a->report ? report_write_file( out, &run, a->report, error ) : WISP_OK;
    const wisp_status written = results_write_file( out, a->format, a->output, reported == WISP_OK ? error : &later );
    return reported == WISP_OK ? written : reported;
}

static wisp_status check_files( const accuracy_arguments* a, wisp_error* error )
{
    wisp_status status = command_check_writable( a->output, error );
    status = status == WISP_OK ? command_check_writable( a->report, error ) : status;
    return status == WISP_OK ? command_check_writable( a->suite, error ) : status;
}

int bench_accuracy( int argc, char** argv )
{
    accuracy_arguments a = { .options = bench_default_options() };
    a.options.seconds = 30.0;
    options_parse( &accuracy_text, take, &a, argc, argv );
    interruption_begin();
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_error error = { 0 };
    // A suite that is kept may be in another folder than the scene; one that is not is as if it were beside it.
    char absolute[PATH_MAX];
    const char* slash = strrchr( a.scene, '/' );
    const char* file = a.suite == NULL                 ? ( slash ? slash + 1 : a.scene )
                       : realpath( a.scene, absolute ) ? absolute
                                                       : a.scene;
    const suite_of_scene_def def = { a.scene, file, a.length, 2.0 * a.options.seconds };
    char* text = NULL;
    wisp_status status = bench_describe_machine( &out.machine, &error );
    status = status == WISP_OK ? check_files( &a, &error ) : status;
    status = status == WISP_OK ? suite_of_scene( &def, &text, &error ) : status;
    if ( status == WISP_OK && a.suite )
    {
        status = write_text( text, a.suite, &error );
    }
    else if ( status == WISP_OK )
    {
        status = run_suite( &a, text, &out, &error );
        status = status == WISP_OK ? write_results( &a, &out, &error ) : status;
    }
    const bool failed = out.failed;
    results_free( &out );
    free( text );
    return status != WISP_OK ? command_fail( &error ) : interruption_status( failed ? STATUS_UNMET : STATUS_GOOD );
}
