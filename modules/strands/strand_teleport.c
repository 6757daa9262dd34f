// Teleports of strands: with their head, or with the surface that they are rooted in. In: a rigid motion. Out: the head,
// frames of rods, last valid states and corners of triangles.
#include "strand_rows.h"
#include "surface_roots.h"

static wisp_status refuse( wisp_world* world, wisp_entity strands )
{
    return wisp_world_fail( world, WISP_CONFLICT,
                            "teleport: strands %u are rooted in a surface, which must be teleported instead",
                            strands.index );
}

static void turn_frames( float* frames, int row_count, wisp_quat turn )
{
    const wisp_teleport_motion rotation = { .motion.rotation = turn, .keep_velocity = true };
    for ( int i = 0; i < row_count * WISP_LANES && frames != NULL; ++i )
    {
        const int row = i / WISP_LANES, lane = i % WISP_LANES;
        const wisp_transform frame = { strands_get_quat( frames, row, lane ), { 0.0f, 0.0f, 0.0f } };
        const wisp_quat q = frame.rotation;
        if ( q.x != 0.0f || q.y != 0.0f || q.z != 0.0f || q.w != 0.0f ) // lanes without a strand hold zeros
        {
            strands_put_quat( frames, row, lane, wisp_teleport_pose( &rotation, frame ).rotation );
        }
    }
}

static void move_columns( const strands_state* state, wisp_world* world, wisp_entity strands,
                          const wisp_teleport_motion* teleport )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const wisp_quat turn = teleport->motion.rotation;
    const wisp_teleport_motion low = { .motion = teleport->motion,
                                       .keep_velocity = true }; // low parts turn like velocities
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->good, 1 ), t->row_count );
    wisp_teleport_lanes( &low, NULL, wisp_world_column( world, strands, state->low, 0 ), t->row_count );
    wisp_teleport_lanes( &low, NULL, wisp_world_column( world, strands, WISP_STRAND_ROOT, 2 ), t->group_count );
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->history, 1 ), t->row_count );
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->history, 0 ), t->row_count );
    turn_frames( wisp_world_column( world, strands, state->curve, 0 ), t->row_count, turn );
    turn_frames( wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 ), t->group_count, turn );
}

static void move_rooted( const strands_state* state, wisp_world* world, wisp_entity surface,
                         const wisp_teleport_motion* teleport )
{
    for ( int i = 0; i < state->rooted_count; ++i )
    {
        const wisp_entity strands = state->rooted[i];
        const wisp_entity* on = wisp_world_column( world, strands, state->surface, 0 );
        if ( on != NULL && wisp_entity_equal( *on, surface ) )
        {
            move_columns( state, world, strands, teleport );
            wisp_world_move_columns( world, strands, teleport );
        }
    }
}

wisp_status strands_teleported( void* memory, wisp_world* world, wisp_entity entity,
                                const wisp_teleport_motion* teleport, bool* is_moved )
{
    const strands_state* state = memory;
    move_rooted( state, world, entity, teleport );
    if ( wisp_world_has( world, entity, state->settings ) == false )
    {
        return WISP_OK;
    }
    if ( wisp_world_has( world, entity, state->head ) == false )
    {
        return refuse( world, entity );
    }
    move_columns( state, world, entity, teleport );
    *is_moved = true;
    return WISP_OK;
}
