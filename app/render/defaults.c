// Default values of definitions.
#include "render.h"

static const wisp_vec3 PALETTE[] = {
    { 0.62f, 0.050f, 0.045f }, // coral red
    { 0.060f, 0.22f, 0.42f },  // slate blue
    { 0.68f, 0.36f, 0.060f },  // amber
    { 0.090f, 0.30f, 0.19f },  // moss green
    { 0.36f, 0.12f, 0.30f },   // plum
    { 0.10f, 0.36f, 0.38f },   // teal
    { 0.66f, 0.27f, 0.19f },   // terracotta
    { 0.55f, 0.50f, 0.42f },   // sand
};

wisp_vec3 render_palette( int body )
{
    return PALETTE[(unsigned)body % WISP_COUNT( PALETTE )];
}

static wisp_vec3 default_colour( render_material material )
{
    switch ( material )
    {
        case RENDER_CLOTH:
            return PALETTE[1];
        case RENDER_LATEX:
            return PALETTE[0];
        case RENDER_SOLID:
            break;
    }
    return ( wisp_vec3 ){ 0.50f, 0.47f, 0.43f };
}

render_mesh render_default_mesh( render_material material )
{
    return ( render_mesh ){ .material = material, .colour = default_colour( material ) };
}

render_curves render_default_curves( void )
{
    return ( render_curves ){ .radius = 4e-5f, .colour = { 0.20f, 0.088f, 0.038f } };
}

render_points render_default_points( void )
{
    return ( render_points ){ .radius = 0.01f, .colour = PALETTE[7] };
}

render_scene render_default_scene( void )
{
    return ( render_scene ){
        .background_top = { 0.52f, 0.57f, 0.63f },
        .background_bottom = { 0.80f, 0.80f, 0.79f },
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
