/// Entities, tables and component columns. An entity owns one contiguous range of rows in each table; a column exists
/// only while some entity has its component.
#pragma once

#include "mask.h"

#include "wisp/module/module.h"

enum
{
    STORE_MAX_COMPONENTS = STORE_MASK_BITS,
    STORE_MAX_COLUMNS = 16, // in one component
    STORE_MAX_RANGES = 128,
};

typedef struct store_rows
{
    int begin, count;
} store_rows;

typedef struct store_component
{
    wisp_component_def def;
    void* columns[STORE_MAX_COLUMNS]; // null until an entity has the component
    int entity_count;
} store_component;

/// An entity that falls asleep still computes what is derived from its state, once.
typedef enum store_sleep
{
    STORE_AWAKE = 0,
    STORE_FALLING_ASLEEP = 1,
    STORE_ASLEEP = 2,
} store_sleep;

typedef struct store_entity
{
    uint32_t generation;
    bool alive;
    store_mask components; // bit c: has component c
    store_mask requests;   // bit c: component c is requested
    store_mask derived;    // bit c: rows exist only by request; a pass must fill them
    store_rows rows[WISP_TABLE_COUNT];
    const wisp_strand_topology* strands; // null without strands
    const wisp_fabric* fabric;           // null without particles
    const struct wisp_samples* samples;  // points that a module keeps on it for others; null: none
    int substeps;                        // in a step of usual length, as asked for; 0: those of the world
    uint64_t halted;                     // 1: left out of every pass
    store_sleep sleep;                   // what the rows of wisp/sleep.h say
    bool is_touched;                     // rows may have changed since it fell asleep
    wisp_detail_frame detail;            // what the rows of wisp/detail.h say
    double origin[3];                    // m, place in the world that the host's coordinates are relative to
    wisp_vec3 offset;                    // m, from the host's coordinates to those of rows
    uint32_t tie;                        // those of one number have one origin of rows; 0: it is on its own
    bool meets;                          // so has what comes near it
    store_mask dirty; // bit p: pass p must run on the entity, because what it watches or writes has changed
} store_entity;

typedef struct store
{
    const wisp_allocator* allocator;
    store_component components[STORE_MAX_COMPONENTS]; // [0] is null
    int component_count;
    wisp_index_range ranges[STORE_MAX_RANGES];
    int range_count;
    int row_count[WISP_TABLE_COUNT];
    int row_capacity[WISP_TABLE_COUNT];
    store_entity* entities;
    int entity_count, dead_count; // slots, alive or not; to reuse
    int entity_capacity;
    store_mask watchers[STORE_MAX_COMPONENTS]; // bit p: pass p runs when the component's rows were written
    store_mask writers[STORE_MAX_COMPONENTS];  // bit p: pass p writes the component
    store_mask transient;                      // components whose rows mean nothing between steps
    uint64_t passes;                           // hash of the passes' names in order: the meaning of the bits
    uint32_t structure;                        // incremented by every added or removed entity, component and request
} store;

void store_init( store* s, const wisp_allocator* allocator );
void store_release( store* s );

/// @return 0 if the registry is full, the name exists with another shape, or the definition is malformed
wisp_component store_declare( store* s, const wisp_component_def* def );

/// @return whether there is room for the ranges
bool store_declare_ranges( store* s, const wisp_index_range* ranges, int count );

/// @return null for a stale handle
store_entity* store_find( const store* s, wisp_entity entity );

/// Find the place in the world that coordinates in rows are relative to, m.
static inline void store_row_origin( const store_entity* e, double out[3] )
{
    out[0] = e->origin[0] - (double)e->offset.x;
    out[1] = e->origin[1] - (double)e->offset.y;
    out[2] = e->origin[2] - (double)e->offset.z;
}

/// Return the vector from coordinates in rows of one entity to those in rows of another, m.
static inline wisp_vec3 store_between( const store_entity* from, const store_entity* to )
{
    double a[3], b[3];
    store_row_origin( from, a );
    store_row_origin( to, b );
    return ( wisp_vec3 ){ (float)( a[0] - b[0] ), (float)( a[1] - b[1] ), (float)( a[2] - b[2] ) };
}

/// The handle of a slot.
wisp_entity store_handle( const store* s, int slot );

/// A new entity with its rows, zeroed, and no component yet. @return false without memory, nothing changed
bool store_add( store* s, const int row_counts[WISP_TABLE_COUNT], wisp_entity* out );

/// Later rows move down to close the gap.
void store_remove( store* s, wisp_entity entity );

/// Make room for as many rows of an entity in a table. @return false without memory, nothing changed
bool store_reserve_rows( store* s, const store_entity* e, wisp_table table, int count );
/// Give it another number of rows, for which there is room. Rows of others move; of its own, those that remain are kept, and those that
/// are new are zero.
void store_resize_rows( store* s, store_entity* e, wisp_table table, int count );

/// @return false without memory, nothing changed
bool store_attach( store* s, wisp_entity entity, wisp_component component );
void store_detach( store* s, wisp_entity entity, wisp_component component );

/// Bytes of a component's columns. @param used receives those of rows of entities that have it
size_t store_memory( const store* s, wisp_component component, size_t* used );

/// First row of the entity's range, null if it lacks the component.
void* store_column( const store* s, const store_entity* e, wisp_component component, int column );

/// Mark the component's rows of this entity as written: passes that watch it run.
static inline void store_touch( const store* s, store_entity* e, wisp_component component )
{
    e->dirty = store_mask_or( e->dirty, s->watchers[component] );
    e->is_touched = true;
}

// snapshot.c

/// Transient components are left out.
size_t store_snapshot_size( const store* s );
void store_snapshot( const store* s, void* out );
/// Check everything before the first byte is written back.
wisp_status store_restore( store* s, const void* bytes, size_t size, wisp_error* error );
/// Hash all rows of all entities except the transient ones.
uint64_t store_hash( const store* s );

/// Hash which components an entity has and which are requested, and its rows, except the transient ones and some others.
uint64_t store_hash_entity( const store* s, const store_entity* e, store_mask excluded );

/// 64-bit hash of bytes, chained through `seed`. Reads little-endian words, so equal bytes hash equal anywhere.
uint64_t store_hash_bytes( uint64_t seed, const void* bytes, size_t size );
