// `wisp bench`: its options, the cases in turn, the written files.
#include "bench_commands.h"

#include "accuracy/accuracy.h"
#include "bench.h"
#include "interruption.h"
#include "io_file.h"
#include "nearest.h"
#include "progress.h"
#include "report.h"
#include "wisp/module/definition.h"
#include "wisp/wisp.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---- what commands share ----

// Options that commands that measure share, and what they write: results, and a page.

void bench_check_names( const options_state* o, const bench_files* files )
{
    // without a file the results go to standard output
    if ( files->report != NULL && strcmp( files->report, files->output ? files->output : "-" ) == 0 )
    {
        options_fail( o, "--report and --output both write to '%s'", files->report );
    }
}

wisp_status bench_check_files( const bench_files* files, wisp_error* error )
{
    const wisp_status status = command_check_writable( files->output, error );
    return status == WISP_OK ? command_check_writable( files->report, error ) : status;
}

// An interruption before the first row leaves the files of an earlier run.
static bool may_write( const results* out, const char* path )
{
    return out->row_count > 0 || interruption_came() == false || path == NULL || access( path, F_OK ) != 0;
}

// The report first, since a reader of standard output may leave early; the results also if it fails.
wisp_status bench_write_files( const bench_files* files, const report_run* run, const results* out,
                               wisp_error* error )
{
    wisp_error later = { 0 };
    const wisp_status reported = files->report != NULL && may_write( out, files->report )
                                     ? report_write_file( out, run, files->report, error )
                                     : WISP_OK;
    const wisp_status written =
        may_write( out, files->output )
            ? results_write_file( out, files->format, files->output, reported == WISP_OK ? error : &later )
            : WISP_OK;
    return reported == WISP_OK ? written : reported;
}

static void show_progress( void* user, double fraction, const char* what )
{
    progress_show( user, fraction, what );
}

// The instruction set of the engine's kernels on this machine, from an empty world.
wisp_status bench_describe_machine( machine_info* out, wisp_error* error )
{
    wisp_world_def def = wisp_default_world_def();
    def.workers = 1;
    wisp_world* world;
    WISP_TRY( wisp_world_create( &def, &world, error ) );
    *out = machine_describe( wisp_world_isa( world ) );
    wisp_world_destroy( world );
    return WISP_OK;
}

int bench_measure( bench_options* options, const bench_files* files, bench_run_fn* run, void* arguments,
                   const char* unmet, int argc, char** argv )
{
    interruption_begin();
    results out = { 0 };
    results_put_options( &out, argc, argv );
    wisp_error error = { 0 };
    report_run page = { 0 };
    wisp_status status = bench_describe_machine( &out.machine, &error );
    status = status == WISP_OK ? bench_check_files( files, &error ) : status;
    if ( status == WISP_OK )
    {
        progress bar = progress_begin();
        options->progress = show_progress;
        options->progress_user = &bar;
        status = run( arguments, &out, &page, &error );
        progress_end( &bar );
    }
    // What was measured before the signal is written as usual.
    if ( status == WISP_CONFLICT && interruption_came() )
    {
        results_add_note( &out, "interrupted: what was not measured by then is missing" );
        status = WISP_OK;
    }
    status = status == WISP_OK && page.what ? bench_write_files( files, &page, &out, &error ) : status;
    const bool failed = out.failed;
    results_free( &out );
    if ( status != WISP_OK )
    {
        return command_fail( &error );
    }
    if ( failed && unmet )
    {
        fprintf( stderr, "%s\n", unmet );
    }
    return interruption_status( failed ? STATUS_UNMET : STATUS_GOOD );
}

#define CASES_MAX 64

typedef struct bench_arguments
{
    bench_options options;
    bench_files files;
    bench_case chosen[CASES_MAX]; ///< cases, and suites, which have no function
    int chosen_count;
    bool only_list;
    char what[1000], how[200]; ///< of the page
} bench_arguments;

// ---- the command line ----

// A suite is a file. Cases have neither a folder nor an extension.
static bool is_path( const char* word )
{
    return strchr( word, '/' ) != NULL || strchr( word, '.' ) != NULL || io_is_standard( word );
}

static void choose_case( const options_state* o, const char* word )
{
    bench_arguments* arguments = o->input;
    int count;
    const bench_case* cases = bench_cases( &count );
    const char* names[CASES_MAX];
    for ( int i = 0; i < count && i < CASES_MAX; ++i )
    {
        names[i] = cases[i].name;
    }
    if ( arguments->chosen_count == CASES_MAX )
    {
        options_fail( o, "no more than %d cases in one run", CASES_MAX );
    }
    arguments->chosen[arguments->chosen_count++] =
        is_path( word ) ? ( bench_case ){ .name = word }
                        : cases[option_word_of( o, word, names, count < CASES_MAX ? count : CASES_MAX )];
}

// An option of some cases is an error where none of them runs. Without a CASE all of them do.
// @param names the cases, separated by spaces @param told the same for the message
static void check_option( const options_state* o, const bench_arguments* arguments, const char* option,
                          const char* names, const char* told )
{
    bool runs = arguments->chosen_count == 0;
    for ( int i = 0; i < arguments->chosen_count; ++i )
    {
        char word[40];
        snprintf( word, sizeof( word ), " %s ", arguments->chosen[i].name );
        runs = runs || strstr( names, word ) != NULL;
    }
    if ( runs == false )
    {
        options_fail( o, "%s is an option of the %s, which does not run", option, told );
    }
}

static bool has_suite( const bench_arguments* arguments )
{
    bool has = false;
    for ( int i = 0; i < arguments->chosen_count; ++i )
    {
        has = has || arguments->chosen[i].run == NULL;
    }
    return has;
}

static void check_bench_options( const options_state* o )
{
    const bench_arguments* arguments = o->input;
    if ( arguments->options.longest && !has_suite( arguments ) )
    {
        check_option( o, arguments, "--long", " stability ", "case 'stability' and of suites" );
    }
    bench_check_names( o, &arguments->files );
}

#define BENCH_CASE( name, purpose, function ) name,
static const char* const case_names[] = {
#include "../bench/cases.inc"
};
#undef BENCH_CASE

static const option_row bench_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "list", 'l', NULL, "Print the cases and what each measures", OPTION_FLAG( bench_arguments, only_list ) },
    BENCH_QUICK_ROW( bench_arguments, "Fewer samples and no large sizes: 20 s per case, not 90" ),
    BENCH_SECONDS_ROW( bench_arguments, "Approximate time limit per case" ),
    BENCH_WORKERS_ROW( bench_arguments ),
    OPTION_TITLE( "Output:" ),
    BENCH_FILE_ROWS( bench_arguments ),
    OPTION_TITLE( "Options of single cases:" ),
    { "long", 0, NULL, "stability, suites: also rows that are long, such as a million steps at rest",
      OPTION_FLAG( bench_arguments, options.longest ) },
};

const command_text bench_text = {
    .name = "bench",
    .operands = "[CASE|SUITE...]",
    .noun = "CASE",
    .summary = "measure time and error together",
    .about = "Measure time, error and hash together. Without a CASE all cases run.\n"
             "A SUITE is a YAML file of scenes and settings: docs/suites.md has its format.",
    .notes = "A check fails if hashes differ between worker counts, if an error is above its\n"
             "tolerance, or if a hard case breaks. Its line begins with FAILED.",
    .examples = "wisp bench --list\n"
                "wisp bench cloth --quick --report cloth.html\n"
                "wisp bench suite.yaml",
    .unmet = "a check failed",
    .rows = bench_rows,
    .row_count = WISP_COUNT( bench_rows ),
    .values = { case_names, WISP_COUNT( case_names ), ".yaml", .to = { .take = choose_case } },
};

// ---- running ----

static int list_cases( void )
{
    int count;
    const bench_case* cases = bench_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        printf( "%-12s %s\n", cases[i].name, cases[i].purpose );
    }
    return STATUS_GOOD;
}

// The names of the cases, for readers.
static void name_cases( const bench_arguments* arguments, char* out, size_t size )
{
    size_t used = (size_t)snprintf( out, size, "%s", arguments->chosen_count == 0 ? "all cases" : "" );
    for ( int i = 0; i < arguments->chosen_count && used < size; ++i )
    {
        used += (size_t)snprintf( out + used, size - used, "%s%s", i > 0 ? ", " : "", arguments->chosen[i].name );
    }
}

static wisp_status run_cases( void* user, results* out, report_run* page, wisp_error* error )
{
    bench_arguments* arguments = user;
    bench_options* options = &arguments->options;
    name_cases( arguments, arguments->what, sizeof arguments->what );
    snprintf( arguments->how, sizeof arguments->how, "%sabout %g s per case, up to %d worker%s",
              options->quick ? "quick, " : "", bench_seconds( options ), options->workers,
              options->workers == 1 ? "" : "s" );
    *page = ( report_run ){ .what = arguments->what, .how = arguments->how };
    int count;
    const bench_case* cases = bench_cases( &count );
    for ( int i = 0; arguments->chosen_count == 0 && i < count && i < CASES_MAX; ++i )
    {
        arguments->chosen[i] = cases[i];
    }
    count = arguments->chosen_count > 0 ? arguments->chosen_count : count;
    for ( int i = 0; i < count; ++i )
    {
        const bench_case* chosen = arguments->chosen + i;
        progress_part( options->progress_user, (double)i / count, 1.0 / count );
        WISP_TRY( chosen->run ? chosen->run( options, out, error )
                              : suite_bench( chosen->name, options, out, error ) );
    }
    return WISP_OK;
}

int command_bench( int argc, char** argv )
{
    bench_arguments arguments = { .options = bench_default_options() };
    options_parse( &bench_text, check_bench_options, &arguments, argc, argv );
    return arguments.only_list
               ? list_cases()
               : bench_measure( &arguments.options, &arguments.files, run_cases, &arguments,
                                "wisp: a result is wrong; the lines that begin with FAILED say which.", argc, argv );
}
