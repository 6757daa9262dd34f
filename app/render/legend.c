// The bar that relates colours to numbers.
#include "image.h"

#include <stdio.h>
#include <string.h>

static const image_colour INK = { 38, 40, 44 };
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
    int scale = image_text_scale( picture );
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
        image_text( picture, x, y, scale, INK, title );
        y += line + scale;
    }
    for ( int k = 0; k < width; ++k )
    {
        float fraction = width > 1 ? (float)k / (float)( width - 1 ) : 0.5f;
        image_fill( picture, x + k, y, 1, thick, colour_at( map, fraction ), 1.0f );
    }
    y += thick + 2 * scale;
    image_text( picture, x, y, scale, INK, left.text );
    image_text( picture, x + width - image_text_width( right.text, scale ), y, scale, INK, right.text );
}
