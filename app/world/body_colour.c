#include "body_colour.h"

#include "palette.h"

// Every other colour first and the rest afterwards, so that all eight occur before one repeats, and cloth and
// balloons of a small scene share none.
static int palette_place( int number )
{
    return 2 * number + number / 4 % 2;
}

// Cloth and balloons start at different ends, so that the first of each has the colour that suits it best.
wisp_vec3 scene_body_colour( scene_body_kind kind, int* cloths, int* balloons )
{
    switch ( kind )
    {
        case SCENE_BODY_CLOTH:
            return palette_body( 1 + palette_place( ( *cloths )++ ) );
        case SCENE_BODY_BALLOON:
            return palette_body( palette_place( ( *balloons )++ ) );
        case SCENE_BODY_STRANDS:
            return palette_hair();
        case SCENE_BODY_COLLIDER:
        case SCENE_BODY_PLANE:
            break;
    }
    return palette_solid();
}
