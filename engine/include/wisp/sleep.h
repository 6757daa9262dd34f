/// Sleep: an entity that rests is left out of every pass until something touches it.
///
///     wisp_sleep_def sleep = wisp_default_sleep_def();
///     wisp_set_sleep( world, surface, &sleep );
///     wisp_world_step( world, dt );
///     if ( wisp_is_asleep( world, surface ) ) ...
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Fill from wisp_default_sleep_def(). Copied.
typedef struct wisp_sleep_def
{
    uint32_t size;   ///< bytes; set by wisp_default_sleep_def()
    bool enabled;    ///< default true; false: the entity never sleeps, and has no column and no pass for it
    float max_speed; ///< m/s, 0 .. 1e6, default 0.02: of the displacement of each vertex over a step
    float seconds;   ///< s, 0 .. 1e6, default 0.5: simulated time for which all vertices stay below it
} wisp_sleep_def;

WISP_DEFINITION( sleep_def );

/// Let an entity sleep, or change when it does; it wakes. Entities do not sleep unless this is called.
///
/// It falls asleep at the end of a step if no vertex moved faster than `max_speed` during `seconds`. Speed is the displacement over a
/// step, so what trembles within a step and returns counts as still. Velocities become 0, positions stay. Bodies that it touches
/// must be at rest too, as must the surfaces that it is rooted in or attached to. Entities with contact whose bounds overlap fall asleep
/// together, in the step in which the last of them is ready.
///
/// Asleep, no pass runs on it. It wakes at the start of a step if
///  - a call has changed a value of it: pins, forces, definitions, positions, velocities, maps, targets, frames, requests. A call that
///    sets what was there already does not wake it;
///  - a body that it collides with moves, appears or disappears within reach of its bounds;
///  - an entity with contact that is awake reaches its bounds;
///  - the surface that it is rooted in or attached to, or one that it collides with, is awake.
/// It feels a surface that wakes one step later. Everything is decided from the state alone, so results do not depend on
/// the number of workers, and snapshots hold it.
/// @param entity a surface, or strands that move
/// @return WISP_BAD_INPUT a number is out of range; WISP_CONFLICT the entity does not move; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_sleep( wisp_world* world, wisp_entity entity, const wisp_sleep_def* def );

/// @return true if the entity sleeps; false also if it was removed
WISP_API bool wisp_is_asleep( const wisp_world* world, wisp_entity entity );

WISP_END_C
