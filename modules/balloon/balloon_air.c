// Air around the skin: buoyancy (balloon paper, eq. 10) and drag (eq. 11).
#include "balloon_internal.h"

#include <math.h>

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Limit an explicit step so that drag never reverses a velocity. The thrust that `signed` gives has the same limit: without it
// the rear of a slack skin is thrown into its front.
wisp_vec3 balloon_drag_force( const balloon_air* air, wisp_vec3 velocity, wisp_vec3 area_vector, float area,
                              float dt_w )
{
    const wisp_vec3 zero = { 0.0f, 0.0f, 0.0f };
    float speed = sqrtf( dot( velocity, velocity ) ), size = sqrtf( dot( area_vector, area_vector ) );
    if ( !( speed > 0.0f && size >= 1e-12f * area && size > 0.0f ) )
    {
        return zero; // at rest, or a normal that cancels
    }
    float along = dot( velocity, area_vector ) / ( speed * size );
    float c = air->half_density_drag * area;
    if ( air->mode == WISP_BALLOON_DRAG_NORMAL )
    {
        float f = -c * speed * speed * along / ( 1.0f + c * speed * dt_w ) / size;
        return ( wisp_vec3 ){ f * area_vector.x, f * area_vector.y, f * area_vector.z };
    }
    c *= air->mode == WISP_BALLOON_DRAG_MAX ? fmaxf( 0.0f, along )
                                            : ( air->mode == WISP_BALLOON_DRAG_ABS ? fabsf( along ) : along );
    float f = -c * speed / ( 1.0f + fabsf( c ) * speed * dt_w );
    return ( wisp_vec3 ){ f * velocity.x, f * velocity.y, f * velocity.z };
}

void balloon_drag( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    const float* vectors = wisp_frame_column( frame, span->entity, state->rings, 0 );
    const float* areas = wisp_frame_column( frame, span->entity, state->rings, 1 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const float dt = wisp_frame_dt( frame, span->entity );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        float* v = velocity + (size_t)slot * 4;
        const float* g = vectors + (size_t)( slot / 8 ) * 24 + slot % 8;
        float dt_w = dt * position[(size_t)slot * 4 + 3];
        wisp_vec3 f = balloon_drag_force( air, ( wisp_vec3 ){ v[0], v[1], v[2] }, ( wisp_vec3 ){ g[0], g[8], g[16] },
                                          areas[slot], dt_w );
        v[0] += dt_w * f.x;
        v[1] += dt_w * f.y;
        v[2] += dt_w * f.z;
    }
}

// Share buoyancy by mass, which gives no torque. The difference of densities contains the weight of the gas.
void balloon_float( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    double lifted = extent->volume * ( gas->air_density - gas->gas_density ); // kg
    float fraction =
        body->mass > 0.0 ? (float)( -lifted / body->mass * (double)wisp_frame_dt( frame, span->entity ) ) : 0.0f;
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        float* v = velocity + (size_t)slot * 4;
        float moves = position[(size_t)slot * 4 + 3] > 0.0f ? fraction : 0.0f;
        v[0] += moves * gravity->x;
        v[1] += moves * gravity->y;
        v[2] += moves * gravity->z;
    }
}
