// Air around the skin: buoyancy (balloon paper, eq. 10) and drag (eq. 11).
#include "balloon_internal.h"

wisp_vertex_drag_args balloon_drag_args( wisp_frame* frame, const wisp_span* span, const balloon_state* state )
{
    const balloon_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    return ( wisp_vertex_drag_args ){
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .vectors = wisp_frame_column( frame, span->entity, state->rings, 0 ),
        .areas = wisp_frame_column( frame, span->entity, state->rings, 1 ),
        .half_density_drag = air->half_density_drag,
        .dt = wisp_frame_dt( frame, span->entity ),
    };
}

void balloon_drag( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_vertex_drag_args args = balloon_drag_args( frame, span, user );
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->vertex_drag( &args, s.begin, s.end );
}

void balloon_push_all( wisp_frame* frame, const wisp_span* span, wisp_vec3 change )
{
    const wisp_particle_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .acceleration = change,
        .dt = 1.0f,
    };
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->accelerate( &args, s.begin, s.end );
}

// Share buoyancy by mass, which gives no torque. The difference of densities contains the weight of the gas.
void balloon_float( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    double lifted = extent->volume * ( gas->air_density - gas->gas_density ); // kg
    float fraction =
        body->mass > 0.0 ? (float)( -lifted / body->mass * (double)wisp_frame_dt( frame, span->entity ) ) : 0.0f;
    balloon_push_all( frame, span,
                      ( wisp_vec3 ){ fraction * gravity->x, fraction * gravity->y, fraction * gravity->z } );
}
