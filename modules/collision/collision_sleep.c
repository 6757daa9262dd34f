// Which bodies an entity at rest can touch. In: its bounds, poses of bodies now and at the end of the coming step. Out: a hash of
// the bodies within reach; nothing rests while one of them moves.
#include "collision_bodies.h"

#include "collision_vectors.h"

#include <string.h>

static float longest_side( const wisp_sleep_bounds* b )
{
    return fmaxf( b->upper[0] - b->lower[0], fmaxf( b->upper[1] - b->lower[1], b->upper[2] - b->lower[2] ) );
}

// Does a ball around a body meet the bounds on its way from one pose to another? A body that rotates about its origin may leave the
// straight line by as much as its centre is away from the origin. A plane has an infinite ball.
static bool passes_by( const collision_body* body, wisp_transform from, wisp_transform to,
                       const wisp_sleep_bounds* bounds, float reach )
{
    const bool turns = memcmp( &from.rotation, &to.rotation, sizeof( from.rotation ) ) != 0;
    const wisp_vec3 p = wisp_transform_to_world( from, body->centre ),
                    q = wisp_transform_to_world( to, body->centre );
    const float start[3] = { p.x, p.y, p.z }, displacement[3] = { q.x - p.x, q.y - p.y, q.z - p.z };
    const float radius = body->ball_radius + ( turns ? wisp_v3_length( body->centre ) : 0.0f ) + reach;
    float enters = 0.0f, leaves = 1.0f; // fractions of the way
    for ( int k = 0; k < 3; ++k )
    {
        const float lower = bounds->lower[k] - radius - start[k], upper = bounds->upper[k] + radius - start[k];
        if ( displacement[k] == 0.0f )
        {
            leaves = lower > 0.0f || upper < 0.0f ? -1.0f : leaves;
            continue;
        }
        const float a = lower / displacement[k], b = upper / displacement[k];
        enters = fmaxf( enters, fminf( a, b ) );
        leaves = fminf( leaves, fmaxf( a, b ) );
    }
    return enters <= leaves;
}

// @param by from the rows of the body to those of the bounds @return false if the body moves
static bool add_rigid( const collision_state* state, const wisp_world* world, const collision_body* body,
                       wisp_vec3 by, const wisp_sleep_bounds* bounds, float reach, uint64_t* hash )
{
    const collision_collider* collider = wisp_world_rows( world, body->entity, state->collider, 0 );
    const wisp_transform* motion = wisp_world_rows( world, body->entity, state->motion, 0 );
    const wisp_transform target = motion != NULL ? *motion : collider->to;
    const wisp_transform from = { collider->to.rotation, wisp_to_rows( collider->to.translation, by ) };
    const wisp_transform to = { target.rotation, wisp_to_rows( target.translation, by ) };
    if ( passes_by( body, from, to, bounds, reach ) == false )
    {
        return true;
    }
    *hash = wisp_hash_bytes( *hash, &body->entity, sizeof( body->entity ) );
    *hash = wisp_hash_bytes( *hash, collider, sizeof( *collider ) );
    *hash = wisp_hash_bytes( *hash, &target, sizeof( target ) );
    // what a body with a mass lies on carries it
    return memcmp( &collider->from, &collider->to, sizeof( collider->to ) ) == 0 && body->is_coupled == false;
}

static bool add_surface( const collision_state* state, const wisp_world* world, const collision_body* body,
                         const wisp_sleep_bounds* bounds, float reach, uint64_t* hash )
{
    wisp_sleep_bounds of_surface;
    if ( wisp_world_bounds( world, body->surface, &of_surface ) == false ||
         wisp_bounds_touch( bounds, &of_surface, reach ) == false )
    {
        return true;
    }
    *hash = wisp_hash_bytes( *hash, &body->entity, sizeof( body->entity ) );
    *hash = wisp_hash_bytes( *hash, wisp_world_rows( world, body->entity, state->collider, 0 ),
                             sizeof( collision_collider ) );
    return wisp_is_asleep( world, body->surface ) || wisp_is_halted( world, body->surface );
}

bool collision_surroundings( const void* memory, wisp_world* world, wisp_entity entity,
                             const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    const collision_state* state = memory;
    const collision_settings* settings = wisp_world_rows( world, entity, state->settings, 0 );
    bool rests = true;
    for ( int i = 0; i < state->body_count && rests && settings != NULL && settings->enabled != 0; ++i )
    {
        const collision_body* body = state->bodies + i;
        const collision_collider* collider = wisp_world_rows( world, body->entity, state->collider, 0 );
        const bool is_left_out =
            body->follows && ( body->surface.index == 0 || wisp_entity_equal( body->surface, entity ) ||
                               collision_is_apart( wisp_world_between( world, body->surface, entity ) ) );
        if ( ( collider->layers & settings->mask ) == 0 || is_left_out )
        {
            continue;
        }
        // what lies on a body rests a little above its thickness
        const float reach = 2.0f * ( settings->thickness + collider->thickness ) + 1e-3f * longest_side( bounds );
        rests = body->follows ? add_surface( state, world, body, bounds, reach, hash )
                              : add_rigid( state, world, body, wisp_world_between( world, body->entity, entity ),
                                           bounds, reach, hash );
    }
    return rests;
}
