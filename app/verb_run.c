#include "verbs.h"

#include "profile_samples.h"
#include "file_kind.h"
#include "progress.h"
#include "run_layers.h"
#include "run_recorder.h"
#include "scene.h"
#include "stats.h"
#include "world_from_scene.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MAX 100000000

typedef struct run_options
{
    const char* scene;
    int steps; ///< 0: as the scene says
    scene_world_options world;
    results_format format;
    const char* output;
    run_recorder_def recorder;
    const char* boundary; ///< file of boundary points, or null
} run_options;

/// What the steps leave behind.
typedef struct run_record
{
    profile_samples profile;
    double* ms; ///< [steps]
    int steps;
    run_layers* layers; ///< or null
} run_record;

// ---- the command line ----

enum
{
    KEY_STEPS = 's',
    KEY_WORKERS = 'w',
    KEY_FORMAT = 'f',
    KEY_OUTPUT = 'o',
    KEY_ISA = 256,
    KEY_RECORD,
    KEY_EVERY,
    KEY_TRACK,
    KEY_TRACK_FILE,
    KEY_VERIFY,
    KEY_BOUNDARY,
};

static const char doc[] =
    "Simulate a scene, write the files it asks for, and print a summary.\n"
    "\v"
    "A recording has the start and the state after each step, or after every Nth. Its extension decides what it is: "
    ".wisp (every bit, for wisp render and --verify), .pc2 (point caches, a file a body), .pvd (ParaView), .obj (a "
    "numbered file a frame) or .usda.\n"
    "\n"
    "Files of --boundary have the vertices of the mesh and behind them the boundary points, each with its normal and "
    "the "
    "number of its edge or triangle. They are numbered as the frames of a recording, of which 1 is the start: "
    "FILE_0002.ply, or FILE_SURFACE_0002.ply of several surfaces.\n" STATUS_HELP;

static const struct argp_option option_list[] = {
    { "steps", KEY_STEPS, "N", 0, "Simulate N steps instead of the scene's", 0 },
    { "workers", KEY_WORKERS, "N", 0, "Use N workers, 1 to 64, instead of the scene's or one a core", 0 },
    { "isa", KEY_ISA, "SET", 0, "Use at most this instruction set: baseline, avx2 or avx512", 0 },
    { "format", KEY_FORMAT, "FORMAT", 0, "Summary as text (default), markdown, csv, json or gbench", 0 },
    { "output", KEY_OUTPUT, "FILE", 0, "Write the summary to FILE instead of standard output", 0 },
    { "record", KEY_RECORD, "FILE", 0, "Record where every vertex is (.wisp, .pc2, .pvd, .obj, .usda)", 0 },
    { "every", KEY_EVERY, "N", 0, "Record, track and write boundary points every Nth step, default 1", 0 },
    { "track", KEY_TRACK, "BODY:VERTEX[,VERTEX...]", 0, "Follow vertices of a body; may be said again", 0 },
    { "track-file", KEY_TRACK_FILE, "FILE.csv", 0, "Where the tracks go", 0 },
    { "boundary", KEY_BOUNDARY, "FILE.ply", 0, "Write the boundary points of all surfaces that have some", 0 },
    { "verify", KEY_VERIFY, "FILE.wisp", 0, "Fail unless each frame has the bits of this recording", 0 },
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
            argp_error( state, "--track: more than %d vertices", RUN_TRACKS_MAX );
        }
        def->tracks[def->track_count++] = ( run_track ){ argument, (int)( colon - argument ), (int)vertex };
        at = end;
    }
    if ( !is_good )
    {
        argp_error( state, "--track: '%s' is not a body and its vertices, such as flag:0,31", argument );
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
    if ( options->boundary && !file_ends_in( options->boundary, ".ply" ) )
    {
        argp_error( state, "--boundary: '%s' does not end in .ply, the format of points with normals",
                    options->boundary );
    }
    if ( ( def->track_count > 0 ) != ( def->track_file != NULL ) )
    {
        argp_error( state, "--track says what is followed and --track-file where it goes: both or neither" );
    }
    if ( def->verify && def->record && strcmp( def->verify, def->record ) == 0 )
    {
        argp_error( state, "--record would write over '%s' while --verify reads it", def->verify );
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

// ---- the steps ----

static wisp_status simulate( scene_world* world, int steps, run_recorder* recorder, run_record* record,
                             wisp_error* error )
{
    record->ms = calloc( (size_t)steps + 1, sizeof( double ) );
    if ( !record->ms )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the times of %d steps", steps );
    }
    progress bar = progress_begin();
    wisp_status status = run_recorder_step( recorder, error );
    while ( record->steps < steps && status == WISP_OK )
    {
        double start = wisp_clock_seconds();
        status = scene_world_step( world, error );
        record->ms[record->steps] = 1e3 * ( wisp_clock_seconds() - start );
        if ( status == WISP_OK )
        {
            ++record->steps;
            status = profile_samples_add( &record->profile, wisp_world_profile( world->world ) );
            if ( status != WISP_OK )
            {
                wisp_fail( error, status, "no memory for the profile of %d steps", steps );
            }
        }
        // Outside of the time that was taken: what a step costs does not depend on who looks on.
        if ( status == WISP_OK )
        {
            status = run_recorder_step( recorder, error );
        }
        if ( status == WISP_OK )
        {
            status = run_layers_step( record->layers, error );
        }
        progress_show( &bar, (double)record->steps / steps, "steps" );
    }
    progress_end( &bar );
    return status;
}

// ---- the summary ----

static void add_profile_table( results* out, run_record* record, double step_ms )
{
    const char* const header[] = { "pass", "items", "ms", "share %" };
    int table = results_add_table( out, "Passes, median over the steps that ran them", 4, header );
    for ( int i = 0; i < record->profile.pass_count; ++i )
    {
        double ms = 1e3 * profile_samples_median( &record->profile, i );
        char items[16], time[24], share[16];
        snprintf( items, sizeof( items ), "%d", record->profile.passes[i].items );
        snprintf( time, sizeof( time ), "%.4f", ms );
        snprintf( share, sizeof( share ), "%.1f", step_ms > 0.0 ? 100.0 * ms / step_ms : 0.0 );
        results_add_cells( out, table,
                           ( const char* const[] ){ record->profile.passes[i].name, items, time, share } );
    }
}

static void add_counter_table( results* out, const wisp_world* world )
{
    const char* const header[] = { "counter", "value" };
    int table = results_add_table( out, "Counters over the whole run", 2, header );
    for ( int i = 0; i < WISP_COUNTER_COUNT; ++i )
    {
        char value[24];
        snprintf( value, sizeof( value ), "%llu", (unsigned long long)wisp_world_counter( world, (wisp_counter)i ) );
        results_add_cells( out, table, ( const char* const[] ){ wisp_counter_name( (wisp_counter)i ), value } );
    }
}

static const char* last_part( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? slash + 1 : path;
}

static void add_row( results* out, const scene_world* world, run_record* record, stats_summary times )
{
    results_row* row = results_add_row( out, last_part( world->scene->name ), "run" );
    if ( !row )
    {
        return;
    }
    int vertices = scene_world_vertices( world );
    results_put( &row->size, "strands", scene_world_strands( world ) );
    results_put( &row->size, "vertices", vertices );
    if ( vertices > 0 )
    {
        results_put( &row->size, "bytes_a_vertex", (double)wisp_world_memory( world->world ) / vertices );
    }
    row->workers = wisp_world_workers( world->world );
    row->ms_median = times.median;
    row->ms_p10 = times.p10;
    row->ms_p90 = times.p90;
    row->steps = record->steps;
    for ( int i = 0; i < record->profile.pass_count; ++i )
    {
        results_put( &row->stages, record->profile.passes[i].name,
                     1e3 * profile_samples_median( &record->profile, i ) );
    }
    row->hash = wisp_world_hash( world->world );
    row->has_hash = true;
    run_layers_put( record->layers, &row->size );
}

// What went wrong now and then, and was answered for.
static void add_warnings( results* out, const wisp_world* world )
{
    static const struct
    {
        wisp_counter counter;
        const char* sentence;
    } warnings[] = {
        { WISP_COUNT_CAPPED, "neighbour queries ran into the limit, and the vertices beyond it were left out" },
        { WISP_COUNT_UNSOLVED, "solves ended at their limit of iterations, short of their tolerance" },
        { WISP_COUNT_INDEFINITE, "solves met negative curvature and stopped there" },
        { WISP_COUNT_UNDIRECTED, "times a link between coincident vertices had no direction and gave no force" },
        { WISP_COUNT_LOWERED, "substeps had links that are stiffer than floats can solve for, and lowered them" },
        { WISP_COUNT_FIRST_ORDER, "substeps were too long for BDF2 and went by implicit Euler" },
        { WISP_COUNT_LIGHTENED,
          "strands feel a share of their weight only, because substeps are too long for their curls" },
    };
    for ( int i = 0; i < WISP_COUNT( warnings ); ++i )
    {
        uint64_t count = wisp_world_counter( world, warnings[i].counter );
        if ( count > 0 )
        {
            results_add_note( out, "%llu %s.", (unsigned long long)count, warnings[i].sentence );
        }
    }
}

// Of surfaces that are asked for them.
static void add_solver_notes( results* out, const scene_world* world )
{
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        const wisp_scene_surface* entry = &world->scene->surfaces[i];
        wisp_implicit_cloth_figures f;
        if ( entry->has_implicit && entry->want_figures &&
             wisp_read_implicit_cloth_figures( world->world, world->surfaces[i].entity, &f ) == WISP_OK )
        {
            results_add_note( out,
                              "%s, last substep: %d iterations, residual %.1e; %d vertices stick, %d slide, %d land; "
                              "energy of stretch %.3e J, of bending %.3e J.",
                              entry->name, f.iterations, (double)f.residual, f.sticking, f.sliding, f.landing,
                              f.stretch_energy, f.bend_energy );
        }
    }
}

static void add_notes( results* out, const scene_world* world, const run_record* record, stats_summary times )
{
    const wisp_scene* scene = world->scene;
    int vertices = scene_world_vertices( world );
    double bytes = (double)wisp_world_memory( world->world );
    if ( record->steps > 0 )
    {
        results_add_note( out, "%d steps with %d workers: %.4f ms a step (p10 %.4f, p90 %.4f).", record->steps,
                          wisp_world_workers( world->world ), times.median, times.p10, times.p90 );
    }
    else
    {
        results_add_note( out, "No step was made; what is written is the rest shape." );
    }
    results_add_note( out, "%d strands, %d vertices, %.0f bytes, %.1f bytes a vertex.", scene_world_strands( world ),
                      vertices, bytes, vertices > 0 ? bytes / vertices : 0.0 );
    for ( int i = 0; i < scene->output_count; ++i )
    {
        results_add_note( out, "Written: %s", scene->outputs[i].file );
    }
    if ( world->next_command < scene->command_count )
    {
        results_add_note( out, "%d of %d commands come after the last step and were not given.",
                          scene->command_count - world->next_command, scene->command_count );
    }
    add_solver_notes( out, world );
    run_layers_report( record->layers, out );
    add_warnings( out, world->world );
    results_add_note( out, "Hash %016llx", (unsigned long long)wisp_world_hash( world->world ) );
}

static void summarise( const scene_world* world, run_record* record, results* out )
{
    out->machine = machine_describe( wisp_world_isa( world->world ) );
    stats_summary times = stats_summarise( record->ms, record->steps );
    add_row( out, world, record, times );
    add_profile_table( out, record, times.median );
    add_counter_table( out, world->world );
    add_notes( out, world, record, times );
}

static void add_recorder_notes( results* out, const run_recorder_def* def, run_recorder_counts counts )
{
    if ( def->record )
    {
        results_add_note( out, "Recorded: %d frames in %s", counts.written, def->record );
    }
    if ( def->track_count > 0 )
    {
        results_add_note( out, "Tracked: %d vertices over %d frames in %s", def->track_count, counts.written,
                          def->track_file );
    }
    if ( def->verify )
    {
        results_add_note( out, "Verified: %d frames of %s, every bit is equal", counts.verified, def->verify );
    }
    if ( counts.unreached > 0 )
    {
        results_add_note( out, "%d frames of %s come after the last step and were not compared.", counts.unreached,
                          def->verify );
    }
}

// What was written before a failure is finished all the same; the failure is what is told.
static wisp_status simulate_and_record( const run_options* options, scene_world* world, run_record* record,
                                        results* out, wisp_error* error )
{
    run_recorder* recorder = NULL;
    int steps = options->steps > 0 ? options->steps : world->scene->steps;
    const run_layers_def layers = { options->boundary, options->recorder.every };
    wisp_status status = run_layers_open( &layers, world, steps, &record->layers, error );
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
        summarise( world, record, out );
        add_recorder_notes( out, &options->recorder, counts );
    }
    return status;
}

// What is written after the last step only.
static wisp_status check_files( const run_options* options, const wisp_scene* scene, wisp_error* error )
{
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        wisp_error cause = { 0 };
        wisp_status status = verb_check_writable( output->file, &cause );
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s:%d:%d: %s", scene->name, output->line, output->column,
                              cause.sentence );
        }
    }
    return verb_check_writable( options->output, error );
}

static wisp_status run_scene( const run_options* options, const wisp_scene* scene, results* out, wisp_error* error )
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
    free( record.ms );
    scene_world_destroy( &world );
    return status;
}

int verb_run( int argc, char** argv )
{
    run_options options = { .recorder = { .every = 1 } };
    const struct argp parser = { option_list, parse, "SCENE", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &options );

    wisp_error error = { 0 };
    wisp_scene scene;
    if ( wisp_scene_read( options.scene, &scene, &error ) != WISP_OK )
    {
        return verb_fail( &error );
    }
    results out = { 0 };
    wisp_status status = check_files( &options, &scene, &error );
    status = status == WISP_OK ? run_scene( &options, &scene, &out, &error ) : status;
    if ( status == WISP_OK )
    {
        status = results_write_file( &out, options.format, options.output, &error );
    }
    results_free( &out );
    wisp_scene_release( &scene );
    return status == WISP_OK ? STATUS_GOOD : verb_fail( &error );
}
