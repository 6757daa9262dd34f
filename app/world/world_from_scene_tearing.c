// Surfaces of a scene that tear: spare vertices of their meshes, the strength, triangles that change.
#include "world_from_scene_parts.h"

#include "wisp/maps.h"

#include <stdlib.h>
#include <string.h>

// ---- spare vertices ----

static int spares_of( const wisp_scene_surface* entry, int vertex_count )
{
    enum
    {
        MIN_SPARES = 64,
        PART = 4, // of the vertices
    };
    const int usual = vertex_count / PART > MIN_SPARES ? vertex_count / PART : MIN_SPARES;
    return entry->has_tearing == false ? 0 : entry->max_new_vertices >= 0 ? entry->max_new_vertices : usual;
}

wisp_status scene_tearing_reserve( const wisp_scene* scene, int surface, scene_world_surface* out, wisp_error* error )
{
    wisp_mesh* mesh = &out->mesh;
    int spares = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const bool has_mesh = i == surface || scene->surfaces[i].instance_of == surface;
        const int count = has_mesh ? spares_of( &scene->surfaces[i], mesh->vertex_count ) : 0;
        spares = count > spares ? count : spares;
    }
    if ( spares == 0 || mesh->vertex_count == 0 )
    {
        return WISP_OK;
    }
    wisp_vec3* points =
        realloc( mesh->points, ( (size_t)mesh->vertex_count + (size_t)spares ) * sizeof *mesh->points );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d spare vertices", spares );
    }
    mesh->points = points;
    for ( int i = 0; i < spares; ++i )
    {
        points[mesh->vertex_count + i] = points[0];
    }
    mesh->vertex_count += spares;
    out->spare_count = spares;
    return WISP_OK;
}

// ---- the strength ----

wisp_status scene_tearing_set( scene_world* world, int surface, const float* factors )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    wisp_tearing_def def = entry->tearing;
    def.factors = factors;
    return entry->has_tearing ? wisp_set_tearing( world->world, world->surfaces[surface].entity, &def ) : WISP_OK;
}

// ---- triangles ----

static wisp_status fail_at_surface( const scene_world* world, int surface, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: '%s': out of memory for its triangles", world->scene->name,
                      world->scene->surfaces[surface].name );
}

wisp_status scene_tearing_prepare( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    scene_world_surface* s = &world->surfaces[surface];
    if ( !entry->has_tearing || entry->instance_of < 0 )
    {
        return WISP_OK;
    }
    const wisp_mesh* source = &world->surfaces[entry->instance_of].mesh;
    const size_t bytes = 3 * (size_t)source->triangle_count * sizeof *source->triangles;
    s->mesh.triangles = malloc( bytes + 1 );
    if ( !s->mesh.triangles )
    {
        return fail_at_surface( world, surface, error );
    }
    memcpy( s->mesh.triangles, source->triangles, bytes );
    s->mesh.triangle_count = source->triangle_count;
    return WISP_OK;
}

static wisp_status follow( scene_world* world, int surface )
{
    scene_world_surface* s = &world->surfaces[surface];
    wisp_tearing_stats stats;
    wisp_status status = wisp_read_tearing_stats( world->world, s->entity, &stats );
    if ( status == WISP_OK && stats.split_count != s->split_count )
    {
        s->split_count = stats.split_count;
        status = wisp_read_triangles( world->world, s->entity, s->mesh.triangles, s->mesh.triangle_count );
    }
    return status;
}

wisp_status scene_tearing_follow( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        if ( scene->surfaces[i].has_tearing && follow( world, i ) != WISP_OK )
        {
            return wisp_fail( error, WISP_CONFLICT, "%s: '%s': %s", scene->name, scene->surfaces[i].name,
                              wisp_world_message( world->world ) );
        }
    }
    return WISP_OK;
}
