#include "verbs.h"

#include "scene.h"
#include "world_from_scene.h"

static const char doc[] = "Print the passes that a scene needs with the reason for each, and what absent ones lack.\n"
                          "\v" STATUS_HELP;

static error_t parse( int key, char* argument, struct argp_state* state )
{
    const char** scene = state->input;
    switch ( key )
    {
        case ARGP_KEY_ARG:
            if ( *scene )
            {
                argp_error( state, "one scene at a time, but there is also '%s'", argument );
            }
            *scene = argument;
            return 0;
        case ARGP_KEY_NO_ARGS:
            argp_error( state, "which scene?" );
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

static void print_line( void* user, const char* line )
{
    fprintf( user, "%s\n", line );
}

int verb_plan( int argc, char** argv )
{
    const char* path = NULL;
    const struct argp parser = { .parser = parse, .args_doc = "SCENE", .doc = doc };
    argp_parse( &parser, argc, argv, 0, NULL, &path );

    wisp_error error = { 0 };
    wisp_scene scene;
    if ( wisp_scene_read( path, &scene, &error ) != WISP_OK )
    {
        return verb_fail( &error );
    }
    // A plan needs no second thread, and one worker starts none.
    const scene_world_options options = { .workers = 1 };
    scene_world world;
    wisp_status status = scene_world_create( &scene, &options, &world, &error );
    if ( status == WISP_OK )
    {
        status = wisp_world_plan( world.world, print_line, stdout );
        if ( status != WISP_OK )
        {
            wisp_fail( &error, status, "%s: %s", scene.name, wisp_world_message( world.world ) );
        }
        else if ( fflush( stdout ) != 0 || ferror( stdout ) )
        {
            status = wisp_fail( &error, WISP_IO_ERROR, "the plan could not be written" );
        }
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status == WISP_OK ? STATUS_GOOD : verb_fail( &error );
}
