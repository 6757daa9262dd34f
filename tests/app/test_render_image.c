// Images, files, contact sheets, letters and colours of numbers.
#include "render_fixture.h"

#include "wisp/module/random.h"

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
    image picture = make( 8, 6, WHITE );
    image_fill( &picture, -5, -5, 7, 7, BLACK, 1.0f );
    image_fill( &picture, 6, 4, 2147483647, 2147483647, BLACK, 0.5f );
    assert_colour( &picture, 0, 0, BLACK );
    assert_colour( &picture, 1, 1, BLACK );
    assert_colour( &picture, 2, 1, WHITE );
    assert_colour( &picture, 7, 5, ( image_colour ){ 128, 128, 128 } );
    assert_colour( &picture, 5, 5, WHITE );
    image_release( &picture );
}

// ---- files ----

static void assert_file_holds( const char* path, const image* picture )
{
    png_image png = { .version = PNG_IMAGE_VERSION };
    assert_int_equal( png_image_begin_read_from_file( &png, path ), 1 );
    assert_int_equal( (int)png.width, picture->width );
    assert_int_equal( (int)png.height, picture->height );
    png.format = PNG_FORMAT_RGB;
    uint8_t* pixels = checked_calloc( PNG_IMAGE_SIZE( png ), 1 );
    assert_int_equal( png_image_finish_read( &png, NULL, pixels, 0, NULL ), 1 );
    assert_memory_equal( pixels, picture->rgb, 3 * (size_t)picture->width * (size_t)picture->height );
    free( pixels );
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
        image picture = noise( sizes[i][0], sizes[i][1] );
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( image_write_png( "test_render_image.png", &picture, &error ), WISP_OK );
        assert_file_holds( "test_render_image.png", &picture );
        image_release( &picture );
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
    image sheet = { 0 };
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
    image_release( &sheet );
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
    image picture = make( 24, 16, WHITE );
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
    image_release( &picture );
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
    image picture = make( 10, 5, WHITE );
    image_text( &picture, -3, -2, 1, BLACK, "MMMMMMMM" );
    image_text( &picture, 1000, 1000, 3, BLACK, "M" );
    assert_true( dark_pixels( &picture, 0, 0, 10, 5 ) > 5 );
    image_release( &picture );
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
    image picture = make( 320, 240, BLACK );
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
    image_release( &picture );
}
