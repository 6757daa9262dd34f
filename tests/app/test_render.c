// Pictures: their content, which depends only on scene, camera and options. Hair, glass and cuts: what pictures show of
// them, and what hides a point from the camera.
#include "render_fixture.h"

#include "sampler.h"

// ---- a scene with one of everything ----

typedef struct everything
{
    fixture_ball balls[3];
    render_mesh meshes[3];
    render_curves curves;
    render_scene scene;
} everything;

static const wisp_vec3 strand_points[] = {
    { -0.9f, 1.9f, 0.6f }, { -0.3f, 1.5f, 0.9f }, { 0.3f, 1.6f, 0.9f }, { 0.9f, 1.2f, 0.8f },
    { -0.8f, 0.4f, 1.0f }, { 0.0f, 0.6f, 1.2f },  { 0.7f, 0.3f, 1.0f },
};
static const int32_t strand_offsets[] = { 0, 4, 4, 7 };

static void make_everything( everything* e )
{
    *e = ( everything ){ .scene = render_default_scene() };
    for ( int i = 0; i < 3; ++i )
    {
        e->balls[i] = fixture_ball_make( ( wisp_vec3 ){ 1.1f * (float)( i - 1 ), 0.7f, 0.0f }, 0.5f );
        e->meshes[i] = fixture_mesh( &e->balls[i], (render_material)i );
    }
    e->meshes[0].is_faceted = true;
    e->curves = render_default_curves();
    e->curves.points = strand_points;
    e->curves.offsets = strand_offsets;
    e->curves.strand_count = 3;
    e->curves.radius = 0.02f;
    e->scene.meshes = e->meshes;
    e->scene.mesh_count = 3;
    e->scene.curves = &e->curves;
    e->scene.curves_count = 1;
    e->scene.has_ground = true;
}

static void free_everything( everything* e )
{
    for ( int i = 0; i < 3; ++i )
    {
        fixture_ball_free( &e->balls[i] );
    }
}

static void assert_same_picture( const image* a, const image* b )
{
    assert_int_equal( a->width, b->width );
    assert_int_equal( a->height, b->height );
    assert_memory_equal( a->rgb, b->rgb, 3 * (size_t)a->width * (size_t)a->height );
}

TEST( the_number_of_threads_changes_no_byte )
{
    SCOPED( free_everything ) everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    SCOPED( image_release ) image one = fixture_picture( &e.scene, &camera, &options );
    for ( int threads = 2; threads <= 3; ++threads )
    {
        options.threads = threads;
        SCOPED( image_release ) image many = fixture_picture( &e.scene, &camera, &options );
        assert_same_picture( &one, &many );
    }
}

static void backwards( void* user, int block_count, wisp_block_fn* run, void* context )
{
    int* calls = user;
    for ( int block = block_count - 1; block >= 0; --block )
    {
        run( context, block, block % 5 );
    }
    *calls += 1;
}

TEST( a_host_that_draws_backwards_gets_the_same_bytes )
{
    SCOPED( free_everything ) everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    SCOPED( image_release ) image ours = fixture_picture( &e.scene, &camera, &options );
    int calls = 0;
    options.parallel_for = backwards;
    options.parallel_user = &calls;
    SCOPED( image_release ) image theirs = fixture_picture( &e.scene, &camera, &options );
    assert_int_equal( calls, 1 );
    assert_same_picture( &ours, &theirs );
}

TEST( another_seed_has_other_noise )
{
    SCOPED( free_everything ) everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    SCOPED( image_release ) image first = fixture_picture( &e.scene, &camera, &options );
    options.seed = 2;
    SCOPED( image_release ) image second = fixture_picture( &e.scene, &camera, &options );
    assert_true( fixture_count_differing( &first, &second ) > 0 );
}

// ---- the background ----

TEST( an_empty_scene_is_its_background )
{
    render_scene scene = render_default_scene();
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    options.tone = RENDER_TONE_SRGB;
    SCOPED( image_release ) image picture = fixture_picture( &scene, &camera, &options );
    for ( int y = 0; y < picture.height; ++y )
    {
        for ( int x = 1; x < picture.width; ++x )
        {
            assert_memory_equal( fixture_pixel( &picture, x, y ), fixture_pixel( &picture, 0, y ), 3 );
        }
    }
    // Half a row below the upper edge the gradient has moved by less than a byte's step.
    const uint8_t *top = fixture_pixel( &picture, 0, 0 ), *bottom = fixture_pixel( &picture, 0, picture.height - 1 );
    assert_in_range( top[0] + 1 - image_byte_of_linear( scene.background_top.x ), 0, 2 );
    assert_in_range( top[2] + 1 - image_byte_of_linear( scene.background_top.z ), 0, 2 );
    assert_in_range( bottom[0] + 1 - image_byte_of_linear( scene.background_bottom.x ), 0, 2 );
    assert_in_range( bottom[2] + 1 - image_byte_of_linear( scene.background_bottom.z ), 0, 2 );
}

TEST( the_ground_runs_out_into_the_background )
{
    SCOPED( free_everything ) everything e;
    make_everything( &e );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    SCOPED( image_release ) image with = fixture_picture( &e.scene, &camera, &options );
    e.scene.has_ground = false;
    SCOPED( image_release ) image without = fixture_picture( &e.scene, &camera, &options );

    // The camera is level, so the horizon is at half height; the bodies leave the left edge free.
    int horizon = options.height / 2;
    assert_false( fixture_differs( &with, &without, 0, horizon - 1 ) );
    assert_false( fixture_differs( &with, &without, 0, horizon + 1 ) );
    assert_true( fixture_count_differing( &with, &without ) > options.width );
}

// ---- positions ----

typedef struct ball_view
{
    image with, without;
} ball_view;

static ball_view view_ball( wisp_vec3 centre, float radius, const render_options* options )
{
    SCOPED( fixture_ball_free ) fixture_ball ball = fixture_ball_make( centre, radius );
    render_mesh mesh = fixture_mesh( &ball, RENDER_SOLID );
    render_scene scene = render_default_scene();
    render_camera camera = fixture_camera();
    ball_view out = { .without = fixture_picture( &scene, &camera, options ) };
    scene.meshes = &mesh;
    scene.mesh_count = 1;
    out.with = fixture_picture( &scene, &camera, options );
    return out;
}

static void release_view( ball_view* v )
{
    image_release( &v->with );
    image_release( &v->without );
}

TEST( a_ball_covers_the_disc_that_the_camera_says )
{
    render_options options = fixture_options();
    const float radius = 0.8f, away = 5.0f;
    SCOPED( release_view ) ball_view v = view_ball( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, radius, &options );
    assert_true( fixture_differs( &v.with, &v.without, 48, 36 ) );
    assert_false( fixture_differs( &v.with, &v.without, 0, 0 ) );
    assert_false( fixture_differs( &v.with, &v.without, 95, 71 ) );

    // The edge of a ball appears at asin( r / d ).
    double edge = tan( asin( (double)( radius / away ) ) ) * 0.5 * options.height / tan( 20.0 * 3.14159265 / 180.0 );
    double count = fixture_count_differing( &v.with, &v.without );
    // A ball of 24 rings is at most 1 % smaller than a sphere; a pixel gathers from one pixel around its centre, so
    // the pixels that the ball touches are up to 1.5 pixels outside.
    assert_true( count > 3.14159265 * edge * edge * 0.98 );
    assert_true( count < 3.14159265 * ( edge + 1.5 ) * ( edge + 1.5 ) );
}

TEST( right_is_right_and_up_is_up )
{
    render_options options = fixture_options();
    render_camera camera = fixture_camera();
    wisp_vec3 centre = { 1.2f, 1.9f, -0.5f };
    SCOPED( release_view ) ball_view v = view_ball( centre, 0.15f, &options );
    fixture_place place = fixture_project( &camera, &options, centre );
    assert_true( place.x > 48.0 && place.y < 36.0 );
    assert_true( fixture_differs( &v.with, &v.without, (int)place.x, (int)place.y ) );
    assert_false( fixture_differs( &v.with, &v.without, (int)place.x, 71 - (int)place.y ) );
    assert_false( fixture_differs( &v.with, &v.without, 95 - (int)place.x, (int)place.y ) );
}

static image picture_of_triangle( const int32_t* triangle, render_material material, bool is_painted )
{
    static const wisp_vec3 points[] = { { -1.0f, 0.2f, 0.0f }, { 1.0f, 0.2f, 0.0f }, { 0.0f, 2.2f, 0.0f } };
    static const wisp_vec3 colours[] = { { 0.6f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.6f }, { 0.0f, 0.6f, 0.0f } };
    render_mesh mesh = render_default_mesh( material );
    mesh.points = points;
    mesh.colours = is_painted ? colours : NULL;
    mesh.vertex_count = 3;
    mesh.triangles = triangle;
    mesh.triangle_count = triangle == NULL ? 0 : 1;
    render_scene scene = render_default_scene();
    scene.meshes = &mesh;
    scene.mesh_count = 1;
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    return fixture_picture( &scene, &camera, &options );
}

TEST( painted_cloth_is_the_same_from_both_sides )
{
    const int32_t front[] = { 0, 1, 2 }, back[] = { 0, 2, 1 };
    SCOPED( image_release )
    image a = picture_of_triangle( front, RENDER_CLOTH, true ), b = picture_of_triangle( back, RENDER_CLOTH, true );
    SCOPED( image_release ) image none = picture_of_triangle( NULL, RENDER_CLOTH, true );
    assert_true( fixture_differs( &a, &none, 48, 40 ) );
    // They differ only by the order of two additions.
    assert_int_equal( fixture_count_differing( &a, &b ), 0 );
}

TEST( the_back_of_cloth_is_paler )
{
    const int32_t front[] = { 0, 1, 2 }, back[] = { 0, 2, 1 };
    SCOPED( image_release )
    image a = picture_of_triangle( front, RENDER_CLOTH, false ), b = picture_of_triangle( back, RENDER_CLOTH, false );
    const uint8_t *blue = fixture_pixel( &a, 48, 40 ), *pale = fixture_pixel( &b, 48, 40 );
    assert_true( blue[2] > 2 * blue[0] );
    assert_true( 2 * pale[2] < 3 * pale[0] );
}

TEST( colours_of_vertices_run_into_each_other )
{
    const int32_t front[] = { 0, 1, 2 };
    SCOPED( image_release ) image picture = picture_of_triangle( front, RENDER_SOLID, true );
    const uint8_t *left = fixture_pixel( &picture, 36, 50 ), *right = fixture_pixel( &picture, 60, 50 );
    const uint8_t *middle = fixture_pixel( &picture, 48, 50 ), *top = fixture_pixel( &picture, 48, 20 );
    assert_true( left[0] > left[2] + 40 && right[2] > right[0] + 40 );
    assert_true( top[1] > top[0] + 40 && top[1] > top[2] + 40 );
    assert_true( middle[0] < left[0] && middle[2] < right[2] && middle[0] > right[0] );
}

// ---- strands ----

static image picture_of_strand( float radius, float min_pixels )
{
    static const wisp_vec3 points[] = { { -1.0f, 1.0f, 0.0f }, { 0.1f, 1.0f, 0.0f }, { 1.0f, 1.0f, 0.0f } };
    static const int32_t offsets[] = { 0, 3 };
    render_curves curves = render_default_curves();
    curves.points = points;
    curves.offsets = offsets;
    curves.strand_count = 1;
    curves.radius = radius;
    render_scene scene = render_default_scene();
    scene.curves = &curves;
    scene.curves_count = 1;
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    options.height = 73; // a row of pixels, and not an edge between two, is where the strand is
    options.samples = 16;
    options.min_curve_pixels = min_pixels;
    return fixture_picture( &scene, &camera, &options );
}

TEST( a_strand_is_seen_along_its_whole_length )
{
    SCOPED( image_release ) image none = picture_of_strand( 0.0f, 0.0f );
    SCOPED( image_release ) image thick = picture_of_strand( 0.04f, 0.0f );
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    options.height = 73;
    int begin = (int)fixture_project( &camera, &options, ( wisp_vec3 ){ -1.0f, 1.0f, 0.0f } ).x;
    int end = (int)fixture_project( &camera, &options, ( wisp_vec3 ){ 1.0f, 1.0f, 0.0f } ).x;
    for ( int x = begin + 1; x < end; ++x )
    {
        assert_true( fixture_differs( &thick, &none, x, 36 ) );
    }
    assert_false( fixture_differs( &thick, &none, begin - 4, 36 ) );
    assert_false( fixture_differs( &thick, &none, end + 4, 36 ) );
    assert_false( fixture_differs( &thick, &none, 48, 30 ) );
}

TEST( a_hair_thinner_than_a_pixel_is_widened )
{
    SCOPED( image_release ) image none = picture_of_strand( 0.0f, 0.0f );
    SCOPED( image_release ) image thin = picture_of_strand( 4e-5f, 0.0f );
    SCOPED( image_release ) image widened = picture_of_strand( 4e-5f, 1.0f );
    assert_true( fixture_count_differing( &widened, &none ) >= 40 );
    assert_true( fixture_count_differing( &thin, &none ) * 4 < fixture_count_differing( &widened, &none ) );
}

// ---- light ----

// A ball above the ground, the key light straight above it, the camera high up in front.
static image picture_with_shadow( render_material material, const render_camera* camera,
                                  const render_options* options )
{
    SCOPED( fixture_ball_free ) fixture_ball ball = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.5f, 0.0f }, 0.5f );
    render_mesh mesh = fixture_mesh( &ball, material );
    mesh.colour = ( wisp_vec3 ){ 0.7f, 0.05f, 0.05f };
    render_scene scene = render_default_scene();
    scene.background_bottom = scene.background_top = ( wisp_vec3 ){ 0.5f, 0.5f, 0.5f };
    scene.has_ground = true;
    scene.meshes = &mesh;
    scene.mesh_count = 1;
    return fixture_picture( &scene, camera, options );
}

static const render_camera above = { { 0.0f, 2.0f, 6.0f }, { 0.0f, 0.7f, 0.0f }, { 0.0f, 1.0f, 0.0f }, 40.0f };

static render_options under_a_lamp( void )
{
    render_options options = fixture_options();
    options.samples = 64;
    options.light = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    return options;
}

TEST( the_ground_under_a_ball_is_darker_than_beside_it )
{
    render_options options = under_a_lamp();
    SCOPED( image_release ) image picture = picture_with_shadow( RENDER_SOLID, &above, &options );
    fixture_place under = fixture_project( &above, &options, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    fixture_place left = fixture_project( &above, &options, ( wisp_vec3 ){ -1.5f, 0.0f, 0.0f } );
    fixture_place right = fixture_project( &above, &options, ( wisp_vec3 ){ 1.5f, 0.0f, 0.0f } );
    int dark = fixture_brightness( &picture, (int)under.x, (int)under.y );
    // The squares of the ground differ by a twentieth, a shadow takes more than half.
    assert_true( dark * 10 < 8 * fixture_brightness( &picture, (int)left.x, (int)left.y ) );
    assert_true( dark * 10 < 8 * fixture_brightness( &picture, (int)right.x, (int)right.y ) );
}

// The brightness of the ground at a distance from under the ball, along a diagonal, where all squares are alike.
static int ground_at( const image* picture, const render_options* options, float distance )
{
    wisp_vec3 p = { distance * 0.70710678f, 0.0f, distance * 0.70710678f };
    fixture_place place = fixture_project( &above, options, p );
    return fixture_brightness( picture, (int)place.x, (int)place.y );
}

TEST( a_shadow_has_a_soft_edge )
{
    render_options options = under_a_lamp();
    options.width = 320;
    options.height = 240;
    SCOPED( image_release ) image picture = picture_with_shadow( RENDER_SOLID, &above, &options );
    int whole = ground_at( &picture, &options, 0.75f ) - ground_at( &picture, &options, 0.25f );
    int edge = ground_at( &picture, &options, 0.55f ) - ground_at( &picture, &options, 0.45f );

    // The lamp is 0.24 wide for each metre of distance and the ball 1.5 m above the ground, so the edge of the shadow
    // spans 0.32 .. 0.68 m. A hard edge would be crossed whole between 0.45 and 0.55 m.
    assert_true( whole > 100 );
    assert_true( edge > 0 && edge * 10 < whole * 6 );
}

TEST( latex_colours_its_shadow )
{
    render_options options = under_a_lamp();
    SCOPED( image_release ) image latex = picture_with_shadow( RENDER_LATEX, &above, &options );
    SCOPED( image_release ) image solid = picture_with_shadow( RENDER_SOLID, &above, &options );
    fixture_place under = fixture_project( &above, &options, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const uint8_t* red = fixture_pixel( &latex, (int)under.x, (int)under.y );
    const uint8_t* grey = fixture_pixel( &solid, (int)under.x, (int)under.y );
    assert_true( red[0] > grey[0] + 20 );
    assert_true( red[0] - red[1] > grey[0] - grey[1] + 20 );
}

TEST( light_from_the_left_lights_the_left )
{
    render_options options = fixture_options();
    options.light = ( wisp_vec3 ){ -1.0f, 0.2f, 0.5f };
    SCOPED( release_view ) ball_view v = view_ball( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.8f, &options );
    assert_true( fixture_brightness( &v.with, 38, 36 ) > fixture_brightness( &v.with, 58, 36 ) + 60 );
}

TEST( film_rolls_off_what_plain_output_cuts )
{
    render_scene scene = render_default_scene();
    scene.background_top = scene.background_bottom = ( wisp_vec3 ){ 1.5f, 0.3f, 0.3f };
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    SCOPED( image_release ) image film = fixture_picture( &scene, &camera, &options );
    options.tone = RENDER_TONE_SRGB;
    image plain = fixture_picture( &scene, &camera, &options );
    assert_int_equal( fixture_pixel( &plain, 5, 5 )[0], 255 );
    assert_int_equal( fixture_pixel( &plain, 5, 5 )[1], image_byte_of_linear( 0.3f ) );
    assert_in_range( fixture_pixel( &film, 5, 5 )[0], 235, 254 );
    image_release( &film );
    image_release( &plain );

    scene.background_top = scene.background_bottom = ( wisp_vec3 ){ 0.7f, 0.3f, 0.1f };
    options.tone = RENDER_TONE_FILMIC;
    film = fixture_picture( &scene, &camera, &options );
    assert_int_equal( fixture_pixel( &film, 5, 5 )[0], image_byte_of_linear( 0.7f ) );
    assert_int_equal( fixture_pixel( &film, 5, 5 )[2], image_byte_of_linear( 0.1f ) );
}

// ---- the automatic camera ----

TEST( the_whole_box_is_in_the_picture_and_fills_it )
{
    render_bounds box = { { -0.3f, 0.1f, -1.2f }, { 1.4f, 0.9f, 0.7f }, true };
    render_options options = fixture_options();
    for ( int angle = 0; angle < 360; angle += 30 )
    {
        render_view view = render_default_view();
        view.azimuth_degrees = (float)angle;
        view.margin = 0.1f;
        render_camera camera;
        assert_int_equal( render_frame_camera( &box, &view, 96.0f / 72.0f, &camera, NULL ), WISP_OK );
        double nearest = 1e9;
        for ( int k = 0; k < 8; ++k )
        {
            wisp_vec3 p = { k & 1 ? box.lower.x : box.upper.x, k & 2 ? box.lower.y : box.upper.y,
                            k & 4 ? box.lower.z : box.upper.z };
            fixture_place at = fixture_project( &camera, &options, p );
            double x = fmin( at.x, 96.0 - at.x ) / 96.0, y = fmin( at.y, 72.0 - at.y ) / 72.0;
            nearest = fmin( nearest, fmin( x, y ) );
        }
        // The camera is computed in single precision from a box of 2 m.
        assert_true( fabs( nearest - 0.1 ) < 1e-4 );
    }
}

TEST( a_turntable_keeps_its_distance )
{
    render_bounds box = { { -1.0f, 0.0f, -0.2f }, { 1.0f, 0.5f, 0.2f }, true };
    render_view view = render_default_view();
    view.is_turntable = true;
    float first = 0.0f;
    for ( int angle = 0; angle < 360; angle += 15 )
    {
        render_camera camera;
        view.azimuth_degrees = (float)angle;
        assert_int_equal( render_frame_camera( &box, &view, 1.5f, &camera, NULL ), WISP_OK );
        float x = camera.eye.x - camera.target.x, y = camera.eye.y - camera.target.y;
        float distance =
            sqrtf( x * x + y * y + ( camera.eye.z - camera.target.z ) * ( camera.eye.z - camera.target.z ) );
        first = angle == 0 ? distance : first;
        // The circle is 32 points, which the view meets at up to 5.6 degrees beside them: cosine 0.995.
        assert_true( fabsf( distance - first ) < 0.006f * first );
    }
}

TEST( an_empty_box_still_has_a_camera )
{
    render_bounds none = { .is_filled = false };
    render_view view = render_default_view();
    render_scene scene = render_default_scene();
    scene.has_ground = true;
    render_options options = fixture_options();
    render_camera camera;
    assert_int_equal( render_frame_camera( &none, &view, 1.0f, &camera, NULL ), WISP_OK );
    SCOPED( image_release ) image picture = fixture_picture( &scene, &camera, &options );
}

TEST( bounds_hold_what_is_drawn_and_join )
{
    SCOPED( free_everything ) everything e;
    make_everything( &e );
    render_bounds bounds;
    assert_int_equal( render_scene_bounds( &e.scene, &bounds, NULL ), WISP_OK );
    assert_true( bounds.is_filled );
    assert_true( fabsf( bounds.lower.x + 1.6f ) < 1e-3f && fabsf( bounds.upper.x - 1.6f ) < 1e-3f );
    assert_true( fabsf( bounds.upper.y - 1.92f ) < 1e-6f ); // the highest point of a strand and its radius
    render_bounds none = { .is_filled = false };
    render_bounds both = render_bounds_union( none, bounds );
    assert_memory_equal( &both.lower, &bounds.lower, sizeof( both.lower ) );
    both = render_bounds_union( bounds, ( render_bounds ){ { 0.0f, -3.0f, 0.0f }, { 0.0f, 0.0f, 9.0f }, true } );
    assert_true( both.lower.y == -3.0f && both.upper.z == 9.0f && both.lower.x == bounds.lower.x );
}

// ---- progress ----

typedef struct listener
{
    int calls;
    double last;
} listener;

static void listen( void* user, double fraction )
{
    listener* l = user;
    assert_true( fraction >= l->last && fraction <= 1.0 );
    l->last = fraction;
    l->calls += 1;
}

TEST( progress_rises_to_one )
{
    render_scene scene = render_default_scene();
    render_camera camera = fixture_camera();
    render_options options = fixture_options();
    for ( int threads = 1; threads <= 2; ++threads )
    {
        listener l = { 0, 0.0 };
        options.threads = threads;
        options.progress = listen;
        options.progress_user = &l;
        SCOPED( image_release ) image picture = fixture_picture( &scene, &camera, &options );
        assert_true( l.last == 1.0 );
        assert_true( threads > 1 || l.calls > 20 ); // 30 tiles
    }
}

// ---- samples ----

// Of N = 2^m points, every box of 2^-a x 2^-(m-a) holds exactly one: the definition of a (0,m,2)-net.
TEST( the_samples_of_a_pixel_are_a_net )
{
    wisp_random_key key = wisp_random_make_key( 3, 1, 4 );
    for ( int pixel = 0; pixel < 20; ++pixel )
    {
        sampler s = sampler_of_pixel( key, pixel, 7 * pixel, 64 );
        for ( int a = 0; a <= 6; ++a )
        {
            int hits[64] = { 0 };
            for ( int k = 0; k < 64; ++k )
            {
                sampler_point p = sampler_at( &s, k, SAMPLER_SKY );
                int column = (int)( p.x * (float)( 1 << a ) ), row = (int)( p.y * (float)( 1 << ( 6 - a ) ) );
                hits[( row << a ) + column] += 1;
            }
            for ( int k = 0; k < 64; ++k )
            {
                assert_int_equal( hits[k], 1 );
            }
        }
    }
}

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
    SCOPED( fixture_ball_free ) fixture_ball ball = make_ball();
    const render_mesh mesh = fixture_mesh( &ball, RENDER_SOLID );
    SCOPED( image_release )
    image none = draw( NULL, 0, NULL, uncut, 0.0f ), whole = draw( &mesh, 1, NULL, uncut, 0.0f );
    SCOPED( image_release ) image left = draw( &mesh, 1, NULL, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, 0.0f );
    SCOPED( image_release ) image longer = draw( &mesh, 1, NULL, ( wisp_vec3 ){ 4.0f, 0.0f, 0.0f }, 0.0f );
    const int covered = count_differing( &whole, &none, 0, 96 );
    assert_true( covered > 300 );
    // the camera stands on the plane of the cut: nothing of the right half is left, not even its inside
    assert_int_equal( count_differing( &left, &none, 50, 96 ), 0 );
    assert_true( 2 * count_differing( &left, &none, 0, 48 ) > covered - 40 );
    assert_memory_equal( left.rgb, longer.rgb, 3 * (size_t)left.width * (size_t)left.height );
}

TEST( a_cut_shows_what_was_inside )
{
    SCOPED( fixture_ball_free )
    fixture_ball ball = make_ball(), seed = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, -0.1f }, 0.15f );
    render_mesh meshes[] = { fixture_mesh( &ball, RENDER_SOLID ), fixture_mesh( &seed, RENDER_SOLID ) };
    meshes[1].colour = ( wisp_vec3 ){ 0.8f, 0.0f, 0.0f };
    SCOPED( image_release ) image whole = draw( meshes, 2, NULL, uncut, 0.0f );
    SCOPED( image_release ) image open = draw( meshes, 2, NULL, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, 0.1f );
    const uint8_t *before = fixture_pixel( &whole, 48, 36 ), *after = fixture_pixel( &open, 48, 36 );
    assert_true( before[0] < before[1] + 40 );
    assert_true( after[0] > 2 * after[1] );
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
    SCOPED( fixture_ball_free )
    fixture_ball ball = make_ball(), shell = fixture_ball_make( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.9f );
    render_mesh meshes[] = { fixture_mesh( &ball, RENDER_SOLID ), fixture_mesh( &shell, RENDER_SOLID ) };
    meshes[0].colour = ( wisp_vec3 ){ 0.8f, 0.0f, 0.0f };
    SCOPED( image_release ) image wall = draw( meshes, 2, NULL, uncut, 0.0f );
    meshes[1].material = RENDER_GLASS;
    SCOPED( image_release ) image glass = draw( meshes, 2, NULL, uncut, 0.0f );
    SCOPED( image_release ) image none = draw( meshes, 1, NULL, uncut, 0.0f );
    const uint8_t *hidden = fixture_pixel( &wall, 48, 36 ), *seen = fixture_pixel( &glass, 48, 36 );
    assert_true( hidden[0] < hidden[1] + 40 );
    assert_true( seen[0] > 2 * seen[1] );
    // the glass itself is there, too
    assert_true( count_differing( &glass, &none, 0, 96 ) > 500 );
}

// ---- what hides a point ----

TEST( the_first_body_before_a_point_is_named )
{
    SCOPED( fixture_ball_free )
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
    SCOPED( image_release ) image none = draw( NULL, 0, NULL, uncut, 0.0f );
    SCOPED( image_release )
    image segments = draw( NULL, 0, &straight, uncut, 0.0f ), smooth = draw( NULL, 0, &hair, uncut, 0.0f );
    // The middle of Hermite's curve: the mean of its ends and an eighth of the difference of its tangents. The tangents
    // are as long as the segment: along the segment at the root, level in the middle.
    const float length = sqrtf( 0.9f * 0.9f + 1.1f * 1.1f );
    const wisp_vec3 chord = { -0.45f, 0.95f, 0.0f };
    const wisp_vec3 curve = { -0.45f + 0.125f * ( 0.9f - length ), 0.95f + 0.125f * 1.1f, 0.0f };
    assert_true( is_covered( &segments, &none, chord ) && !is_covered( &segments, &none, curve ) );
    assert_true( is_covered( &smooth, &none, curve ) && !is_covered( &smooth, &none, chord ) );
    assert_true( is_covered( &segments, &none, bow[1] ) && is_covered( &smooth, &none, bow[1] ) );
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
    SCOPED( image_release )
    image none = draw( NULL, 0, NULL, uncut, 0.0f ), dot = draw( NULL, 0, &curves, uncut, 0.0f );
    assert_int_equal( count_differing( &dot, &none, 0, 96 ), 0 );
    curves.strand_count = 2;
    SCOPED( image_release ) image both = draw( NULL, 0, &curves, uncut, 0.0f );
    assert_true( count_differing( &both, &none, 0, 48 ) >= 10 );
    assert_int_equal( count_differing( &both, &none, 50, 96 ), 0 );
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
    SCOPED( image_release ) image none = { 0 }, other = { 0 };
    SCOPED( image_release )
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
}
