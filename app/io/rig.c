// Rigs: where skeleton, weights and clips come from.
#include "rig.h"

#include <stdlib.h>

#include "gltf.h"
#include "gltf_rig.h"

void wisp_rig_release( wisp_rig* rig )
{
    if ( rig != NULL )
    {
        wisp_skin_release( rig->skin );
        wisp_skeleton_release( &rig->skeleton );
        wisp_animation_release( &rig->animation );
        *rig = ( wisp_rig ){ 0 };
    }
}

// ---- the mesh's side ----

static wisp_status load_skeleton( const wisp_scene_mesh* mesh, gltf_model* model, wisp_rig* out, wisp_error* error )
{
    if ( mesh->file == NULL || mesh->arrays != NULL || !gltf_is_path( mesh->file ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: the mesh has no skeleton, expected a glTF file" );
    }
    int node = 0;
    const wisp_status status = gltf_model_read( mesh->file, model, &node, error );
    return status == WISP_OK ? gltf_rig( model, node, mesh->file, &out->skeleton, &out->skin, error ) : status;
}

// ---- clips ----

static wisp_status load_clips( const gltf_model* model, const char* file, const wisp_scene_animation* animation,
                               float duration, const wisp_skeleton* skeleton, wisp_animation* all, wisp_clip* clips,
                               wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int c = 0; c < animation->clip_count && status == WISP_OK; ++c )
    {
        const wisp_scene_clip* from = &animation->clips[c];
        status = gltf_rig_animation( model, from->name, file, skeleton, &all[c], error );
        all[c].loops = all[c].loops && from->loop;
        const bool is_last = c + 1 == animation->clip_count;
        const float rest = is_last ? duration : from[1].time - animation->blend;
        const float once = from->time + all[c].duration / from->speed;
        clips[c] = ( wisp_clip ){ .animation = &all[c],
                                  .begin = from->time,
                                  .end = is_last && rest < once ? once : rest,
                                  .speed = from->speed };
    }
    return status;
}

static wisp_status join( const gltf_model* model, const char* file, const wisp_scene_animation* animation,
                         float duration, wisp_rig* out, wisp_error* error )
{
    const size_t count = (size_t)animation->clip_count;
    wisp_animation* all = calloc( count, sizeof *all );
    wisp_clip* clips = calloc( count, sizeof *clips );
    wisp_status status =
        all != NULL && clips != NULL
            ? load_clips( model, file, animation, duration, &out->skeleton, all, clips, error )
            : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d clips", animation->clip_count );
    status = status == WISP_OK
                 ? wisp_animation_join( clips, animation->clip_count, &out->skeleton, &out->animation, error )
                 : status;
    for ( size_t c = 0; c < count && all != NULL; ++c )
    {
        wisp_animation_release( &all[c] );
    }
    free( all );
    free( clips );
    return status;
}

// The file of the clips is that of the mesh unless it is named.
static wisp_status load_animation( const wisp_scene_mesh* mesh, const wisp_scene_animation* animation, float duration,
                                   const gltf_model* model, wisp_rig* out, wisp_error* error )
{
    if ( animation->file == NULL )
    {
        return join( model, mesh->file, animation, duration, out, error );
    }
    gltf_model other;
    wisp_status status = gltf_read( animation->file, 0, &other, error );
    status = status == WISP_OK ? join( &other, animation->file, animation, duration, out, error ) : status;
    gltf_release( &other );
    return status;
}

wisp_status wisp_rig_load( const wisp_scene_mesh* mesh, const wisp_scene_animation* animation, float duration,
                           wisp_rig* out, wisp_error* error )
{
    gltf_model model = { 0 };
    *out = ( wisp_rig ){ 0 };
    wisp_status status = load_skeleton( mesh, &model, out, error );
    status = status == WISP_OK ? load_animation( mesh, animation, duration, &model, out, error ) : status;
    gltf_release( &model );
    if ( status != WISP_OK )
    {
        wisp_rig_release( out );
    }
    return status;
}
