#include "verbs.h"

#include "tune_report.h"

#include <stdlib.h>
#include <string.h>

#define DEFAULT_LIMIT 300.0

typedef struct tune_options
{
    const char* scene;
    tune_scene_def search;
    results_format format;
    const char* output; ///< where the tuned scene goes, or null
} tune_options;

// ---- the command line ----

enum
{
    KEY_ERROR = 'e',
    KEY_BUDGET = 'b',
    KEY_SECONDS = 's',
    KEY_WORKERS = 'w',
    KEY_FORMAT = 'f',
    KEY_OUTPUT = 'o',
    KEY_LIMIT = 256,
};

static const char doc[] =
    "Find the cheapest setting of a scene that meets an error, or the most accurate one within a time.\n"
    "\v"
    "Tuned are substeps and iterations, tethers and levels of cloth (off, or their finest_level), tolerance and "
    "repeats of implicit cloth, stretch_passes of strands that move by the direct solve, as far as the scene has "
    "them; on all surfaces and strands alike. Settings are run on this machine, which should have nothing else to "
    "do.\n"
    "\n"
    "The error is the root mean square distance, in metres, over all points of surfaces and of strands with "
    "dynamics, and over 12 looks spread over the run, from the same scene with 16 times the substeps of the "
    "finest setting, without tethers and levels. Scenes that go another way after the smallest change, as "
    "crumpling cloth does, cannot meet a small error.\n"
    "\n"
    "--output writes the scene with the fields of the choice changed, added or, where levels are off, taken out, "
    "and everything else as it was, if what was asked for is met.\n"
    "\n" STATUS_HELP;

static const struct argp_option option_list[] = {
    { "error", KEY_ERROR, "METRES", 0, "Find the cheapest setting with at most this error", 0 },
    { "budget", KEY_BUDGET, "MS", 0, "Find the most accurate setting with at most these milliseconds a step", 0 },
    { "seconds", KEY_SECONDS, "S", 0, "Simulate S seconds in each run, default the scene's steps, 2 s at most", 0 },
    { "limit", KEY_LIMIT, "SECONDS", 0, "Begin no run after so many seconds, default 300", 0 },
    { "workers", KEY_WORKERS, "N", 0, "Use N workers, 1 to 64, instead of the scene's or one a core", 0 },
    { "format", KEY_FORMAT, "FORMAT", 0, "Report as text (default), markdown, csv, json or gbench", 0 },
    { "output", KEY_OUTPUT, "FILE", 0, "Write the scene with the setting that was found to FILE", 0 },
    { 0 },
};

static void check( struct argp_state* state, const tune_options* options )
{
    if ( ( options->search.error > 0.0 ) == ( options->search.budget_ms > 0.0 ) )
    {
        argp_error( state, "--error says how wrong it may be and --budget how long it may take: one of them" );
    }
}

static error_t parse( int key, char* argument, struct argp_state* state )
{
    tune_options* options = state->input;
    switch ( key )
    {
        case KEY_ERROR:
            options->search.error = option_positive( state, "--error", argument, 1e6 );
            return 0;
        case KEY_BUDGET:
            options->search.budget_ms = option_positive( state, "--budget", argument, 1e6 );
            return 0;
        case KEY_SECONDS:
            options->search.seconds = option_positive( state, "--seconds", argument, 1e6 );
            return 0;
        case KEY_LIMIT:
            options->search.limit = option_positive( state, "--limit", argument, 1e9 );
            return 0;
        case KEY_WORKERS:
            options->search.world.workers = option_whole( state, "--workers", argument, 1, WISP_MAX_WORKERS );
            return 0;
        case KEY_FORMAT:
            options->format = (results_format)option_word( state, "--format", argument, results_format_names,
                                                           RESULTS_FORMAT_COUNT );
            return 0;
        case KEY_OUTPUT:
            options->output = argument;
            return 0;
        case ARGP_KEY_ARG:
            if ( options->scene )
            {
                argp_error( state, "one scene at a time, but there is also '%s'", argument );
            }
            options->scene = argument;
            return 0;
        case ARGP_KEY_NO_ARGS:
            argp_error( state, "which scene?" );
            return 0;
        case ARGP_KEY_SUCCESS:
            check( state, options );
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

// ---- the scene's file ----

static int folder_length( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? (int)( slash - path ) + 1 : 0;
}

static bool reads_files( const wisp_scene* scene )
{
    bool reads = false;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        reads |= scene->strands[i].file != NULL;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        reads |= scene->surfaces[i].mesh.file != NULL;
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        reads |= scene->colliders[i].mesh.file != NULL;
    }
    return reads;
}

static wisp_status edit_scene( const tune_options* options, const tune_knobs* knobs, const int* choice,
                               const wisp_scene* scene, const char* to, wisp_error* error )
{
    wisp_scene_edit* edits;
    int count;
    wisp_status status = tune_knobs_edits( knobs, choice, scene, &edits, &count, error );
    status = status == WISP_OK ? wisp_scene_edit_file( options->scene, edits, count, to, error ) : status;
    free( edits );
    return status;
}

// What cannot be written is told before minutes go by: every value of every knob is in one of the choices that are tried.
static wisp_status check_output( const tune_options* options, const tune_knobs* knobs, const wisp_scene* scene,
                                 wisp_error* error )
{
    const int length = folder_length( options->scene );
    if ( reads_files( scene ) && ( length != folder_length( options->output ) ||
                                   strncmp( options->scene, options->output, (size_t)length ) != 0 ) )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "%s reads files of its folder, which a scene in another one would not find: write %s beside it",
            options->scene, options->output );
    }
    wisp_status status = WISP_OK;
    for ( int value = 0; value < WISP_TUNE_MAX_VALUES && status == WISP_OK; ++value )
    {
        int choice[WISP_TUNE_MAX_KNOBS], longest = 0;
        for ( int k = 0; k < knobs->count; ++k )
        {
            const int last = knobs->knobs[k].value_count - 1;
            choice[k] = value < last ? value : last;
            longest = last > longest ? last : longest;
        }
        status = value <= longest ? edit_scene( options, knobs, choice, scene, NULL, error ) : WISP_OK;
    }
    return status;
}

// Written, and read again: what the file says must be what was chosen.
static wisp_status write_scene( const tune_options* options, const tune_knobs* knobs, const int* choice,
                                const wisp_scene* scene, wisp_error* error )
{
    wisp_status status = edit_scene( options, knobs, choice, scene, options->output, error );
    wisp_scene written;
    status = status == WISP_OK ? wisp_scene_read( options->output, &written, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( !tune_knobs_agree( knobs, choice, &written ) )
    {
        status = wisp_fail( error, WISP_BAD_INPUT,
                            "%s: the scene that was written has another setting than was chosen", options->output );
    }
    wisp_scene_release( &written );
    return status;
}

// ---- the verb ----

static wisp_status tune( tune_options* options, const wisp_scene* scene, const tune_knobs* knobs, results* out,
                         bool* is_met, wisp_error* error )
{
    wisp_tune_result found;
    tune_scene_facts facts;
    options->search.knobs = knobs;
    wisp_status status = options->output ? check_output( options, knobs, scene, error ) : WISP_OK;
    status = status == WISP_OK ? verb_check_writable( options->output, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    status = tune_scene_search( &options->search, &found, &facts, error );
    if ( status == WISP_OK )
    {
        *is_met = found.is_met;
        tune_report( out, &options->search, &facts, &found );
    }
    if ( status == WISP_OK && options->output && found.is_met )
    {
        status = write_scene( options, knobs, found.choice, scene, error );
        results_add_note( out, "Written: %s", options->output );
    }
    else if ( status == WISP_OK && options->output )
    {
        results_add_note( out, "Nothing was written to %s.", options->output );
    }
    wisp_tune_release( &found );
    return status;
}

int verb_tune( int argc, char** argv )
{
    tune_options options = { .search = { .limit = DEFAULT_LIMIT } };
    const struct argp parser = { option_list, parse, "SCENE", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &options );

    // Twice: one stays as it was read, the fields of the other change from run to run.
    wisp_error error = { 0 };
    wisp_scene scene, varied = { 0 };
    wisp_status status = wisp_scene_read( options.scene, &scene, &error );
    status = status == WISP_OK ? wisp_scene_read( options.scene, &varied, &error ) : status;
    options.search.scene = &varied;
    tune_knobs knobs;
    status = status == WISP_OK ? tune_knobs_find( &scene, &knobs, &error ) : status;
    results out = { 0 };
    bool is_met = false;
    status = status == WISP_OK ? tune( &options, &scene, &knobs, &out, &is_met, &error ) : status;
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    wisp_scene_release( &varied );
    wisp_scene_release( &scene );
    return status != WISP_OK ? verb_fail( &error ) : is_met ? STATUS_GOOD : STATUS_UNMET;
}
