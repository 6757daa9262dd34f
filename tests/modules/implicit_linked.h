/// Implicit cloth as published.
#pragma once

#include "implicit_cloth.h"

/// Links and weights as published.
static inline wisp_implicit_cloth_def linked_def( void )
{
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.stiffness_model = WISP_IMPLICIT_STIFFNESS_LINK;
    def.weights = WISP_IMPLICIT_WEIGHTS_EFFECTIVE;
    def.tolerance = 1e-4f;
    return def;
}
