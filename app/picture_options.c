#include "picture_options.h"

#include "commands.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

picture_options picture_default_options( void )
{
    render_scene scene = render_default_scene();
    return ( picture_options ){
        .samples = render_default_options().samples,
        .view = render_default_view(),
        .background = { scene.background_top, scene.background_bottom },
    };
}

void picture_parse_numbers( const options_state* o, const char* text, int count, float* out )
{
    const char* at = text;
    for ( int i = 0; i < count; ++i )
    {
        char* end = NULL;
        out[i] = strtof( at, &end );
        char requested = i + 1 < count ? ',' : '\0';
        if ( end == at || *end != requested || !isfinite( out[i] ) )
        {
            options_fail( o, "%s: got '%s', expected %d number%s", o->name, text, count,
                          count == 1 ? "" : "s separated by commas" );
        }
        at = end + 1;
    }
}

void picture_parse_size( const options_state* o, const char* text, picture_options* out )
{
    char* end = NULL;
    long width = strtol( text, &end, 10 );
    long height = *end == 'x' ? strtol( end + 1, &end, 10 ) : 0;
    if ( *end || width < 1 || height < 1 || width > RENDER_MAX_SIDE || height > RENDER_MAX_SIDE )
    {
        options_fail( o, "--size: got '%s', expected a size such as 640x480, each side from 1 to %d", text,
                      RENDER_MAX_SIDE );
    }
    out->width = (int)width;
    out->height = (int)height;
}

// ---- frames ----

/// A part of A:B:STEP. @return the text after it
static const char* parse_part( const char* text, int empty, int* value, bool* is_good )
{
    char* end = NULL;
    errno = 0;
    long number = strtol( text, &end, 10 );
    *value = end == text ? empty : (int)number;
    *is_good = *is_good && ( end == text || ( !errno && number >= 0 && number < INT_MAX ) ) &&
               ( *end == ':' || *end == '\0' );
    return *end == ':' ? end + 1 : end;
}

void picture_parse_frames( const options_state* o, const char* text, picture_options* out )
{
    bool is_good = strchr( text, ':' ) != NULL;
    const char* at = parse_part( text, 0, &out->first, &is_good );
    at = parse_part( at, PICTURE_FRAME_END, &out->last, &is_good );
    at = parse_part( at, 1, &out->step, &is_good );
    if ( !is_good || *at || out->step < 1 || ( out->last != PICTURE_FRAME_END && out->last < out->first ) )
    {
        options_fail( o, "--frames: got '%s', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers",
                      text );
    }
    out->choice = PICTURE_FRAMES;
}

// ---- surroundings of the bodies ----

void picture_parse_ground( const options_state* o, const char* text, picture_options* out )
{
    char* end = NULL;
    float height = strtof( text, &end );
    if ( end != text && !*end && isfinite( height ) )
    {
        out->ground = PICTURE_GROUND_HEIGHT;
        out->ground_height = height;
        return;
    }
    out->ground = (picture_ground)option_word( o, text );
}

static float linear_of_srgb( unsigned long byte )
{
    float fraction = (float)byte / 255.0f;
    return fraction <= 0.04045f ? fraction / 12.92f : powf( ( fraction + 0.055f ) / 1.055f, 2.4f );
}

static const char* parse_colour( const char* text, wisp_vec3* out )
{
    char digits[7] = "";
    size_t count = *text == '#' ? strspn( text + 1, "0123456789abcdefABCDEF" ) : 0;
    if ( count != 6 )
    {
        return NULL;
    }
    memcpy( digits, text + 1, 6 );
    unsigned long value = strtoul( digits, NULL, 16 );
    *out = ( wisp_vec3 ){ linear_of_srgb( value >> 16 ), linear_of_srgb( value >> 8 & 255 ),
                          linear_of_srgb( value & 255 ) };
    return text + 7;
}

void picture_parse_background( const options_state* o, const char* text, picture_options* out )
{
    const render_scene studio = render_default_scene();
    const wisp_vec3 colours[][2] = {
        { studio.background_top, studio.background_bottom },
        { { 1.0f, 1.0f, 1.0f }, { 1.0f, 1.0f, 1.0f } },
        { { 0.012f, 0.014f, 0.018f }, { 0.045f, 0.050f, 0.060f } },
    };
    if ( *text != '#' )
    {
        int word = option_word( o, text );
        out->background[0] = colours[word][0];
        out->background[1] = colours[word][1];
        return;
    }
    const char* end = parse_colour( text, &out->background[0] );
    out->background[1] = out->background[0];
    if ( end && *end == ',' )
    {
        end = parse_colour( end + 1, &out->background[1] );
    }
    if ( !end || *end )
    {
        options_fail( o, "--background: got '%s', expected a colour such as #20242c, or two separated by a comma",
                      text );
    }
}
