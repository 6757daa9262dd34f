// Strands at rest. In: the surface that they are rooted in. Out: whether they can rest; the history of substeps and the velocities of the
// last valid state, which become zero.
#include "strand_passes.h"

#include "strand_rows.h"

#include <string.h>

bool strands_surroundings( const void* memory, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                           uint64_t* hash )
{
    (void)bounds;
    (void)hash;
    const strands_state* state = memory;
    const wisp_entity* surface = wisp_world_rows( world, entity, state->surface, 0 );
    return surface == NULL || surface->index == 0 || wisp_is_asleep( world, *surface ) ||
           wisp_is_halted( world, *surface );
}

void strands_rested( const void* memory, wisp_world* world, wisp_entity entity )
{
    const strands_state* state = memory;
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    float* velocity = wisp_world_column( world, entity, state->good, 1 );
    if ( velocity != NULL && t != NULL )
    {
        memset( velocity, 0, strands_vector( t->row_count, 0 ) * sizeof( float ) );
    }
    // the next substep has none before it
    float* step = wisp_world_column( world, entity, state->history, 2 );
    for ( int i = 0; t != NULL && step != NULL && i < t->group_count * WISP_LANES; ++i )
    {
        step[strands_scalar( t->group_row[i / WISP_LANES], i % WISP_LANES )] = -1.0f;
    }
}
