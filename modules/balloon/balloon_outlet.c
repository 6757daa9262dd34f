// The outlet: mass flow and thrust (balloon paper, eq. 12).
#include "balloon_internal.h"

#include <math.h>

// A jet ends at 1e-4 P_atm and starts again above 5e-4, because noise of the solver in the pressure would make it chatter.
static const double CLOSE_AT = 1e-4, OPEN_AT = 5e-4;

// The area vectors of the outlet's vertices give its normal. @return false if they cancel
static bool aim( const float* position, const float* vectors, balloon_outlet* outlet )
{
    double normal[3] = { 0 }, place[3] = { 0 };
    for ( int i = 0; i < outlet->count; ++i )
    {
        int slot = outlet->slots[i];
        for ( int k = 0; k < 3; ++k )
        {
            normal[k] += (double)vectors[(size_t)( slot / 8 ) * 24 + (size_t)( 8 * k + slot % 8 )];
            place[k] += (double)position[(size_t)slot * 4 + (size_t)k] / outlet->count;
        }
    }
    double length = sqrt( normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2] );
    for ( int k = 0; k < 3; ++k )
    {
        outlet->normal[k] = length > 0.0 ? normal[k] / length : 0.0;
        outlet->place[k] = place[k];
    }
    return length > 0.0;
}

// Let out gas, at most what V_0 has above its minimum. The thrust follows from the actual flow.
static void flow( balloon_outlet* outlet, balloon_gas* gas, double pressure, double dt )
{
    outlet->speed = sqrt( 2.0 * fmax( 0.0, pressure ) / gas->gas_density );
    double requested = gas->gas_density * outlet->area * outlet->speed;
    double most = gas->gas_density * fmax( 0.0, gas->target_volume - gas->min_volume ) / dt;
    outlet->mass_flow = fmin( requested, most );
    gas->target_volume -= outlet->mass_flow / gas->gas_density * dt;
    outlet->gas_lost += outlet->mass_flow * dt;
}

void balloon_let_out( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_gauge* gauge = wisp_frame_column( frame, span->entity, state->gauge, 0 );
    const float* vectors = wisp_frame_column( frame, span->entity, state->rings, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    double fraction = gauge->pressure / gas->atmosphere;
    bool runs = outlet->open != 0 && fraction > ( outlet->running != 0 ? CLOSE_AT : OPEN_AT );
    outlet->jet_starts += runs && outlet->running == 0 ? 1 : 0;
    outlet->running = runs ? 1 : 0;
    outlet->speed = outlet->mass_flow = 0.0;
    if ( runs && aim( position, vectors, outlet ) )
    {
        flow( outlet, gas, gauge->pressure, (double)wisp_frame_dt( frame, span->entity ) );
    }
}

// Apply the linear part F = -mdot v n, shared by mass. The spin pass applies the angular part.
void balloon_jet( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    if ( outlet->mass_flow == 0.0 || body->mass == 0.0 )
    {
        return;
    }
    double factor = -outlet->mass_flow * outlet->speed / body->mass * (double)wisp_frame_dt( frame, span->entity );
    balloon_push_all( frame, span,
                      ( wisp_vec3 ){ (float)( factor * outlet->normal[0] ), (float)( factor * outlet->normal[1] ),
                                     (float)( factor * outlet->normal[2] ) } );
}
