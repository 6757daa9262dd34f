#include "figures_drape.h"

#define SIDE 400
#define SHEET_COLUMNS 5 // more pictures make two rows
#define BALL_LEVEL 4    // of the icosphere that stands for the ball

typedef struct stage
{
    const figures_album* album;
    const wisp_mesh* ball;
    render_mesh meshes[2];
    render_scene scene;
} stage;

static const render_scene* set_scene( void* context, int shot )
{
    stage* out = context;
    const figures_album* album = out->album;
    const wisp_mesh* ball = out->ball;
    out->meshes[0] = render_default_mesh( RENDER_CLOTH );
    out->meshes[0].points = album->shots[shot];
    out->meshes[0].triangles = album->mesh->triangles;
    out->meshes[0].vertex_count = album->mesh->vertex_count;
    out->meshes[0].triangle_count = album->mesh->triangle_count;
    out->meshes[1] = render_default_mesh( RENDER_SOLID );
    out->meshes[1].points = ball->points;
    out->meshes[1].triangles = ball->triangles;
    out->meshes[1].vertex_count = ball->vertex_count;
    out->meshes[1].triangle_count = ball->triangle_count;
    out->scene = render_default_scene();
    out->scene.meshes = out->meshes;
    out->scene.mesh_count = ball->vertex_count > 0 ? 2 : 1;
    return &out->scene;
}

static wisp_status make_ball( wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = BALL_LEVEL;
    generator.radius = TRIANGLE_BALL_RADIUS;
    wisp_status status = wisp_mesh_generate( &generator, out, error );
    for ( int i = 0; i < out->vertex_count; ++i )
    {
        out->points[i].y += TRIANGLE_BALL_HEIGHT;
    }
    return status;
}

// Each picture as a file of its own, numbered from 1.
static wisp_status write_each( const figures_case* page, const picture_sheet* sheet, const char* name,
                               wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < sheet->count && status == WISP_OK; ++i )
    {
        char path[4096], numbered[128];
        snprintf( numbered, sizeof( numbered ), "%s_%d", name, i + 1 );
        status = picture_path( page->pictures, numbered, path, sizeof( path ), error );
        status = status == WISP_OK ? image_write_png( path, &sheet->pictures[i], error ) : status;
    }
    return status;
}

wisp_status drape_write( figures_case* page, const figures_album* album, bool has_ball, const char* name,
                         const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .columns = album->count > SHEET_COLUMNS ? ( album->count + 1 ) / 2 : album->count };
    wisp_mesh ball = { 0 };
    wisp_status status = has_ball ? make_ball( &ball, error ) : WISP_OK;
    stage one = { .album = album, .ball = &ball };
    const picture_shots shots = { .scene = set_scene,
                                  .context = &one,
                                  .count = album->count,
                                  .view = render_default_view(),
                                  .width = SIDE,
                                  .height = SIDE };
    status = status == WISP_OK
                 ? picture_sheet_draw( &shots, album->labels[0], sizeof album->labels[0], &sheet, error )
                 : status;
    wisp_mesh_release( &ball );
    status = status == WISP_OK ? write_each( page, &sheet, name, error ) : status;
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}
