#include "commands.h"

#include "base64.h"
#include "file_kind.h"
#include "interruption.h"
#include "io_file.h"
#include "program_data.h"
#include "results_write.h"
#include "progress.h"
#include "record.h"
#include "scene.h"
#include "wisp/base.h"
#include "world_from_scene.h"
#include "wisp/module/definition.h"

#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// ---- the page ----

// One HTML file that `./dev web` builds, in which data take the place of one word.

// Files of a page, all together.
#define VIEW_MAX_BYTES ( 64u << 20 )
#define PAGE_MAX_BYTES ( 64u << 20 )

static const char place_begin[] = "<script type=\"application/json\" id=\"wisp-data\">";
static const char place_word[] = "null";

// ---- data ----

// @return a string for json_decref(), null without memory
static json_t* encode( const unsigned char* bytes, size_t size )
{
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    if ( !stream )
    {
        return NULL;
    }
    io_base64 letters = { .out = stream };
    io_base64_put( &letters, bytes, size );
    io_base64_end( &letters );
    const bool is_whole = !ferror( stream );
    json_t* string = fclose( stream ) == 0 && is_whole ? json_stringn( text, length ) : NULL;
    free( text );
    return string;
}

// Read a file into the page's data. @param name as the page knows it
// @return WISP_BAD_INPUT the files exceed VIEW_MAX_BYTES; WISP_IO_ERROR; WISP_NO_MEMORY
static wisp_status add_file( json_t* files, const char* name, const char* path, size_t* total, wisp_error* error )
{
    json_t* word = json_string( name );
    if ( !word )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got a file name that is not UTF-8, which a page cannot hold",
                          path );
    }
    json_decref( word );
    unsigned char* bytes;
    size_t size;
    WISP_TRY( io_file_read( path, VIEW_MAX_BYTES, &bytes, &size, error ) );
    *total += size;
    if ( *total > VIEW_MAX_BYTES )
    {
        free( bytes );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: with this file a page has more than %u MB, which is the limit",
                          path, VIEW_MAX_BYTES >> 20 );
    }
    const bool is_added = json_object_set_new( files, name, encode( bytes, size ) ) == 0;
    free( bytes );
    return is_added ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the page", path );
}

// ---- the page ----

static wisp_status read_page( unsigned char** page, size_t* size, size_t* place, wisp_error* error )
{
    char path[PATH_MAX];
    struct stat found;
    program_data_path( "viewer.html", path, sizeof path );
    if ( stat( path, &found ) != 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR,
                          "%s: the page of `wisp view` is not there: './dev web' builds it, and WISP_DATA names the "
                          "folder that has it",
                          io_short_name( path ) );
    }
    WISP_TRY( io_file_read( path, PAGE_MAX_BYTES, page, size, error ) );
    const unsigned char* begin = *size ? memmem( *page, *size, place_begin, sizeof place_begin - 1 ) : NULL;
    const size_t at = begin ? (size_t)( begin - *page ) + sizeof place_begin - 1 : *size;
    if ( *size - at < sizeof place_word || memcmp( *page + at, place_word, sizeof place_word - 1 ) != 0 )
    {
        free( *page );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the page has no place for data", path );
    }
    *place = at;
    return WISP_OK;
}

// Write the page with its data.
// @return WISP_IO_ERROR there is no page to fill (the message says how to build one), or `path` cannot be written
static wisp_status write_page( const json_t* data, const char* path, size_t* size, wisp_error* error )
{
    unsigned char* page;
    size_t page_size = 0, place = 0;
    WISP_TRY( read_page( &page, &page_size, &place, error ) );
    char* text = json_dumps( data, JSON_COMPACT );
    io_output output = { 0 };
    wisp_status status = text ? io_output_open( path, &output, error )
                              : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the page", path );
    if ( status == WISP_OK )
    {
        const size_t behind = place + sizeof place_word - 1;
        fwrite( page, 1, place, output.stream );
        results_json_put_script( text, output.stream );
        fwrite( page + behind, 1, page_size - behind, output.stream );
        const long end = ftell( output.stream );
        *size = end > 0 ? (size_t)end : 0;
        status = io_output_commit( &output, error );
    }
    free( text );
    free( page );
    return status;
}

// ---- a scene ----

// What a page holds of a scene: its files, and the hashes of a native run.

// ---- files ----

// Steps between two hashes.
#define VIEW_HASH_EVERY 60

/// Files of one page.
typedef struct page_files
{
    json_t* files;
    const char* scene; // path
    size_t folder;     // length of its folder, with the slash
    size_t total;      // bytes so far
} page_files;

static const char* name_in_page( const page_files* page, const char* path )
{
    return strncmp( path, page->scene, page->folder ) == 0 ? io_input_name( path ) + page->folder : path;
}

static wisp_status add_scene_file( void* user, const char* path, wisp_error* error )
{
    page_files* page = user;
    const bool is_there = json_object_get( page->files, name_in_page( page, path ) ) != NULL;
    return is_there ? WISP_OK : add_file( page->files, name_in_page( page, path ), path, &page->total, error );
}

// Add the scene's file and all files that it reads, under names relative to its folder.
static wisp_status add_scene_files( const wisp_scene* scene, const char* path, json_t* files, wisp_error* error )
{
    page_files page = { .files = files, .scene = path, .folder = io_folder_length( path ) };
    const wisp_status status = add_scene_file( &page, path, error );
    return status == WISP_OK ? wisp_scene_files( scene, add_scene_file, &page, error ) : status;
}

// ---- hashes ----

static wisp_status add_hash( const scene_world* world, json_t* values, wisp_error* error )
{
    char text[20];
    snprintf( text, sizeof text, "%016llx", (unsigned long long)wisp_world_hash( world->world ) );
    return json_array_append_new( values, json_string( text ) ) == 0
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for hashes", world->scene->name );
}

static wisp_status run_hashed( scene_world* world, int* steps, json_t* values, wisp_error* error )
{
    progress bar = progress_begin();
    // The page requests the same, and a request that the scene lacks is part of the hash.
    wisp_status status = scene_world_request_shown( world, error );
    int step = 0;
    while ( step < *steps && status == WISP_OK && !interruption_came() )
    {
        ++step;
        status = scene_world_step( world, error );
        if ( status == WISP_OK && step % VIEW_HASH_EVERY == 0 )
        {
            status = add_hash( world, values, error );
        }
        progress_show( &bar, (double)step / *steps, "steps" );
    }
    *steps = step;
    progress_end( &bar );
    return status;
}

// Simulate the scene, and hash its state after every VIEW_HASH_EVERY-th step.
// @param steps to make; receives those that were made, fewer after an interruption
// @param out receives an object for json_decref()
static wisp_status compute_hashes( const wisp_scene* scene, int* steps, json_t** out, wisp_error* error )
{
    scene_world world;
    const scene_world_options options = { 0 };
    *out = NULL;
    WISP_TRY( scene_world_create( scene, &options, &world, error ) );
    json_t* values = json_array();
    wisp_status status = values ? run_hashed( &world, steps, values, error )
                                : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for hashes", scene->name );
    if ( status == WISP_OK )
    {
        *out = json_pack( "{s:i, s:s, s:o}", "every", VIEW_HASH_EVERY, "isa", wisp_world_isa( world.world ), "values",
                          values );
    }
    else
    {
        json_decref( values );
    }
    scene_world_destroy( &world );
    return status == WISP_OK && *out == NULL
               ? wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for hashes", scene->name )
               : status;
}

// ---- the command ----

#define VIEW_STEPS_MAX 1000000

typedef struct view_options
{
    const char* input;
    const char* output;
    int steps; ///< that are hashed; -1: those of the scene
} view_options;

// ---- the command line ----

static const option_row view_rows[] = {
    { "output", 'o', "FILE.html", "Write the page to FILE.html; required",
      OPTION_TEXT( view_options, output, ".html" ) },
    { "steps", 's', "N", "Simulate N steps for hashes, 0 for none; default: the scene's steps",
      OPTION_WHOLE( view_options, steps, 0, VIEW_STEPS_MAX ) },
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
    .rows = view_rows,
    .row_count = WISP_COUNT( view_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, view_options, input, ".yaml .yml .json .wisp" ),
};

static void check_view_options( const options_state* o )
{
    const view_options* options = o->input;
    if ( !options->output )
    {
        options_fail( o, "expected an output file: -o FILE.html" );
    }
    if ( !io_is_standard( options->output ) && !io_has_extension( options->output, ".html" ) )
    {
        options_fail( o, "-o: got '%s', expected a file name that ends in .html", options->output );
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
    WISP_TRY( compute_hashes( scene, &made, &hashes, error ) );
    if ( made < all )
    {
        fprintf( stderr, "wisp: interrupted at step %d of %d: the page has the hashes until then\n", made, all );
    }
    json_object_set_new( data, "hashes", hashes );
    return WISP_OK;
}

static wisp_status take_scene( const view_options* options, json_t* files, json_t** data, wisp_error* error )
{
    wisp_scene scene;
    WISP_TRY( wisp_scene_read( options->input, &scene, error ) );
    interruption_begin(); // before that there is nothing to keep
    wisp_status status = add_scene_files( &scene, options->input, files, error );
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
        status = add_file( files, io_file_name( io_input_name( options->input ) ), options->input, &total, error );
    }
    *data = status == WISP_OK ? begin_data( "recording", options->input, files ) : NULL;
    return status;
}

static wisp_status take_input( const view_options* options, json_t* files, json_t** data, wisp_error* error )
{
    file_kind kind;
    WISP_TRY( file_kind_find( options->input, &kind, error ) );
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
    options_parse( &view_text, check_view_options, &options, argc, argv );

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
    status = status == WISP_OK ? write_page( data, options.output, &size, &error ) : status;
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
