// Sleep: which entities fall asleep at the end of a step, and which wake at the start of one. In: how long each has been still
// (passes/sleep.c), hashes of its rows and of what is around it, bounds. Out: store_entity.sleep, by which the plan leaves entities out.
//
// Everything is a function of the rows, of the step and of the bodies of modules, on the calling thread: the number of workers
// does not matter. What a call may have written is only looked at after a call (store_entity.is_touched): an entity at rest costs
// a hash of what is around it and, with contact, a comparison of bounds.
#include "world.h"

#include "alloc.h"

#include "wisp/module/components.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- bounds ----

// Bounds of entities, with where they go in a step. In: rows of vertices, the reach of contact. Out: which entities are reached by others.

// ---- rows and bounds ----

const void* wisp_world_rows( const wisp_world* world, wisp_entity entity, wisp_component component, int column )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL && component < world->store.component_count ? store_column( &world->store, e, component, column )
                                                                 : NULL;
}

uint64_t wisp_hash_bytes( uint64_t seed, const void* bytes, size_t size )
{
    return store_hash_bytes( seed, bytes, size );
}

// NaN extends nothing.
static void add_point( wisp_sleep_bounds* bounds, const float* p, size_t coordinate )
{
    for ( size_t k = 0; k < 3; ++k )
    {
        const float at = p[k * coordinate];
        bounds->lower[k] = at < bounds->lower[k] ? at : bounds->lower[k];
        bounds->upper[k] = at > bounds->upper[k] ? at : bounds->upper[k];
    }
}

static void add_moved( wisp_sleep_bounds* bounds, const float* p, const float* velocity, size_t coordinate,
                       float seconds )
{
    const float moved[3] = { p[0] + seconds * velocity[0], p[coordinate] + seconds * velocity[coordinate],
                             p[2 * coordinate] + seconds * velocity[2 * coordinate] };
    add_point( bounds, moved, 1 );
}

static void add_particles( const wisp_world* world, const store_entity* e, float seconds, wisp_sleep_bounds* out )
{
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    const float* velocity = store_column( &world->store, e, WISP_PARTICLE_VELOCITY, 0 );
    const float* target = store_column( &world->store, e, WISP_PARTICLE_TARGET, 0 );
    for ( size_t i = 0; i < (size_t)e->fabric->vertex_count * 4; i += 4 )
    {
        add_point( out, position + i, 1 );
        if ( seconds > 0.0f && velocity != NULL )
        {
            add_moved( out, position + i, velocity + i, 1, seconds );
        }
        if ( target != NULL && target[i + 3] != 0.0f && position[i + 3] == 0.0f )
        {
            add_point( out, target + i, 1 );
        }
    }
}

static void add_strands( const wisp_world* world, const store_entity* e, float seconds, wisp_sleep_bounds* out )
{
    const wisp_strand_topology* t = e->strands;
    const float* position = store_column( &world->store, e, WISP_STRAND_POSITION, 0 );
    const float* velocity = store_column( &world->store, e, WISP_STRAND_VELOCITY, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            const size_t at = (size_t)( t->group_row[group] + v ) * 3 * WISP_LANES + (size_t)lane;
            add_point( out, position + at, WISP_LANES );
            if ( seconds > 0.0f && velocity != NULL )
            {
                add_moved( out, position + at, velocity + at, WISP_LANES, seconds );
            }
        }
    }
}

bool sleep_find_bounds( const wisp_world* world, const store_entity* e, float seconds, wisp_sleep_bounds* out )
{
    *out = ( wisp_sleep_bounds ){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    if ( e->fabric != NULL )
    {
        add_particles( world, e, seconds, out );
    }
    else if ( e->strands != NULL && store_mask_has( &e->components, WISP_STRAND_POSITION ) )
    {
        add_strands( world, e, seconds, out );
    }
    return out->lower[0] <= out->upper[0];
}

static float step_seconds( const wisp_world* world )
{
    return world->frame.seconds * (float)world->frame.substeps;
}

bool wisp_world_bounds( const wisp_world* world, wisp_entity entity, wisp_sleep_bounds* out )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL && sleep_find_bounds( world, e, step_seconds( world ), out );
}

bool wisp_bounds_touch( const wisp_sleep_bounds* a, const wisp_sleep_bounds* b, float reach )
{
    bool touch = true;
    for ( int k = 0; k < 3; ++k )
    {
        touch = touch && a->lower[k] - reach <= b->upper[k] && b->lower[k] - reach <= a->upper[k];
    }
    return touch;
}

// ---- who reaches whom ----

// Return the row of an entity; null if it cannot sleep.
static passes_sleep* sleep_state_of( const wisp_world* world, const store_entity* e )
{
    return store_column( &world->store, e, world->sleep.components.state, 0 );
}

// Return the bounds in which an entity fell asleep.
static wisp_sleep_bounds sleep_bounds_of( const passes_sleep* state )
{
    wisp_sleep_bounds bounds;
    memcpy( bounds.lower, state->lower, sizeof( bounds.lower ) );
    memcpy( bounds.upper, state->upper, sizeof( bounds.upper ) );
    return bounds;
}

// Return room for a box of each slot, and for sleep_wake_touched() behind them; null without memory.
static sleep_box* sleep_reserve_boxes( wisp_world* world )
{
    const int count = world->store.entity_count;
    const size_t bytes = (size_t)count * sizeof( sleep_box ) + sleep_wake_bytes( count );
    return base_buffer_reserve( &world->allocator, &world->sleep.boxes, bytes ) ? world->sleep.boxes.data : NULL;
}

// Compute bounds and reach of all entities. `is_still` stays.
static void sleep_fill_boxes( wisp_world* world, sleep_box* boxes )
{
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        const store_entity* e = world->store.entities + slot;
        sleep_box* box = boxes + slot;
        store_row_origin( e, box->origin );
        box->reach = e->alive && e->halted == 0
                         ? plan_registry_reach( &world->registry, world, store_handle( &world->store, slot ) )
                         : -1.0f;
        if ( box->reach >= 0.0f && e->sleep != STORE_AWAKE )
        {
            box->bounds = sleep_bounds_of( sleep_state_of( world, e ) );
        }
        else if ( box->reach >= 0.0f && sleep_find_bounds( world, e, step_seconds( world ), &box->bounds ) == false )
        {
            box->reach = -1.0f;
        }
    }
}

// What lies on another rests a little above the distance at which both act.
static float pair_reach( const sleep_box* a, const sleep_box* b )
{
    float longest = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        longest = fmaxf( longest, a->bounds.upper[k] - a->bounds.lower[k] );
    }
    return a->reach + b->reach + 1e-3f * longest;
}

// An entity by where it begins along an axis, and how far any of those before it and itself go.
typedef struct sleep_place
{
    float begin, end;
    int32_t slot;
} sleep_place;

static int compare_places( const void* a, const void* b )
{
    const sleep_place *x = a, *y = b;
    const int order = ( x->begin > y->begin ) - ( x->begin < y->begin );
    return order != 0 ? order : ( x->slot > y->slot ) - ( x->slot < y->slot );
}

// The axis along which the middles are spread most.
static int find_axis( const sleep_box* boxes, int count )
{
    int axis = 0;
    float widest = -1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        float lower = INFINITY, upper = -INFINITY;
        for ( int i = 0; i < count; ++i )
        {
            const wisp_sleep_bounds* b = &boxes[i].bounds;
            if ( boxes[i].reach >= 0.0f )
            {
                lower = fminf( lower, 0.5f * b->lower[k] + 0.5f * b->upper[k] );
                upper = fmaxf( upper, 0.5f * b->lower[k] + 0.5f * b->upper[k] );
            }
        }
        axis = upper - lower > widest ? k : axis;
        widest = fmaxf( widest, upper - lower );
    }
    return axis;
}

// List those that are still, in ascending order. @return how many; `reach` receives the largest of their own parts of a pair
static int list_still( const sleep_box* boxes, int count, int axis, sleep_place* places, float* reach )
{
    static const sleep_box NO_REACH = { .reach = 0.0f };
    int found = 0;
    *reach = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        if ( boxes[i].is_still && boxes[i].reach >= 0.0f )
        {
            places[found++] = ( sleep_place ){ boxes[i].bounds.lower[axis], boxes[i].bounds.upper[axis], i };
            *reach = fmaxf( *reach, pair_reach( boxes + i, &NO_REACH ) );
        }
    }
    qsort( places, (size_t)found, sizeof( *places ), compare_places );
    for ( int i = 1; i < found; ++i )
    {
        places[i].end = fmaxf( places[i].end, places[i - 1].end );
    }
    return found;
}

// Return the number of places that begin no later.
static int count_begun( const sleep_place* places, int count, float at )
{
    int lower = 0, upper = count;
    while ( lower < upper )
    {
        const int middle = lower + ( upper - lower ) / 2;
        if ( places[middle].begin <= at )
        {
            lower = middle + 1;
        }
        else
        {
            upper = middle;
        }
    }
    return lower;
}

size_t sleep_wake_bytes( int count )
{
    return (size_t)count * ( sizeof( sleep_place ) + sizeof( int32_t ) );
}

// Each that is not still stirs those that it reaches, once. They are looked for along one axis, backwards from where it ends, until none
// of those before comes as far.
void sleep_wake_touched( sleep_box* boxes, int count, void* room )
{
    sleep_place* places = room;
    int32_t* queue = (int32_t*)( places + count );
    float still_reach;
    const int axis = find_axis( boxes, count );
    const int still = list_still( boxes, count, axis, places, &still_reach );
    int queued = 0;
    for ( int i = 0; i < count && still > 0; ++i )
    {
        if ( boxes[i].is_still == false && boxes[i].reach >= 0.0f )
        {
            queue[queued++] = i;
        }
    }
    for ( int next = 0; next < queued; ++next )
    {
        const sleep_box* b = boxes + queue[next];
        // a little farther than any pair reaches, against rounding
        const float reach = 1.001f * ( still_reach + b->reach );
        const float slack = 1e-6f * fmaxf( fabsf( b->bounds.lower[axis] ), fabsf( b->bounds.upper[axis] ) );
        const float from = b->bounds.lower[axis] - reach - slack, to = b->bounds.upper[axis] + reach + slack;
        for ( int i = count_begun( places, still, to ) - 1; i >= 0 && places[i].end >= from; --i )
        {
            sleep_box* a = boxes + places[i].slot;
            if ( a->is_still && memcmp( a->origin, b->origin, sizeof( a->origin ) ) == 0 &&
                 wisp_bounds_touch( &a->bounds, &b->bounds, pair_reach( a, b ) ) )
            {
                a->is_still = false;
                queue[queued++] = places[i].slot;
            }
        }
    }
}

// ---- sleep ----

static const wisp_field SLEEP_FIELDS[] = {
    WISP_SWITCH( wisp_sleep_def, enabled, true ),
    WISP_NUMBER( wisp_sleep_def, max_speed, 0.02, 0, 1e6, "m/s" ),
    WISP_NUMBER( wisp_sleep_def, seconds, 0.5, 0, 1e6, "s" ),
};
WISP_DEFINE( sleep_def, "sleep", SLEEP_FIELDS )

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
    const bool sleeps = world->store.components[world->sleep.components.state].entity_count > 0;
    for ( int slot = 0; slot < world->store.entity_count && sleeps; ++slot )
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
        sleep_wake_touched( boxes, count, boxes + count );
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
    sleep_wake_touched( boxes, world->store.entity_count, boxes + world->store.entity_count );
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

static wisp_status check_sleep( wisp_world* world, wisp_entity entity )
{
    const store_entity* e = store_find( &world->store, entity );
    const bool moves =
        e->fabric != NULL || ( e->strands != NULL && store_mask_has( &e->components, WISP_STRAND_VELOCITY ) );
    return moves ? WISP_OK
                 : wisp_world_fail( world, WISP_CONFLICT,
                                    "sleep: entity %u is neither a surface nor strands that move", entity.index );
}

static wisp_status set_components( wisp_world* world, wisp_entity entity, bool sleeps )
{
    const passes_sleep_components* c = &world->sleep.components;
    const bool is_surface = wisp_world_fabric( world, entity ) != NULL;
    const wisp_component_use all[] = { { c->particles, sleeps && is_surface },
                                       { c->strands, sleeps && is_surface == false },
                                       { c->state, sleeps },
                                       { c->moved, sleeps ? WISP_REQUESTED : 0 } };
    return wisp_world_set_components( world, entity, all, WISP_COUNT( all ) );
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
    wisp_sleep_def def;
    WISP_TRY( wisp_world_begin_def( world, &entity, &wisp_sleep_def_fields, &def, given ) );
    WISP_TRY( check_sleep( world, entity ) );
    const bool is_new = wisp_world_has( world, entity, world->sleep.components.state ) == false;
    WISP_TRY( set_components( world, entity, def.enabled ) );
    store_entity* e = store_find( &world->store, entity );
    if ( def.enabled == false )
    {
        e->sleep = STORE_AWAKE;
        return WISP_OK;
    }
    if ( is_new )
    {
        keep_positions( world, entity );
    }
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
