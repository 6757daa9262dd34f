/// For modules whose effects reach an entity from outside of its rows, so that it cannot rest by itself.
#pragma once

#include "wisp/module/module.h"
#include "wisp/sleep.h"

WISP_BEGIN_C

/// Bounds of an entity, m.
typedef struct wisp_sleep_bounds
{
    float lower[3], upper[3];
} wisp_sleep_bounds;

/// What sleep has to know of a module. Called between passes, on the calling thread. Read rows with wisp_world_rows() here.
/// Zero-initialised members are never called.
typedef struct wisp_sleep_hooks
{
    /// Hash what acts on the entity from outside of its rows. It stays asleep as long as the hash stays the same.
    /// @return false if something acts on it that moves, so that it cannot rest
    bool ( *surroundings )( const void* state, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                            uint64_t* hash );
    /// @return m, distance at which the entity acts on others that reach it; below 0: on none
    float ( *reach )( const void* state, wisp_world* world, wisp_entity entity );
    /// The entity falls asleep: forget its velocities. Those of the engine are 0.
    void ( *rested )( const void* state, wisp_world* world, wisp_entity entity );
} wisp_sleep_hooks;

/// Does no pass run on the entity in this step, because it sleeps?
WISP_API bool wisp_frame_is_asleep( wisp_frame* frame, wisp_entity entity );

/// As wisp_world_column(), to read: counts as no change.
WISP_API const void* wisp_world_rows( const wisp_world* world, wisp_entity entity, wisp_component component,
                                      int column );
/// Compute the bounds of an entity with vertices, and of where its velocities take it in a step like the last one.
/// @return false if it has no vertices
WISP_API bool wisp_world_bounds( const wisp_world* world, wisp_entity entity, wisp_sleep_bounds* out );
/// @return whether the bounds touch when both reach out so far, m
WISP_API bool wisp_bounds_touch( const wisp_sleep_bounds* a, const wisp_sleep_bounds* b, float reach );
/// @return a 64-bit hash of bytes, chained through `seed`
WISP_API uint64_t wisp_hash_bytes( uint64_t seed, const void* bytes, size_t size );

WISP_END_C
