#include "figures_bench.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 360

// Linear RGB, apart from each other and from the body.
static const wisp_vec3 TRACK_COLOURS[FIGURES_TRACKS_MAX] = {
    { 0.02f, 0.12f, 0.60f }, { 0.75f, 0.42f, 0.0f }, { 0.0f, 0.30f, 0.08f }, { 0.02f, 0.02f, 0.02f }
};

static void move_to_origin( wisp_vec3* points, int count )
{
    double centre[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        centre[0] += (double)points[i].x / count;
        centre[1] += (double)points[i].y / count;
        centre[2] += (double)points[i].z / count;
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i].x -= (float)centre[0];
        points[i].y -= (float)centre[1];
        points[i].z -= (float)centre[2];
    }
}

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
    if ( album->is_centred )
    {
        move_to_origin( shot, album->mesh->vertex_count );
    }
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

/// A scene of one or more shapes and perhaps tracks.
typedef struct shot_scene
{
    const figures_album* album;
    const figures_tracks* tracks; // [picture]; null: none
    int shots_per_picture;
    render_mesh meshes[FIGURES_SHOTS_MAX];
    render_curves curves[FIGURES_TRACKS_MAX];
    int32_t offsets[2];
    render_scene scene;
} shot_scene;

static const render_scene* set_scene( void* context, int picture )
{
    shot_scene* out = context;
    const figures_album* album = out->album;
    out->scene = render_default_scene();
    out->scene.meshes = out->meshes;
    out->scene.mesh_count = out->shots_per_picture;
    for ( int i = 0; i < out->shots_per_picture; ++i )
    {
        out->meshes[i] = render_default_mesh( RENDER_LATEX );
        out->meshes[i].points = album->shots[picture * out->shots_per_picture + i];
        out->meshes[i].triangles = album->mesh->triangles;
        out->meshes[i].vertex_count = album->mesh->vertex_count;
        out->meshes[i].triangle_count = album->mesh->triangle_count;
    }
    if ( out->tracks )
    {
        const figures_tracks* tracks = out->tracks + picture;
        out->offsets[0] = 0;
        out->offsets[1] = tracks->length;
        for ( int i = 0; i < tracks->track_count; ++i )
        {
            out->curves[i] = render_default_curves();
            out->curves[i].points = tracks->points + (size_t)i * (size_t)tracks->length;
            out->curves[i].offsets = out->offsets;
            out->curves[i].strand_count = 1;
            out->curves[i].radius = tracks->radius;
            out->curves[i].colour = TRACK_COLOURS[i];
        }
        out->scene.curves = out->curves;
        out->scene.curves_count = tracks->track_count;
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
    const int each = album->shots_per_picture > 0 ? album->shots_per_picture : 1;
    shot_scene one = { .album = album, .tracks = tracks, .shots_per_picture = each };
    const picture_shots shots = { .scene = set_scene,
                                  .context = &one,
                                  .count = album->count / each,
                                  .view = render_default_view(),
                                  .width = SIDE,
                                  .height = SIDE };
    const wisp_status status =
        picture_sheet_draw( &shots, album->labels[each - 1], (size_t)each * sizeof album->labels[0], &sheet, error );
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}
