#include "bench_commands.h"

#include "accuracy/accuracy.h"
#include "bench_texts.h"
#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "report.h"
#include "suite.h"
#include "validate/validate.h"
#include "wisp/wisp.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

// ---- `wisp accuracy` ----

// `wisp accuracy`: what accuracy costs in a scene of the user's.

typedef struct accuracy_arguments
{
    bench_options options;
    bench_files files;
    const char *scene, *suite;
    double length;
} accuracy_arguments;

static bool take_accuracy_option( options_state* o, int key, const char* argument )
{
    accuracy_arguments* a = o->input;
    switch ( key )
    {
        case BENCH_KEY_LENGTH:
            a->length = option_positive( o, argument, 1e6 );
            return true;
        case BENCH_KEY_SUITE:
            a->suite = argument;
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &a->scene );
            bench_take_file( o, key, argument, &a->files );
            if ( a->suite && io_is_standard( a->scene ) )
            {
                options_fail( o, "--suite: expected a scene in a file, which the suite names" );
            }
            return true;
        default:
            return bench_take_measurement( o, key, argument, &a->options ) ||
                   bench_take_file( o, key, argument, &a->files ) || option_input( o, key, argument, &a->scene );
    }
}

static wisp_status run_suite( accuracy_arguments* a, const char* text, results* out, wisp_error* error )
{
    wisp_suite suite;
    progress bar = progress_begin();
    a->options.progress = bench_show_progress;
    a->options.progress_user = &bar;
    wisp_status status = suite_parse( text, strlen( text ), a->scene, NULL, &suite, error );
    status = status == WISP_OK ? suite_bench_rows( &suite, &a->options, out, error ) : status;
    progress_end( &bar );
    suite_release( &suite );
    return bench_keep_interrupted( out, status );
}

int command_accuracy( int argc, char** argv )
{
    accuracy_arguments a = { .options = bench_default_options() };
    a.options.seconds = 30.0;
    options_parse( &accuracy_text, take_accuracy_option, &a, argc, argv );
    interruption_begin();
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_error error = { 0 };
    // A suite that is kept may be in another folder than the scene; one that is not is as if it were beside it.
    char absolute[PATH_MAX];
    const char* file = a.suite == NULL ? io_file_name( a.scene ) : realpath( a.scene, absolute ) ? absolute : a.scene;
    const suite_of_scene_def def = { .path = a.scene, .file = file, .length = a.length };
    char* text = NULL;
    wisp_status status = bench_describe_machine( &out.machine, &error );
    status = status == WISP_OK ? bench_check_files( &a.files, &error ) : status;
    status = status == WISP_OK ? suite_of_scene( &def, &text, &error ) : status;
    if ( status == WISP_OK && a.suite )
    {
        status = io_file_write( a.suite, text, strlen( text ), &error );
    }
    else if ( status == WISP_OK )
    {
        status = run_suite( &a, text, &out, &error );
        const report_run page = { .what = io_input_name( a.scene ), .how = "wisp accuracy" };
        status = status == WISP_OK ? bench_write_files( &a.files, &page, &out, &error ) : status;
    }
    const bool failed = out.failed;
    results_free( &out );
    free( text );
    return status != WISP_OK ? command_fail( &error ) : interruption_status( failed ? STATUS_UNMET : STATUS_GOOD );
}

// ---- `wisp validate` ----

// `wisp validate`: what theory and measurements say of it, by every solver that can do it.

enum
{
    MAX_CASES = 64,
};

typedef struct validate_arguments
{
    bench_options options;
    bench_files files;
    uint64_t chosen;
    bool only_list;
} validate_arguments;

static int list_names( const char* names[MAX_CASES] )
{
    int count;
    const validate_case* const* cases = validate_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        names[i] = cases[i]->name;
    }
    return count;
}

static bool take_validate_option( options_state* o, int key, const char* argument )
{
    validate_arguments* a = o->input;
    const char* names[MAX_CASES];
    switch ( key )
    {
        case BENCH_KEY_LIST:
            a->only_list = true;
            return true;
        case OPTIONS_OPERAND:
        {
            const int count = list_names( names );
            a->chosen |= 1ull << option_word_of( o, argument, names, count );
            return true;
        }
        default:
            return bench_take_measurement( o, key, argument, &a->options ) ||
                   bench_take_file( o, key, argument, &a->files );
    }
}

static int list_validations( void )
{
    int count;
    const validate_case* const* cases = validate_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        printf( "%-18s %s\n", cases[i]->name, cases[i]->title );
    }
    return STATUS_GOOD;
}

static wisp_status run_validation( validate_arguments* a, results* out, char* summary, size_t size,
                                   wisp_error* error )
{
    progress bar = progress_begin();
    a->options.progress = bench_show_progress;
    a->options.progress_user = &bar;
    const wisp_status status = validate_run( a->chosen, &a->options, out, summary, size, error );
    progress_end( &bar );
    return bench_keep_interrupted( out, status );
}

int command_validate( int argc, char** argv )
{
    validate_arguments a = { .options = bench_default_options() };
    options_parse( &validate_text, take_validate_option, &a, argc, argv );
    if ( a.only_list )
    {
        return list_validations();
    }
    interruption_begin();
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_error error = { 0 };
    wisp_status status = bench_describe_machine( &out.machine, &error );
    status = status == WISP_OK ? bench_check_files( &a.files, &error ) : status;
    char summary[600] = "";
    status = status == WISP_OK ? run_validation( &a, &out, summary, sizeof summary, &error ) : status;
    const report_run page = { .what = "validation", .how = "wisp validate", .errors = summary };
    status = status == WISP_OK ? bench_write_files( &a.files, &page, &out, &error ) : status;
    const bool failed = out.failed;
    results_free( &out );
    return status != WISP_OK ? command_fail( &error ) : interruption_status( failed ? STATUS_UNMET : STATUS_GOOD );
}
