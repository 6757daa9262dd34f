#include "image.h"

#include "io_file.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- numbers as colours ----

// Oklab in its cylindrical form: lightness, chroma, and hue in radians.
typedef struct lch
{
    float lightness, chroma, hue;
} lch;

// Ottosson 2020, "A perceptual color space for image processing": from Oklab back to linear sRGB.
static wisp_vec3 linear_of( lch c )
{
    float a = c.chroma * cosf( c.hue ), b = c.chroma * sinf( c.hue );
    float l = c.lightness + 0.3963377774f * a + 0.2158037573f * b;
    float m = c.lightness - 0.1055613458f * a - 0.0638541728f * b;
    float s = c.lightness - 0.0894841775f * a - 1.2914855480f * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    return ( wisp_vec3 ){
        4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
        -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
        -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s,
    };
}

static wisp_vec3 cut( wisp_vec3 c )
{
    return ( wisp_vec3 ){ fminf( 1.0f, fmaxf( 0.0f, c.x ) ), fminf( 1.0f, fmaxf( 0.0f, c.y ) ),
                          fminf( 1.0f, fmaxf( 0.0f, c.z ) ) };
}

// Lightness and hue are linear. Chroma is lower in the middle, where blue-greens of the screen are least saturated.
static lch rising( float t )
{
    float middle = 1.0f - fabsf( 2.0f * t - 0.82f );
    return ( lch ){ 0.30f + 0.60f * t, 0.126f - 0.05f * middle + 0.03f * t, 5.20f - 3.40f * t };
}

// Both arms have the same lightness at the same distance from the middle, so that no sign appears larger.
static lch diverging( float t )
{
    float side = 2.0f * t - 1.0f, far = fabsf( side );
    return ( lch ){ 0.93f - 0.45f * far, 0.155f * far, side < 0.0f ? 4.50f : 0.46f };
}

wisp_vec3 colour_map_at( colour_map map, float fraction )
{
    if ( isnan( fraction ) )
    {
        return ( wisp_vec3 ){ 0.18f, 0.18f, 0.18f };
    }
    float t = fminf( 1.0f, fmaxf( 0.0f, fraction ) );
    return cut( linear_of( map == COLOUR_MAP_DIVERGING ? diverging( t ) : rising( t ) ) );
}

void colour_map_apply( colour_map map, const float* values, int count, float lower, float upper, wisp_vec3* colours )
{
    for ( int i = 0; i < count; ++i )
    {
        // In double precision the range of two floats cannot overflow.
        double range = (double)upper - (double)lower;
        double fraction = range != 0.0 ? ( (double)values[i] - (double)lower ) / range : 0.5;
        colours[i] = colour_map_at( map, isnan( values[i] ) ? values[i] : (float)fraction );
    }
}

// ---- pictures in memory ----

wisp_status image_make( int width, int height, image_colour colour, image* out, wisp_error* error )
{
    if ( width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE ||
         (int64_t)width * height > IMAGE_MAX_PIXELS )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "picture: %d x %d pixels; sides must be in 1 .. %d and pixels at most %d", width, height,
                          IMAGE_MAX_SIDE, IMAGE_MAX_PIXELS );
    }
    size_t count = (size_t)width * (size_t)height;
    uint8_t* rgb = malloc( 3 * count );
    if ( rgb == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "picture: out of memory for %d x %d pixels", width, height );
    }
    *out = ( image ){ width, height, rgb };
    image_fill( out, 0, 0, width, height, colour, 1.0f );
    return WISP_OK;
}

void image_release( image* picture )
{
    if ( picture != NULL )
    {
        free( picture->rgb );
        *picture = ( image ){ 0 };
    }
}

// IEC 61966-2-1.
uint8_t image_byte_of_linear( float linear )
{
    float v = fminf( 1.0f, fmaxf( 0.0f, linear ) );
    float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * powf( v, 1.0f / 2.4f ) - 0.055f;
    return (uint8_t)( 255.0f * encoded + 0.5f );
}

static uint8_t mixed( uint8_t old, uint8_t new, float opacity )
{
    return (uint8_t)( (float)old + opacity * ( (float)new - (float)old ) + 0.5f );
}

void image_fill( image* picture, int x, int y, int width, int height, image_colour colour, float opacity )
{
    int64_t right = (int64_t)x + width, bottom = (int64_t)y + height;
    int left = x > 0 ? x : 0, top = y > 0 ? y : 0;
    float fraction = fminf( 1.0f, fmaxf( 0.0f, opacity ) );
    for ( int row = top; row < bottom && row < picture->height; ++row )
    {
        for ( int column = left; column < right && column < picture->width; ++column )
        {
            uint8_t* p = picture->rgb + 3 * ( (size_t)row * (size_t)picture->width + (size_t)column );
            p[0] = mixed( p[0], colour.r, fraction );
            p[1] = mixed( p[1], colour.g, fraction );
            p[2] = mixed( p[2], colour.b, fraction );
        }
    }
}

// ---- files ----

// libpng's simplified interface: it catches internal errors and returns a message.
static wisp_status write_to( FILE* stream, const char* path, const image* picture, wisp_error* error )
{
    png_image png = { .version = PNG_IMAGE_VERSION };
    png.width = (png_uint_32)picture->width;
    png.height = (png_uint_32)picture->height;
    png.format = PNG_FORMAT_RGB;
    int good = png_image_write_to_stdio( &png, stream, 0, picture->rgb, 3 * picture->width, NULL );
    png_image_free( &png );
    if ( good == 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: cannot write the picture: %s", io_short_name( path ),
                          png.message );
    }
    return WISP_OK;
}

wisp_status image_write_png( const char* path, const image* picture, wisp_error* error )
{
    if ( picture->rgb == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: an empty picture is not written", io_short_name( path ) );
    }
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    return status == WISP_OK ? io_output_end( &output, write_to( output.stream, path, picture, error ), error )
                             : status;
}

// ---- letters ----

// A small pixel font, so that a picture can have labels without a font library.

enum
{
    LETTER_WIDTH = 5,
    LETTER_HEIGHT = 7,
    CELL_WIDTH = 6,
    FIRST = 0x20, // printable ASCII
    LAST = 0x7e,
};

// Rows from the top; the leftmost square of a row is its highest bit.
// clang-format off
static const uint8_t LETTERS[LAST - FIRST + 1][LETTER_HEIGHT] = {
    { 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00 }, // space
    { 0x04, 0x04, 0x04, 0x04, 0x04, 0x00, 0x04 }, // !
    { 0x0a, 0x0a, 0x0a, 0x00, 0x00, 0x00, 0x00 }, // "
    { 0x0a, 0x0a, 0x1f, 0x0a, 0x1f, 0x0a, 0x0a }, // #
    { 0x04, 0x0f, 0x14, 0x0e, 0x05, 0x1e, 0x04 }, // $
    { 0x19, 0x19, 0x02, 0x04, 0x08, 0x13, 0x13 }, // %
    { 0x0c, 0x12, 0x14, 0x08, 0x15, 0x12, 0x0d }, // &
    { 0x04, 0x04, 0x08, 0x00, 0x00, 0x00, 0x00 }, // '
    { 0x02, 0x04, 0x08, 0x08, 0x08, 0x04, 0x02 }, // (
    { 0x08, 0x04, 0x02, 0x02, 0x02, 0x04, 0x08 }, // )
    { 0x00, 0x04, 0x15, 0x0e, 0x15, 0x04, 0x00 }, // *
    { 0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00 }, // +
    { 0x00, 0x00, 0x00, 0x00, 0x0c, 0x04, 0x08 }, // ,
    { 0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00 }, // -
    { 0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c }, // .
    { 0x00, 0x01, 0x02, 0x04, 0x08, 0x10, 0x00 }, // /
    { 0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e }, // 0
    { 0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e }, // 1
    { 0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f }, // 2
    { 0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e }, // 3
    { 0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02 }, // 4
    { 0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e }, // 5
    { 0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e }, // 6
    { 0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08 }, // 7
    { 0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e }, // 8
    { 0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c }, // 9
    { 0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x0c, 0x00 }, // :
    { 0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x04, 0x08 }, // ;
    { 0x02, 0x04, 0x08, 0x10, 0x08, 0x04, 0x02 }, // <
    { 0x00, 0x00, 0x1f, 0x00, 0x1f, 0x00, 0x00 }, // =
    { 0x08, 0x04, 0x02, 0x01, 0x02, 0x04, 0x08 }, // >
    { 0x0e, 0x11, 0x01, 0x02, 0x04, 0x00, 0x04 }, // ?
    { 0x0e, 0x11, 0x01, 0x0d, 0x15, 0x15, 0x0e }, // @
    { 0x0e, 0x11, 0x11, 0x11, 0x1f, 0x11, 0x11 }, // A
    { 0x1e, 0x11, 0x11, 0x1e, 0x11, 0x11, 0x1e }, // B
    { 0x0e, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0e }, // C
    { 0x1c, 0x12, 0x11, 0x11, 0x11, 0x12, 0x1c }, // D
    { 0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f }, // E
    { 0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10 }, // F
    { 0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f }, // G
    { 0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11 }, // H
    { 0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e }, // I
    { 0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c }, // J
    { 0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11 }, // K
    { 0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f }, // L
    { 0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11 }, // M
    { 0x11, 0x11, 0x19, 0x15, 0x13, 0x11, 0x11 }, // N
    { 0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e }, // O
    { 0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10 }, // P
    { 0x0e, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0d }, // Q
    { 0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11 }, // R
    { 0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e }, // S
    { 0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04 }, // T
    { 0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e }, // U
    { 0x11, 0x11, 0x11, 0x11, 0x11, 0x0a, 0x04 }, // V
    { 0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0a }, // W
    { 0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11 }, // X
    { 0x11, 0x11, 0x11, 0x0a, 0x04, 0x04, 0x04 }, // Y
    { 0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f }, // Z
    { 0x0e, 0x08, 0x08, 0x08, 0x08, 0x08, 0x0e }, // [
    { 0x00, 0x10, 0x08, 0x04, 0x02, 0x01, 0x00 }, // backslash
    { 0x0e, 0x02, 0x02, 0x02, 0x02, 0x02, 0x0e }, // ]
    { 0x04, 0x0a, 0x11, 0x00, 0x00, 0x00, 0x00 }, // ^
    { 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1f }, // _
    { 0x08, 0x04, 0x02, 0x00, 0x00, 0x00, 0x00 }, // `
    { 0x00, 0x00, 0x0e, 0x01, 0x0f, 0x11, 0x0f }, // a
    { 0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x1e }, // b
    { 0x00, 0x00, 0x0e, 0x10, 0x10, 0x11, 0x0e }, // c
    { 0x01, 0x01, 0x0d, 0x13, 0x11, 0x11, 0x0f }, // d
    { 0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e }, // e
    { 0x06, 0x09, 0x08, 0x1c, 0x08, 0x08, 0x08 }, // f
    { 0x00, 0x0f, 0x11, 0x11, 0x0f, 0x01, 0x0e }, // g
    { 0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x11 }, // h
    { 0x04, 0x00, 0x0c, 0x04, 0x04, 0x04, 0x0e }, // i
    { 0x02, 0x00, 0x06, 0x02, 0x02, 0x12, 0x0c }, // j
    { 0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12 }, // k
    { 0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e }, // l
    { 0x00, 0x00, 0x1a, 0x15, 0x15, 0x11, 0x11 }, // m
    { 0x00, 0x00, 0x16, 0x19, 0x11, 0x11, 0x11 }, // n
    { 0x00, 0x00, 0x0e, 0x11, 0x11, 0x11, 0x0e }, // o
    { 0x00, 0x00, 0x1e, 0x11, 0x1e, 0x10, 0x10 }, // p
    { 0x00, 0x00, 0x0d, 0x13, 0x0f, 0x01, 0x01 }, // q
    { 0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10 }, // r
    { 0x00, 0x00, 0x0e, 0x10, 0x0e, 0x01, 0x1e }, // s
    { 0x08, 0x08, 0x1c, 0x08, 0x08, 0x09, 0x06 }, // t
    { 0x00, 0x00, 0x11, 0x11, 0x11, 0x13, 0x0d }, // u
    { 0x00, 0x00, 0x11, 0x11, 0x11, 0x0a, 0x04 }, // v
    { 0x00, 0x00, 0x11, 0x11, 0x15, 0x15, 0x0a }, // w
    { 0x00, 0x00, 0x11, 0x0a, 0x04, 0x0a, 0x11 }, // x
    { 0x00, 0x00, 0x11, 0x11, 0x0f, 0x01, 0x0e }, // y
    { 0x00, 0x00, 0x1f, 0x02, 0x04, 0x08, 0x1f }, // z
    { 0x02, 0x04, 0x04, 0x08, 0x04, 0x04, 0x02 }, // {
    { 0x04, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04 }, // |
    { 0x08, 0x04, 0x04, 0x02, 0x04, 0x04, 0x08 }, // }
    { 0x00, 0x00, 0x08, 0x15, 0x02, 0x00, 0x00 }, // ~
};
// clang-format on

static const uint8_t UNKNOWN[LETTER_HEIGHT] = { 0x1f, 0x11, 0x11, 0x11, 0x11, 0x11, 0x1f };

static void put_letter( image* picture, int x, int y, int scale, image_colour colour, unsigned char letter )
{
    const uint8_t* rows = letter >= FIRST && letter <= LAST ? LETTERS[letter - FIRST] : UNKNOWN;
    for ( int row = 0; row < LETTER_HEIGHT; ++row )
    {
        for ( int column = 0; column < LETTER_WIDTH; ++column )
        {
            if ( rows[row] >> ( LETTER_WIDTH - 1 - column ) & 1 )
            {
                image_fill( picture, x + column * scale, y + row * scale, scale, scale, colour, 1.0f );
            }
        }
    }
}

void image_text( image* picture, int x, int y, int scale, image_colour colour, const char* text )
{
    for ( ; *text != '\0' && x < picture->width; ++text, x += CELL_WIDTH * scale )
    {
        put_letter( picture, x, y, scale, colour, (unsigned char)*text );
    }
}

int image_text_width( const char* text, int scale )
{
    size_t length = strnlen( text, IMAGE_MAX_SIDE );
    return length == 0 ? 0 : ( CELL_WIDTH * (int)length - 1 ) * scale;
}

// The size of letters that suits a picture. @return scale, at least 1
static int text_scale( const image* picture )
{
    int scale = picture->height / 240;
    return scale > 1 ? scale : 1;
}

// ---- contact sheets ----

// Contact sheets: many small pictures on one large one.

static const image_colour PAPER = { 246, 246, 244 };
static const image_colour LABEL_INK = { 58, 60, 64 };

typedef struct sheet
{
    int columns, rows;
    int cell_width, cell_height; // of the largest picture
    int gap, scale, label_height;
} sheet;

static wisp_status check_pictures( const image* pictures, int count, int columns, wisp_error* error )
{
    if ( count < 1 || columns < 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: %d pictures in %d columns", count, columns );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( pictures[i].rgb == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: picture %d of %d is empty", i, count );
        }
    }
    return WISP_OK;
}

// The sheet is as close to a square as whole cells allow.
static int square_columns( int count, int cell_width, int cell_height )
{
    double columns = sqrt( (double)count * cell_height / cell_width );
    int nearest = (int)( columns + 0.5 );
    return nearest < 1 ? 1 : nearest > count ? count : nearest;
}

static sheet lay_out( const image* pictures, int count, int columns, bool has_labels )
{
    sheet out = { .gap = 0 };
    for ( int i = 0; i < count; ++i )
    {
        out.cell_width = pictures[i].width > out.cell_width ? pictures[i].width : out.cell_width;
        out.cell_height = pictures[i].height > out.cell_height ? pictures[i].height : out.cell_height;
    }
    out.columns = columns > 0 ? columns : square_columns( count, out.cell_width, out.cell_height );
    out.columns = out.columns < count ? out.columns : count;
    out.rows = count / out.columns + ( count % out.columns != 0 ? 1 : 0 );
    out.gap = out.cell_width / 50 > 4 ? out.cell_width / 50 : 4;
    out.scale = text_scale( &( image ){ out.cell_width, out.cell_height, NULL } );
    out.label_height = has_labels ? 8 * out.scale + out.gap / 2 : 0;
    return out;
}

static void paste( const image* from, image* to, int x, int y )
{
    for ( int row = 0; row < from->height; ++row )
    {
        memcpy( to->rgb + 3 * ( (size_t)( y + row ) * (size_t)to->width + (size_t)x ),
                from->rgb + 3 * (size_t)row * (size_t)from->width, 3 * (size_t)from->width );
    }
}

// A label wider than its picture is cut, so that it does not overlap its neighbour.
static void put_label( image* to, const sheet* s, int x, int y, const char* label )
{
    char shown[256];
    size_t most = (size_t)( ( s->cell_width + s->scale ) / ( 6 * s->scale ) );
    size_t length = strlen( label );
    length = length < most ? length : most;
    length = length < sizeof( shown ) - 1 ? length : sizeof( shown ) - 1;
    memcpy( shown, label, length );
    shown[length] = '\0';
    image_text( to, x + ( s->cell_width - image_text_width( shown, s->scale ) ) / 2, y, s->scale, LABEL_INK, shown );
}

wisp_status image_sheet( const image* pictures, int count, int columns, const char* const* labels, image* out,
                         wisp_error* error )
{
    WISP_TRY( check_pictures( pictures, count, columns, error ) );
    sheet s = lay_out( pictures, count, columns, labels != NULL );
    int64_t width = (int64_t)s.columns * ( s.cell_width + s.gap ) + s.gap;
    int64_t height = (int64_t)s.rows * ( s.cell_height + s.label_height + s.gap ) + s.gap;
    if ( width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: %lld x %lld pixels are more than %d on a side",
                          (long long)width, (long long)height, IMAGE_MAX_SIDE );
    }
    image made = { 0 };
    WISP_TRY( image_make( (int)width, (int)height, PAPER, &made, error ) );
    for ( int i = 0; i < count; ++i )
    {
        const image* from = &pictures[i];
        int x = s.gap + ( i % s.columns ) * ( s.cell_width + s.gap );
        int y = s.gap + ( i / s.columns ) * ( s.cell_height + s.label_height + s.gap );
        paste( from, &made, x + ( s.cell_width - from->width ) / 2, y + ( s.cell_height - from->height ) / 2 );
        if ( labels != NULL && labels[i] != NULL )
        {
            put_label( &made, &s, x, y + s.cell_height + s.gap / 2, labels[i] );
        }
    }
    image_release( out );
    *out = made;
    return WISP_OK;
}

// ---- the colour bar ----

// The bar that relates colours to numbers.

static const image_colour LEGEND_INK = { 38, 40, 44 };
static const image_colour PANEL = { 250, 250, 248 };

typedef struct number_text
{
    char text[32];
} number_text;

// Three digits, with a decimal point in every locale.
static number_text text_of( double value )
{
    number_text out;
    snprintf( out.text, sizeof( out.text ), "%.3g", value );
    for ( char* c = out.text; *c != '\0'; ++c )
    {
        *c = *c == ',' ? '.' : *c;
    }
    return out;
}

static image_colour colour_at( colour_map map, float fraction )
{
    wisp_vec3 c = colour_map_at( map, fraction );
    return ( image_colour ){ image_byte_of_linear( c.x ), image_byte_of_linear( c.y ), image_byte_of_linear( c.z ) };
}

void image_legend( image* picture, colour_map map, double lower, double upper, const char* title )
{
    int scale = text_scale( picture );
    int pad = 4 * scale, line = 8 * scale, thick = 6 * scale;
    number_text left = text_of( lower ), right = text_of( upper );
    int numbers = image_text_width( left.text, scale ) + image_text_width( right.text, scale ) + 6 * scale;
    int heading = title != NULL ? image_text_width( title, scale ) : 0;
    int width = picture->width / 4;
    width = width > numbers ? width : numbers;
    width = width > heading ? width : heading;

    int height = 2 * pad + thick + scale + line + ( title != NULL ? line + scale : 0 );
    int x = 2 * pad, y = picture->height - pad - height;
    image_fill( picture, x - pad, y, width + 2 * pad, height, PANEL, 0.72f );
    y += pad;
    if ( title != NULL )
    {
        image_text( picture, x, y, scale, LEGEND_INK, title );
        y += line + scale;
    }
    for ( int k = 0; k < width; ++k )
    {
        float fraction = width > 1 ? (float)k / (float)( width - 1 ) : 0.5f;
        image_fill( picture, x + k, y, 1, thick, colour_at( map, fraction ), 1.0f );
    }
    y += thick + 2 * scale;
    image_text( picture, x, y, scale, LEGEND_INK, left.text );
    image_text( picture, x + width - image_text_width( right.text, scale ), y, scale, LEGEND_INK, right.text );
}
