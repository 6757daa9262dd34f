#include "bench_commands.h"

#include "accuracy/accuracy.h"
#include "io_file.h"
#include "report.h"
#include "suite.h"
#include "validate/validate.h"
#include "wisp/module/definition.h"
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
    wisp_status status = suite_parse( text, strlen( text ), a->scene, NULL, &suite, error );
    status = status == WISP_OK ? suite_bench_rows( &suite, &a->options, out, error ) : status;
    suite_release( &suite );
    return status;
}

static wisp_status run_accuracy( void* user, results* out, report_run* page, wisp_error* error )
{
    accuracy_arguments* a = user;
    out->is_result_first = true;
    // A suite that is kept may be in another folder than the scene; one that is not is as if it were beside it.
    char absolute[PATH_MAX];
    const char* file = a->suite == NULL                 ? io_file_name( a->scene )
                       : realpath( a->scene, absolute ) ? absolute
                                                        : a->scene;
    const suite_of_scene_def def = { .path = a->scene, .file = file, .length = a->length };
    char* text = NULL;
    WISP_TRY( suite_of_scene( &def, &text, error ) );
    *page = ( report_run ){ .what = a->suite ? NULL : io_input_name( a->scene ), .how = "wisp accuracy" };
    const wisp_status status =
        a->suite ? io_file_write( a->suite, text, strlen( text ), error ) : run_suite( a, text, out, error );
    free( text );
    return status;
}

int command_accuracy( int argc, char** argv )
{
    accuracy_arguments a = { .options = bench_default_options() };
    a.options.seconds = 30.0;
    options_parse( &accuracy_text, check_accuracy_options, &a, argc, argv );
    return bench_measure( &a.options, &a.files, run_accuracy, &a, NULL, argc, argv );
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
    char summary[600]; ///< of the page
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

static wisp_status run_validation( void* user, results* out, report_run* page, wisp_error* error )
{
    validate_arguments* a = user;
    out->is_result_first = true;
    *page = ( report_run ){ .what = "validation", .how = "wisp validate", .errors = a->summary };
    return validate_run( a->chosen, &a->options, out, a->summary, sizeof a->summary, error );
}

int command_validate( int argc, char** argv )
{
    validate_arguments a = { .options = bench_default_options() };
    options_parse( &validate_text, check_validate_options, &a, argc, argv );
    return a.only_list ? list_validations()
                       : bench_measure( &a.options, &a.files, run_validation, &a, NULL, argc, argv );
}
