#include "verbs.h"

#include "info_results.h"
#include "world_from_scene.h"

#include <errno.h>
#include <string.h>
#include <strings.h>

static const char doc[] =
    "Tell what is in a groom (.hair, .tfx), a scene (.yaml, .yml, .json) or a result (.json), and "
    "what is wrong with it.\n"
    "\v" STATUS_HELP;

static error_t parse( int key, char* argument, struct argp_state* state )
{
    const char** path = state->input;
    switch ( key )
    {
        case ARGP_KEY_ARG:
            if ( *path )
            {
                argp_error( state, "one file at a time, but there is also '%s'", argument );
            }
            *path = argument;
            return 0;
        case ARGP_KEY_NO_ARGS:
            argp_error( state, "which file?" );
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

// ---- what kind of file ----

typedef enum file_kind
{
    KIND_UNKNOWN,
    KIND_GROOM,
    KIND_SCENE,
    KIND_RESULTS,
} file_kind;

static bool ends_in( const char* path, const char* extension )
{
    size_t length = strlen( path ), tail = strlen( extension );
    return length > tail && strcasecmp( path + length - tail, extension ) == 0;
}

// Names decide, except that a groom may be called anything as long as it begins like one, and that scenes and results
// can both be JSON.
static wisp_status find_kind( const char* path, file_kind* kind, wisp_error* error )
{
    FILE* file = fopen( path, "rb" );
    if ( !file )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", path, strerror( errno ) );
    }
    char head[4096];
    size_t size = fread( head, 1, sizeof( head ), file );
    bool failed = ferror( file ) != 0;
    int cause = errno;
    fclose( file );
    if ( failed )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", path, strerror( cause ) );
    }

    bool is_hair = size >= 4 && memcmp( head, "HAIR", 4 ) == 0;
    bool is_json = ends_in( path, ".json" );
    *kind = is_hair || ends_in( path, ".hair" ) || ends_in( path, ".tfx" )   ? KIND_GROOM
            : is_json && info_is_results( head, size )                       ? KIND_RESULTS
            : is_json || ends_in( path, ".yaml" ) || ends_in( path, ".yml" ) ? KIND_SCENE
                                                                             : KIND_UNKNOWN;
    return *kind != KIND_UNKNOWN
               ? WISP_OK
               : wisp_fail(
                     error, WISP_BAD_INPUT,
                     "%s: neither a groom (.hair, .tfx), nor a scene (.yaml, .yml, .json), nor a result (.json)",
                     path );
}

// ---- grooms ----

static wisp_status info_groom( const char* path, wisp_error* error )
{
    wisp_groom groom;
    wisp_status status = wisp_groom_read( path, &groom, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    // Told first, refused afterwards: the list of what is wrong helps more than its first element alone.
    status = wisp_groom_info( stdout, &groom, path );
    if ( status == WISP_OK )
    {
        wisp_error cause = { 0 };
        status = wisp_groom_check( &groom, &cause );
        if ( status != WISP_OK )
        {
            wisp_fail( error, status, "%s: %s", path, cause.sentence );
        }
    }
    else
    {
        wisp_fail( error, status, "%s: it cannot be described (%s)", path, wisp_status_name( status ) );
    }
    wisp_groom_release( &groom );
    return status;
}

// ---- scenes ----

static const char* shape_name( wisp_groom_shape shape )
{
    return shape == WISP_GROOM_STRAIGHT ? "straight" : shape == WISP_GROOM_WAVY ? "wavy" : "curly";
}

static void print_stages( const wisp_frozen_hair_def* def )
{
    printf( "    frozen hair:%s%s%s\n", def->freeze ? " freeze" : "", def->align ? " align" : "",
            def->clump ? " clump" : "" );
}

static void print_strands( const wisp_scene_strands* entry, const wisp_groom* groom )
{
    printf( "  %s (line %d): %d strands, %d vertices, %d dimensions, ", entry->name, entry->line, groom->strand_count,
            groom->vertex_count, groom->dimension );
    if ( entry->is_made )
    {
        printf( "made: %s\n", shape_name( entry->recipe.shape ) );
    }
    else
    {
        printf( "read from %s\n", entry->file );
    }
    if ( entry->has_frozen_hair )
    {
        print_stages( &entry->frozen_hair );
    }
    if ( entry->has_climate )
    {
        printf( "    climate: %g degrees Celsius, wetness %g\n", (double)entry->climate.temperature,
                (double)entry->climate.wetness );
    }
    if ( entry->has_look )
    {
        printf( "    look: %g to %g m wide\n", (double)entry->look.root_width, (double)entry->look.tip_width );
    }
    if ( entry->want_points || entry->want_width || entry->want_colour )
    {
        printf( "    wants:%s%s%s\n", entry->want_points ? " points" : "", entry->want_width ? " width" : "",
                entry->want_colour ? " colour" : "" );
    }
}

// Files are read whole and checked: that they exist says little.
static wisp_status info_scene( const char* path, wisp_error* error )
{
    wisp_scene scene;
    wisp_status status = wisp_scene_read( path, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    printf( "%s: scene of %d steps of %g s, %d substeps, %d iterations\n", path, scene.steps,
            (double)scene.step_seconds, scene.substeps, scene.iterations );
    printf( "strands: %d\n", scene.strands_count );
    for ( int i = 0; i < scene.strands_count && status == WISP_OK; ++i )
    {
        wisp_groom groom;
        status = scene_groom( &scene, i, &groom, error );
        if ( status == WISP_OK )
        {
            print_strands( &scene.strands[i], &groom );
            wisp_groom_release( &groom );
        }
    }
    if ( status == WISP_OK )
    {
        printf( "commands: %d\n", scene.command_count );
        printf( "outputs: %d\n", scene.output_count );
        for ( int i = 0; i < scene.output_count; ++i )
        {
            printf( "  %s of %s\n", scene.outputs[i].file, scene.strands[scene.outputs[i].strands].name );
        }
    }
    wisp_scene_release( &scene );
    return status;
}

int verb_info( int argc, char** argv )
{
    const char* path = NULL;
    const struct argp parser = { .parser = parse, .args_doc = "FILE", .doc = doc };
    argp_parse( &parser, argc, argv, 0, NULL, &path );

    wisp_error error = { 0 };
    file_kind kind = KIND_UNKNOWN;
    wisp_status status = find_kind( path, &kind, &error );
    if ( status == WISP_OK )
    {
        status = kind == KIND_GROOM   ? info_groom( path, &error )
                 : kind == KIND_SCENE ? info_scene( path, &error )
                                      : info_results( path, stdout, &error );
    }
    if ( status == WISP_OK && ( fflush( stdout ) != 0 || ferror( stdout ) ) )
    {
        status = wisp_fail( &error, WISP_IO_ERROR, "the description could not be written" );
    }
    return status == WISP_OK ? STATUS_GOOD : verb_fail( &error );
}
