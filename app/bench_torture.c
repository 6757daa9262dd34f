#include "bench_commands.h"
#include "bench_texts.h"

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
    int close;      ///< TORTURE_CLOSE, or 0
    results_format format;
} torture_options;

static bool take_torture_option( options_state* o, int key, const char* argument )
{
    torture_options* options = o->input;
    switch ( key )
    {
        case TORTURE_KEY_LIMIT:
            options->seconds = option_positive( o, argument, 1e6 );
            return true;
        case TORTURE_KEY_TWIN:
            options->twin = option_word( o, argument );
            return true;
        case TORTURE_KEY_CLOSE:
            options->close = TORTURE_CLOSE;
            return true;
        case TORTURE_KEY_FORMAT:
            options->format = (results_format)option_word( o, argument );
            return true;
        case OPTIONS_OPERAND:
            if ( options->file_count == FILES_MAX )
            {
                options_fail( o, "got more than %d scenes", FILES_MAX );
            }
            options->files[options->file_count++] = argument;
            return true;
        case OPTIONS_END:
            if ( options->file_count == 0 )
            {
                options_fail( o, "expected a scene" );
            }
            return true;
        default:
            return false;
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
        const int twins = twins_of[options->twin] | options->close;
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
    options_parse( &torture_text, take_torture_option, &options, argc, argv );
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
