// Images, files, contact sheets, letters and colours of numbers. Points in pictures: balls at the expected pixels, in their
// colours, opaque, next to unchanged meshes and strands. Scenes, cameras, options and points that must be rejected, each
// with one message that names the error.
#include "render_fixture.h"

#include "wisp/module/random.h"

#include <limits.h>
#include <png.h>
#include <unistd.h>

static const image_colour WHITE = { 255, 255, 255 }, BLACK = { 0, 0, 0 };

static image make( int width, int height, image_colour colour )
{
    image out = { 0 };
    assert_int_equal( image_make( width, height, colour, &out, NULL ), WISP_OK );
    return out;
}

static void assert_colour( const image* picture, int x, int y, image_colour colour )
{
    const uint8_t* p = fixture_pixel( picture, x, y );
    assert_int_equal( p[0], colour.r );
    assert_int_equal( p[1], colour.g );
    assert_int_equal( p[2], colour.b );
}

static void assert_words( const wisp_error* error, const char* words )
{
    assert_contains( error->message, words );
}

// ---- memory ----

TEST( a_picture_without_pixels_or_with_too_many_is_refused )
{
    const int sides[][2] = { { 0, 4 }, { 4, -1 }, { IMAGE_MAX_SIDE + 1, 1 }, { 60000, 60000 } };
    for ( int i = 0; i < WISP_COUNT( sides ); ++i )
    {
        image out = { 0 };
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( image_make( sides[i][0], sides[i][1], WHITE, &out, &error ), WISP_BAD_INPUT );
        assert_null( out.rgb );
        assert_words( &error, "pixels; sides must be in 1 .. 65535" );
    }
}

TEST( a_linear_value_becomes_its_srgb_byte )
{
    // IEC 61966-2-1 at its ends, in its straight part (0.002 x 12.92 x 255 = 6.6) and at middle grey.
    assert_int_equal( image_byte_of_linear( 0.0f ), 0 );
    assert_int_equal( image_byte_of_linear( 1.0f ), 255 );
    assert_int_equal( image_byte_of_linear( 0.002f ), 7 );
    assert_int_equal( image_byte_of_linear( 0.2158605f ), 128 );
    assert_int_equal( image_byte_of_linear( -3.0f ), 0 );
    assert_int_equal( image_byte_of_linear( INFINITY ), 255 );
    assert_int_equal( image_byte_of_linear( NAN ), 0 );
}

TEST( filling_stays_inside_the_picture )
{
    SCOPED( image_release ) image picture = make( 8, 6, WHITE );
    image_fill( &picture, -5, -5, 7, 7, BLACK, 1.0f );
    image_fill( &picture, 6, 4, 2147483647, 2147483647, BLACK, 0.5f );
    assert_colour( &picture, 0, 0, BLACK );
    assert_colour( &picture, 1, 1, BLACK );
    assert_colour( &picture, 2, 1, WHITE );
    assert_colour( &picture, 7, 5, ( image_colour ){ 128, 128, 128 } );
    assert_colour( &picture, 5, 5, WHITE );
}

// ---- files ----

static void assert_file_holds( const char* path, const image* picture )
{
    png_image png = { .version = PNG_IMAGE_VERSION };
    assert_int_equal( png_image_begin_read_from_file( &png, path ), 1 );
    assert_int_equal( (int)png.width, picture->width );
    assert_int_equal( (int)png.height, picture->height );
    png.format = PNG_FORMAT_RGB;
    SCOPED( free_local ) uint8_t* pixels = checked_calloc( PNG_IMAGE_SIZE( png ), 1 );
    assert_int_equal( png_image_finish_read( &png, NULL, pixels, 0, NULL ), 1 );
    assert_memory_equal( pixels, picture->rgb, 3 * (size_t)picture->width * (size_t)picture->height );
}

static image noise( int width, int height )
{
    image out = make( width, height, WHITE );
    wisp_random_key key = wisp_random_make_key( 5, 0, 0 );
    for ( size_t i = 0; i < 3 * (size_t)width * (size_t)height; ++i )
    {
        out.rgb[i] = (uint8_t)wisp_random_bits( key, (uint32_t)i, 0, 0 );
    }
    return out;
}

TEST( a_file_holds_the_pixels_of_the_picture )
{
    const int sizes[][2] = { { 1, 1 }, { 33, 17 }, { 3, 400 } };
    for ( int i = 0; i < WISP_COUNT( sizes ); ++i )
    {
        SCOPED( image_release ) image picture = noise( sizes[i][0], sizes[i][1] );
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( image_write_png( "test_render_image.png", &picture, &error ), WISP_OK );
        assert_file_holds( "test_render_image.png", &picture );
    }
    unlink( "test_render_image.png" );
}

TEST( a_picture_that_cannot_be_written_leaves_the_old_file )
{
    const char* path = "test_render_image_kept.png";
    image old = noise( 9, 9 ), empty = { 0 };
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( image_write_png( path, &old, &error ), WISP_OK );
    assert_int_equal( image_write_png( path, &empty, &error ), WISP_BAD_INPUT );
    assert_words( &error, "test_render_image_kept.png: an empty picture is not written" );
    assert_file_holds( path, &old );

    assert_int_equal( image_write_png( "no such folder/a.png", &old, &error ), WISP_IO_ERROR );
    assert_words( &error, "no such folder/a.png" );
    if ( access( "/dev/full", W_OK ) == 0 )
    {
        assert_int_equal( image_write_png( "/dev/full", &old, &error ), WISP_IO_ERROR );
        assert_words( &error, "/dev/full: cannot write" );
    }
    unlink( path );
    image_release( &old );
}

// ---- contact sheets ----

TEST( a_sheet_shows_each_picture_in_its_cell )
{
    image pictures[5];
    for ( int i = 0; i < 5; ++i )
    {
        pictures[i] = make( 20, 10, ( image_colour ){ (uint8_t)( 10 + 40 * i ), 0, 200 } );
    }
    SCOPED( image_release ) image sheet = { 0 };
    assert_int_equal( image_sheet( pictures, 5, 3, NULL, &sheet, NULL ), WISP_OK );
    const int gap = 4; // the least
    assert_int_equal( sheet.width, 3 * 20 + 4 * gap );
    assert_int_equal( sheet.height, 2 * 10 + 3 * gap );
    for ( int i = 0; i < 5; ++i )
    {
        int x = gap + ( i % 3 ) * ( 20 + gap ), y = gap + ( i / 3 ) * ( 10 + gap );
        image_colour own = { (uint8_t)( 10 + 40 * i ), 0, 200 };
        assert_colour( &sheet, x, y, own );
        assert_colour( &sheet, x + 19, y + 9, own );
        assert_memory_equal( fixture_pixel( &sheet, x - 1, y ), fixture_pixel( &sheet, 0, 0 ), 3 );
        assert_memory_equal( fixture_pixel( &sheet, x, y + 10 ), fixture_pixel( &sheet, 0, 0 ), 3 );
        image_release( &pictures[i] );
    }
    // The sixth cell is empty.
    assert_memory_equal( fixture_pixel( &sheet, sheet.width - gap - 1, sheet.height - gap - 1 ),
                         fixture_pixel( &sheet, 0, 0 ), 3 );
}

TEST( a_smaller_picture_stands_in_the_middle_of_its_cell )
{
    image pictures[] = { make( 30, 30, BLACK ), make( 10, 20, BLACK ) };
    image sheet = { 0 };
    assert_int_equal( image_sheet( pictures, 2, 2, NULL, &sheet, NULL ), WISP_OK );
    int x = 4 + 30 + 4 + 10, y = 4 + 5;
    assert_colour( &sheet, x, y, BLACK );
    assert_colour( &sheet, x + 9, y + 19, BLACK );
    assert_true( fixture_pixel( &sheet, x - 1, y )[0] > 200 && fixture_pixel( &sheet, x, y - 1 )[0] > 200 );
    image_release( &sheet );
    image_release( &pictures[0] );
    image_release( &pictures[1] );
}

static int dark_pixels( const image* picture, int left, int top, int right, int bottom )
{
    int count = 0;
    for ( int y = top; y < bottom; ++y )
    {
        for ( int x = left; x < right; ++x )
        {
            count += fixture_pixel( picture, x, y )[0] < 128 ? 1 : 0;
        }
    }
    return count;
}

TEST( labels_stand_below_their_pictures_and_in_no_other_cell )
{
    image pictures[] = { make( 60, 30, WHITE ), make( 60, 30, WHITE ), make( 60, 30, WHITE ) };
    const char* const labels[] = { "a name that is far too long for a cell", NULL, "t = 1" };
    image sheet = { 0 };
    assert_int_equal( image_sheet( pictures, 3, 3, labels, &sheet, NULL ), WISP_OK );
    const int gap = 4, line = 8 + gap / 2, below = gap + 30;
    assert_int_equal( sheet.height, 30 + line + 2 * gap );
    assert_true( dark_pixels( &sheet, gap, below, gap + 60, sheet.height ) > 50 );
    assert_int_equal( dark_pixels( &sheet, gap + 60, 0, gap + 60 + gap + 60 + gap, sheet.height ), 0 );
    assert_true( dark_pixels( &sheet, 3 * gap + 120, below, sheet.width, sheet.height ) > 10 );
    assert_int_equal( dark_pixels( &sheet, 0, 0, sheet.width, below ), 0 );
    image_release( &sheet );
    for ( int i = 0; i < 3; ++i )
    {
        image_release( &pictures[i] );
    }
}

TEST( a_sheet_left_to_itself_is_nearly_square )
{
    image pictures[12];
    for ( int i = 0; i < 12; ++i )
    {
        pictures[i] = make( 40, 30, WHITE );
    }
    image sheet = { 0 };
    assert_int_equal( image_sheet( pictures, 12, 0, NULL, &sheet, NULL ), WISP_OK );
    assert_int_equal( sheet.width, 3 * 44 + 4 ); // three columns of four: 136 x 140
    assert_int_equal( sheet.height, 4 * 34 + 4 );
    image_release( &sheet );
    for ( int i = 0; i < 12; ++i )
    {
        image_release( &pictures[i] );
    }
}

TEST( a_sheet_refuses_what_it_cannot_show )
{
    image pictures[] = { make( 30000, 2, WHITE ), { 0 } };
    image sheet = { 0 };
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( image_sheet( pictures, 0, 1, NULL, &sheet, &error ), WISP_BAD_INPUT );
    assert_words( &error, "contact sheet: 0 pictures in 1 columns" );
    assert_int_equal( image_sheet( pictures, 2, 1, NULL, &sheet, &error ), WISP_BAD_INPUT );
    assert_words( &error, "contact sheet: picture 1 of 2 is empty" );
    image three[] = { pictures[0], pictures[0], pictures[0] };
    assert_int_equal( image_sheet( three, 3, 3, NULL, &sheet, &error ), WISP_BAD_INPUT );
    assert_words( &error, "are more than 65535 on a side" );
    assert_null( sheet.rgb );
    image_release( &pictures[0] );
}

// ---- letters ----

TEST( letters_are_their_squares )
{
    static const char* const drawing[7] = { ".###.#####", "#...#..#..", "#......#..", "#......#..",
                                            "#......#..", "#...#..#..", ".###...#.." };
    SCOPED( image_release ) image picture = make( 24, 16, WHITE );
    image_text( &picture, 2, 2, 2, BLACK, "C" );
    image_text( &picture, 12, 2, 2, BLACK, "T" );
    for ( int y = 0; y < 14; ++y )
    {
        for ( int x = 0; x < 20; ++x )
        {
            bool is_ink = drawing[y / 2][x / 2] == '#';
            assert_int_equal( fixture_pixel( &picture, 2 + x, 2 + y )[0], is_ink ? 0 : 255 );
        }
    }
    assert_int_equal( image_text_width( "CT", 2 ), 22 );
    assert_int_equal( image_text_width( "", 2 ), 0 );
}

TEST( every_character_has_a_drawing_of_its_own )
{
    image drawn[96];
    for ( int i = 0; i < 96; ++i )
    {
        const char text[2] = { (char)( i == 95 ? 7 : 33 + i ), '\0' }; // the last is the box of an unknown character
        drawn[i] = make( 6, 8, WHITE );
        image_text( &drawn[i], 0, 0, 1, BLACK, i == 94 ? "\xc3" : text );
        assert_true( dark_pixels( &drawn[i], 0, 0, 5, 7 ) > 1 );
        assert_int_equal( dark_pixels( &drawn[i], 5, 0, 6, 8 ), 0 );
        for ( int k = 0; k < i && i < 95; ++k )
        {
            assert_true( fixture_count_differing( &drawn[k], &drawn[i] ) > 0 );
        }
    }
    assert_int_equal( fixture_count_differing( &drawn[94], &drawn[95] ), 0 );
    for ( int i = 0; i < 96; ++i )
    {
        image_release( &drawn[i] );
    }
}

TEST( text_that_leaves_the_picture_is_cut )
{
    SCOPED( image_release ) image picture = make( 10, 5, WHITE );
    image_text( &picture, -3, -2, 1, BLACK, "MMMMMMMM" );
    image_text( &picture, 1000, 1000, 3, BLACK, "M" );
    assert_true( dark_pixels( &picture, 0, 0, 10, 5 ) > 5 );
}

// ---- colours of numbers ----

typedef struct oklab
{
    double l, a, b;
} oklab;

// Ottosson 2020, forwards, in double precision.
static oklab oklab_of( wisp_vec3 c )
{
    double r = (double)c.x, g = (double)c.y, b = (double)c.z;
    double l = cbrt( 0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b );
    double m = cbrt( 0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b );
    double s = cbrt( 0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b );
    return ( oklab ){ 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
                      1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
                      0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s };
}

static double distance( oklab a, oklab b )
{
    return sqrt( ( a.l - b.l ) * ( a.l - b.l ) + ( a.a - b.a ) * ( a.a - b.a ) + ( a.b - b.b ) * ( a.b - b.b ) );
}

TEST( equal_steps_of_a_map_look_equal )
{
    for ( int map = COLOUR_MAP_RISING; map <= COLOUR_MAP_DIVERGING; ++map )
    {
        double least = 1e9, most = 0.0;
        for ( int k = 0; k < 64; ++k )
        {
            wisp_vec3 a = colour_map_at( (colour_map)map, (float)k / 64.0f );
            wisp_vec3 b = colour_map_at( (colour_map)map, (float)( k + 1 ) / 64.0f );
            double step = distance( oklab_of( a ), oklab_of( b ) );
            least = fmin( least, step );
            most = fmax( most, step );
        }
        // The maps are drawn so that steps differ by a quarter at most; cutting at the edge of sRGB would show here.
        assert_true( most < 1.25 * least );
    }
}

TEST( lightness_rises_evenly )
{
    for ( int k = 0; k <= 64; ++k )
    {
        double l = oklab_of( colour_map_at( COLOUR_MAP_RISING, (float)k / 64.0f ) ).l;
        assert_true( fabs( l - ( 0.30 + 0.60 * k / 64.0 ) ) < 1e-3 ); // coefficients have ten digits, colours seven
    }
}

TEST( values_take_the_colours_of_their_place )
{
    const float values[] = { -1.0f, 0.0f, 5.0f, 10.0f, 3e38f, NAN };
    wisp_vec3 colours[6];
    colour_map_apply( COLOUR_MAP_RISING, values, 6, 0.0f, 10.0f, colours );
    wisp_vec3 lower = colour_map_at( COLOUR_MAP_RISING, 0.0f ), upper = colour_map_at( COLOUR_MAP_RISING, 1.0f );
    wisp_vec3 middle = colour_map_at( COLOUR_MAP_RISING, 0.5f );
    assert_memory_equal( &colours[0], &lower, sizeof( lower ) );
    assert_memory_equal( &colours[1], &lower, sizeof( lower ) );
    assert_memory_equal( &colours[2], &middle, sizeof( lower ) );
    assert_memory_equal( &colours[3], &upper, sizeof( lower ) );
    assert_memory_equal( &colours[4], &upper, sizeof( lower ) );
    assert_true( colours[5].x == colours[5].y && colours[5].y == colours[5].z );
    colour_map_apply( COLOUR_MAP_RISING, values, 1, 2.0f, 2.0f, colours );
    assert_memory_equal( &colours[0], &middle, sizeof( lower ) );
}

static bool has_colour( const image* picture, image_colour c )
{
    for ( size_t i = 0; i < (size_t)picture->width * (size_t)picture->height; ++i )
    {
        const uint8_t* p = picture->rgb + 3 * i;
        if ( p[0] == c.r && p[1] == c.g && p[2] == c.b )
        {
            return true;
        }
    }
    return false;
}

TEST( a_legend_has_both_ends_of_its_map_and_stays_in_its_corner )
{
    SCOPED( image_release ) image picture = make( 320, 240, BLACK );
    image_legend( &picture, COLOUR_MAP_RISING, 0.0, 0.25, "strain" );
    for ( int end = 0; end <= 1; ++end )
    {
        wisp_vec3 c = colour_map_at( COLOUR_MAP_RISING, (float)end );
        image_colour bytes = { image_byte_of_linear( c.x ), image_byte_of_linear( c.y ),
                               image_byte_of_linear( c.z ) };
        assert_true( has_colour( &picture, bytes ) );
    }
    assert_colour( &picture, 0, 0, BLACK );
    assert_colour( &picture, 319, 239, BLACK );
    assert_colour( &picture, 160, 200, BLACK );
    image_release( &picture );

    // Too small for a legend: the part that fits is drawn, and nothing is written outside.
    picture = make( 5, 4, BLACK );
    image_legend( &picture, COLOUR_MAP_DIVERGING, -1e300, 1e300, "a long title" );
}

// ---- points ----

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
    SCOPED( image_release ) image none = picture_of( NULL ), picture = picture_of( &points );
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
}

TEST( every_point_has_its_colour )
{
    render_points points = two_points( 0.2f );
    SCOPED( image_release ) image picture = picture_of( &points );
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

static void assert_points_refused( const render_points* points, int count, const char* words )
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
    assert_points_refused( &good, -1, "-1 sets of points do not fit their array" );
    assert_points_refused( NULL, 1, "1 sets of points do not fit their array" );
    bad.count = -2;
    assert_points_refused( &bad, 1, "points 0: -2 points do not fit their array" );
    bad = good;
    bad.points = NULL;
    assert_points_refused( &bad, 1, "points 0: 2 points do not fit their array" );
    bad = good;
    bad.name = "layer";
    bad.radius = 0.0f;
    assert_points_refused( &bad, 1, "points \"layer\": radius 0 is not above 0" );
    bad.radius = NAN;
    assert_points_refused( &bad, 1, "radius nan" );
    const wisp_vec3 lost[] = { { 0.0f, 1.0f, 0.0f }, { 0.0f, INFINITY, 0.0f } };
    bad = good;
    bad.points = lost;
    assert_points_refused( &bad, 1, "points 0: vertex 1 is not finite" );
    const wisp_vec3 black_hole[] = { { 0.0f, 0.0f, 0.0f }, { 0.0f, -1.0f, 0.0f } };
    bad = good;
    bad.colours = black_hole;
    assert_points_refused( &bad, 1, "of vertex 1 is not in 0 .. 10" );
}

TEST( no_points_are_nothing )
{
    render_points points = render_default_points();
    SCOPED( image_release ) image none = picture_of( NULL ), empty = picture_of( &points );
    assert_int_equal( fixture_count_differing( &none, &empty ), 0 );
}

// ---- what is rejected ----

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
    SCOPED( image_release ) image old = { 0 };
    assert_int_equal( image_make( 3, 2, ( image_colour ){ 1, 2, 3 }, &old, NULL ), WISP_OK );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( draw( s, &old, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_int_equal( old.width, 3 );
    assert_int_equal( fixture_pixel( &old, 2, 1 )[2], 3 );
}

TEST( the_unspoilt_scene_is_drawn )
{
    spoilt s;
    make_good( &s );
    SCOPED( image_release ) image picture = { 0 };
    assert_int_equal( draw( &s, &picture, NULL ), WISP_OK );
    assert_int_equal( picture.width, s.options.width );
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
        SCOPED( image_release ) image picture = { 0 };
        wisp_error error = { .status = WISP_OK };
        if ( draw( &s, &picture, &error ) != WISP_OK )
        {
            fail_msg( "scale %g, shift %g: %s", (double)scale, (double)shift, error.message );
        }
    }
}
