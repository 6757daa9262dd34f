// Bounds of entities, with where they go in a step. In: rows of vertices, the reach of contact. Out: which entities are reached by others.
#include "sleep_bounds.h"

#include "alloc.h"
#include "wisp/module/components.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

passes_sleep* sleep_state_of( const wisp_world* world, const store_entity* e )
{
    return store_column( &world->store, e, world->sleep.components.state, 0 );
}

wisp_sleep_bounds sleep_bounds_of( const passes_sleep* state )
{
    wisp_sleep_bounds bounds;
    memcpy( bounds.lower, state->lower, sizeof( bounds.lower ) );
    memcpy( bounds.upper, state->upper, sizeof( bounds.upper ) );
    return bounds;
}

sleep_box* sleep_reserve_boxes( wisp_world* world )
{
    const int count = world->store.entity_count;
    const size_t bytes = (size_t)count * sizeof( sleep_box ) + sleep_stir_bytes( count );
    return base_buffer_reserve( &world->allocator, &world->sleep.boxes, bytes ) ? world->sleep.boxes.data : NULL;
}

void sleep_fill_boxes( wisp_world* world, sleep_box* boxes )
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
typedef struct stir_place
{
    float begin, end;
    int32_t slot;
} stir_place;

static int compare_places( const void* a, const void* b )
{
    const stir_place *x = a, *y = b;
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
static int list_still( const sleep_box* boxes, int count, int axis, stir_place* places, float* reach )
{
    static const sleep_box NO_REACH = { .reach = 0.0f };
    int found = 0;
    *reach = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        if ( boxes[i].is_still && boxes[i].reach >= 0.0f )
        {
            places[found++] = ( stir_place ){ boxes[i].bounds.lower[axis], boxes[i].bounds.upper[axis], i };
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
static int count_begun( const stir_place* places, int count, float at )
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

size_t sleep_stir_bytes( int count )
{
    return (size_t)count * ( sizeof( stir_place ) + sizeof( int32_t ) );
}

// Each that is not still stirs those that it reaches, once. They are looked for along one axis, backwards from where it ends, until none
// of those before comes as far.
void sleep_stir( sleep_box* boxes, int count, void* room )
{
    stir_place* places = room;
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
