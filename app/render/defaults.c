// Default values of definitions.
#include "palette.h"
#include "render.h"

static wisp_vec3 default_colour( render_material material )
{
    switch ( material )
    {
        case RENDER_CLOTH:
            return palette_body( 1 );
        case RENDER_LATEX:
            return palette_body( 0 );
        case RENDER_GLASS:
        case RENDER_SOLID:
            break;
    }
    return palette_solid();
}

render_mesh render_default_mesh( render_material material )
{
    return ( render_mesh ){ .material = material, .colour = default_colour( material ) };
}

render_curves render_default_curves( void )
{
    return ( render_curves ){ .radius = 4e-5f, .colour = palette_hair() };
}

render_points render_default_points( void )
{
    return ( render_points ){ .radius = 0.01f, .colour = palette_body( 7 ) };
}

render_scene render_default_scene( void )
{
    return ( render_scene ){
        .background_top = { 0.21f, 0.24f, 0.28f },
        .background_bottom = { 0.46f, 0.46f, 0.45f },
    };
}

render_options render_default_options( void )
{
    return ( render_options ){
        .width = 640,
        .height = 480,
        .samples = 16,
        .threads = 1,
        .seed = 1,
        .exposure = 1.0f,
        .tone = RENDER_TONE_FILMIC,
        .min_curve_pixels = 0.7f,
    };
}
