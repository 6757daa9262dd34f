// Snapshots: where the scene stands, the parameters of strands, which pins are held, places of colliders, and the bytes of
// the world behind them.
#include "binding_internal.h"

#include <string.h>

typedef struct snapshot_place
{
    int32_t next_step, next_command, next_event, is_combed;
} snapshot_place;

static size_t front_size( const binding_world* w )
{
    return sizeof( snapshot_place ) + (size_t)w->scene.strands_count * sizeof( hair_state ) +
           scene_pins_state_size( &w->world ) + (size_t)w->scene.collider_count * sizeof( wisp_transform );
}

static char* put( char* at, const void* from, size_t size )
{
    memcpy( at, from, size );
    return at + size;
}

static const char* take( const char* at, void* to, size_t size )
{
    memcpy( to, at, size );
    return at + size;
}

// Columns that only steps fill exist once the plan is compiled. A snapshot of the start has them, so that it fits later.
static wisp_status compile( const binding_world* w, wisp_error* error )
{
    return wisp_world_plan_passes( w->world.world ) >= 0 ? WISP_OK : binding_fail( w, WISP_CONFLICT, error );
}

wisp_status binding_snapshot_prepare( binding_world* w, size_t* size, wisp_error* error )
{
    const wisp_status status = compile( w, error );
    *size = status == WISP_OK ? front_size( w ) + wisp_world_snapshot_size( w->world.world ) : 0;
    return status;
}

wisp_status binding_snapshot( const binding_world* w, void* out, size_t size, wisp_error* error )
{
    const size_t front = front_size( w ), expected = front + wisp_world_snapshot_size( w->world.world );
    if ( size < expected )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got room for %zu bytes, expected %zu", w->scene.name, size,
                          expected );
    }
    const snapshot_place place = { w->world.next_step, w->world.next_command, w->world.next_event, w->is_combed };
    char* at = put( out, &place, sizeof place );
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        const hair_state hair = binding_hair_state( w, i );
        at = put( at, &hair, sizeof hair );
    }
    scene_pins_save( &w->world, at );
    at += scene_pins_state_size( &w->world );
    for ( int i = 0; i < w->scene.collider_count; ++i )
    {
        at = put( at, &w->world.colliders[i].pose, sizeof( wisp_transform ) );
    }
    return binding_fail( w, wisp_world_snapshot( w->world.world, at, size - front ), error );
}

static bool is_place( const binding_world* w, const snapshot_place* place )
{
    return place->next_step >= 0 && place->next_command >= 0 && place->next_command <= w->scene.command_count &&
           place->next_event >= 0 && place->next_event <= w->scene.event_count;
}

wisp_status binding_restore( binding_world* w, const void* bytes, size_t size, wisp_error* error )
{
    const size_t front = front_size( w );
    snapshot_place place = { .next_step = -1 };
    if ( size >= front )
    {
        memcpy( &place, bytes, sizeof place );
    }
    if ( !is_place( w, &place ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %zu bytes, which are no snapshot of this world",
                          w->scene.name, size );
    }
    wisp_status status = compile( w, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_world_restore( w->world.world, (const char*)bytes + front, size - front );
    if ( status != WISP_OK )
    {
        return binding_fail( w, status, error );
    }
    const char* at = (const char*)bytes + sizeof place;
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        hair_state hair;
        at = take( at, &hair, sizeof hair );
        binding_hair_restore( w, i, hair );
    }
    scene_pins_load( &w->world, at );
    at += scene_pins_state_size( &w->world );
    for ( int i = 0; i < w->scene.collider_count; ++i )
    {
        at = take( at, &w->world.colliders[i].pose,
                   sizeof( wisp_transform ) ); // the world's bytes have moved the collider itself
    }
    w->world.next_step = place.next_step;
    w->world.next_command = place.next_command;
    w->world.next_event = place.next_event;
    w->is_combed = place.is_combed != 0;
    w->is_between = false;
    return WISP_OK;
}
