#include "bench_commands.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "torture_twins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FILES_MAX 4096

// By the words of --twin.
static const int twins_of[] = { TORTURE_TWIN_ALL, TORTURE_TWIN_BITS, TORTURE_TWIN_SNAPSHOT, TORTURE_TWIN_SCALE,
                                TORTURE_TWIN_SHIFT };

typedef struct torture_options
{
    const char* files[FILES_MAX];
    int file_count, twin;
    double seconds; ///< of wall time, of a scene
    bool is_close;  ///< judge by the close limits, too
    results_format format;
} torture_options;

static void take_scene_file( const options_state* o, const char* argument )
{
    torture_options* options = o->input;
    if ( options->file_count == FILES_MAX )
    {
        options_fail( o, "got more than %d scenes", FILES_MAX );
    }
    options->files[options->file_count++] = argument;
}

static const char* const twin_words[] = { "all", "bits", "snapshot", "scale", "shift" };
static const option_row torture_rows[] = {
    OPTION_TITLE( "Judgement:" ),
    { "limit", 0, "SECONDS", "Wall time of a scene, default 20", OPTION_NUMBER( torture_options, seconds, 1e6 ) },
    { "twin", 0, "TWIN", "Run it again in this way alone, default all",
      OPTION_WORD( torture_options, twin, twin_words ) },
    { "close", 0, NULL, "Judge by the close limits of suites with checks, too",
      OPTION_FLAG( torture_options, is_close ) },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( torture_options, format ),
};

const command_text torture_text = {
    .name = "torture",
    .operands = "SCENE...",
    .noun = "scene",
    .summary = "judge whether the engine withstands scenes",
    .about = "Judge whether the engine withstands scenes.",
    .notes = "Each scene runs in a process of its own, and again in other ways, and is judged: crash,\n"
             "time, status, finite, halted, energy, strain, penetration, intersections, rest, bits,\n"
             "snapshot, scale, shift. docs/outputs.md explains each.",
    .examples = "wisp torture --close data/scenes/flag.yaml",
    .unmet = "a scene breaks",
    .rows = torture_rows,
    .row_count = WISP_COUNT( torture_rows ),
    .values = { .files = ".yaml .yml .json", .to = { .take = take_scene_file } },
};

static void check_torture_options( const options_state* o )
{
    if ( ( (const torture_options*)o->input )->file_count == 0 )
    {
        options_fail( o, "expected a scene" );
    }
}

// ---- what was found ----

typedef struct torture_found
{
    int scenes, broken[STABILITY_CHECK_COUNT];
    double seconds;
} torture_found;

static int broken_count( const torture_found* found )
{
    int sum = 0;
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        sum += found->broken[i];
    }
    return sum;
}

static void put_found( const torture_found* found, results* out )
{
    const double per_second = found->scenes / fmax( found->seconds, 1e-9 );
    out->machine = machine_describe( "every set" );
    const int table = results_begin_table( out, "", "\t" );
    if ( interruption_came() )
    {
        results_add_line( out, table, "interrupted\tafter %d scenes", found->scenes );
    }
    results_row* row = results_add_row( out, "torture", "search" );
    results_add_line( out, table, "scenes\t%d, %.3g per second", found->scenes, per_second );
    results_put( &row->size, "scenes", found->scenes );
    results_put( &row->size, "scenes_per_second", per_second );
    results_add_line( out, table, "broken\t%d", broken_count( found ) );
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        if ( found->broken[i] > 0 )
        {
            results_add_line( out, table, "%s\t%d", stability_check_names[i], found->broken[i] );
        }
        results_put( &row->size, stability_check_names[i], found->broken[i] );
    }
}

static wisp_status read_tree( const char* path, text_node** out, wisp_error* error )
{
    const size_t MAX_BYTES = (size_t)16 << 20;
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    *out = NULL;
    status = status == WISP_OK ? text_parse( bytes ? (const char*)bytes : "", size, path, out, error ) : status;
    free( bytes );
    return status;
}

static wisp_status judge_file( const torture_options* options, const char* path, torture_found* found, results* out,
                               wisp_error* error )
{
    text_node* tree;
    wisp_scene scene = { 0 };
    wisp_status status = read_tree( path, &tree, error );
    const torture_subject subject = { tree, path };
    status = status == WISP_OK ? torture_read( &subject, &scene, error ) : status;
    if ( status == WISP_OK )
    {
        const int twins = twins_of[options->twin] | ( options->is_close ? TORTURE_CLOSE : 0 );
        const stability_verdict verdict = torture_judge_scene( &subject, twins, options->seconds );
        const bool is_judged = !interruption_came();
        found->scenes += is_judged;
        if ( verdict.check != STABILITY_HOLDS && is_judged )
        {
            ++found->broken[verdict.check];
            results_add_note( out, "%s: %s: %s", path, stability_check_names[verdict.check], verdict.message );
        }
    }
    wisp_scene_release( &scene );
    text_release( tree );
    return status;
}

int command_torture( int argc, char** argv )
{
    static torture_options options; // too large for a stack
    options = ( torture_options ){ .seconds = 20.0 };
    options_parse( &torture_text, check_torture_options, &options, argc, argv );
    interruption_begin();
    wisp_error error = { 0 };
    wisp_status status = WISP_OK;
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    torture_found found = { 0 };
    const double start = wisp_clock_seconds();
    for ( int i = 0; i < options.file_count && status == WISP_OK && !interruption_came(); ++i )
    {
        status = judge_file( &options, options.files[i], &found, &out, &error );
    }
    found.seconds = wisp_clock_seconds() - start;
    put_found( &found, &out );
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    return status != WISP_OK ? command_fail( &error )
                             : interruption_status( broken_count( &found ) > 0 ? STATUS_UNMET : STATUS_GOOD );
}
