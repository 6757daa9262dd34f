#include "commands.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "tune_report.h"

#include <stdlib.h>
#include <string.h>

#define DEFAULT_LIMIT 300.0

typedef struct tune_options
{
    const char* scene;
    tune_scene_def search;
    results_format format;
    const char* output; ///< path of the tuned scene, or null
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

static const option_row rows[] = {
    OPTION_TITLE( "Target, one of:" ),
    { "error", KEY_ERROR, "METRES", "Cheapest configuration with at most this error", OPTION_ANY },
    { "budget", KEY_BUDGET, "MS", "Most accurate configuration within MS ms per step", OPTION_ANY },
    OPTION_TITLE( "Search:" ),
    { "seconds", KEY_SECONDS, "S", "Simulate S seconds per run; default: the scene, at most 2", OPTION_ANY },
    { "limit", KEY_LIMIT, "SECONDS", "Start no run after this time, default 300", OPTION_ANY },
    { "workers", KEY_WORKERS, "N", "Use N workers, 1 to 64; default: the scene's, or one per core", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( KEY_FORMAT ),
    { "output", KEY_OUTPUT, "FILE", "Write the tuned scene to FILE; default: not written", OPTION_FILES( ".yaml" ) },
};

const command_text tune_text = {
    .name = "tune",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "find the cheapest configuration within an error or time",
    .about = "Find the cheapest configuration of a scene within an error, or the most accurate\n"
             "one within a time.",
    .notes = "Tuned are, as far as the scene uses them: substeps and iterations; tethers of cloth\n"
             "and substeps of its coarse sheets; tolerance and Newton iterations of implicit cloth;\n"
             "stretch passes of strands. Configurations are timed on this machine, which should be\n"
             "idle.\n"
             "\n"
             "The error is a root mean square distance in metres, over all points and 12 samples\n"
             "of time, from a reference: the same scene with 16 times the finest substeps,\n"
             "without tethers and coarse sheets. Chaotic scenes, such as crumpling cloth, cannot\n"
             "meet a small error.\n"
             "\n"
             "--output writes the scene with the changed keys, and everything else as it was, if\n"
             "the target is met.",
    .examples = "wisp tune data/scenes/hanging_cloth.yaml --error 0.005\n"
                "wisp tune data/scenes/hanging_cloth.yaml --budget 2 -o data/scenes/tuned.yaml",
    .unmet = "no configuration meets the target",
    .rows = rows,
    .row_count = WISP_COUNT( rows ),
    .values = OPTION_FILES( ".yaml .yml .json" ),
};

static void check( const options_state* o, const tune_options* options )
{
    if ( ( options->search.error > 0.0 ) == ( options->search.budget_ms > 0.0 ) )
    {
        options_fail( o, "expected one of --error and --budget" );
    }
}

static bool take( options_state* o, int key, const char* argument )
{
    tune_options* options = o->input;
    switch ( key )
    {
        case KEY_ERROR:
            options->search.error = option_positive( o, argument, 1e6 );
            return true;
        case KEY_BUDGET:
            options->search.budget_ms = option_positive( o, argument, 1e6 );
            return true;
        case KEY_SECONDS:
            options->search.seconds = option_positive( o, argument, 1e6 );
            return true;
        case KEY_LIMIT:
            options->search.limit = option_positive( o, argument, 1e9 );
            return true;
        case KEY_WORKERS:
            options->search.world.workers = option_whole( o, argument, 1, WISP_MAX_WORKERS );
            return true;
        case KEY_FORMAT:
            options->format = (results_format)option_word( o, argument );
            return true;
        case KEY_OUTPUT:
            options->output = argument;
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &options->scene );
            check( o, options );
            return true;
        default:
            return option_input( o, key, argument, &options->scene );
    }
}

// ---- the scene's file ----

static int folder_length( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? (int)( slash - path ) + 1 : 0;
}

static wisp_status count_file( void* user, const char* file, wisp_error* error )
{
    (void)file, (void)error;
    *(int*)user += 1;
    return WISP_OK;
}

static bool reads_files( const wisp_scene* scene )
{
    int count = 0;
    (void)wisp_scene_files( scene, count_file, &count, NULL );
    return count > 0;
}

static wisp_status edit_scene( const tune_options* options, const tune_parameters* parameters,
                               const int* configuration, const wisp_scene* scene, const char* to, wisp_error* error )
{
    wisp_scene_edit* edits;
    int count;
    wisp_status status = tune_parameters_edits( parameters, configuration, scene, &edits, &count, error );
    status = status == WISP_OK ? wisp_scene_edit_file( options->scene, edits, count, to, error ) : status;
    free( edits );
    return status;
}

// Fails before the search, which takes minutes, if the result could not be written. Every value of every parameter
// occurs in one of the tested configurations.
static wisp_status check_output( const tune_options* options, const tune_parameters* parameters,
                                 const wisp_scene* scene, wisp_error* error )
{
    const int length = folder_length( options->scene );
    if ( reads_files( scene ) && ( length != folder_length( options->output ) ||
                                   strncmp( options->scene, options->output, (size_t)length ) != 0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: reads files of its folder, so the tuned scene %s must be in the same folder",
                          options->scene, options->output );
    }
    wisp_status status = WISP_OK;
    for ( int value = 0; value < WISP_TUNE_MAX_VALUES && status == WISP_OK; ++value )
    {
        int configuration[WISP_TUNE_MAX_PARAMETERS], longest = 0;
        for ( int k = 0; k < parameters->count; ++k )
        {
            const int last = parameters->parameters[k].value_count - 1;
            configuration[k] = value < last ? value : last;
            longest = last > longest ? last : longest;
        }
        status = value <= longest ? edit_scene( options, parameters, configuration, scene, NULL, error ) : WISP_OK;
    }
    return status;
}

// Writes the scene and reads it again: the file must hold the chosen configuration.
static wisp_status write_scene( const tune_options* options, const tune_parameters* parameters,
                                const int* configuration, const wisp_scene* scene, wisp_error* error )
{
    wisp_status status = edit_scene( options, parameters, configuration, scene, options->output, error );
    wisp_scene written;
    if ( io_is_standard( options->output ) )
    {
        return status;
    }
    status = status == WISP_OK ? wisp_scene_read( options->output, &written, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( !tune_parameters_agree( parameters, configuration, &written ) )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: the written scene differs from the chosen configuration",
                            options->output );
    }
    wisp_scene_release( &written );
    return status;
}

// ---- the command ----

static bool show( void* user, int run_count, int max_runs )
{
    progress_show( user, (double)run_count / max_runs, "of the runs allowed" );
    return !interruption_came();
}

// A trial that has begun ends: it is the last one. Without a reference there is nothing to keep.
static bool go_on( void* user, bool is_reference )
{
    (void)user;
    return !( is_reference && interruption_came() );
}

static void show_reference( void* user, double fraction )
{
    progress_show( user, fraction, "of the reference run" );
}

static wisp_status tune( tune_options* options, const wisp_scene* scene, const tune_parameters* parameters,
                         results* out, bool* meets_target, wisp_error* error )
{
    wisp_tune_result found;
    tune_scene_info info;
    options->search.parameters = parameters;
    wisp_status status = options->output ? check_output( options, parameters, scene, error ) : WISP_OK;
    status = status == WISP_OK ? command_check_writable( options->output, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    progress bar = progress_begin();
    options->search.progress = show;
    options->search.reference_progress = show_reference;
    options->search.progress_user = &bar;
    options->search.go_on = go_on;
    status = tune_scene_search( &options->search, &found, &info, error );
    status = status != WISP_OK && interruption_came() ? interruption_check( error ) : status;
    progress_end( &bar );
    if ( status == WISP_OK )
    {
        *meets_target = found.meets_target;
        tune_report( out, &options->search, &info, &found );
        if ( interruption_came() )
        {
            results_add_note( out, "interrupted after %d runs: a better configuration may exist", found.run_count );
        }
    }
    if ( status == WISP_OK && options->output && found.meets_target )
    {
        status = write_scene( options, parameters, found.configuration, scene, error );
        results_add_note( out, "written: %s", options->output );
    }
    else if ( status == WISP_OK && options->output )
    {
        results_add_note( out, "not written: %s", options->output );
    }
    wisp_tune_release( &found );
    return status;
}

int command_tune( int argc, char** argv )
{
    tune_options options = { .search = { .limit = DEFAULT_LIMIT } };
    options_parse( &tune_text, take, &options, argc, argv );

    // The scene is read twice: the fields of the second copy change from run to run.
    wisp_error error = { 0 };
    wisp_scene scene, varied = { 0 };
    wisp_status status = wisp_scene_read( options.scene, &scene, &error );
    status = status == WISP_OK ? wisp_scene_read( options.scene, &varied, &error ) : status;
    interruption_begin(); // before that there is nothing to keep
    options.search.scene = &varied;
    tune_parameters parameters;
    status = status == WISP_OK ? tune_parameters_find( &scene, &parameters, &error ) : status;
    results out = { 0 };
    results_put_options( &out, argc, argv );
    bool meets_target = false;
    status = status == WISP_OK ? tune( &options, &scene, &parameters, &out, &meets_target, &error ) : status;
    // A scene on standard output leaves the error stream for the report.
    const bool is_scene_shown = options.output != NULL && io_is_standard( options.output );
    status =
        status == WISP_OK ? results_write( &out, options.format, is_scene_shown ? stderr : stdout, &error ) : status;
    results_free( &out );
    wisp_scene_release( &varied );
    wisp_scene_release( &scene );
    return status != WISP_OK ? command_fail( &error )
                             : interruption_status( meets_target ? STATUS_GOOD : STATUS_UNMET );
}
