#include "figures_bench.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 360
#define TRACK_RADIUS 0.0015f // m

wisp_status figures_take( const figures_case* page, figures_album* album, surface_implementation* implementation,
                          wisp_error* error, const char* format, ... )
{
    if ( !page->pictures || album->count == FIGURES_SHOTS_MAX )
    {
        return WISP_OK;
    }
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t bytes = (size_t)album->mesh->vertex_count * sizeof( wisp_vec3 );
    wisp_vec3* shot = malloc( bytes );
    if ( !shot )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( shot, points, bytes );
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( album->labels[album->count], sizeof( album->labels[0] ), format, arguments );
    va_end( arguments );
    album->shots[album->count++] = shot;
    return WISP_OK;
}

void figures_album_free( figures_album* album )
{
    for ( int i = 0; i < album->count; ++i )
    {
        free( album->shots[i] );
    }
    album->count = 0;
}

/// A scene of one shape and perhaps tracks.
typedef struct shot_scene
{
    const figures_album* album;
    const figures_tracks* tracks; // null: none
    render_mesh mesh;
    render_curves curves;
    int32_t offsets[FIGURES_SHOTS_MAX + 1];
    render_scene scene;
} shot_scene;

static const render_scene* set_scene( void* context, int shot )
{
    shot_scene* out = context;
    const figures_album* album = out->album;
    const figures_tracks* tracks = out->tracks;
    out->mesh = render_default_mesh( RENDER_LATEX );
    out->mesh.points = album->shots[shot];
    out->mesh.triangles = album->mesh->triangles;
    out->mesh.vertex_count = album->mesh->vertex_count;
    out->mesh.triangle_count = album->mesh->triangle_count;
    out->scene = render_default_scene();
    out->scene.meshes = &out->mesh;
    out->scene.mesh_count = 1;
    if ( tracks )
    {
        out->curves = render_default_curves();
        for ( int i = 0; i <= tracks->track_count; ++i )
        {
            out->offsets[i] = i * tracks->length;
        }
        out->curves.points = tracks->points;
        out->curves.offsets = out->offsets;
        out->curves.strand_count = tracks->track_count;
        out->curves.radius = TRACK_RADIUS;
        out->scene.curves = &out->curves;
        out->scene.curves_count = 1;
    }
    return &out->scene;
}

wisp_status figures_write( figures_case* page, const figures_album* album, const figures_tracks* tracks,
                           const char* name, const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .count = 0 };
    shot_scene one = { .album = album, .tracks = tracks };
    const picture_shots shots = { .scene = set_scene,
                                  .context = &one,
                                  .count = album->count,
                                  .view = render_default_view(),
                                  .width = SIDE,
                                  .height = SIDE };
    const wisp_status status = picture_sheet_draw( &shots, album->labels[0], sizeof album->labels[0], &sheet, error );
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}
