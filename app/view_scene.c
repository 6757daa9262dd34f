#include "view_scene.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "view_page.h"
#include "world_from_scene.h"

#include <stdio.h>
#include <string.h>

// ---- files ----

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

static wisp_status add_file( void* user, const char* path, wisp_error* error )
{
    page_files* page = user;
    const bool is_there = json_object_get( page->files, name_in_page( page, path ) ) != NULL;
    return is_there ? WISP_OK : view_add_file( page->files, name_in_page( page, path ), path, &page->total, error );
}

wisp_status view_scene_files( const wisp_scene* scene, const char* path, json_t* files, wisp_error* error )
{
    const char* slash = strrchr( path, '/' );
    page_files page = { .files = files, .scene = path, .folder = slash ? (size_t)( slash - path ) + 1 : 0 };
    const wisp_status status = add_file( &page, path, error );
    return status == WISP_OK ? wisp_scene_files( scene, add_file, &page, error ) : status;
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

static wisp_status run( scene_world* world, int* steps, json_t* values, wisp_error* error )
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

wisp_status view_scene_hashes( const wisp_scene* scene, int* steps, json_t** out, wisp_error* error )
{
    scene_world world;
    const scene_world_options options = { 0 };
    *out = NULL;
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    json_t* values = json_array();
    status = values ? run( &world, steps, values, error )
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
