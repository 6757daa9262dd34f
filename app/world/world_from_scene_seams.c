// Seams of a scene in the world.
#include "world_from_scene_parts.h"

#include <stdlib.h>

static wisp_status refuse( const scene_world* world, const wisp_scene_seam* entry, wisp_status status,
                           const char* message, wisp_error* error )
{
    return scene_fail_at( world->scene, entry->line, entry->column, "seam", entry->name, status, message, error );
}

// The scene numbers vertices as the file does; a repair that drops vertices renumbers the others.
static int32_t find_vertex( const scene_world* world, int surface, int32_t number )
{
    const int source = world->scene->surfaces[surface].instance_of;
    return scene_vertex_of_number( &world->surfaces[source >= 0 ? source : surface].repairs, number );
}

static wisp_status find_pairs( const scene_world* world, const wisp_scene_seam* entry, int32_t* pairs,
                               wisp_error* error )
{
    for ( int i = 0; i < 2 * entry->pair_count; ++i )
    {
        const int surface = entry->surfaces[i % 2];
        pairs[i] = find_vertex( world, surface, entry->pairs[i] );
        if ( pairs[i] < 0 || pairs[i] >= world->surfaces[surface].mesh.vertex_count )
        {
            char message[200];
            snprintf( message, sizeof message,
                      "pairs[%d]: got vertex %d of '%s', which the mesh does not have or which repair removed", i / 2,
                      entry->pairs[i], world->scene->surfaces[surface].name );
            return refuse( world, entry, WISP_BAD_INPUT, message, error );
        }
    }
    return WISP_OK;
}

static wisp_status add_seam( scene_world* world, int seam, wisp_error* error )
{
    const wisp_scene_seam* entry = &world->scene->seams[seam];
    int32_t* pairs = malloc( (size_t)entry->pair_count * 2 * sizeof *pairs + 1 );
    if ( !pairs )
    {
        return refuse( world, entry, WISP_NO_MEMORY, "out of memory for its pairs", error );
    }
    wisp_status status = find_pairs( world, entry, pairs, error );
    if ( status == WISP_OK )
    {
        wisp_seam_def def = entry->def;
        def.a = world->surfaces[entry->surfaces[0]].entity;
        def.b = world->surfaces[entry->surfaces[1]].entity;
        def.pairs = pairs;
        def.pair_count = entry->pair_count;
        status = wisp_add_seam( world->world, &def, &world->seams[seam] );
        status =
            status == WISP_OK ? WISP_OK : refuse( world, entry, status, wisp_world_message( world->world ), error );
    }
    free( pairs );
    return status;
}

wisp_status scene_seams_add( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    world->seams = calloc( (size_t)scene->seam_count + 1, sizeof *world->seams );
    wisp_status status =
        world->seams ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its seams", scene->name );
    for ( int i = 0; i < scene->seam_count && status == WISP_OK; ++i )
    {
        status = add_seam( world, i, error );
    }
    return status;
}
