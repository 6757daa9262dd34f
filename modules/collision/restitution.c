// Restitution of surfaces, after velocities are known (Mueller et al. 2020, "Detailed rigid body simulation with extended position
// based dynamics", eq. 34). With n the normal away from the body, w the velocity of its surface and v~ the velocity of a particle at
// the start of the substep, a particle on which the body pushed gets
//
//   v += n max( 0, ( w - v ) n + e max( 0, ( w - v~ ) n ) ),   e = 0 where the approach is slower than 2 |g| h
//
// Velocities after gravity of the substep would give a bounce more energy than the fall had, so v~ is without it. The term without e
// is left out: the projection already stopped the particle.
#include "collision_state.h"
#include "particle_contacts.h"
#include "reaction.h"

#include <math.h>

float collision_bounce( const collision_find_args* args, const collision_view* view, const collision_contact* c,
                        int slot )
{
    if ( !( view->restitution > 0.0f ) )
    {
        return -INFINITY;
    }
    const wisp_vec3 n = wisp_v3_load( c->normal ), motion = wisp_v3_load( c->motion );
    const wisp_vec3 v =
        wisp_v3_mul_add( wisp_v3_load( args->velocity + (size_t)slot * 4 ), -args->dt, args->gravity );
    const float surface = wisp_v3_dot( n, motion ) / args->dt, approach_speed = surface - wisp_v3_dot( n, v );
    const bool bounces = approach_speed > 2.0f * wisp_v3_length( args->gravity ) * args->dt;
    return bounces ? surface + view->restitution * approach_speed : -INFINITY;
}

void collision_bounce_off( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const wisp_entity e = span->entity;
    const float* position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 );
    const int32_t* count = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 0 );
    collision_contact( *contact )[WISP_COLLISION_CONTACTS] =
        wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 2 );
    float( *bounce )[WISP_COLLISION_CONTACTS] = wisp_frame_column( frame, e, state->bounce, 0 );
    int32_t( *body )[WISP_COLLISION_CONTACTS] = wisp_frame_column( frame, e, state->contact_body, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        collision_impulse* sums =
            body != NULL ? collision_reaction_sums( frame, e, state, slot / COLLISION_BLOCK ) : NULL;
        const int used = count[slot] < WISP_COLLISION_CONTACTS ? count[slot] : WISP_COLLISION_CONTACTS;
        for ( int i = 0; i < used; ++i )
        {
            const wisp_vec3 n = wisp_v3_load( contact[slot][i].normal ),
                            v = wisp_v3_load( velocity + (size_t)slot * 4 );
            float change = bounce[slot][i] - wisp_v3_dot( n, v );
            if ( state->coupled_count > 0 && body != NULL && change > 0.0f && bounce[slot][i] > -INFINITY )
            {
                // of the separation, the body takes the rest
                const float surface =
                    wisp_v3_dot( n, wisp_v3_load( contact[slot][i].motion ) ) / wisp_frame_dt( frame, e );
                const wisp_vec3 at = wisp_v3_load( position + (size_t)slot * 4 );
                const float share = collision_share_of( frame, state, body[slot][i], e, at, n ).normal;
                change = share < 1.0f ? share * ( bounce[slot][i] - surface ) : change;
            }
            if ( contact[slot][i].normal_correction > 0.0f && change > 0.0f )
            {
                const wisp_vec3 now = wisp_v3_mul_add( v, change, n ),
                                x = wisp_v3_load( position + (size_t)slot * 4 );
                collision_store( velocity + (size_t)slot * 4, now );
                if ( sums != NULL )
                {
                    // velocities in place of positions give the impulse; it acts at the position
                    const double mass = 1.0 / (double)position[(size_t)slot * 4 + 3];
                    collision_add_impulse( sums[body[slot][i]], mass, v, now, x );
                }
            }
        }
    }
}
