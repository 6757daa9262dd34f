#include "bench_commands.h"

#include "gate_check.h"
#include "gate_paired.h"
#include "interruption.h"
#include "io_file.h"
#include "machine.h"
#include "progress.h"
#include "suite_measure.h"
#include "suite_motion.h"
#include "text_tree.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum gate_action
{
    ACTION_RECORD,
    ACTION_CHECK,
    ACTION_ACCEPT,
    ACTION_STEP,
    ACTION_SELF_TEST,
} gate_action;

typedef struct gate_options
{
    bool has_action;
    gate_action action;
    const char *suite, *base, *output, *isa, *reason, *junit, *html, *patch, *paired;
    bool no_instructions, lacks_instructions, has_cycles, is_strict, tells_github, takes_turns;
    int steps, row, trials;
    gate_slow slow; // step: by how much it is slowed down
    double patience;
    results_format format;
    int argc;
    char** argv;
} gate_options;

static void take_gate_operand( const options_state* p, const char* argument )
{
    gate_options* o = p->input;
    if ( o->suite )
    {
        options_fail( p, "got a second suite '%s', expected one", argument );
    }
    if ( o->has_action && strcmp( argument, "-" ) == 0 )
    {
        options_fail( p, "suite: got '-', expected a file: other processes read it too" );
    }
    if ( o->has_action )
    {
        o->suite = argument;
        return;
    }
    o->has_action = true;
    o->action = (gate_action)option_word( p, argument );
}

static const char* const action_words[] = { "record", "check", "accept", "step", "self-test" };

static const option_row gate_rows[] = {
    OPTION_TITLE( "Files:" ),
    { "base", 'b', "FILE", "The base file, default SUITE-base.json beside the suite",
      OPTION_TEXT( gate_options, base, ".json" ) },
    { "output", 'o', "FILE", "The results; record, accept: the base file, as --base",
      OPTION_TEXT( gate_options, output, ".json" ) },
    OPTION_TITLE( "Measuring:" ),
    { "no-instructions", 0, NULL, "Do not count instructions, for which valgrind is needed",
      OPTION_FLAG( gate_options, no_instructions ) },
    { "cycles", 0, NULL, "record, accept: estimate cycles too, with a model of caches; three times as slow",
      OPTION_FLAG( gate_options, has_cycles ) },
    { "isa", 0, "SET", "Kernels: baseline, avx2 or avx512; default: the best, whose bits are the same",
      OPTION_NAME( gate_options, isa, option_isa_words ) },
    { "steps", 0, "N", "Measure the first N steps of each row", OPTION_WHOLE( gate_options, steps, 1, INT_MAX ) },
    { "row", 0, "N", "step, self-test: number of the row, counted from 0",
      OPTION_WHOLE( gate_options, row, 0, SUITE_MAX_ROWS ) },
    { "turns", 0, NULL, NULL, OPTION_FLAG( gate_options, takes_turns ) },
    { "slow", 0, "N", NULL, OPTION_WHOLE( gate_options, slow.loops, 0, INT_MAX ) },
    { "trials", 0, "N", "self-test: gates of each slow-down, default 10",
      OPTION_WHOLE( gate_options, trials, 1, 100000 ) },
    { "paired", 0, "WISP", "check: compare times with another program, instead of a base file",
      OPTION_TEXT( gate_options, paired, "*" ) },
    { "patience", 0, "S", "check --paired: longest time of one run of a row, default 120 s",
      OPTION_NUMBER( gate_options, patience, 1e6 ) },
    OPTION_TITLE( "Verdict:" ),
    { "reason", 'r', "TEXT", "accept: why the new values are right; it is kept in the base file",
      OPTION_TEXT( gate_options, reason, NULL ) },
    { "patch", 0, "FILE", "accept: leave the base file, and write a patch for 'git apply'",
      OPTION_TEXT( gate_options, patch, "*" ) },
    { "strict", 0, NULL, "check: rows that only the suite or only the base has fail, too",
      OPTION_FLAG( gate_options, is_strict ) },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( gate_options, format ),
    { "junit", 0, "FILE", "Write JUnit's XML too, a test case for each row",
      OPTION_FILE( gate_options, junit, ".xml" ) },
    { "html", 0, "FILE", "Write one HTML page too, with charts of before and after",
      OPTION_FILE( gate_options, html, ".html" ) },
    { "github", 0, NULL, "Tell GitHub: annotations, and the table in the summary of the step",
      OPTION_FLAG( gate_options, tells_github ) },
};

const command_text gate_text = {
    .name = "gate",
    .operands = "ACTION SUITE",
    .noun = "action",
    .summary = "measure the scenes of a suite, and fail if one became worse",
    .about = "Measure the scenes of a suite and fail if one became worse.",
    .notes = "Actions:\n"
             "  record SUITE     measure all rows and write the base file\n"
             "  check SUITE      measure all rows and compare them with the base file\n"
             "  accept SUITE     the same as record, with a reason, which the base file keeps\n"
             "  self-test SUITE  compare times of this program with itself, slowed down: what is found?\n"
             "  step SUITE       only run the steps of one row, for profilers\n"
             "\n"
             "What is compared is the same in every run: bits of all points, instructions, bytes,\n"
             "allocations, stretch, energy, penetration, intersections, resets. docs/gate.md has the format\n"
             "of suites and of budgets.",
    .examples = "wisp gate record suite.yaml -o base.json\n"
                "wisp gate check suite.yaml --base base.json --junit gate.xml\n"
                "wisp gate check suite.yaml --paired ../old/build/app/wisp",
    .unmet = "a row is worse than its budget allows",
    .rows = gate_rows,
    .row_count = WISP_COUNT( gate_rows ),
    .values = { action_words, WISP_COUNT( action_words ), ".yaml", .to = { .take = take_gate_operand } },
};

static void check_gate_options( const options_state* p )
{
    gate_options* o = p->input;
    if ( o->suite == NULL )
    {
        options_fail( p, "expected an action and a suite, such as check suite.yaml" );
    }
    if ( o->action == ACTION_ACCEPT && ( o->reason == NULL || strlen( o->reason ) >= GATE_MAX_REASON ) )
    {
        options_fail( p, "accept: expected --reason with up to %d bytes", (int)GATE_MAX_REASON - 1 );
    }
    if ( o->steps > 0 && o->paired != NULL )
    {
        options_fail( p, "--steps: not with --paired, which divides rows into turns" );
    }
    if ( o->base == NULL && ( o->action == ACTION_RECORD || o->action == ACTION_ACCEPT ) )
    {
        o->base = o->output;
    }
    if ( o->patch && ( o->action != ACTION_ACCEPT || ( o->base ? o->base : o->suite )[0] == '/' ) )
    {
        options_fail( p, "--patch: expected accept, and a base file below this folder" );
    }
}

// ---- whether rows fit the reference, known from their scenes before any of them runs ----

static double step_of( const wisp_scene* scene )
{
    return wisp_scene_step_time( scene, scene->steps ) / scene->steps;
}

static const char* body_name( const wisp_scene* scene, int i )
{
    return i < scene->strands_count ? scene->strands[i].name : scene->surfaces[i - scene->strands_count].name;
}

static bool has_common_body( const wisp_scene* a, const wisp_scene* b )
{
    bool has = false;
    for ( int i = 0; i < a->strands_count + a->surface_count; ++i )
    {
        for ( int k = 0; k < b->strands_count + b->surface_count; ++k )
        {
            has = has || strcmp( body_name( a, i ), body_name( b, k ) ) == 0;
        }
    }
    return has;
}

static wisp_status check_fit( const char* label, const wisp_scene* scene, const wisp_scene* reference, double longest,
                              wisp_error* error )
{
    const double ratio = longest / step_of( scene );
    if ( fabs( ratio - round( ratio ) ) > 1e-3 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: steps of %.6g s do not divide the longest of the suite, %.6g s, at whose ends motions "
                          "are compared; a dt of %.6g s or %.6g s does",
                          label, step_of( scene ), longest, longest / floor( ratio ), longest / ceil( ratio ) );
    }
    return has_common_body( scene, reference )
               ? WISP_OK
               : wisp_fail(
                     error, WISP_BAD_INPUT,
                     "%s: bodies are compared by their names, and none of the reference is called '%s'; name it "
                     "'%s'",
                     label, body_name( scene, 0 ), body_name( reference, 0 ) );
}

// Every row's scene, and those of the references, in one walk that `longest` is found in and one that checks.
static wisp_status check_fits( const suite_references* references, wisp_error* error )
{
    const wisp_suite* suite = references->suite;
    wisp_scene reference, scene;
    double longest = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 2 * suite->row_count && suite->reference_count > 0 && status == WISP_OK; ++i )
    {
        const suite_row* row = suite->rows + i % suite->row_count;
        char label[SUITE_MAX_LABEL];
        suite_label( row, label );
        status = suite_scene( &suite->references[references->of_row[i % suite->row_count]].fine, &reference, error );
        status = status == WISP_OK ? suite_scene( row, &scene, error ) : status;
        if ( status == WISP_OK )
        {
            longest = fmax( longest, fmax( step_of( &scene ), step_of( &reference ) ) );
            status = i < suite->row_count ? status : check_fit( label, &scene, &reference, longest, error );
            wisp_scene_release( &scene );
        }
        wisp_scene_release( &reference );
    }
    return status;
}

// @param done receives how many rows were measured, fewer after an interruption
static wisp_status measure_all( const wisp_suite* suite, const gate_options* o, suite_measurement* out, int* done,
                                wisp_error* error )
{
    *done = 0;
    if ( o->no_instructions == false && strstr( machine_kernels(), "avx2" ) == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "gate: this build leaves out the kernels for AVX2, with which instructions are counted: "
                          "-Dkernels=all has them, --no-instructions gates without" );
    }
    char steps[32];
    snprintf( steps, sizeof steps, "--steps=%d", o->steps );
    const suite_count_options counts = { .has_cycles = o->has_cycles, .step = o->steps > 0 ? steps : NULL };
    suite_references references;
    progress bar = progress_begin();
    progress_show( &bar, 0.0, "the reference" );
    wisp_status status = suite_references_find( suite, &references, error );
    status = status == WISP_OK ? check_fits( &references, error ) : status;
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        progress_show( &bar, (double)i / suite->row_count, suite->rows[i].name );
        const suite_reference* reference;
        status = suite_reference_of( &references, i, &reference, error );
        status = status == WISP_OK ? suite_reference_run( reference, suite->rows + i, o->isa, NULL, out + i, error )
                                   : status;
        status = status == WISP_OK && !o->no_instructions
                     ? suite_count_instructions( o->suite, i, &counts, out + i, error )
                     : status;
        *done += status == WISP_OK ? 1 : 0;
    }
    suite_references_release( &references );
    progress_end( &bar );
    return status;
}

// ---- record and accept ----

static void add_reason( gate_base* base, const char* text )
{
    gate_reason* grown = text_alloc( ( (size_t)base->accepted_count + 1 ) * sizeof *grown );
    for ( int i = 0; i < base->accepted_count; ++i )
    {
        grown[i] = base->accepted[i];
    }
    free( base->accepted );
    base->accepted = grown;
    gate_reason* reason = grown + base->accepted_count++;
    gate_today( reason->date );
    snprintf( reason->text, sizeof reason->text, "%s", text );
}

static void fill_base( const wisp_suite* suite, const suite_measurement* measured, gate_base* base )
{
    const machine_info machine = machine_describe( "" );
    snprintf( base->suite, sizeof base->suite, "%s", suite->name );
    snprintf( base->version, sizeof base->version, "%s", machine.version );
    gate_compiler( base->compiler, sizeof base->compiler );
    gate_today( base->date );
    free( base->rows );
    base->rows = text_alloc( (size_t)suite->row_count * sizeof *base->rows );
    base->row_count = suite->row_count;
    for ( int i = 0; i < base->row_count; ++i )
    {
        memcpy( base->rows[i].name, suite->rows[i].name, sizeof base->rows[i].name );
        memcpy( base->rows[i].variant, suite->rows[i].variant, sizeof base->rows[i].variant );
        base->rows[i].measured = measured[i];
    }
}

static wisp_status check_suite( const gate_base* base, const wisp_suite* suite, const char* path, wisp_error* error )
{
    return strcmp( base->suite, suite->name ) == 0
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: the base is of suite '%s', not of '%s'", path, base->suite,
                            suite->name );
}

static wisp_status record( const wisp_suite* suite, const gate_options* o, const suite_measurement* measured,
                           wisp_error* error )
{
    gate_base base = { 0 };
    wisp_status status = WISP_OK;
    if ( o->action == ACTION_ACCEPT )
    {
        status = gate_base_read( o->base, &base, error );
        status = status == WISP_OK ? check_suite( &base, suite, o->base, error ) : status;
    }
    if ( status == WISP_OK && o->action == ACTION_ACCEPT )
    {
        add_reason( &base, o->reason );
    }
    if ( status == WISP_OK )
    {
        fill_base( suite, measured, &base );
    }
    const char* file = o->patch ? o->patch : o->base;
    status = status != WISP_OK ? status
             : o->patch        ? gate_write_patch( &base, o->base, o->patch, error )
                               : gate_base_write( &base, o->base, error );
    if ( status == WISP_OK )
    {
        fprintf( io_is_standard( file ) ? stderr : stdout, "gate %s: %s: %d rows in %s\n", suite->name,
                 o->action == ACTION_ACCEPT ? "accepted" : "recorded", suite->row_count, file );
    }
    gate_base_release( &base );
    return status;
}

// ---- check ----

static void note_interruption( const char* what, int done, int all, results* out )
{
    if ( done < all )
    {
        results_add_note( out, "interrupted: %s %d of %d rows", what, done, all );
    }
}

// Workflow commands are read on standard output, the summary of a step in a file that GitHub names.
static wisp_status tell_github( const wisp_suite* suite, const gate_row_check* checks, const char* path,
                                const results* report, wisp_error* error )
{
    const char* summary = getenv( "GITHUB_STEP_SUMMARY" );
    gate_print_annotations( suite, checks, path );
    FILE* stream = summary && summary[0] ? fopen( summary, "abe" ) : NULL;
    const wisp_status status = stream ? results_write( report, RESULTS_MARKDOWN, stream, error ) : WISP_OK;
    const bool is_lost = summary && summary[0] && ( stream == NULL || fclose( stream ) != 0 );
    return status == WISP_OK && is_lost ? wisp_fail( error, WISP_IO_ERROR, "%s: %s", summary, strerror( errno ) )
                                        : status;
}

// @param all rows of the suite, of which there are fewer after an interruption
static wisp_status report( const wisp_suite* suite, int all, const gate_options* o, const gate_base* base,
                           const suite_measurement* measured, bool* is_worse, wisp_error* error )
{
    gate_row_check* checks = text_alloc( (size_t)suite->row_count * sizeof *checks );
    results out = { .machine = machine_describe( measured[0].isa ), .is_result_first = true };
    results_put_options( &out, o->argc, o->argv );
    note_interruption( "checked", suite->row_count, all, &out );
    const bool compares = gate_counts_are_comparable( base );
    if ( o->lacks_instructions )
    {
        results_add_note( &out, "instructions are not counted: the base was recorded without them" );
    }
    else if ( !compares && !o->no_instructions )
    {
        results_add_note( &out, "instructions are not compared: the base was measured with a program of %s",
                          base->compiler );
    }
    for ( int i = 0; i < suite->row_count; ++i )
    {
        gate_check_row( suite->rows + i, base, compares, measured + i, checks + i );
        *is_worse = *is_worse || checks[i].state == GATE_WORSE || ( o->is_strict && checks[i].state == GATE_NEW );
    }
    const int missing = gate_count_missing( base, suite->rows, suite->row_count );
    if ( missing > 0 && suite->row_count == all )
    {
        results_add_note( &out, "%d rows of the base are not in the suite any more", missing );
        *is_worse = *is_worse || o->is_strict;
    }
    gate_report( suite, checks, &out );
    wisp_status status = o->tells_github ? tell_github( suite, checks, o->suite, &out, error ) : WISP_OK;
    status = status == WISP_OK ? results_write_file( &out, o->format, o->output, error ) : status;
    status = status == WISP_OK && o->junit ? gate_write_junit( suite, checks, o->junit, error ) : status;
    status = status == WISP_OK && o->html ? gate_write_page( suite, checks, &out, o->html, error ) : status;
    results_free( &out );
    free( checks );
    return status;
}

static bool base_has( const gate_base* base, suite_measure m )
{
    bool any = false;
    for ( int i = 0; i < base->row_count; ++i )
    {
        any = any || isfinite( base->rows[i].measured.values[m] );
    }
    return any;
}

// Counts what the base has, if its counts can be compared.
static int check_against_base( wisp_suite* suite, gate_options* o, wisp_error* error )
{
    const int all = suite->row_count;
    gate_base base;
    bool is_worse = false;
    wisp_status status = gate_base_read( o->base, &base, error );
    status = status == WISP_OK ? check_suite( &base, suite, o->base, error ) : status;
    suite_measurement* measured = text_alloc( (size_t)suite->row_count * sizeof *measured );
    if ( status == WISP_OK )
    {
        o->has_cycles = base_has( &base, SUITE_CYCLES ) && gate_counts_are_comparable( &base );
        o->lacks_instructions = !o->no_instructions && !base_has( &base, SUITE_INSTRUCTIONS );
        o->no_instructions = o->no_instructions || o->lacks_instructions;
        int done = 0;
        status = measure_all( suite, o, measured, &done, error );
        if ( status != WISP_OK && interruption_came() && done > 0 )
        {
            suite->row_count = done;
            status = WISP_OK;
        }
    }
    status = status == WISP_OK ? report( suite, all, o, &base, measured, &is_worse, error ) : status;
    free( measured );
    gate_base_release( &base );
    return status != WISP_OK ? command_fail( error ) : interruption_status( is_worse ? STATUS_UNMET : STATUS_GOOD );
}

// ---- times ----

static int compare_times( wisp_suite* suite, const gate_options* o, wisp_error* error )
{
    const int all = suite->row_count;
    gate_pair_check* checks = text_alloc( (size_t)suite->row_count * sizeof *checks );
    results out = { .machine = machine_describe( o->isa ? o->isa : "avx2" ), .is_result_first = true };
    results_put_options( &out, o->argc, o->argv );
    progress bar = progress_begin();
    const gate_turns turns = { .suite = o->suite, .isa = out.machine.isa, .patience = o->patience };
    wisp_status status = gate_compare_programs( suite, o->paired, turns, &bar, checks, error );
    progress_end( &bar );
    bool is_worse = false;
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        is_worse = is_worse || checks[i].pace == PACE_SLOWER || ( o->is_strict && checks[i].pace != PACE_FINE );
    }
    if ( status == WISP_OK )
    {
        note_interruption( "compared", suite->row_count, all, &out );
        gate_report_pairs( suite, checks, &out );
        status = results_write_file( &out, o->format, o->output, error );
    }
    results_free( &out );
    free( checks );
    return status != WISP_OK ? command_fail( error ) : interruption_status( is_worse ? STATUS_UNMET : STATUS_GOOD );
}

static int test_itself( const wisp_suite* suite, const gate_options* o, wisp_error* error )
{
    results out = { .machine = machine_describe( o->isa ? o->isa : "avx2" ), .is_result_first = true };
    results_put_options( &out, o->argc, o->argv );
    progress bar = progress_begin();
    const gate_turns turns = { .suite = o->suite, .isa = out.machine.isa, .row = o->row, .patience = o->patience };
    const gate_self_test_options options = { o->trials > 0 ? o->trials : 10, !o->no_instructions };
    wisp_status status = gate_self_test( suite, &turns, &options, &bar, &out, error );
    progress_end( &bar );
    if ( status != WISP_OK && interruption_came() )
    {
        results_add_note( &out, "interrupted: slow-downs that are not listed were not tested" );
        status = WISP_OK;
    }
    status = status == WISP_OK ? results_write_file( &out, o->format, o->output, error ) : status;
    results_free( &out );
    return status == WISP_OK ? interruption_status( STATUS_GOOD ) : command_fail( error );
}

static wisp_status slow_down( void* user, const scene_world* world, wisp_error* error )
{
    (void)error;
    gate_slow* slow = user;
    if ( world->next_step > 0 && slow->loops > 0 )
    {
        gate_slow_waste( slow );
    }
    return WISP_OK;
}

static int step_row( const wisp_suite* suite, gate_options* o, wisp_error* error )
{
    const suite_row* row = suite->rows + o->row;
    const suite_observer observer = { .observe = slow_down, .user = &o->slow };
    suite_measurement measured;
    if ( o->takes_turns )
    {
        return gate_answer_turns( row, &o->slow, o->isa, error ) == WISP_OK ? STATUS_GOOD : command_fail( error );
    }
    if ( suite_run_row( row, o->isa, &observer, &measured, error ) != WISP_OK )
    {
        return command_fail( error );
    }
    printf( "%016llx\n", (unsigned long long)measured.hash );
    return STATUS_GOOD;
}

static int run_action( wisp_suite* suite, gate_options* o, wisp_error* error )
{
    if ( o->row >= suite->row_count )
    {
        wisp_fail( error, WISP_BAD_INPUT, "%s: got row %d, the suite has %d", o->suite, o->row, suite->row_count );
        return command_fail( error );
    }
    if ( o->action == ACTION_SELF_TEST )
    {
        return test_itself( suite, o, error );
    }
    if ( o->action == ACTION_CHECK && o->paired != NULL )
    {
        return compare_times( suite, o, error );
    }
    if ( o->action == ACTION_CHECK || o->action == ACTION_STEP )
    {
        return o->action == ACTION_CHECK ? check_against_base( suite, o, error ) : step_row( suite, o, error );
    }
    wisp_status status = command_check_writable( o->patch ? o->patch : o->base, error );
    suite_measurement* measured = text_alloc( (size_t)suite->row_count * sizeof *measured );
    if ( status == WISP_OK )
    {
        int done = 0;
        status = measure_all( suite, o, measured, &done, error );
        if ( status != WISP_OK && interruption_came() )
        {
            wisp_fail( error, WISP_CONFLICT, "interrupted after %d of %d rows: %s is as it was", done,
                       suite->row_count, o->base );
        }
    }
    status = status == WISP_OK ? record( suite, o, measured, error ) : status;
    free( measured );
    return status == WISP_OK ? STATUS_GOOD : command_fail( error );
}

int command_gate( int argc, char** argv )
{
    gate_options options = { .argc = argc, .argv = argv, .patience = 120.0 };
    options_parse( &gate_text, check_gate_options, &options, argc, argv );
    interruption_begin();
    // suite.yaml has suite-base.json
    char beside[PATH_MAX + 16];
    const char* dot = strrchr( io_file_name( options.suite ), '.' );
    const int length = dot ? (int)( dot - options.suite ) : (int)strlen( options.suite );
    snprintf( beside, sizeof beside, "%.*s-base.json", length < PATH_MAX ? length : PATH_MAX, options.suite );
    options.base = options.base ? options.base : beside;
    wisp_error error = { 0 };
    wisp_suite all;
    const bool is_read = suite_read( options.suite, &all, &error ) == WISP_OK;
    for ( int i = 0; is_read && options.steps > 0 && i < all.row_count; ++i )
    {
        const int own = all.rows[i].steps;
        all.rows[i].steps = own > 0 && own < options.steps ? own : options.steps;
    }
    wisp_suite part = all; // an interruption leaves fewer rows of it
    const int status = is_read ? run_action( &part, &options, &error ) : command_fail( &error );
    suite_release( &all );
    return status;
}
