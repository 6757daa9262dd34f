// Scenes, cameras and options that must be rejected, each with one message that names the error.
#include "render_fixture.h"

#include <limits.h>

// A valid scene, for the tests to break.
typedef struct spoilt
{
    wisp_vec3 points[4], colours[4], strand_points[3];
    int32_t triangles[6], offsets[3];
    float radii[3];
    render_mesh meshes[2];
    render_curves curves;
    render_scene scene;
    render_camera camera;
    render_options options;
} spoilt;

static void make_good( spoilt* s )
{
    *s = ( spoilt ){
        .points = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 1.0f, 1.0f, 0.0f } },
        .strand_points = { { 0.0f, 0.0f, 1.0f }, { 0.0f, 1.0f, 1.0f }, { 0.0f, 2.0f, 1.0f } },
        .triangles = { 0, 1, 2, 2, 1, 3 },
        .offsets = { 0, 2, 3 },
        .radii = { 0.1f, 0.0f, 0.1f },
        .scene = render_default_scene(),
        .camera = fixture_camera(),
        .options = fixture_options(),
    };
    for ( int i = 0; i < 2; ++i )
    {
        s->meshes[i] = render_default_mesh( RENDER_CLOTH );
        s->meshes[i].points = s->points;
        s->meshes[i].colours = s->colours;
        s->meshes[i].vertex_count = 4;
        s->meshes[i].triangles = s->triangles;
        s->meshes[i].triangle_count = 2;
    }
    s->meshes[0].name = "flag";
    s->curves = render_default_curves();
    s->curves.points = s->strand_points;
    s->curves.offsets = s->offsets;
    s->curves.radii = s->radii;
    s->curves.strand_count = 2;
    s->scene.meshes = s->meshes;
    s->scene.mesh_count = 2;
    s->scene.curves = &s->curves;
    s->scene.curves_count = 1;
    s->scene.has_ground = true;
}

static wisp_status draw( const spoilt* s, image* out, wisp_error* error )
{
    return render_picture( &s->scene, &s->camera, &s->options, out, error );
}

// Rejected with these words, and the previous picture is still there.
static void assert_refused( const spoilt* s, const char* words )
{
    image old = { 0 };
    assert_int_equal( image_make( 3, 2, ( image_colour ){ 1, 2, 3 }, &old, NULL ), WISP_OK );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( draw( s, &old, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_int_equal( old.width, 3 );
    assert_int_equal( fixture_pixel( &old, 2, 1 )[2], 3 );
    image_release( &old );
}

TEST( the_unspoilt_scene_is_drawn )
{
    spoilt s;
    make_good( &s );
    image picture = { 0 };
    assert_int_equal( draw( &s, &picture, NULL ), WISP_OK );
    assert_int_equal( picture.width, s.options.width );
    image_release( &picture );
}

TEST( a_vertex_that_is_not_finite_is_named )
{
    spoilt s;
    make_good( &s );
    s.points[2].y = NAN;
    assert_refused( &s, "mesh \"flag\": vertex 2 is not finite (0, nan, 0)" );
    s.meshes[0].vertex_count = s.meshes[0].triangle_count = 0;
    assert_refused( &s, "mesh 1: vertex 2 is not finite" );
    make_good( &s );
    s.points[3].x = 2e6f;
    assert_refused( &s, "mesh \"flag\": vertex 3 at (2e+06, 1, 0) is more than 1e+06 m from the origin" );
    make_good( &s );
    s.strand_points[1].z = -INFINITY;
    assert_refused( &s, "curves 0: vertex 1 is not finite (0, 1, -inf)" );
}

TEST( a_triangle_that_names_no_vertex_is_named )
{
    spoilt s;
    make_good( &s );
    s.triangles[4] = 4;
    assert_refused( &s, "mesh \"flag\": triangle 1 names vertex 4 of 4" );
    s.triangles[4] = INT32_MIN;
    assert_refused( &s, "mesh \"flag\": triangle 1 names vertex -2147483648 of 4" );
    make_good( &s );
    s.meshes[1].triangle_count = -1;
    assert_refused( &s, "mesh 1: 4 vertices and -1 triangles do not fit their arrays" );
    make_good( &s );
    s.meshes[1].points = NULL;
    assert_refused( &s, "mesh 1: 4 vertices and 2 triangles do not fit their arrays" );
    make_good( &s );
    s.meshes[0].material = (render_material)7;
    assert_refused( &s, "mesh \"flag\": material 7 is none of solid, cloth, latex and glass" );
}

TEST( a_strand_out_of_order_is_named )
{
    spoilt s;
    make_good( &s );
    s.curves.name = "head";
    s.offsets[1] = 5;
    assert_refused( &s, "curves \"head\": strand 1 ends at vertex 3, before it begins at 5" );
    s.offsets[0] = 1;
    assert_refused( &s, "curves \"head\": the first strand begins at vertex 1 instead of 0" );
    make_good( &s );
    s.curves.offsets = NULL;
    assert_refused( &s, "curves 0: 2 strands do not fit their offsets" );
    make_good( &s );
    s.curves.points = NULL;
    assert_refused( &s, "curves 0: 2 strands have no points" );
    make_good( &s );
    s.radii[1] = -0.5f;
    assert_refused( &s, "curves 0: radius -0.5 of vertex 1" );
    make_good( &s );
    s.curves.radius = NAN;
    assert_refused( &s, "curves 0: radius nan is not in 0 .. 1e+06" );
}

TEST( a_colour_that_is_none_is_named )
{
    spoilt s;
    make_good( &s );
    s.colours[1].x = -0.1f;
    assert_refused( &s, "mesh \"flag\": colour (-0.1, 0, 0) of vertex 1 is not in 0 .. 10" );
    make_good( &s );
    s.meshes[1].colour.y = INFINITY;
    assert_refused( &s, "mesh 1: colour" );
    make_good( &s );
    s.scene.background_top.x = NAN;
    assert_refused( &s, "background: colour (nan" );
    make_good( &s );
    s.scene.ground_height = NAN;
    assert_refused( &s, "ground: height nan" );
    make_good( &s );
    s.scene.mesh_count = -2;
    assert_refused( &s, "picture: -2 meshes and 1 sets of curves do not fit their arrays" );
}

TEST( a_camera_that_sees_nothing_is_refused )
{
    spoilt s;
    make_good( &s );
    s.camera.target = s.camera.eye;
    assert_refused( &s, "camera: eye and target are the same point" );
    make_good( &s );
    s.camera.up = ( wisp_vec3 ){ 0.0f, 0.0f, 2.0f };
    assert_refused( &s, "camera: up has no length or lies along the view" );
    s.camera.up = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    assert_refused( &s, "camera: up has no length or lies along the view" );
    make_good( &s );
    s.camera.eye.x = NAN;
    assert_refused( &s, "camera: eye, target or up is not finite" );
    make_good( &s );
    s.camera.eye.x = 1e20f;
    assert_refused( &s, "camera: eye or target is more than 1e+09 m from the origin" );
    make_good( &s );
    s.camera.fov_degrees = 180.0f;
    assert_refused( &s, "camera: the angle of view is 180 degrees and must be in 1 .. 150" );
}

TEST( a_frame_that_cannot_be_is_refused )
{
    render_bounds box = { { 0.0f, 0.0f, 0.0f }, { 1.0f, NAN, 1.0f }, true };
    render_view view = render_default_view();
    render_camera camera;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( render_frame_camera( &box, &view, 1.0f, &camera, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "camera: the bounds hold nan" ) );
    box.upper.y = 1.0f;
    view.elevation_degrees = 90.0f;
    assert_int_equal( render_frame_camera( &box, &view, 1.0f, &camera, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "camera: elevation is 90 and must be in -89 .. 89" ) );
    view = render_default_view();
    assert_int_equal( render_frame_camera( &box, &view, 0.0f, &camera, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "camera: aspect is 0" ) );
}

TEST( options_out_of_range_are_named )
{
    spoilt s;
    make_good( &s );
    s.options.width = 0;
    assert_refused( &s, "picture: width is 0 and must be in 1 .. 16384" );
    make_good( &s );
    s.options.height = INT_MAX;
    assert_refused( &s, "picture: height is 2.14748e+09" );
    make_good( &s );
    s.options.samples = 0;
    assert_refused( &s, "picture: the number of samples is 0 and must be in 1 .. 4096" );
    make_good( &s );
    s.options.threads = 65;
    assert_refused( &s, "picture: the number of threads is 65 and must be in 1 .. 64" );
    make_good( &s );
    s.options.exposure = NAN;
    assert_refused( &s, "picture: exposure is nan" );
    make_good( &s );
    s.options.light.x = INFINITY;
    assert_refused( &s, "picture: the direction of the light is not finite" );
}

// Legal but unusual input must be drawn without a sanitizer error: flat and doubled triangles, bodies of one point,
// strands of one, a point for a scene, tiny and far bodies.
TEST( strange_scenes_are_drawn )
{
    const float scales[] = { 0.0f, 1e-30f, 1e-6f, 1e5f };
    const float shifts[] = { 0.0f, 9e5f };
    for ( int i = 0; i < WISP_COUNT( scales ) * WISP_COUNT( shifts ); ++i )
    {
        spoilt s;
        make_good( &s );
        float scale = scales[i / WISP_COUNT( shifts )], shift = shifts[i % WISP_COUNT( shifts )];
        for ( int v = 0; v < 4; ++v )
        {
            s.points[v] = ( wisp_vec3 ){ scale * s.points[v].x + shift, scale * s.points[v].y, 0.0f };
        }
        s.triangles[3] = s.triangles[4];
        s.meshes[1].material = RENDER_LATEX;
        s.strand_points[0] = s.strand_points[1];
        s.scene.ground_height = -1e-3f;
        render_bounds bounds;
        render_view view = render_default_view();
        assert_int_equal( render_scene_bounds( &s.scene, &bounds, NULL ), WISP_OK );
        assert_int_equal( render_frame_camera( &bounds, &view, 4.0f / 3.0f, &s.camera, NULL ), WISP_OK );
        image picture = { 0 };
        wisp_error error = { .status = WISP_OK };
        if ( draw( &s, &picture, &error ) != WISP_OK )
        {
            fail_msg( "scale %g, shift %g: %s", (double)scale, (double)shift, error.message );
        }
        image_release( &picture );
    }
}
