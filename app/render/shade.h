/// Light: from the lamps to a surface, and from the surface to the camera.
#pragma once

#include "stage.h"

/// The samples of one camera ray.
typedef struct shade_sample
{
    const sampler* pixel;
    int number;
} shade_sample;

enum
{
    SHADE_PANES_MAX = 32, ///< panes of glass that a ray passes; what is behind more is not seen
};

/// Light that a surface reflects along the ray that hit it.
wisp_vec3 shade_surface( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample );

/// The ground: the background behind it, in the shadow of the bodies on it.
/// @param background the colour of the background behind that pixel
/// @param distance m along the ray
wisp_vec3 shade_ground( const stage* s, const trace_ray* ray, float distance, wisp_vec3 background,
                        shade_sample sample );
