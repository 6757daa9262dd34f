#include "commands.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "run_recorder.h"
#include "run_summary.h"
#include "scene.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define RUN_STEPS_MAX 100000000

typedef struct run_options
{
    const char* scene;
    int steps; ///< 0: that of the scene
    scene_world_options world;
    results_format format;
    const char* output;
    run_recorder_def recorder;
    const char* boundary; ///< file of boundary points, or null
    int frames_per_step;  ///< 0: that of the scene
    bool is_verbose;
    bool intersections; ///< count those of all surfaces after each step
} run_options;

// ---- the command line ----

static void parse_track( const options_state* o, const char* argument )
{
    run_recorder_def* def = &( (run_options*)o->input )->recorder;
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
            options_fail( o, "--track: got more than %d vertices, which is the limit", RUN_TRACKS_MAX );
        }
        def->tracks[def->track_count++] = ( run_track ){ argument, (int)( colon - argument ), (int)vertex };
        at = end;
    }
    if ( !is_good )
    {
        options_fail( o, "--track: got '%s', expected a body and its vertices, such as flag:0,31", argument );
    }
}

static void parse_values( const options_state* o, const char* argument )
{
    unsigned* values = &( (run_options*)o->input )->recorder.values;
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
            options_fail( o, "--record-with: got '%s', expected strain, speed or both with a comma", argument );
        }
        *values |= 1u << found;
        at = at[length] ? at + length + 1 : NULL;
    }
}

static const option_row run_rows[] = {
    OPTION_TITLE( "Simulation:" ),
    { "steps", 's', "N", "Simulate N steps; default: the scene's steps",
      OPTION_WHOLE( run_options, steps, 1, RUN_STEPS_MAX ) },
    { "workers", 'w', "N", "Use N workers, 1 to 64; default: the scene's, or one per core",
      OPTION_WHOLE( run_options, world.workers, 1, WISP_MAX_WORKERS ) },
    { "isa", 0, "SET", "Use at most baseline, avx2 or avx512; default: the best available",
      OPTION_NAME( run_options, world.isa, option_isa_words ) },
    OPTION_TITLE( "Summary:" ),
    { "intersections", 0, NULL, "Count the edges through triangles of all surfaces after each step",
      OPTION_FLAG( run_options, intersections ) },
    { "verbose", 'v', NULL, "Print tables of passes, memory, counters and what the scene computes",
      OPTION_FLAG( run_options, is_verbose ) },
    OPTION_RESULTS_FORMAT( run_options, format ),
    { "output", 'o', "FILE", "Write the summary to FILE; default: standard output",
      OPTION_TEXT( run_options, output, "*" ) },
    OPTION_TITLE( "Recording:" ),
    { "record", 0, "FILE", "Record all vertices (.wisp, .pc2, .pvd, .obj, .usda, .glb)",
      OPTION_FILE( run_options, recorder.record, ".wisp .pc2 .pvd .obj .usda .glb" ) },
    { "record-with",
      0,
      "VALUE[,VALUE]",
      "Compute strain or speed and record them too (.pvd, .usda); default: those that the scene computes",
      { OPTION_LIST( run_value_names ), .to = { .take = parse_values } } },
    { "every", 0, "N", "Record every Nth step, default 1",
      OPTION_WHOLE( run_options, recorder.every, 1, RUN_STEPS_MAX ) },
    { "frames-per-step", 0, "N",
      "Record N frames per step, 1 to 1000, ghosts on smooth curves in time; default: the scene's",
      OPTION_WHOLE( run_options, frames_per_step, 1, 1000 ) },
    { "track", 0, "BODY:VERTEX[,VERTEX...]", "Write the path of these vertices; can be repeated",
      OPTION_TAKEN( parse_track ) },
    { "track-file", 0, "FILE.csv", "File for the paths of --track",
      OPTION_FILE( run_options, recorder.track_file, ".csv" ) },
    { "boundary", 0, "FILE.ply", "Write the boundary points of all surfaces",
      OPTION_FILE( run_options, boundary, ".ply" ) },
    { "verify", 0, "FILE.wisp", "Fail at the first frame that differs from this recording",
      OPTION_TEXT( run_options, recorder.verify, ".wisp" ) },
};

const command_text run_text = {
    .name = "run",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "simulate a scene, write its files and print a summary",
    .about = "Simulate a scene, write its files and print a summary.",
    .notes = "Recordings hold the start of the scene and the state after each step. The extension\n"
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
             "docs/outputs.md describes each format, the summary and the hash.",
    .examples = "wisp run data/scenes/flag.yaml\n"
                "wisp run data/scenes/flag.yaml --steps 100 --record flag.wisp\n"
                "wisp run data/scenes/character.yaml --intersections",
    .rows = run_rows,
    .row_count = WISP_COUNT( run_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, run_options, scene, ".yaml .yml .json" ),
};

static void check_run_options( const options_state* o )
{
    const run_options* options = o->input;
    const run_recorder_def* def = &options->recorder;
    if ( options->boundary && !io_has_extension( options->boundary, ".ply" ) )
    {
        options_fail( o, "--boundary: got '%s', expected a file name that ends in .ply", options->boundary );
    }
    if ( ( def->track_count > 0 ) != ( def->track_file != NULL ) )
    {
        options_fail( o, "--track: expected together with --track-file, or neither of them" );
    }
    if ( def->values && !( def->record && wisp_record_has_values( def->record ) ) )
    {
        options_fail( o, "--record-with: expected together with --record and a file that ends in .pvd or .usda" );
    }
    if ( def->values && def->verify )
    {
        options_fail( o, "--record-with: expected without --verify, since hashes cover what is computed" );
    }
    if ( options->frames_per_step > 1 && def->every > 1 )
    {
        options_fail( o, "--frames-per-step: expected without --every, which leaves steps out" );
    }
    if ( options->frames_per_step > 1 && !def->record && def->track_count == 0 )
    {
        options_fail( o, "--frames-per-step: expected together with --record or --track" );
    }
    if ( def->verify && def->record && strcmp( def->verify, def->record ) == 0 )
    {
        options_fail( o, "--record: got '%s', which --verify reads; expected another file", def->verify );
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
    while ( record->steps < steps && status == WISP_OK && !interruption_came() )
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
        status = status == WISP_OK ? run_recorder_step( recorder, error ) : status;
        status = status == WISP_OK ? run_contact_step( record->contact, error ) : status;
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
    const run_contact_def contact = { options->boundary, options->recorder.every };
    wisp_status status = run_contact_open( &contact, world, steps, &record->contact, error );
    status = status == WISP_OK ? run_recorder_open( &options->recorder, world, &recorder, error ) : status;
    status = status == WISP_OK ? simulate( world, steps, recorder, record, error ) : status;
    run_recorder_counts counts = run_recorder_count( recorder );
    wisp_error later = { 0 };
    wisp_status closed = run_recorder_close( recorder, status == WISP_OK ? error : &later );
    status = status == WISP_OK ? closed : status;
    record->all_steps = steps;
    // What the scene writes is its end, which an interrupted run has not reached.
    if ( status == WISP_OK && record->steps == steps )
    {
        status = scene_world_write_outputs( world, error );
    }
    if ( status == WISP_OK )
    {
        run_summarise( world, record, &options->recorder, counts,
                       !options->is_verbose && options->format == RESULTS_TEXT, out );
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
    WISP_TRY( scene_world_create( scene, &options->world, &world, error ) );
    wisp_status status = simulate_and_record( options, &world, &record, out, error );
    profile_samples_free( &record.profile );
    run_contact_close( record.contact );
    free( record.ms );
    scene_world_destroy( &world );
    return status;
}

int command_run( int argc, char** argv )
{
    run_options options = { .recorder = { .every = 1 } };
    options_parse( &run_text, check_run_options, &options, argc, argv );

    wisp_error error = { 0 };
    wisp_scene scene;
    if ( wisp_scene_read( options.scene, &scene, &error ) != WISP_OK )
    {
        return command_fail( &error );
    }
    scene.frames_per_step = options.frames_per_step > 0 ? options.frames_per_step : scene.frames_per_step;
    if ( options.intersections )
    {
        scene_request_intersections( &scene );
    }
    interruption_begin(); // before that there is nothing to keep
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
    return status == WISP_OK ? interruption_status( STATUS_GOOD ) : command_fail( &error );
}
