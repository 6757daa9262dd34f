// State of the module in one world: followers and drawings by their entity, and their removal.
#include "guide_internal.h"

#include <string.h>

guide_follower* guide_find_follower( const guide_state* state, wisp_entity ghosts )
{
    for ( int i = 0; i < state->follower_count; ++i )
    {
        if ( wisp_entity_equal( state->followers[i]->ghosts, ghosts ) )
        {
            return state->followers[i];
        }
    }
    return NULL;
}

const guide_follower* guide_active_follower( const guide_state* state, wisp_entity ghosts )
{
    const guide_follower* f = guide_find_follower( state, ghosts );
    return f != NULL && f->targets.index != 0 ? f : NULL;
}

guide_drawing* guide_find_drawing( const guide_state* state, wisp_entity curves )
{
    for ( int i = 0; i < state->drawing_count; ++i )
    {
        if ( wisp_entity_equal( state->drawings[i]->curves, curves ) )
        {
            return state->drawings[i];
        }
    }
    return NULL;
}

void guide_let_go( wisp_world* world, const guide_state* state, wisp_entity entity )
{
    bool followed = false, drawn = false;
    for ( int i = 0; i < state->follower_count; ++i )
    {
        followed = followed || wisp_entity_equal( state->followers[i]->targets, entity );
    }
    for ( int i = 0; i < state->drawing_count; ++i )
    {
        drawn = drawn || wisp_entity_equal( state->drawings[i]->source, entity );
    }
    if ( followed == false && wisp_world_has( world, entity, state->before ) )
    {
        wisp_world_cancel_request( world, entity, state->table );
        wisp_world_detach( world, entity, state->table );
        wisp_world_detach( world, entity, state->before );
    }
    if ( drawn == false && wisp_world_has( world, entity, state->drawn ) )
    {
        wisp_world_cancel_request( world, entity, state->drawn );
        wisp_world_detach( world, entity, state->drawn );
    }
}

wisp_status guide_find_ghosts( wisp_world* world, wisp_entity ghosts, const guide_follower** out )
{
    const guide_state* s = wisp_world_module_state( world, "guide_hair" );
    *out = s != NULL ? guide_find_follower( s, ghosts ) : NULL;
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u has no targets", ghosts.index );
}
