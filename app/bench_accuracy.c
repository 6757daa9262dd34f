// `wisp accuracy`: what accuracy costs in a scene of the user's.
#include "bench_accuracy.h"

#include "commands.h"

#include "accuracy/accuracy.h"
#include "io_file.h"
#include "progress.h"
#include "report.h"
#include "suite_of_scene.h"
#include "wisp/wisp.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum
{
    KEY_SECONDS = 256,
    KEY_LENGTH,
    KEY_REPORT,
    KEY_SUITE,
};

static const char doc[] =
    "Show what accuracy costs in a scene: error and time by substeps, iterations and solvers, the settings that\n"
    "no other beats, the fastest ones at equal error, the most accurate ones at equal time, and observed orders.\n"
    "\v"
    "Errors are distances to the same scene with so many substeps and iterations that it has converged.\n"
    "How far it has is printed; smaller errors are not resolved. That run is kept in $WISP_CACHE, or in\n"
    "~/.cache/wisp, and is not made again. Only the first second of a scene is compared unless --length is given:\n"
    "motion becomes chaotic, and distances say nothing then.\n"
    "\n"
    "Examples:\n"
    "  wisp accuracy scene.yaml\n"
    "  wisp accuracy scene.yaml --length 0.5 --report accuracy.html\n"
    "  wisp accuracy scene.yaml --suite suite.yaml\n"
    "\n" STATUS_HELP_UNMET( "a check failed: two runs of one setting have other bits" );

static const struct argp_option option_list[] = {
    { 0, 0, 0, 0, "Measurement:", 1 },
    { "length", KEY_LENGTH, "S", 0, "Seconds of motion that are compared; default: all of the scene, at most 1", 1 },
    { "seconds", KEY_SECONDS, "S", 0, "Approximate time limit, without that of the converged run; default 30", 1 },
    { "workers", 'w', "N", 0, "Workers of the parallel variant, 1 to 64, default 2", 1 },
    { "quick", 'q', NULL, 0, "Fewer settings and samples", 1 },
    { 0, 0, 0, 0, "Output:", 2 },
    { "format", 'f', "FORMAT", 0, "text (default), markdown, csv, json, gbench, bencher, github or hyperfine", 2 },
    { "output", 'o', "FILE", 0, "Write the results to FILE; default: standard output", 2 },
    { "report", KEY_REPORT, "FILE", 0, "Also write an HTML page with charts", 2 },
    { "suite", KEY_SUITE, "FILE", 0,
      "Only write the suite that this would run, to be changed, run by `wisp bench` and gated", 2 },
    { 0 },
};

typedef struct accuracy_arguments
{
    bench_options options;
    results_format format;
    const char *scene, *output, *report, *suite;
    double length;
} accuracy_arguments;

static error_t parse( int key, char* argument, struct argp_state* state )
{
    accuracy_arguments* a = state->input;
    switch ( key )
    {
        case KEY_LENGTH:
            a->length = option_positive( state, "--length", argument, 1e6 );
            return 0;
        case KEY_SECONDS:
            a->options.seconds = option_positive( state, "--seconds", argument, 1e6 );
            return 0;
        case 'w':
            a->options.workers = option_whole( state, "--workers", argument, 1, WISP_MAX_WORKERS );
            return 0;
        case 'q':
            a->options.quick = true;
            return 0;
        case 'f':
            a->format = (results_format)option_word( state, "--format", argument, results_format_names,
                                                     RESULTS_FORMAT_COUNT );
            return 0;
        case 'o':
            a->output = argument;
            return 0;
        case KEY_REPORT:
            a->report = argument;
            return 0;
        case KEY_SUITE:
            a->suite = argument;
            return 0;
        default:
            return option_input( state, key, argument, "scene", &a->scene ) ? 0 : ARGP_ERR_UNKNOWN;
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
    return status;
}

static wisp_status write_results( const accuracy_arguments* a, const results* out, wisp_error* error )
{
    wisp_status status = results_write_file( out, a->format, a->output, error );
    if ( status == WISP_OK && a->report )
    {
        const report_run run = { .what = a->scene, .how = "wisp accuracy" };
        status = report_write_file( out, &run, a->report, error );
    }
    return status;
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
    const struct argp parser = { option_list, parse, "SCENE", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &a );
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
    return status != WISP_OK ? command_fail( &error ) : failed ? STATUS_UNMET : STATUS_GOOD;
}
