#include "colour_map.h"

#include <math.h>

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
