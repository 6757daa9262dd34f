// Statistics of a balloon, on request: pressures, volumes, the four forces (balloon paper, fig. 4), spin and orientation.
#include "balloon_internal.h"

#include <math.h>
#include <string.h>

static void take_weight( wisp_frame* frame, const wisp_span* span, const balloon_state* state, double volume,
                         const balloon_body* body, wisp_balloon_stats* f )
{
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const wisp_vec3* g = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    const double down[3] = { g != NULL ? (double)g->x : 0.0, g != NULL ? (double)g->y : 0.0,
                             g != NULL ? (double)g->z : 0.0 };
    bool floats = wisp_frame_has( frame, span->entity, state->buoyancy );
    double lifted = floats ? volume * ( gas->air_density - gas->gas_density ) : 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        f->gravity[k] = body->mass * down[k];
        f->buoyancy[k] = -lifted * down[k];
    }
}

static void take_jet( const balloon_outlet* outlet, const balloon_body* body, wisp_balloon_stats* f )
{
    f->outlet_speed = outlet->speed;
    f->mass_flow = outlet->mass_flow;
    f->gas_lost = outlet->gas_lost;
    f->jet_starts = outlet->jet_starts;
    for ( int k = 0; k < 3; ++k )
    {
        f->jet[k] = -outlet->mass_flow * outlet->speed * outlet->normal[k];
    }
    balloon_torque_of( body, outlet, f->torque );
}

// Eq. 15: q + dt/2 (0, omega) q, normalised.
static void turn( double q[4], const double w[3], double dt )
{
    double h = 0.5 * dt;
    double next[4] = {
        q[0] - h * ( w[0] * q[1] + w[1] * q[2] + w[2] * q[3] ),
        q[1] + h * ( w[0] * q[0] + w[1] * q[3] - w[2] * q[2] ),
        q[2] + h * ( w[1] * q[0] + w[2] * q[1] - w[0] * q[3] ),
        q[3] + h * ( w[2] * q[0] + w[0] * q[2] - w[1] * q[1] ),
    };
    double length = sqrt( next[0] * next[0] + next[1] * next[1] + next[2] * next[2] + next[3] * next[3] );
    for ( int k = 0; k < 4 && isfinite( length ); ++k ) // the state check restores particles, but not this
    {
        q[k] = next[k] / length;
    }
}

bool balloon_is_last_substep( wisp_frame* frame, const wisp_span* span )
{
    return span->substep + 1 == wisp_frame_substeps( frame, span->entity );
}

// Measure once a substep, so that the orientation follows. At the end of a step all values belong to its last substep, the only
// one whose drag is summed.
void balloon_take_stats( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const balloon_gauge* gauge = wisp_frame_column( frame, span->entity, state->gauge, 0 );
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    wisp_balloon_stats* f = wisp_frame_column( frame, span->entity, state->stats, 0 );
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    double q[4] = { f->orientation[0], f->orientation[1], f->orientation[2], f->orientation[3] };
    q[0] = q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0 ? 1.0 : q[0];
    *f = ( wisp_balloon_stats ){
        .rest_volume = gas->rest_volume,
        .target_volume = gas->target_volume,
        .volume = extent->volume,
        .pressure = gauge->pressure,
        .centre = { body->centre[0] - (double)o.x, body->centre[1] - (double)o.y, body->centre[2] - (double)o.z },
    };
    take_weight( frame, span, state, extent->volume, body, f );
    if ( wisp_frame_has( frame, span->entity, state->air ) && balloon_is_last_substep( frame, span ) )
    {
        const wisp_vertex_drag_args args = balloon_drag_args( frame, span, state );
        wisp_frame_kernels( frame )->sum_vertex_drag( &args, 0, wisp_frame_fabric( frame, span->entity )->slot_count,
                                                      f->drag );
    }
    if ( outlet != NULL )
    {
        take_jet( outlet, body, f );
    }
    balloon_spin_of( body, body->angular_momentum, f->angular_velocity );
    turn( q, f->angular_velocity, (double)wisp_frame_dt( frame, span->entity ) );
    memcpy( f->orientation, q, sizeof( q ) );
}
