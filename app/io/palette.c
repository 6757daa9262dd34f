#include "palette.h"

static const wisp_vec3 PALETTE[] = {
    { 0.62f, 0.050f, 0.045f }, // coral red
    { 0.045f, 0.16f, 0.32f },  // slate blue
    { 0.68f, 0.36f, 0.060f },  // amber
    { 0.090f, 0.30f, 0.19f },  // moss green
    { 0.36f, 0.12f, 0.30f },   // plum
    { 0.10f, 0.36f, 0.38f },   // teal
    { 0.66f, 0.27f, 0.19f },   // terracotta
    { 0.55f, 0.50f, 0.42f },   // sand
};

wisp_vec3 palette_body( int body )
{
    return PALETTE[(unsigned)body % WISP_COUNT( PALETTE )];
}

wisp_vec3 palette_hair( void )
{
    return ( wisp_vec3 ){ 0.20f, 0.088f, 0.038f };
}

wisp_vec3 palette_solid( void )
{
    return ( wisp_vec3 ){ 0.50f, 0.47f, 0.43f };
}
