// Surfaces that clips of keyframes move: where the vertices of their mesh are at a time.
#include "world_from_scene_parts.h"

#include <stdlib.h>

#include "rig.h"
#include "wisp/module/module.h"

struct scene_animation
{
    wisp_rig rig;
    wisp_skin_pose pose;
    wisp_affine* joints;
    wisp_vec3* points; // [skin->point_count] m, in the world
};

void scene_animation_release( scene_animation* animation )
{
    if ( animation != NULL )
    {
        wisp_skin_pose_release( &animation->pose, NULL );
        wisp_rig_release( &animation->rig );
        free( animation->joints );
        free( animation->points );
        free( animation );
    }
}

wisp_status scene_animation_pose( const wisp_scene* scene, int surface, scene_animation* animation, double time,
                                  const wisp_vec3** points, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const float scale = scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface].mesh.scale;
    wisp_skeleton_pose( &animation->rig.skeleton, &animation->rig.animation, (float)time, animation->joints );
    const wisp_status status = wisp_skin_points( animation->rig.skin, &animation->pose, entry->animation.method,
                                                 animation->joints, animation->points, error );
    for ( int v = 0; v < animation->rig.skin->point_count && status == WISP_OK; ++v )
    {
        const wisp_vec3 p = animation->points[v];
        animation->points[v] =
            wisp_transform_to_world( entry->pose, ( wisp_vec3 ){ scale * p.x, scale * p.y, scale * p.z } );
    }
    *points = animation->points;
    return status;
}

static wisp_status load( const wisp_scene* scene, int surface, const wisp_vec3* rest, int vertex_count,
                         scene_animation* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const wisp_scene_surface* source = &scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface];
    const float unscaled = 1.0f / source->mesh.scale;
    wisp_vec3* points = malloc( (size_t)vertex_count * sizeof *points + 1 );
    for ( int v = 0; v < vertex_count && points != NULL; ++v )
    {
        points[v] = ( wisp_vec3 ){ unscaled * rest[v].x, unscaled * rest[v].y, unscaled * rest[v].z };
    }
    wisp_status status =
        points != NULL ? wisp_rig_load( &source->mesh, points, vertex_count, &entry->animation,
                                        (float)scene->steps * scene->dt, &out->rig, error )
                       : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d vertices", vertex_count );
    free( points );
    if ( status == WISP_OK && out->rig.skin->point_count != vertex_count )
    {
        status =
            wisp_fail( error, WISP_BAD_INPUT,
                       "animation: the skeleton moves %d vertices, but repair left %d of them: use a repair that "
                       "removes none",
                       out->rig.skin->point_count, vertex_count );
    }
    if ( status == WISP_OK )
    {
        out->joints = malloc( (size_t)out->rig.skeleton.joint_count * sizeof *out->joints );
        out->points = malloc( (size_t)vertex_count * sizeof *out->points + 1 );
        status = out->joints != NULL && out->points != NULL
                     ? WISP_OK
                     : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d vertices", vertex_count );
    }
    return status;
}

wisp_status scene_animation_load( const wisp_scene* scene, int surface, const wisp_vec3* rest, scene_world_surface* s,
                                  wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    if ( !entry->has_animation )
    {
        return WISP_OK;
    }
    wisp_error cause = { 0 };
    const wisp_vec3* points = NULL;
    s->animation = calloc( 1, sizeof *s->animation );
    wisp_status status = s->animation != NULL
                             ? load( scene, surface, rest, s->mesh.vertex_count, s->animation, &cause )
                             : wisp_fail( &cause, WISP_NO_MEMORY, "out of memory for an animation" );
    status = status == WISP_OK ? scene_animation_pose( scene, surface, s->animation, 0.0, &points, &cause ) : status;
    for ( int v = 0; v < s->mesh.vertex_count && status == WISP_OK; ++v )
    {
        s->mesh.points[v] = points[v];
    }
    return status == WISP_OK ? WISP_OK
                             : scene_fail_at( scene, entry->line, entry->column, "surface", entry->name, status,
                                              cause.message, error );
}
