// Where the memory of a world goes.
#include "world.h"

#include "fabric.h"

#include <string.h>

// Parts as they are found.
typedef struct part_list
{
    wisp_memory_part* out;
    int count, capacity;
} part_list;

static void add( part_list* parts, const char* name, wisp_memory_kind kind, size_t bytes, size_t capacity )
{
    if ( capacity == 0 )
    {
        return;
    }
    if ( parts->count < parts->capacity )
    {
        parts->out[parts->count] = ( wisp_memory_part ){ name, kind, bytes, capacity };
    }
    parts->count += 1;
}

static void add_whole( part_list* parts, const char* name, wisp_memory_kind kind, size_t bytes )
{
    add( parts, name, kind, bytes, bytes );
}

// Instances share what they are instances of, so each is counted where the first entity has it.
static bool is_first( const store* s, int slot, const void* shared, bool is_fabric )
{
    for ( int i = 0; i < slot; ++i )
    {
        const store_entity* e = s->entities + i;
        const void* other = is_fabric ? (const void*)e->fabric : (const void*)e->strands;
        if ( e->alive && other == shared )
        {
            return false;
        }
    }
    return true;
}

// A surface whose triangles have changed has a fabric in the memory of the world.
static bool is_own( const store* s, const wisp_fabric* fabric )
{
    return ( (const cook_fabric*)fabric )->keep.allocator == s->allocator;
}

static size_t topology_bytes( const store* s )
{
    size_t bytes = 0;
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        bytes += e->alive && e->strands != NULL && is_first( s, i, e->strands, false )
                     ? ( (const cook_strands*)e->strands )->bytes
                     : 0;
        bytes += e->alive && e->fabric != NULL && is_own( s, e->fabric ) && is_first( s, i, e->fabric, true )
                     ? wisp_fabric_bytes( e->fabric )
                     : 0;
    }
    return bytes;
}

static size_t fabric_bytes( const store* s )
{
    size_t bytes = 0;
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        bytes += e->alive && e->fabric != NULL && is_own( s, e->fabric ) == false && is_first( s, i, e->fabric, true )
                     ? wisp_fabric_bytes( e->fabric )
                     : 0;
    }
    return bytes;
}

static void add_engine( part_list* parts, const wisp_world* world )
{
    const store* s = &world->store;
    size_t pool = 0;
    const size_t scratch = jobs_memory( world->pool, &pool );
    const size_t clocks = (size_t)world->registry.workers * sizeof( plan_clock );
    add_whole( parts, "world", WISP_MEMORY_ENGINE, sizeof( *world ) );
    add_whole( parts, "workers", WISP_MEMORY_ENGINE, pool + clocks );
    add_whole( parts, "scratch", WISP_MEMORY_ENGINE, scratch );
    add( parts, "entities", WISP_MEMORY_ENGINE, (size_t)s->entity_count * sizeof( store_entity ),
         (size_t)s->entity_capacity * sizeof( store_entity ) );
    add_whole( parts, "topology", WISP_MEMORY_ENGINE, topology_bytes( s ) );
    add_whole( parts, "plan", WISP_MEMORY_ENGINE, plan_memory( &world->plan ) );
    add_whole( parts, "blended points", WISP_MEMORY_ENGINE, world->blend.previous.size + world->blend.points.size );
    add_whole( parts, "sleep", WISP_MEMORY_ENGINE, world->sleep.boxes.size );
    add_whole( parts, "origins", WISP_MEMORY_ENGINE, world->origin_members.size );
}

// @return sum over the parts
static size_t sum_of( const wisp_memory_part* parts, int count )
{
    size_t sum = 0;
    for ( int i = 0; i < count; ++i )
    {
        sum += parts[i].capacity;
    }
    return sum;
}

enum
{
    ENGINE_PARTS = 8,
    ALL_PARTS = ENGINE_PARTS + PLAN_MAX_STATES + STORE_MAX_COMPONENTS,
};

int wisp_world_memory_parts( const wisp_world* world, wisp_memory_part* out, int capacity )
{
    if ( world == NULL )
    {
        return 0;
    }
    wisp_memory_part found[ALL_PARTS + 2];
    part_list engine = { found, 0, ENGINE_PARTS };
    add_engine( &engine, world );
    wisp_memory_part* own = found + ENGINE_PARTS;
    part_list rest = { own, 0, ALL_PARTS + 2 - ENGINE_PARTS };
    size_t outside = 0;
    for ( int i = 0; i < world->registry.state_count; ++i )
    {
        size_t held;
        const size_t bytes = plan_registry_memory( &world->registry, i, &held, &outside );
        add( &rest, world->registry.states[i].module, WISP_MEMORY_MODULE, held, bytes );
    }
    for ( int i = 1; i < world->store.component_count; ++i )
    {
        size_t used;
        const size_t bytes = store_memory( &world->store, (wisp_component)i, &used );
        add( &rest, world->store.components[i].def.name, WISP_MEMORY_COMPONENT, used, bytes );
    }
    // descriptions of the plan that a host has, and what modules of a host keep without saying so
    const size_t known = sum_of( found, engine.count ) + sum_of( own, rest.count );
    const size_t all = wisp_world_memory( world );
    add_whole( &engine, "other", WISP_MEMORY_ENGINE, all > known ? all - known : 0 );
    add_whole( &rest, "fabrics", WISP_MEMORY_OUTSIDE, fabric_bytes( &world->store ) );
    add_whole( &rest, "trees of Embree", WISP_MEMORY_OUTSIDE, outside );
    for ( int i = 0; out != NULL && i < engine.count + rest.count && i < capacity; ++i )
    {
        out[i] = i < engine.count ? found[i] : own[i - engine.count];
    }
    return engine.count + rest.count;
}
