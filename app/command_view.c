#include "commands.h"

#include "file_kind.h"
#include "interruption.h"
#include "io_file.h"
#include "record.h"
#include "view_page.h"
#include "view_scene.h"

#include <stdio.h>
#include <string.h>

#define STEPS_MAX 1000000

typedef struct view_options
{
    const char* input;
    const char* output;
    int steps; ///< that are hashed; -1: those of the scene
} view_options;

// ---- the command line ----

enum
{
    KEY_OUTPUT = 'o',
    KEY_STEPS = 's',
};

static const option_row rows[] = {
    { "output", KEY_OUTPUT, "FILE.html", "Write the page to FILE.html; required", OPTION_FILES( ".html" ) },
    { "steps", KEY_STEPS, "N", "Simulate N steps for hashes, 0 for none; default: the scene's steps", OPTION_ANY },
};

const command_text view_text = {
    .name = "view",
    .operands = "SCENE|RECORDING",
    .noun = "scene or recording",
    .summary = "write a page that simulates a scene, or plays a recording, in a browser",
    .about = "Write a page that simulates a scene, or plays a recording, in a browser.",
    .notes = "The page is one file with all that it needs. It opens without a network and without a server.\n"
             "The scene runs in WebAssembly, with the bits of this program: the page shows its hash of every\n"
             "60th step beside that of a run that is made now. Vertices and colliders can be dragged, settings\n"
             "of accuracy changed, and hair with `frozen_hair` combed. docs/view.md describes it.\n"
             "\n"
             "Recordings end in .wisp, as 'wisp run --record' writes them.",
    .examples = "wisp view data/scenes/flag.yaml -o flag.html\n"
                "wisp view flag.wisp -o flag.html",
    .rows = rows,
    .row_count = WISP_COUNT( rows ),
    .values = OPTION_FILES( ".yaml .yml .json .wisp" ),
};

static void check( const options_state* o, const view_options* options )
{
    if ( !options->output )
    {
        options_fail( o, "expected an output file: -o FILE.html" );
    }
    if ( !io_is_standard( options->output ) && !io_has_extension( options->output, ".html" ) )
    {
        options_fail( o, "-o: got '%s', expected a file name that ends in .html", options->output );
    }
}

static bool take( options_state* o, int key, const char* argument )
{
    view_options* options = o->input;
    switch ( key )
    {
        case KEY_OUTPUT:
            options->output = argument;
            return true;
        case KEY_STEPS:
            options->steps = option_whole( o, argument, 0, STEPS_MAX );
            return true;
        case OPTIONS_END:
            option_input( o, key, argument, &options->input );
            check( o, options );
            return true;
        default:
            return option_input( o, key, argument, &options->input );
    }
}

// ---- data ----

// The title is the name without its extension.
static json_t* begin_data( const char* kind, const char* path, json_t* files )
{
    const char* name = io_file_name( io_input_name( path ) );
    const char* dot = strrchr( name, '.' );
    return json_pack( "{s:s, s:s, s:s, s:s%, s:O}", "version", WISP_VERSION_STRING, "kind", kind, "name", name,
                      "title", name, dot ? (size_t)( dot - name ) : strlen( name ), "files", files );
}

static wisp_status add_hashes( const view_options* options, const wisp_scene* scene, json_t* data, wisp_error* error )
{
    json_t* hashes;
    const int all = options->steps >= 0 ? options->steps : scene->steps;
    int made = all;
    const wisp_status status = view_scene_hashes( scene, &made, &hashes, error );
    if ( status == WISP_OK )
    {
        if ( made < all )
        {
            fprintf( stderr, "wisp: interrupted at step %d of %d: the page has the hashes until then\n", made, all );
        }
        json_object_set_new( data, "hashes", hashes );
    }
    return status;
}

static wisp_status take_scene( const view_options* options, json_t* files, json_t** data, wisp_error* error )
{
    wisp_scene scene;
    wisp_status status = wisp_scene_read( options->input, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    interruption_begin(); // before that there is nothing to keep
    status = view_scene_files( &scene, options->input, files, error );
    *data = status == WISP_OK ? begin_data( "scene", options->input, files ) : NULL;
    status = *data ? add_hashes( options, &scene, *data, error ) : status;
    wisp_scene_release( &scene );
    return status;
}

static wisp_status take_recording( const view_options* options, json_t* files, json_t** data, wisp_error* error )
{
    wisp_recording* recording = NULL;
    size_t total = 0;
    if ( options->steps >= 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got --steps, but a recording is played, not simulated",
                          options->input );
    }
    wisp_status status = wisp_recording_open( options->input, &recording, error );
    if ( status == WISP_OK && wisp_recording_describe( recording ).frame_count == 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: the recording has no whole frame", options->input );
    }
    wisp_recording_close( recording );
    if ( status == WISP_OK )
    {
        status =
            view_add_file( files, io_file_name( io_input_name( options->input ) ), options->input, &total, error );
    }
    *data = status == WISP_OK ? begin_data( "recording", options->input, files ) : NULL;
    return status;
}

static wisp_status take_input( const view_options* options, json_t* files, json_t** data, wisp_error* error )
{
    file_kind kind;
    const wisp_status status = file_kind_find( options->input, &kind, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( kind != FILE_SCENE && kind != FILE_RECORDING )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got another kind of file, expected a scene or a recording",
                          options->input );
    }
    return kind == FILE_SCENE ? take_scene( options, files, data, error )
                              : take_recording( options, files, data, error );
}

int command_view( int argc, char** argv )
{
    view_options options = { .steps = -1 };
    options_parse( &view_text, take, &options, argc, argv );

    wisp_error error = { 0 };
    json_t* files = json_object();
    json_t* data = NULL;
    size_t size = 0;
    wisp_status status = command_check_writable( options.output, &error );
    status = status == WISP_OK ? take_input( &options, files, &data, &error ) : status;
    if ( status == WISP_OK && !data )
    {
        status = wisp_fail( &error, WISP_NO_MEMORY, "%s: out of memory for the page", options.input );
    }
    status = status == WISP_OK ? view_page_write( data, options.output, &size, &error ) : status;
    if ( status == WISP_OK )
    {
        const size_t hashes = json_array_size( json_object_get( json_object_get( data, "hashes" ), "values" ) );
        fprintf( io_is_standard( options.output ) ? stderr : stdout, "%s: %.1f MB, %zu hash%s\n", options.output,
                 (double)size / 1e6, hashes, hashes == 1 ? "" : "es" );
    }
    json_decref( data );
    json_decref( files );
    return status == WISP_OK ? interruption_status( STATUS_GOOD ) : command_fail( &error );
}
