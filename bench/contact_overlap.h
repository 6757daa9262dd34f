/// How surfaces lie to each other, by another road than that of contact: signed distances of the vertices of each
/// closed surface from the others.
#pragma once

#include "contact_scene.h"

typedef struct contact_overlap
{
    double overlap; ///< m, how much nearer than the thickness, or how deep in another surface, a vertex is at most
    int missed;     ///< vertices of any surface nearer than half of the thickness to another one, or in it
    int touching;   ///< vertices of the first surface next to another one
    double unevenness,
        patch; ///< m: how far those are from their mean along x (root mean square), and how far from the
               ///< axis at most; NaN without them
} contact_overlap;

/// Of a world of closed surfaces. What is deeper than PRESS_RADIUS counts as that.
wisp_status contact_find_overlap( contact_world* world, contact_overlap* out, wisp_error* error );
