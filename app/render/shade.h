/// Light: from the lamps to a surface, and from the surface to the camera.
#pragma once

#include "stage.h"

/// The samples of one camera ray.
typedef struct shade_sample
{
    const sampler* pixel;
    int number;
} shade_sample;

/// Light from the key light at a point, through all translucent bodies in between.
/// @param towards unit length @param far m, may be infinite
wisp_vec3 light_of_key( const stage* s, wisp_vec3 place, wisp_vec3 towards, float far );

/// A direction towards a point of the key light.
wisp_vec3 light_key_direction( const stage* s, shade_sample sample );

enum
{
    SHADE_PANES_MAX = 32, ///< panes of glass that a ray passes; what is behind more is not seen
};

/// The nearest body that is not glass. The ray starts at the last pane before it, afterwards.
bool light_find_opaque( const stage* s, trace_ray* ray, trace_hit* hit );

/// Light from the sky or from the nearest body in a direction, by one ray.
wisp_vec3 light_of_surroundings( const stage* s, const trace_ray* ray );

/// The same with the lamps as seen in a mirror.
wisp_vec3 light_in_mirror( const stage* s, const trace_ray* ray );

/// A direction around a normal, distributed by the cosine.
wisp_vec3 light_sky_direction( wisp_vec3 normal, shade_sample sample );

/// The brightness of the key light on a surface that faces it, and of the whole sky without occlusion.
extern const float light_key_strength, light_sky_strength;

/// Light that a surface reflects along the ray that hit it.
wisp_vec3 shade_surface( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample );

/// The ground: the background behind it, in the shadow of the bodies on it.
/// @param background the colour of the background behind that pixel
/// @param distance m along the ray
wisp_vec3 shade_ground( const stage* s, const trace_ray* ray, float distance, wisp_vec3 background,
                        shade_sample sample );
