// Surfaces that clips of keyframes move: where the vertices of their mesh are at a time.
#include "world_from_scene_parts.h"

#include <math.h>
#include <stdlib.h>

#include "gltf.h"
#include "rig.h"
#include "wisp/module/module.h"

struct scene_animation
{
    wisp_rig rig;
    wisp_skin_pose pose;
    gltf_model model; // whose morph targets the vertices follow; empty: the rig moves them
    gltf_moment moment;
    int node;
    double* work;
    wisp_affine* joints;
    wisp_vec3* points; // [skin->point_count] m, in the world
};

void scene_animation_release( scene_animation* animation )
{
    if ( animation != NULL )
    {
        wisp_skin_pose_release( &animation->pose, NULL );
        wisp_rig_release( &animation->rig );
        gltf_release( &animation->model );
        free( animation->work );
        free( animation->joints );
        free( animation->points );
        free( animation );
    }
}

static int count_of( const scene_animation* animation )
{
    return animation->model.meshes[animation->model.nodes[animation->node].mesh].mesh.vertex_count;
}

static wisp_status turn_joints( const wisp_scene_surface* entry, scene_animation* animation, double time,
                                wisp_error* error )
{
    wisp_skeleton_pose( &animation->rig.skeleton, &animation->rig.animation, (float)time, animation->joints );
    return wisp_skin_points( animation->rig.skin, &animation->pose, entry->animation.method, animation->joints,
                             animation->points, error );
}

// Before the clip and after it its first and its last pose stay.
static wisp_status morph( const wisp_scene_surface* entry, scene_animation* animation, double time,
                          wisp_error* error )
{
    const wisp_scene_clip* clip = &entry->animation.clips[0];
    animation->moment.time = fmax( time - (double)clip->time, 0.0 ) * (double)clip->speed;
    gltf_points_at( &animation->model, animation->node, animation->moment, animation->work, animation->points );
    for ( int v = 0; v < count_of( animation ); ++v )
    {
        const wisp_vec3 p = animation->points[v];
        if ( !( isfinite( p.x ) && isfinite( p.y ) && isfinite( p.z ) ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "animation: vertex %d is not finite at %g s", v, time );
        }
    }
    return WISP_OK;
}

wisp_status scene_animation_pose( const wisp_scene* scene, int surface, scene_animation* animation, double time,
                                  const wisp_vec3** points, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const float scale = scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface].mesh.scale;
    const bool is_morphed = animation->work != NULL;
    const wisp_status status =
        is_morphed ? morph( entry, animation, time, error ) : turn_joints( entry, animation, time, error );
    const int count = is_morphed ? count_of( animation ) : animation->rig.skin->point_count;
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        const wisp_vec3 p = animation->points[v];
        animation->points[v] =
            wisp_transform_to_world( entry->pose, ( wisp_vec3 ){ scale * p.x, scale * p.y, scale * p.z } );
    }
    *points = animation->points;
    return status;
}

// Whether a file has morph targets that a clip moves, and no skin, which a rig would move.
static bool has_morphs( const char* path, const wisp_scene_clip* clip, scene_animation* out )
{
    bool has = false;
    if ( gltf_model_read( path, &out->model, &out->node, NULL ) == WISP_OK )
    {
        const gltf_node* node = &out->model.nodes[out->node];
        out->moment = ( gltf_moment ){ gltf_find_animation( &out->model, clip->name ), 0.0, -1 };
        const gltf_animation* a = out->moment.animation >= 0 ? &out->model.animations[out->moment.animation] : NULL;
        for ( int w = 0; a != NULL && node->skin < 0 && w < a->weights_count; ++w )
        {
            has = has || a->weights[w].node == out->node;
        }
    }
    if ( !has )
    {
        gltf_release( &out->model );
    }
    return has;
}

static wisp_status load_morphs( const wisp_scene_animation* entry, const char* path, int vertex_count,
                                scene_animation* out, wisp_error* error )
{
    if ( entry->clip_count > 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: got %d clips, expected one of a mesh with morph targets",
                          entry->clip_count );
    }
    if ( count_of( out ) != vertex_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: %.200s: got %d vertices, expected %d as the mesh has",
                          path, count_of( out ), vertex_count );
    }
    out->work = malloc( gltf_points_work( &out->model, out->node ) * sizeof *out->work );
    out->points = malloc( (size_t)vertex_count * sizeof *out->points + 1 );
    return out->work != NULL && out->points != NULL
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d vertices", vertex_count );
}

static wisp_status load( const wisp_scene* scene, int surface, int vertex_count, scene_animation* out,
                         wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const wisp_scene_surface* source = &scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface];
    const char* path = entry->animation.file != NULL ? entry->animation.file
                       : source->mesh.arrays == NULL ? source->mesh.file
                                                     : NULL;
    if ( path != NULL && gltf_is_path( path ) && has_morphs( path, &entry->animation.clips[0], out ) )
    {
        return load_morphs( &entry->animation, path, vertex_count, out, error );
    }
    wisp_status status =
        wisp_rig_load( &source->mesh, &entry->animation, (float)scene->steps * scene->dt, &out->rig, error );
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

wisp_status scene_animation_load( const wisp_scene* scene, int surface, scene_world_surface* s, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    if ( !entry->has_animation )
    {
        return WISP_OK;
    }
    wisp_error cause = { 0 };
    const wisp_vec3* points = NULL;
    s->animation = calloc( 1, sizeof *s->animation );
    wisp_status status = s->animation != NULL ? load( scene, surface, s->mesh.vertex_count, s->animation, &cause )
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
