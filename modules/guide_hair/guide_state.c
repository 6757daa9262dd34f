// What the module keeps in one world: followers and drawings, found by their entity, and who is let go.
#include "guide_internal.h"

#include <string.h>

guide_follower* guide_find_follower( const guide_state* state, wisp_entity ghosts )
{
    for ( int i = 0; i < state->follower_count; ++i )
    {
        if ( guide_same( state->followers[i]->ghosts, ghosts ) )
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
        if ( guide_same( state->drawings[i]->curves, curves ) )
        {
            return state->drawings[i];
        }
    }
    return NULL;
}

bool guide_reserve( wisp_world* world, void*** array, int* capacity, int count )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    if ( count < *capacity )
    {
        return true;
    }
    const int more = *capacity > 0 ? 2 * *capacity : 8;
    void** grown = allocator->allocate( allocator->user, (size_t)more * sizeof( void* ), 64 );
    if ( grown == NULL )
    {
        return false;
    }
    if ( *array != NULL )
    {
        memcpy( grown, *array, (size_t)count * sizeof( void* ) );
        allocator->release( allocator->user, *array, (size_t)*capacity * sizeof( void* ) );
    }
    *array = grown;
    *capacity = more;
    return true;
}

void guide_let_go( wisp_world* world, const guide_state* state, wisp_entity entity )
{
    bool followed = false, drawn = false;
    for ( int i = 0; i < state->follower_count; ++i )
    {
        followed = followed || guide_same( state->followers[i]->targets, entity );
    }
    for ( int i = 0; i < state->drawing_count; ++i )
    {
        drawn = drawn || guide_same( state->drawings[i]->source, entity );
    }
    if ( followed == false && wisp_world_has( world, entity, state->before ) )
    {
        wisp_unwant( world, entity, state->table );
        wisp_world_detach( world, entity, state->table );
        wisp_world_detach( world, entity, state->before );
    }
    if ( drawn == false && wisp_world_has( world, entity, state->drawn ) )
    {
        wisp_unwant( world, entity, state->drawn );
        wisp_world_detach( world, entity, state->drawn );
    }
}

wisp_status guide_find_ghosts( wisp_world* world, wisp_entity ghosts, const guide_follower** out )
{
    const guide_state* s = wisp_world_module_state( world, "guide_hair" );
    *out = s != NULL ? guide_find_follower( s, ghosts ) : NULL;
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u has no targets",
                                           ghosts.index );
}
