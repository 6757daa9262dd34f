#include "commands.h"

#include "io_file.h"
#include "progress.h"
#include "run_bodies.h"
#include "run_summary.h"
#include "scene.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MAX 100000000

typedef struct run_options
{
    const char* scene;
    int steps; ///< 0: that of the scene
    scene_world_options world;
    results_format format;
    const char* output;
    run_recorder_def recorder;
    const char* boundary; ///< file of boundary points, or null
} run_options;

// ---- the command line ----

enum
{
    KEY_STEPS = 's',
    KEY_WORKERS = 'w',
    KEY_FORMAT = 'f',
    KEY_OUTPUT = 'o',
    KEY_ISA = 256,
    KEY_RECORD,
    KEY_RECORD_WITH,
    KEY_EVERY,
    KEY_TRACK,
    KEY_TRACK_FILE,
    KEY_VERIFY,
    KEY_BOUNDARY,
};

static const char doc[] = "Simulate a scene, write its files and print a summary.\n"
                          "\v"
                          "Recordings hold the start of the scene and the state after each step. The extension\n"
                          "selects the format:\n"
                          "  .wisp   every bit, for 'wisp render' and --verify\n"
                          "  .pc2    point cache, one file per body\n"
                          "  .pvd    ParaView, one numbered .vtp file per frame\n"
                          "  .obj    one numbered file per frame\n"
                          "  .usda   USD with time samples\n"
                          "  .glb    glTF with a morph target per frame\n"
                          "\n"
                          "--boundary writes one file per frame: FILE_0002.ply follows the first step, and\n"
                          "FILE_SURFACE_0002.ply if several surfaces have boundary points.\n"
                          "docs/outputs.md describes each format, the summary and the hash.\n"
                          "\n"
                          "Examples:\n"
                          "  wisp run data/scenes/flag.yaml\n"
                          "  wisp run data/scenes/flag.yaml --steps 100 --record flag.wisp\n"
                          "\n" STATUS_HELP;

static const struct argp_option option_list[] = {
    { 0, 0, 0, 0, "Simulation:", 1 },
    { "steps", KEY_STEPS, "N", 0, "Simulate N steps; default: the scene's steps", 1 },
    { "workers", KEY_WORKERS, "N", 0, "Use N workers, 1 to 64; default: the scene's, or one per core", 1 },
    { "isa", KEY_ISA, "SET", 0, "Use at most baseline, avx2 or avx512; default: the best available", 1 },
    { 0, 0, 0, 0, "Summary:", 2 },
    { "format", KEY_FORMAT, "FORMAT", 0, "text (default), markdown, csv, json, gbench, bencher, github or hyperfine",
      2 },
    { "output", KEY_OUTPUT, "FILE", 0, "Write the summary to FILE; default: standard output", 2 },
    { 0, 0, 0, 0, "Recording:", 3 },
    { "record", KEY_RECORD, "FILE", 0, "Record all vertices (.wisp, .pc2, .pvd, .obj, .usda, .glb)", 3 },
    { "record-with", KEY_RECORD_WITH, "VALUE[,VALUE]", 0,
      "Compute strain or speed and record them too (.pvd, .usda); default: those that the scene computes", 3 },
    { "every", KEY_EVERY, "N", 0, "Record every Nth step, default 1", 3 },
    { "track", KEY_TRACK, "BODY:VERTEX[,VERTEX...]", 0, "Write the path of these vertices; can be repeated", 3 },
    { "track-file", KEY_TRACK_FILE, "FILE.csv", 0, "File for the paths of --track", 3 },
    { "boundary", KEY_BOUNDARY, "FILE.ply", 0, "Write the boundary points of all surfaces", 3 },
    { "verify", KEY_VERIFY, "FILE.wisp", 0, "Fail at the first frame that differs from this recording", 3 },
    { 0 },
};

static void parse_track( struct argp_state* state, const char* argument, run_recorder_def* def )
{
    const char* colon = strrchr( argument, ':' );
    bool is_good = colon && colon > argument && colon - argument <= WISP_RECORD_MAX_NAME;
    for ( const char* at = colon; is_good && at && *at; )
    {
        char* end = NULL;
        errno = 0;
        long vertex = strtol( at + 1, &end, 10 );
        is_good = end > at + 1 && !errno && vertex >= 0 && vertex < INT_MAX && ( *end == ',' || !*end );
        if ( def->track_count == RUN_TRACKS_MAX )
        {
            argp_error( state, "--track: got more than %d vertices, which is the limit", RUN_TRACKS_MAX );
        }
        def->tracks[def->track_count++] = ( run_track ){ argument, (int)( colon - argument ), (int)vertex };
        at = end;
    }
    if ( !is_good )
    {
        argp_error( state, "--track: got '%s', expected a body and its vertices, such as flag:0,31", argument );
    }
}

static void parse_values( struct argp_state* state, const char* argument, unsigned* values )
{
    for ( const char* at = argument; at; )
    {
        const size_t length = strcspn( at, "," );
        int found = -1;
        for ( int k = 0; k < RUN_VALUE_COUNT; ++k )
        {
            const bool is_equal =
                strlen( run_value_names[k] ) == length && !strncmp( at, run_value_names[k], length );
            found = is_equal ? k : found;
        }
        if ( found < 0 )
        {
            argp_error( state, "--record-with: got '%s', expected strain, speed or both with a comma", argument );
        }
        *values |= 1u << found;
        at = at[length] ? at + length + 1 : NULL;
    }
}

/// Options about recording. @return whether it was one of them
static bool parse_recorder( int key, char* argument, struct argp_state* state, run_recorder_def* def )
{
    switch ( key )
    {
        case KEY_RECORD:
            def->record = argument;
            return true;
        case KEY_RECORD_WITH:
            parse_values( state, argument, &def->values );
            return true;
        case KEY_EVERY:
            def->every = option_whole( state, "--every", argument, 1, STEPS_MAX );
            return true;
        case KEY_TRACK:
            parse_track( state, argument, def );
            return true;
        case KEY_TRACK_FILE:
            def->track_file = argument;
            return true;
        case KEY_VERIFY:
            def->verify = argument;
            return true;
        default:
            return false;
    }
}

static void check( struct argp_state* state, const run_options* options )
{
    const run_recorder_def* def = &options->recorder;
    if ( options->boundary && !io_has_extension( options->boundary, ".ply" ) )
    {
        argp_error( state, "--boundary: got '%s', expected a file name that ends in .ply", options->boundary );
    }
    if ( ( def->track_count > 0 ) != ( def->track_file != NULL ) )
    {
        argp_error( state, "--track: expected together with --track-file, or neither of them" );
    }
    if ( def->values && !( def->record && wisp_record_has_values( def->record ) ) )
    {
        argp_error( state, "--record-with: expected together with --record and a file that ends in .pvd or .usda" );
    }
    if ( def->values && def->verify )
    {
        argp_error( state, "--record-with: expected without --verify, since hashes cover what is computed" );
    }
    if ( def->verify && def->record && strcmp( def->verify, def->record ) == 0 )
    {
        argp_error( state, "--record: got '%s', which --verify reads; expected another file", def->verify );
    }
}

static error_t parse( int key, char* argument, struct argp_state* state )
{
    run_options* options = state->input;
    if ( parse_recorder( key, argument, state, &options->recorder ) )
    {
        return 0;
    }
    switch ( key )
    {
        case KEY_STEPS:
            options->steps = option_whole( state, "--steps", argument, 1, STEPS_MAX );
            return 0;
        case KEY_WORKERS:
            options->world.workers = option_whole( state, "--workers", argument, 1, WISP_MAX_WORKERS );
            return 0;
        case KEY_ISA:
            options->world.isa = option_isa_words[option_word( state, "--isa", argument, option_isa_words, 3 )];
            return 0;
        case KEY_FORMAT:
            options->format = (results_format)option_word( state, "--format", argument, results_format_names,
                                                           RESULTS_FORMAT_COUNT );
            return 0;
        case KEY_OUTPUT:
            options->output = argument;
            return 0;
        case KEY_BOUNDARY:
            options->boundary = argument;
            return 0;
        case ARGP_KEY_SUCCESS:
            check( state, options );
            return 0;
        default:
            return option_input( state, key, argument, "scene", &options->scene ) ? 0 : ARGP_ERR_UNKNOWN;
    }
}

// ---- the steps ----

static wisp_status simulate( scene_world* world, int steps, run_recorder* recorder, run_record* record,
                             wisp_error* error )
{
    record->ms = calloc( (size_t)steps + 1, sizeof( double ) );
    if ( !record->ms )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for the times of %d steps", steps );
    }
    progress bar = progress_begin();
    wisp_status status = run_recorder_step( recorder, error );
    while ( record->steps < steps && status == WISP_OK )
    {
        const double start = wisp_clock_seconds(), cpu_start = machine_cpu_seconds();
        status = scene_world_step( world, error );
        record->ms[record->steps] = 1e3 * ( wisp_clock_seconds() - start );
        record->cpu_seconds += machine_cpu_seconds() - cpu_start;
        if ( status == WISP_OK )
        {
            ++record->steps;
            status = profile_samples_add( &record->profile, wisp_world_profile( world->world ) );
            if ( status != WISP_OK )
            {
                wisp_fail( error, status, "run: out of memory for the profile of %d steps", steps );
            }
        }
        // Outside of the measured time: recording does not change the cost of a step.
        if ( status == WISP_OK )
        {
            status = run_recorder_step( recorder, error );
        }
        if ( status == WISP_OK )
        {
            status = run_layers_step( record->layers, error );
        }
        if ( status == WISP_OK )
        {
            status = run_collision_step( record->collision, error );
        }
        progress_show( &bar, (double)record->steps / steps, "steps" );
    }
    progress_end( &bar );
    return status;
}

// ---- one run ----

// A failed run still finishes the files it has begun. Its own message is the one that is printed.
static wisp_status simulate_and_record( run_options* options, scene_world* world, run_record* record, results* out,
                                        wisp_error* error )
{
    run_recorder* recorder = NULL;
    int steps = options->steps > 0 ? options->steps : world->scene->steps;
    options->recorder.steps = steps;
    options->recorder.is_part = options->steps > 0;
    const run_layers_def layers = { options->boundary, options->recorder.every };
    wisp_status status = run_layers_open( &layers, world, steps, &record->layers, error );
    if ( status == WISP_OK )
    {
        status = run_collision_open( world, &record->collision, error );
    }
    if ( status == WISP_OK )
    {
        status = run_recorder_open( &options->recorder, world, &recorder, error );
    }
    if ( status == WISP_OK )
    {
        status = simulate( world, steps, recorder, record, error );
    }
    run_recorder_counts counts = run_recorder_count( recorder );
    wisp_error later = { 0 };
    wisp_status closed = run_recorder_close( recorder, status == WISP_OK ? error : &later );
    status = status == WISP_OK ? closed : status;
    if ( status == WISP_OK )
    {
        status = scene_world_write_outputs( world, error );
    }
    if ( status == WISP_OK )
    {
        run_summarise( world, record, &options->recorder, counts, out );
    }
    return status;
}

// Results that exist after the last step only.
static wisp_status check_files( const run_options* options, const wisp_scene* scene, wisp_error* error )
{
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        wisp_error cause = { 0 };
        wisp_status status = command_check_writable( output->file, &cause );
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s:%d:%d: %s", scene->name, output->line, output->column,
                              cause.message );
        }
    }
    return command_check_writable( options->output, error );
}

static wisp_status run_scene( run_options* options, const wisp_scene* scene, results* out, wisp_error* error )
{
    scene_world world;
    run_record record = { 0 };
    wisp_status status = scene_world_create( scene, &options->world, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = simulate_and_record( options, &world, &record, out, error );
    profile_samples_free( &record.profile );
    run_layers_close( record.layers );
    run_collision_close( record.collision );
    free( record.ms );
    scene_world_destroy( &world );
    return status;
}

int command_run( int argc, char** argv )
{
    run_options options = { .recorder = { .every = 1 } };
    const struct argp parser = { option_list, parse, "SCENE", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &options );

    wisp_error error = { 0 };
    wisp_scene scene;
    if ( wisp_scene_read( options.scene, &scene, &error ) != WISP_OK )
    {
        return command_fail( &error );
    }
    results out = { 0 };
    results_put_options( &out, argc, argv );
    wisp_status status = check_files( &options, &scene, &error );
    status = status == WISP_OK ? run_scene( &options, &scene, &out, &error ) : status;
    if ( status == WISP_OK )
    {
        status = results_write_file( &out, options.format, options.output, &error );
    }
    results_free( &out );
    wisp_scene_release( &scene );
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
