// Hair, glass and cuts: what pictures show of them, and what hides a point from the camera.
#include "render_fixture.h"

static fixture_ball make_ball( void )
{
    return fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.5f );
}

static image draw( const render_mesh* meshes, int mesh_count, const render_curves* curves, wisp_vec3 cut_normal,
                   float cut_offset )
{
    render_scene scene = render_default_scene();
    scene.meshes = meshes;
    scene.mesh_count = mesh_count;
    scene.curves = curves;
    scene.curves_count = curves != NULL ? 1 : 0;
    scene.cut_normal = cut_normal;
    scene.cut_offset = cut_offset;
    const render_camera camera = fixture_camera();
    const render_options options = fixture_options();
    return fixture_picture( &scene, &camera, &options );
}

static const wisp_vec3 uncut = { 0.0f, 0.0f, 0.0f };

// ---- cuts ----

static int count_differing( const image* a, const image* b, int begin, int end )
{
    int count = 0;
    for ( int y = 0; y < a->height; ++y )
    {
        for ( int x = begin; x < end; ++x )
        {
            count += fixture_differs( a, b, x, y );
        }
    }
    return count;
}

TEST( a_cut_leaves_the_side_behind_it )
{
    fixture_ball ball = make_ball();
    const render_mesh mesh = fixture_mesh( &ball, RENDER_SOLID );
    image none = draw( NULL, 0, NULL, uncut, 0.0f ), whole = draw( &mesh, 1, NULL, uncut, 0.0f );
    image left = draw( &mesh, 1, NULL, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, 0.0f );
    image longer = draw( &mesh, 1, NULL, ( wisp_vec3 ){ 4.0f, 0.0f, 0.0f }, 0.0f );
    const int covered = count_differing( &whole, &none, 0, 96 );
    assert_true( covered > 300 );
    // the camera stands on the plane of the cut: nothing of the right half is left, not even its inside
    assert_int_equal( count_differing( &left, &none, 50, 96 ), 0 );
    assert_true( 2 * count_differing( &left, &none, 0, 48 ) > covered - 40 );
    assert_memory_equal( left.rgb, longer.rgb, 3 * (size_t)left.width * (size_t)left.height );
    image_release( &none );
    image_release( &whole );
    image_release( &left );
    image_release( &longer );
    fixture_ball_free( &ball );
}

TEST( a_cut_shows_what_was_inside )
{
    fixture_ball ball = make_ball(), seed = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, -0.1f }, 0.15f );
    render_mesh meshes[] = { fixture_mesh( &ball, RENDER_SOLID ), fixture_mesh( &seed, RENDER_SOLID ) };
    meshes[1].colour = ( wisp_vec3 ){ 0.8f, 0.0f, 0.0f };
    image whole = draw( meshes, 2, NULL, uncut, 0.0f );
    image open = draw( meshes, 2, NULL, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, 0.1f );
    const uint8_t *before = fixture_pixel( &whole, 48, 36 ), *after = fixture_pixel( &open, 48, 36 );
    assert_true( before[0] < before[1] + 40 );
    assert_true( after[0] > 2 * after[1] );
    image_release( &whole );
    image_release( &open );
    fixture_ball_free( &ball );
    fixture_ball_free( &seed );
}

TEST( a_cut_that_is_not_a_number_is_refused )
{
    render_scene scene = render_default_scene();
    const render_camera camera = fixture_camera();
    const render_options options = fixture_options();
    image out = { 0 };
    wisp_error error = { .status = WISP_OK };
    scene.cut_normal = ( wisp_vec3 ){ 0.0f, NAN, 0.0f };
    assert_int_equal( render_picture( &scene, &camera, &options, &out, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "cut" ) );
    scene.cut_normal = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    scene.cut_offset = INFINITY;
    assert_int_equal( render_picture( &scene, &camera, &options, &out, &error ), WISP_BAD_INPUT );
}

// ---- glass ----

TEST( a_body_is_seen_through_glass_and_not_through_a_wall )
{
    fixture_ball ball = make_ball(), shell = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.9f );
    render_mesh meshes[] = { fixture_mesh( &ball, RENDER_SOLID ), fixture_mesh( &shell, RENDER_SOLID ) };
    meshes[0].colour = ( wisp_vec3 ){ 0.8f, 0.0f, 0.0f };
    image wall = draw( meshes, 2, NULL, uncut, 0.0f );
    meshes[1].material = RENDER_GLASS;
    image glass = draw( meshes, 2, NULL, uncut, 0.0f );
    image none = draw( meshes, 1, NULL, uncut, 0.0f );
    const uint8_t *hidden = fixture_pixel( &wall, 48, 36 ), *seen = fixture_pixel( &glass, 48, 36 );
    assert_true( hidden[0] < hidden[1] + 40 );
    assert_true( seen[0] > 2 * seen[1] );
    // the glass itself is there, too
    assert_true( count_differing( &glass, &none, 0, 96 ) > 500 );
    image_release( &wall );
    image_release( &glass );
    image_release( &none );
    fixture_ball_free( &ball );
    fixture_ball_free( &shell );
}

// ---- what hides a point ----

TEST( the_first_body_before_a_point_is_named )
{
    fixture_ball near = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, 2.0f }, 0.2f ), far = make_ball();
    const render_mesh meshes[] = { fixture_mesh( &far, RENDER_SOLID ), fixture_mesh( &near, RENDER_SOLID ) };
    render_scene scene = render_default_scene();
    scene.meshes = meshes;
    scene.mesh_count = 2;
    const render_camera camera = fixture_camera();
    const wisp_vec3 points[] = {
        { 0.0f, 1.0f, -2.0f },  // behind both
        { 0.48f, 1.0f, -1.0f }, // behind the far one alone
        { 0.0f, 1.0f, 2.2f },   // on the near one, in front
        { 3.0f, 1.0f, 0.0f },   // beside them
        { 0.0f, 1.0f, 4.0f },   // before them
    };
    const int expected[] = { 1, 0, -1, -1, -1 };
    int bodies[WISP_COUNT( points )];
    wisp_error error = { .status = WISP_OK };
    assert_ok( render_find_hiding( &scene, &camera, points, WISP_COUNT( points ), bodies, &error ), error );
    assert_memory_equal( bodies, expected, sizeof( expected ) );
    scene.cut_normal = ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
    scene.cut_offset = 1.0f;
    assert_ok( render_find_hiding( &scene, &camera, points, 1, bodies, &error ), error );
    assert_int_equal( bodies[0], 0 );
    const wisp_vec3 lost = { NAN, 0.0f, 0.0f };
    assert_int_equal( render_find_hiding( &scene, &camera, &lost, 1, bodies, &error ), WISP_BAD_INPUT );
    fixture_ball_free( &near );
    fixture_ball_free( &far );
}

// ---- hair ----

static const wisp_vec3 bow[] = { { -0.9f, 0.4f, 0.0f }, { 0.0f, 1.5f, 0.0f }, { 0.9f, 0.4f, 0.0f } };
static const int32_t bow_offsets[] = { 0, 3 };

static render_curves make_bow( bool is_hair )
{
    render_curves curves = render_default_curves();
    curves.points = bow;
    curves.offsets = bow_offsets;
    curves.strand_count = 1;
    curves.radius = 0.03f;
    curves.is_hair = is_hair;
    return curves;
}

static bool is_covered( const image* picture, const image* none, wisp_vec3 point )
{
    const render_camera camera = fixture_camera();
    const render_options options = fixture_options();
    const fixture_place at = fixture_project( &camera, &options, point );
    return fixture_differs( picture, none, (int)at.x, (int)at.y );
}

TEST( hair_bends_between_its_points_and_other_curves_do_not )
{
    const render_curves straight = make_bow( false ), hair = make_bow( true );
    image none = draw( NULL, 0, NULL, uncut, 0.0f );
    image segments = draw( NULL, 0, &straight, uncut, 0.0f ), smooth = draw( NULL, 0, &hair, uncut, 0.0f );
    // The middle of Hermite's curve: the mean of its ends and an eighth of the difference of its tangents. The tangents
    // are as long as the segment: along the segment at the root, level in the middle.
    const float length = sqrtf( 0.9f * 0.9f + 1.1f * 1.1f );
    const wisp_vec3 chord = { -0.45f, 0.95f, 0.0f };
    const wisp_vec3 curve = { -0.45f + 0.125f * ( 0.9f - length ), 0.95f + 0.125f * 1.1f, 0.0f };
    assert_true( is_covered( &segments, &none, chord ) && !is_covered( &segments, &none, curve ) );
    assert_true( is_covered( &smooth, &none, curve ) && !is_covered( &smooth, &none, chord ) );
    assert_true( is_covered( &segments, &none, bow[1] ) && is_covered( &smooth, &none, bow[1] ) );
    image_release( &none );
    image_release( &segments );
    image_release( &smooth );
}

// A strand of four points that are nearer to each other than floats can tell, or than is seen, and one that is not.
TEST( strands_far_shorter_than_their_radius_draw_no_strokes )
{
    wisp_vec3 points[8];
    for ( int i = 0; i < 4; ++i )
    {
        const float t = 1e-5f * (float)i;
        points[i] = ( wisp_vec3 ){ 0.4f + t, 1.0f - 0.5f * t, 0.3f * t };
        points[4 + i] = ( wisp_vec3 ){ -0.8f + 0.2f * (float)i, 0.6f, 0.0f };
    }
    const int32_t offsets[] = { 0, 4, 8 };
    render_curves curves = render_default_curves();
    curves.points = points;
    curves.offsets = offsets;
    curves.strand_count = 1;
    curves.radius = 0.01f;
    image none = draw( NULL, 0, NULL, uncut, 0.0f ), dot = draw( NULL, 0, &curves, uncut, 0.0f );
    assert_int_equal( count_differing( &dot, &none, 0, 96 ), 0 );
    curves.strand_count = 2;
    image both = draw( NULL, 0, &curves, uncut, 0.0f );
    assert_true( count_differing( &both, &none, 0, 48 ) >= 10 );
    assert_int_equal( count_differing( &both, &none, 50, 96 ), 0 );
    image_release( &none );
    image_release( &dot );
    image_release( &both );
}

enum
{
    STRANDS = 8,
};

// Upright strands beside each other, all the same.
static image picture_of_rows( bool is_hair, float radius, image* none )
{
    wisp_vec3 points[2 * STRANDS];
    int32_t offsets[STRANDS + 1];
    for ( int s = 0; s <= STRANDS; ++s )
    {
        offsets[s] = 2 * s;
    }
    for ( int s = 0; s < STRANDS; ++s )
    {
        const float x = 0.3f * ( (float)s - 3.5f );
        points[2 * s] = ( wisp_vec3 ){ x, 1.8f, 0.0f };
        points[2 * s + 1] = ( wisp_vec3 ){ x, 0.2f, 0.0f };
    }
    render_curves curves = render_default_curves();
    curves.points = points;
    curves.offsets = offsets;
    curves.strand_count = STRANDS;
    curves.radius = radius;
    curves.is_hair = is_hair;
    *none = draw( NULL, 0, NULL, uncut, 0.0f );
    return draw( NULL, 0, &curves, uncut, 0.0f );
}

static int width_at( const image* picture, const image* none, int strand, float height )
{
    const render_camera camera = fixture_camera();
    const render_options options = fixture_options();
    const fixture_place at =
        fixture_project( &camera, &options, ( wisp_vec3 ){ 0.3f * ( (float)strand - 3.5f ), height, 0.0f } );
    int count = 0;
    for ( int x = (int)at.x - 3; x <= (int)at.x + 3; ++x )
    {
        count += fixture_differs( picture, none, x, (int)at.y );
    }
    return count;
}

// Of the middles of all strands.
static int range_of_brightness( const image* picture )
{
    const render_camera camera = fixture_camera();
    const render_options options = fixture_options();
    int brightest = 0, darkest = 3 * 255;
    for ( int s = 0; s < STRANDS; ++s )
    {
        const wisp_vec3 middle = { 0.3f * ( (float)s - 3.5f ), 1.0f, 0.0f };
        const fixture_place at = fixture_project( &camera, &options, middle );
        const int light = fixture_brightness( picture, (int)at.x, (int)at.y );
        brightest = light > brightest ? light : brightest;
        darkest = light < darkest ? light : darkest;
    }
    return brightest - darkest;
}

TEST( hair_is_pointed_and_its_strands_differ )
{
    image none = { 0 }, other = { 0 };
    image rods = picture_of_rows( false, 0.09f, &none ), hair = picture_of_rows( true, 0.09f, &other );
    int roots = 0, tips = 0, rod_roots = 0, rod_tips = 0;
    for ( int s = 0; s < STRANDS; ++s )
    {
        roots += width_at( &hair, &other, s, 1.7f );
        tips += width_at( &hair, &other, s, 0.25f );
        rod_roots += width_at( &rods, &none, s, 1.7f );
        rod_tips += width_at( &rods, &none, s, 0.25f );
    }
    assert_int_equal( rod_roots, rod_tips );
    assert_true( 5 * tips < 4 * roots );
    assert_true( 2 * range_of_brightness( &hair ) > 3 * range_of_brightness( &rods ) );
    image_release( &none );
    image_release( &other );
    image_release( &rods );
    image_release( &hair );
}
