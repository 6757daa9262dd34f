#include "image.h"

#include <math.h>
#include <stdlib.h>

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
