#include "bench_commands.h"
#include "bench_texts.h"

#include "interruption.h"
#include "torture_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FILES_MAX 4096
#define MESHES_MAX 64
#define MINUTES_MAX 1e6

typedef struct torture_options
{
    torture_search search;
    const char* meshes[MESHES_MAX];
    const char* files[FILES_MAX];
    int file_count;
    double minutes; ///< 0: not given
    bool prints;    ///< the first scene, instead of a search
    results_format format;
} torture_options;

// ---- the command line ----

// A path of a mesh must not depend on the folder of the scenes that name it.
static void add_mesh( const options_state* o, torture_options* options, const char* path )
{
    if ( options->search.generator.mesh_count == MESHES_MAX )
    {
        options_fail( o, "--mesh: got more than %d files", MESHES_MAX );
    }
    char* absolute = realpath( path, NULL );
    if ( absolute == NULL )
    {
        options_fail( o, "--mesh: got '%s', expected a file", path );
    }
    options->meshes[options->search.generator.mesh_count++] = absolute;
}

static void add_file( const options_state* o, torture_options* options, const char* path )
{
    if ( options->file_count == FILES_MAX )
    {
        options_fail( o, "got more than %d scenes", FILES_MAX );
    }
    options->files[options->file_count++] = path;
}

static bool take_torture_option( options_state* o, int key, const char* argument )
{
    torture_options* options = o->input;
    torture_search* search = &options->search;
    switch ( key )
    {
        case TORTURE_KEY_MINUTES:
            options->minutes = option_positive( o, argument, MINUTES_MAX );
            return true;
        case TORTURE_KEY_SCENES:
            search->max_scenes = option_whole( o, argument, 1, 1000000000 );
            return true;
        case TORTURE_KEY_SEED:
            search->generator.seed = (uint64_t)option_whole( o, argument, 0, 2000000000 );
            return true;
        case TORTURE_KEY_FIRST:
            search->first = option_whole( o, argument, 0, 1000000000 );
            return true;
        case TORTURE_KEY_MESH:
            add_mesh( o, options, argument );
            return true;
        case TORTURE_KEY_LIMIT:
            search->scene_seconds = option_positive( o, argument, 1e6 );
            return true;
        case TORTURE_KEY_JOBS:
            search->jobs = option_whole( o, argument, 1, 64 );
            return true;
        case TORTURE_KEY_CLOSE:
            search->close = TORTURE_CLOSE;
            return true;
        case TORTURE_KEY_PRINT:
            options->prints = true;
            return true;
        case TORTURE_KEY_OUT:
            search->folder = option_file( o, argument );
            return true;
        case TORTURE_KEY_KEEP:
            search->keep = option_whole( o, argument, 0, 1000000 );
            return true;
        case TORTURE_KEY_FORMAT:
            options->format = (results_format)option_word( o, argument );
            return true;
        case OPTIONS_OPERAND:
            add_file( o, options, argument );
            return true;
        default:
            return false;
    }
}

static int core_count( void )
{
    const long cores = sysconf( _SC_NPROCESSORS_ONLN );
    return cores < 1 ? 1 : cores > 64 ? 64 : (int)cores;
}

static int print_scene( const torture_search* search )
{
    text_node* scene = torture_generate( &search->generator, search->first );
    char* text = text_write( scene, NULL );
    fputs( text, stdout );
    free( text );
    text_release( scene );
    return STATUS_GOOD;
}

int command_torture( int argc, char** argv )
{
    static torture_options options; // too large for a stack
    options = ( torture_options ){
        .search = { .generator = { .seed = 1 },
                    .jobs = core_count(),
                    .scene_seconds = 20.0,
                    .folder = TORTURE_FOLDER,
                    .keep = 3 },
    };
    options.search.generator.meshes = options.meshes;
    options_parse( &torture_text, take_torture_option, &options, argc, argv );
    const bool has_end = options.minutes > 0.0 || options.search.max_scenes == 0;
    options.search.max_seconds = has_end ? 60.0 * ( options.minutes > 0.0 ? options.minutes : 1.0 ) : INFINITY;

    if ( options.prints )
    {
        return print_scene( &options.search );
    }
    interruption_begin();
    wisp_error error = { 0 };
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    torture_found found;
    wisp_status status = options.file_count > 0
                             ? torture_replay( options.files, options.file_count, options.search.close,
                                               options.search.scene_seconds, &found, &out, &error )
                             : torture_search_run( &options.search, &found, &out, &error );
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    for ( int i = 0; i < options.search.generator.mesh_count; ++i )
    {
        free( (void*)(uintptr_t)options.meshes[i] );
    }
    return status != WISP_OK ? command_fail( &error )
                             : interruption_status( torture_broken_count( &found ) > 0 ? STATUS_UNMET : STATUS_GOOD );
}
