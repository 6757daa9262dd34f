// Points in pictures: balls at the expected pixels, in their colours, opaque, next to unchanged meshes and strands;
// and points that must be rejected.
#include "render_fixture.h"

static const wisp_vec3 two_places[] = { { -0.6f, 1.0f, 0.0f }, { 0.7f, 1.2f, 0.3f } };
static const wisp_vec3 red_and_green[] = { { 0.7f, 0.02f, 0.02f }, { 0.02f, 0.6f, 0.02f } };

static render_points two_points( float radius )
{
    render_points points = render_default_points();
    points.points = two_places;
    points.colours = red_and_green;
    points.count = 2;
    points.radius = radius;
    return points;
}

static image picture_of( const render_points* points )
{
    render_scene scene = render_default_scene();
    scene.points = points;
    scene.points_count = points ? 1 : 0;
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    return fixture_picture( &scene, &camera, &options );
}

TEST( points_are_balls_where_the_camera_says )
{
    render_points points = two_points( 0.2f );
    image none = picture_of( NULL ), picture = picture_of( &points );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    double covered = 0.0;
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_vec3 p = two_places[i];
        fixture_place at = fixture_project( &camera, &options, p );
        assert_true( fixture_differs( &picture, &none, (int)at.x, (int)at.y ) );
        const double side = fixture_project( &camera, &options, ( wisp_vec3 ){ p.x + 0.2f, p.y, p.z } ).x - at.x;
        covered += 3.14159265358979 * side * side;
        assert_false( fixture_differs( &picture, &none, (int)( at.x + side + 3.0 ), (int)at.y ) );
        assert_false( fixture_differs( &picture, &none, (int)at.x, (int)( at.y - side - 3.0 ) ) );
    }
    // a pixel on the rim counts as a whole: at most one ring of pixels, half of it too many
    const double count = fixture_count_differing( &picture, &none );
    assert_true( count > covered && count < 1.5 * covered );
    image_release( &none );
    image_release( &picture );
}

TEST( every_point_has_its_colour )
{
    render_points points = two_points( 0.2f );
    image picture = picture_of( &points );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    for ( int i = 0; i < 2; ++i )
    {
        fixture_place at = fixture_project( &camera, &options, two_places[i] );
        const uint8_t* p = fixture_pixel( &picture, (int)at.x, (int)at.y );
        assert_true( i == 0 ? p[0] > 2 * p[1] : p[1] > 2 * p[0] );
    }
    image_release( &picture );

    points.colours = NULL;
    points.colour = ( wisp_vec3 ){ 0.02f, 0.02f, 0.7f };
    picture = picture_of( &points );
    for ( int i = 0; i < 2; ++i )
    {
        fixture_place at = fixture_project( &camera, &options, two_places[i] );
        const uint8_t* p = fixture_pixel( &picture, (int)at.x, (int)at.y );
        assert_true( p[2] > 2 * p[0] && p[2] > 2 * p[1] );
    }
    image_release( &picture );
}

// ---- next to other bodies ----

static const wisp_vec3 strand_points[] = { { -1.0f, 0.5f, 0.4f }, { 0.0f, 0.5f, 0.4f }, { 1.0f, 0.5f, 0.4f } };
static const int32_t strand_offsets[] = { 0, 3 };

typedef struct everything
{
    fixture_ball ball;
    render_mesh mesh;
    render_curves curves;
    render_points points;
    render_scene scene;
} everything;

static void make_everything( everything* e )
{
    *e = ( everything ){ .ball = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.2f, -0.6f }, 0.4f ),
                         .curves = render_default_curves(),
                         .points = two_points( 0.1f ),
                         .scene = render_default_scene() };
    e->mesh = fixture_mesh( &e->ball, RENDER_LATEX );
    e->curves.points = strand_points;
    e->curves.offsets = strand_offsets;
    e->curves.strand_count = 1;
    e->curves.radius = 0.03f;
    e->scene.meshes = &e->mesh;
    e->scene.mesh_count = 1;
    e->scene.curves = &e->curves;
    e->scene.curves_count = 1;
    e->scene.points = &e->points;
    e->scene.points_count = 1;
    e->scene.has_ground = true;
}

TEST( meshes_and_strands_stay_what_they_are_beside_points )
{
    everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    image with = fixture_picture( &e.scene, &camera, &options );
    e.scene.points_count = 0;
    image without = fixture_picture( &e.scene, &camera, &options );
    // the middle of the strand and of the ball, away from the points and from their shadows
    fixture_place strand = fixture_project( &camera, &options, strand_points[1] );
    fixture_place ball = fixture_project( &camera, &options, ( wisp_vec3 ){ 0.0f, 1.2f, -0.2f } );
    const uint8_t* p = fixture_pixel( &with, (int)strand.x, (int)strand.y );
    const uint8_t* q = fixture_pixel( &without, (int)strand.x, (int)strand.y );
    for ( int k = 0; k < 3; ++k )
    {
        // a point takes a little of the light that comes from all around
        assert_true( abs( p[k] - q[k] ) < 30 );
    }
    p = fixture_pixel( &with, (int)ball.x, (int)ball.y );
    assert_true( p[0] > p[1] && p[0] > p[2] );
    fixture_place point = fixture_project( &camera, &options, two_places[1] );
    assert_true( fixture_differs( &with, &without, (int)point.x, (int)point.y ) );
    image_release( &with );
    image_release( &without );
    fixture_ball_free( &e.ball );
}

TEST( the_number_of_threads_changes_no_byte_of_points )
{
    everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    image one = fixture_picture( &e.scene, &camera, &options );
    options.threads = 3;
    image three = fixture_picture( &e.scene, &camera, &options );
    assert_memory_equal( one.rgb, three.rgb, 3 * (size_t)one.width * (size_t)one.height );
    image_release( &one );
    image_release( &three );
    fixture_ball_free( &e.ball );
}

// Light goes through latex and strands: a point among them lets none through.
TEST( a_point_throws_a_shadow_also_where_others_let_light_through )
{
    const wisp_vec3 place = { 0.0f, 0.6f, 0.0f };
    render_points points = render_default_points();
    points.points = &place;
    points.count = 1;
    points.radius = 0.4f;
    everything e;
    make_everything( &e );
    render_scene scene = render_default_scene();
    scene.has_ground = true;
    scene.curves = &e.curves;
    scene.curves_count = 1;
    render_camera camera = fixture_camera();
    camera.eye = ( wisp_vec3 ){ 0.0f, 4.0f, 5.0f };
    render_options options = fixture_options();
    options.light = ( wisp_vec3 ){ 1.0f, 1.0f, 0.0f };
    image bright = fixture_picture( &scene, &camera, &options );
    scene.points = &points;
    scene.points_count = 1;
    image dark = fixture_picture( &scene, &camera, &options );
    // light falls from the right at 45 degrees, so the middle of the shadow is as far to the left as the ball is high
    fixture_place at = fixture_project( &camera, &options, ( wisp_vec3 ){ -0.6f, 0.0f, 0.0f } );
    assert_true( fixture_brightness( &dark, (int)at.x, (int)at.y ) * 10 <
                 fixture_brightness( &bright, (int)at.x, (int)at.y ) * 8 );
    image_release( &bright );
    image_release( &dark );
    fixture_ball_free( &e.ball );
}

TEST( bounds_hold_whole_balls )
{
    render_points points = two_points( 0.25f );
    render_scene scene = render_default_scene();
    scene.points = &points;
    scene.points_count = 1;
    render_bounds bounds;
    assert_int_equal( render_scene_bounds( &scene, &bounds, NULL ), WISP_OK );
    assert_true( bounds.is_filled );
    assert_true( bounds.lower.x == -0.6f - 0.25f && bounds.upper.x == 0.7f + 0.25f );
    assert_true( bounds.lower.y == 1.0f - 0.25f && bounds.upper.z == 0.3f + 0.25f );
}

// ---- refusals ----

static void assert_refused( const render_points* points, int count, const char* words )
{
    render_scene scene = render_default_scene();
    scene.points = points;
    scene.points_count = count;
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    image out = { 0 };
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( render_picture( &scene, &camera, &options, &out, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_null( out.rgb );
}

TEST( points_that_cannot_be_are_refused_by_name )
{
    render_points good = two_points( 0.1f ), bad = good;
    assert_refused( &good, -1, "-1 sets of points do not fit their array" );
    assert_refused( NULL, 1, "1 sets of points do not fit their array" );
    bad.count = -2;
    assert_refused( &bad, 1, "points 0: -2 points do not fit their array" );
    bad = good;
    bad.points = NULL;
    assert_refused( &bad, 1, "points 0: 2 points do not fit their array" );
    bad = good;
    bad.name = "layer";
    bad.radius = 0.0f;
    assert_refused( &bad, 1, "points \"layer\": radius 0 is not above 0" );
    bad.radius = NAN;
    assert_refused( &bad, 1, "radius nan" );
    const wisp_vec3 lost[] = { { 0.0f, 1.0f, 0.0f }, { 0.0f, INFINITY, 0.0f } };
    bad = good;
    bad.points = lost;
    assert_refused( &bad, 1, "points 0: vertex 1 is not finite" );
    const wisp_vec3 black_hole[] = { { 0.0f, 0.0f, 0.0f }, { 0.0f, -1.0f, 0.0f } };
    bad = good;
    bad.colours = black_hole;
    assert_refused( &bad, 1, "of vertex 1 is not in 0 .. 10" );
}

TEST( no_points_are_nothing )
{
    render_points points = render_default_points();
    image none = picture_of( NULL ), empty = picture_of( &points );
    assert_int_equal( fixture_count_differing( &none, &empty ), 0 );
    image_release( &none );
    image_release( &empty );
}
