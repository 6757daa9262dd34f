#include "bench_commands.h"

#include "accuracy/accuracy.h"
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

static const option_row accuracy_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "length", 0, "S", "Seconds of motion that are compared; default: all of the scene, at most 1",
      OPTION_NUMBER( accuracy_arguments, length, 1e6 ) },
    BENCH_SECONDS_ROW( accuracy_arguments, "Approximate time limit, without that of the converged run; default 30" ),
    BENCH_WORKERS_ROW( accuracy_arguments ),
    BENCH_QUICK_ROW( accuracy_arguments, "Fewer settings and samples" ),
    OPTION_TITLE( "Output:" ),
    BENCH_FILE_ROWS( accuracy_arguments ),
    { "suite", 0, "FILE", "Only write the suite that this would run, to be changed, run by 'wisp bench' and gated",
      OPTION_TEXT( accuracy_arguments, suite, ".yaml" ) },
};

const command_text accuracy_text = {
    .name = "accuracy",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "show what accuracy costs in a scene",
    .about = "Show what accuracy costs in a scene: error and time by substeps, iterations and solvers, the\n"
             "settings that no other beats, the fastest ones at equal error, the most accurate ones at equal\n"
             "time, and observed orders.",
    .notes = "Errors are distances to the same scene with so many substeps and iterations that it has\n"
             "converged. How far it has is printed; smaller errors are not resolved. That run is kept in\n"
             "$WISP_CACHE, or in ~/.cache/wisp, and is not made again. Only the first second of a scene is\n"
             "compared unless --length is given: motion becomes chaotic, and distances say nothing then.",
    .examples = "wisp accuracy scene.yaml\n"
                "wisp accuracy scene.yaml --length 0.5 --report accuracy.html\n"
                "wisp accuracy scene.yaml --suite suite.yaml",
    .unmet = "a check failed: two runs of one setting have other bits",
    .rows = accuracy_rows,
    .row_count = WISP_COUNT( accuracy_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, accuracy_arguments, scene, ".yaml .yml .json" ),
};

static void check_accuracy_options( const options_state* o )
{
    const accuracy_arguments* a = o->input;
    bench_check_names( o, &a->files );
    if ( a->suite && io_is_standard( a->scene ) )
    {
        options_fail( o, "--suite: expected a scene in a file, which the suite names" );
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
    options_parse( &accuracy_text, check_accuracy_options, &a, argc, argv );
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

static void choose_validation( const options_state* o, const char* argument )
{
    const char* names[MAX_CASES];
    const int count = list_names( names );
    ( (validate_arguments*)o->input )->chosen |= 1ull << option_word_of( o, argument, names, count );
}

static const option_row validate_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "list", 'l', NULL, "Print the cases", OPTION_FLAG( validate_arguments, only_list ) },
    BENCH_QUICK_ROW( validate_arguments, "Fewer settings and samples" ),
    BENCH_SECONDS_ROW( validate_arguments, "Approximate time limit per case, default 20" ),
    BENCH_WORKERS_ROW( validate_arguments ),
    OPTION_TITLE( "Output:" ),
    BENCH_FILE_ROWS( validate_arguments ),
};

const command_text validate_text = {
    .name = "validate",
    .operands = "[CASE...]",
    .noun = "CASE",
    .summary = "measure errors against theory, beside time",
    .about = "Measure errors against theory beside the time of a step, by every solver that can do a case: with\n"
             "which settings they converge, and to what. Without a CASE all cases run.",
    .notes = "Each case says what it tests, what it leaves out, its formula and its source. Errors are shown,\n"
             "whatever they are: docs/validation.md tells which are large, and why.",
    .examples = "wisp validate --report validation.html\n"
                "wisp validate cantilever column --quick",
    .unmet = "two runs of one setting have other bits",
    .rows = validate_rows,
    .row_count = WISP_COUNT( validate_rows ),
    .values = OPTION_TAKEN( choose_validation ),
};

static void check_validate_options( const options_state* o )
{
    bench_check_names( o, &( (const validate_arguments*)o->input )->files );
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
    options_parse( &validate_text, check_validate_options, &a, argc, argv );
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
