#include "figures_drape.h"

#include "render.h"

#define SIDE 400
#define SHEET_COLUMNS 5 // more pictures make two rows
#define BALL_LEVEL 4    // of the icosphere that stands for the ball

typedef struct stage
{
    render_mesh meshes[2];
    render_scene scene;
} stage;

static void set_scene( const figures_album* album, int shot, const wisp_mesh* ball, stage* out )
{
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
}

static wisp_status make_ball( wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_recipe recipe = wisp_default_mesh_recipe( WISP_MESH_ICOSPHERE );
    recipe.level = BALL_LEVEL;
    recipe.radius = TRIANGLE_BALL_RADIUS;
    wisp_status status = wisp_mesh_make( &recipe, out, error );
    for ( int i = 0; i < out->vertex_count; ++i )
    {
        out->points[i].y += TRIANGLE_BALL_HEIGHT;
    }
    return status;
}

// One camera for all shapes, so that they can be compared.
static wisp_status find_camera( const figures_album* album, const wisp_mesh* ball, render_camera* camera,
                                wisp_error* error )
{
    render_bounds all = { .is_filled = false };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < album->count && status == WISP_OK; ++i )
    {
        stage shot;
        render_bounds one = { .is_filled = false };
        set_scene( album, i, ball, &shot );
        status = render_scene_bounds( &shot.scene, &one, error );
        all = render_bounds_union( all, one );
    }
    const render_view view = render_default_view();
    return status == WISP_OK ? render_frame_camera( &all, &view, 1.0f, camera, error ) : status;
}

static wisp_status draw( const figures_album* album, const wisp_mesh* ball, image* pictures, wisp_error* error )
{
    render_camera camera;
    render_options options = render_default_options();
    options.width = SIDE;
    options.height = SIDE;
    options.threads = 2;
    wisp_status status = find_camera( album, ball, &camera, error );
    for ( int i = 0; i < album->count && status == WISP_OK; ++i )
    {
        stage shot;
        set_scene( album, i, ball, &shot );
        status = render_picture( &shot.scene, &camera, &options, &pictures[i], error );
    }
    return status;
}

// @param number of the picture; below 0: the contact sheet
static wisp_status write_one( const figures_case* page, const char* name, int number, const image* picture,
                              char* path, size_t size, wisp_error* error )
{
    int length = number < 0 ? snprintf( path, size, "%s/%s.png", page->pictures, name )
                            : snprintf( path, size, "%s/%s_%d.png", page->pictures, name, number + 1 );
    if ( length >= (int)size )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "the folder for pictures has too long a name" );
    }
    return image_write_png( path, picture, error );
}

static wisp_status write_all( const figures_case* page, const figures_album* album, const image* pictures,
                              const char* name, char* path, size_t size, wisp_error* error )
{
    const char* labels[FIGURES_SHOTS_MAX];
    const int columns = album->count > SHEET_COLUMNS ? ( album->count + 1 ) / 2 : album->count;
    image sheet = { 0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < album->count && status == WISP_OK; ++i )
    {
        labels[i] = album->labels[i];
        status = write_one( page, name, i, &pictures[i], path, size, error );
    }
    status = status == WISP_OK ? image_sheet( pictures, album->count, columns, labels, &sheet, error ) : status;
    status = status == WISP_OK ? write_one( page, name, -1, &sheet, path, size, error ) : status;
    image_release( &sheet );
    return status;
}

wisp_status drape_write( figures_case* page, const figures_album* album, bool has_ball, const char* name,
                         const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    char path[4096];
    image pictures[FIGURES_SHOTS_MAX] = { { 0 } };
    wisp_mesh ball = { 0 };
    wisp_status status = has_ball ? make_ball( &ball, error ) : WISP_OK;
    status = status == WISP_OK ? draw( album, &ball, pictures, error ) : status;
    status = status == WISP_OK ? write_all( page, album, pictures, name, path, sizeof( path ), error ) : status;
    for ( int i = 0; i < album->count; ++i )
    {
        image_release( &pictures[i] );
    }
    wisp_mesh_release( &ball );
    if ( status == WISP_OK )
    {
        results_add_note( page->out, "%s: ![%s](%s)", caption, caption, path );
        results_add_picture( page->out, path, caption );
    }
    return status;
}
