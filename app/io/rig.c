// Rigs: where skeleton, weights and clips come from.
#include "rig.h"

#include <stdlib.h>

#include "figure.h"
#include "gltf.h"
#include "gltf_rig.h"
#include "io_file.h"

#define TEXT_CAP ( (size_t)1 << 24 ) // bytes of keyframes

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

static wisp_status load_figure( float height, const wisp_vec3* points, int point_count, wisp_rig* out,
                                wisp_error* error )
{
    wisp_skin_weights weights = { 0 };
    wisp_status status = wisp_figure_skeleton( height, &out->skeleton, error );
    status = status == WISP_OK ? wisp_figure_bind( height, points, point_count, &weights, error ) : status;
    status = status == WISP_OK ? wisp_skeleton_skin( &out->skeleton, points, &weights, &out->skin, error ) : status;
    wisp_skin_weights_release( &weights );
    return status;
}

static wisp_status load_skeleton( const wisp_scene_mesh* mesh, const wisp_vec3* points, int point_count,
                                  gltf_model* model, wisp_rig* out, wisp_error* error )
{
    if ( mesh->is_generated && mesh->generator.shape == WISP_MESH_FIGURE )
    {
        return load_figure( mesh->generator.height, points, point_count, out, error );
    }
    if ( mesh->file == NULL || mesh->arrays != NULL || !gltf_is_path( mesh->file ) )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "animation: the mesh has no skeleton, expected 'generate: { shape: figure }' or a glTF file" );
    }
    int node = 0;
    const wisp_status status = gltf_model_read( mesh->file, model, &node, error );
    return status == WISP_OK ? gltf_rig( model, node, mesh->file, &out->skeleton, &out->skin, error ) : status;
}

// ---- clips ----

// Clips of a file, by name: of the model if it was read, else of keyframes in YAML.
typedef struct clip_file
{
    const char* name;
    const gltf_model* model; // null: text
    unsigned char* text;
    size_t size;
    float scale; // of translations in text
} clip_file;

static wisp_status load_clip( const clip_file* file, const char* name, const wisp_skeleton* skeleton,
                              wisp_animation* out, wisp_error* error )
{
    return file->model != NULL
               ? gltf_rig_animation( file->model, name, file->name, skeleton, out, error )
               : wisp_animation_parse( file->text, file->size, file->name, name, skeleton, file->scale, out, error );
}

static wisp_status load_clips( const clip_file* file, const wisp_scene_animation* animation, float duration,
                               const wisp_skeleton* skeleton, wisp_animation* all, wisp_clip* clips,
                               wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int c = 0; c < animation->clip_count && status == WISP_OK; ++c )
    {
        const wisp_scene_clip* from = &animation->clips[c];
        status = load_clip( file, from->name, skeleton, &all[c], error );
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

static wisp_status join( const clip_file* file, const wisp_scene_animation* animation, float duration, wisp_rig* out,
                         wisp_error* error )
{
    const size_t count = (size_t)animation->clip_count;
    wisp_animation* all = calloc( count, sizeof *all );
    wisp_clip* clips = calloc( count, sizeof *clips );
    wisp_status status =
        all != NULL && clips != NULL
            ? load_clips( file, animation, duration, &out->skeleton, all, clips, error )
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
    clip_file file = { .name = animation->file,
                       .scale = mesh->generator.height / wisp_default_figure_generator().height };
    gltf_model other = { 0 };
    wisp_status status = WISP_OK;
    if ( animation->file == NULL )
    {
        file.name = mesh->file;
        file.model = model;
        status = mesh->is_generated ? wisp_fail( error, WISP_BAD_INPUT, "animation: a figure needs the key 'file'" )
                                    : WISP_OK;
    }
    else if ( gltf_is_path( animation->file ) )
    {
        file.model = &other;
        status = gltf_read( animation->file, 0, &other, error );
    }
    else
    {
        status = io_file_read( animation->file, TEXT_CAP, &file.text, &file.size, error );
    }
    status = status == WISP_OK ? join( &file, animation, duration, out, error ) : status;
    free( file.text );
    gltf_release( &other );
    return status;
}

wisp_status wisp_rig_load( const wisp_scene_mesh* mesh, const wisp_vec3* points, int point_count,
                           const wisp_scene_animation* animation, float duration, wisp_rig* out, wisp_error* error )
{
    gltf_model model = { 0 };
    *out = ( wisp_rig ){ 0 };
    wisp_status status = load_skeleton( mesh, points, point_count, &model, out, error );
    status = status == WISP_OK ? load_animation( mesh, animation, duration, &model, out, error ) : status;
    gltf_release( &model );
    if ( status != WISP_OK )
    {
        wisp_rig_release( out );
    }
    return status;
}
