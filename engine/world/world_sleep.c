// Sleep: which entities fall asleep at the end of a step, and which wake at the start of one. In: how long each has been still
// (passes/sleep.c), hashes of its rows and of what is around it, bounds. Out: store_entity.sleep, by which the plan leaves entities out.
//
// Everything is a function of the rows, of the step and of the bodies of modules, on the calling thread: the number of workers
// does not matter. What a call may have written is only looked at after a call (store_entity.is_touched): an entity at rest costs
// a hash of what is around it and, with contact, a comparison of bounds.
#include "sleep_bounds.h"

#include "wisp/module/components.h"

#include <math.h>
#include <string.h>

void wisp_init_sleep_def( wisp_sleep_def* def, size_t size )
{
    const wisp_sleep_def values = { .enabled = true, .max_speed = 0.02f, .seconds = 0.5f };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

// ---- waking ----

static void wake( wisp_world* world, store_entity* e )
{
    e->sleep = STORE_AWAKE;
    passes_sleep* state = sleep_state_of( world, e );
    state->phase = STORE_AWAKE;
    state->still = 0.0f;
}

static uint64_t hash_rows( const wisp_world* world, const store_entity* e )
{
    return store_hash_entity( &world->store, e, store_bit( world->sleep.components.state ) );
}

static bool is_disturbed( wisp_world* world, int slot )
{
    store_entity* e = world->store.entities + slot;
    const passes_sleep* state = sleep_state_of( world, e );
    const bool has_changed = e->is_touched && hash_rows( world, e ) != state->rows;
    e->is_touched = false;
    const wisp_sleep_bounds bounds = sleep_bounds_of( state );
    uint64_t around;
    return has_changed ||
           plan_registry_surroundings( &world->registry, world, store_handle( &world->store, slot ), &bounds,
                                       &around ) == false ||
           around != state->surroundings;
}

bool world_sleep_shift( wisp_world* world, store_entity* e, wisp_vec3 by )
{
    passes_sleep* state = e->sleep != STORE_AWAKE ? sleep_state_of( world, e ) : NULL;
    const float shift[3] = { by.x, by.y, by.z };
    for ( int k = 0; k < 3 && state != NULL; ++k )
    {
        state->lower[k] += shift[k];
        state->upper[k] += shift[k];
    }
    if ( state != NULL )
    {
        state->rows = hash_rows( world, e );
    }
    return state != NULL;
}

void world_sleep_disturb( wisp_world* world )
{
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        store_entity* e = world->store.entities + slot;
        if ( e->alive && e->sleep != STORE_AWAKE )
        {
            sleep_state_of( world, e )->rows += 1;
            e->is_touched = true;
        }
    }
}

static void wake_reached( wisp_world* world )
{
    sleep_box* boxes = sleep_reserve_boxes( world );
    const int count = world->store.entity_count;
    if ( boxes != NULL )
    {
        sleep_fill_boxes( world, boxes );
        for ( int slot = 0; slot < count; ++slot )
        {
            boxes[slot].is_still = world->store.entities[slot].sleep != STORE_AWAKE;
        }
        sleep_stir( boxes, count, boxes + count );
    }
    for ( int slot = 0; slot < count; ++slot )
    {
        store_entity* e = world->store.entities + slot;
        if ( e->sleep != STORE_AWAKE && ( boxes == NULL || boxes[slot].is_still == false ) )
        {
            wake( world, e );
        }
    }
}

static bool has_sleepers( const wisp_world* world )
{
    const store* s = &world->store;
    return s->components[world->sleep.components.state].entity_count > 0;
}

void world_sleep_begin( wisp_world* world )
{
    bool has_asleep = false;
    for ( int slot = 0; slot < world->store.entity_count && has_sleepers( world ); ++slot )
    {
        store_entity* e = world->store.entities + slot;
        if ( e->sleep != STORE_AWAKE && is_disturbed( world, slot ) )
        {
            wake( world, e );
        }
        has_asleep = has_asleep ||
                     ( e->sleep != STORE_AWAKE &&
                       plan_registry_reach( &world->registry, world, store_handle( &world->store, slot ) ) >= 0.0f );
    }
    if ( has_asleep )
    {
        wake_reached( world );
    }
}

// ---- falling asleep ----

static void clear_rows( wisp_world* world, store_entity* e, wisp_component component, int column )
{
    const wisp_component_def* def = &world->store.components[component].def;
    void* rows = store_column( &world->store, e, component, column );
    if ( rows != NULL )
    {
        memset( rows, 0, (size_t)e->rows[def->table].count * def->columns[column].row_size );
        store_touch( &world->store, e, component );
    }
}

void world_forget_velocities( wisp_world* world, store_entity* e )
{
    clear_rows( world, e, WISP_PARTICLE_VELOCITY, 0 );
    clear_rows( world, e, WISP_PARTICLE_LAST_VALID, 1 );
    clear_rows( world, e, WISP_STRAND_VELOCITY, 0 );
    wisp_world_restart_levels( world, store_handle( &world->store, (int)( e - world->store.entities ) ) );
}

static void fall_asleep( wisp_world* world, int slot )
{
    store_entity* e = world->store.entities + slot;
    const wisp_entity entity = store_handle( &world->store, slot );
    world_forget_velocities( world, e );
    plan_registry_rested( &world->registry, world, entity );
    passes_sleep* state = sleep_state_of( world, e );
    state->rows = hash_rows( world, e );
    state->phase = STORE_FALLING_ASLEEP;
    e->sleep = STORE_FALLING_ASLEEP;
}

// Derived rows are computed once more after the velocities became zero.
static void end_fall( wisp_world* world, store_entity* e )
{
    passes_sleep* state = sleep_state_of( world, e );
    state->rows = hash_rows( world, e );
    state->phase = STORE_ASLEEP;
    e->sleep = STORE_ASLEEP;
}

static bool is_ready( wisp_world* world, int slot )
{
    const store_entity* e = world->store.entities + slot;
    passes_sleep* state = e->alive ? sleep_state_of( world, e ) : NULL;
    wisp_sleep_bounds bounds;
    // sums of the same steps differ from the seconds by rounding
    if ( state == NULL || e->sleep != STORE_AWAKE || e->halted != 0 || state->still <= 0.0f ||
         state->still < 0.9999f * state->seconds || sleep_find_bounds( world, e, 0.0f, &bounds ) == false ||
         plan_registry_surroundings( &world->registry, world, store_handle( &world->store, slot ), &bounds,
                                     &state->surroundings ) == false )
    {
        return false;
    }
    memcpy( state->lower, bounds.lower, sizeof( bounds.lower ) );
    memcpy( state->upper, bounds.upper, sizeof( bounds.upper ) );
    return true;
}

// @return whether any of them is
static bool mark_ready( wisp_world* world, sleep_box* boxes )
{
    bool found = false;
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        const bool ready = is_ready( world, slot );
        boxes[slot].is_still = ready || world->store.entities[slot].sleep != STORE_AWAKE;
        found = found || ready;
    }
    return found;
}

void world_sleep_end( wisp_world* world )
{
    sleep_box* boxes = has_sleepers( world ) ? sleep_reserve_boxes( world ) : NULL;
    for ( int slot = 0; slot < world->store.entity_count && boxes != NULL; ++slot )
    {
        if ( world->store.entities[slot].sleep == STORE_FALLING_ASLEEP )
        {
            end_fall( world, world->store.entities + slot );
        }
    }
    if ( boxes == NULL || mark_ready( world, boxes ) == false )
    {
        return;
    }
    sleep_fill_boxes( world, boxes );
    sleep_stir( boxes, world->store.entity_count, boxes + world->store.entity_count );
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        if ( boxes[slot].is_still && world->store.entities[slot].sleep == STORE_AWAKE )
        {
            fall_asleep( world, slot );
        }
    }
}

// ---- snapshots ----

void world_sleep_to_rows( wisp_world* world, bool has_snapshot )
{
    for ( int slot = 0; slot < world->store.entity_count && has_sleepers( world ); ++slot )
    {
        const store_entity* e = world->store.entities + slot;
        passes_sleep* state = e->alive ? sleep_state_of( world, e ) : NULL;
        if ( state != NULL )
        {
            state->phase =
                state->phase % PASSES_TOUCHED + ( has_snapshot == false && e->is_touched ? PASSES_TOUCHED : 0 );
        }
    }
}

void world_sleep_from_rows( wisp_world* world )
{
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        store_entity* e = world->store.entities + slot;
        const passes_sleep* state = e->alive ? sleep_state_of( world, e ) : NULL;
        e->sleep = state != NULL ? (store_sleep)( state->phase % PASSES_TOUCHED ) : STORE_AWAKE;
        e->is_touched = state != NULL && state->phase >= PASSES_TOUCHED;
    }
    world_sleep_to_rows( world, true );
}

// ---- calls of the host ----

static wisp_status check_sleep( wisp_world* world, wisp_entity entity, const wisp_sleep_def* def )
{
    const wisp_number_range ranges[] = {
        { "max_speed", def->max_speed, 0.0f, 1e6f },
        { "seconds", def->seconds, 0.0f, 1e6f },
    };
    WISP_TRY( wisp_world_check_ranges( world, "sleep", ranges, WISP_COUNT( ranges ) ) );
    const store_entity* e = store_find( &world->store, entity );
    const bool moves =
        e->fabric != NULL || ( e->strands != NULL && store_mask_has( &e->components, WISP_STRAND_VELOCITY ) );
    return moves ? WISP_OK
                 : wisp_world_fail( world, WISP_CONFLICT,
                                    "sleep: entity %u is neither a surface nor strands that move", entity.index );
}

static void stop_sleep( wisp_world* world, wisp_entity entity )
{
    const passes_sleep_components* c = &world->sleep.components;
    const wisp_component all[] = { c->moved, c->particles, c->strands, c->state };
    wisp_world_cancel_request( world, entity, c->moved );
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        wisp_world_detach( world, entity, all[i] );
    }
    store_find( &world->store, entity )->sleep = STORE_AWAKE;
}

static wisp_status start_sleep( wisp_world* world, wisp_entity entity )
{
    const passes_sleep_components* c = &world->sleep.components;
    const bool is_surface = wisp_world_fabric( world, entity ) != NULL;
    wisp_status status = wisp_world_attach( world, entity, is_surface ? c->particles : c->strands );
    status = status == WISP_OK ? wisp_world_attach( world, entity, c->state ) : status;
    return status == WISP_OK ? wisp_world_request( world, entity, c->moved ) : status;
}

// The first step is measured from where the entity is now.
static void keep_positions( wisp_world* world, wisp_entity entity )
{
    const passes_sleep_components* c = &world->sleep.components;
    const wisp_fabric* fabric = wisp_world_fabric( world, entity );
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    const size_t bytes = fabric != NULL ? (size_t)fabric->slot_count * 4 * sizeof( float )
                                        : (size_t)t->row_count * 3 * WISP_LANES * sizeof( float );
    memcpy( wisp_world_column( world, entity, fabric != NULL ? c->particles : c->strands, 0 ),
            wisp_world_rows( world, entity, fabric != NULL ? WISP_PARTICLE_POSITION : WISP_STRAND_POSITION, 0 ),
            bytes );
}

wisp_status wisp_set_sleep( wisp_world* world, wisp_entity entity, const wisp_sleep_def* given )
{
    wisp_sleep_def def = wisp_default_sleep_def();
    WISP_TRY( wisp_world_begin_def( world, "wisp_default_sleep_def", &def, given ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    WISP_TRY( check_sleep( world, entity, &def ) );
    if ( def.enabled == false )
    {
        stop_sleep( world, entity );
        return WISP_OK;
    }
    const bool is_new = wisp_world_has( world, entity, world->sleep.components.state ) == false;
    const wisp_status status = start_sleep( world, entity );
    if ( status != WISP_OK )
    {
        if ( is_new )
        {
            stop_sleep( world, entity );
        }
        return status;
    }
    if ( is_new )
    {
        keep_positions( world, entity );
    }
    store_entity* e = store_find( &world->store, entity );
    passes_sleep* state = sleep_state_of( world, e );
    state->max_speed = def.max_speed;
    state->seconds = def.seconds;
    wake( world, e );
    return WISP_OK;
}

bool wisp_is_asleep( const wisp_world* world, wisp_entity entity )
{
    const store_entity* e = world != NULL ? store_find( &world->store, entity ) : NULL;
    return e != NULL && e->sleep != STORE_AWAKE;
}
