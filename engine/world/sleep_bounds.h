/// Bounds of entities, and which of them reach each other. For the files of sleep.
#pragma once

#include "world.h"

/// An entity that acts on others with contact.
typedef struct sleep_box
{
    wisp_sleep_bounds bounds; // m, with its motion in a step unless it sleeps
    float reach;              // m; below 0: it acts on none, or is halted
    bool is_still;            // it sleeps, or is going to
    double origin[3];         // m, of the bounds: those of others are not near
} sleep_box;

/// Return the row of an entity; null if it cannot sleep.
passes_sleep* sleep_state_of( const wisp_world* world, const store_entity* e );
/// Return the bounds in which an entity fell asleep.
wisp_sleep_bounds sleep_bounds_of( const passes_sleep* state );
/// Compute the bounds of an entity, and of where its velocities and targets take it in so many seconds. @return false without vertices
bool sleep_find_bounds( const wisp_world* world, const store_entity* e, float seconds, wisp_sleep_bounds* out );

/// Return room for a box of each slot, and for sleep_stir() behind them; null without memory.
sleep_box* sleep_reserve_boxes( wisp_world* world );
/// Compute bounds and reach of all entities. `is_still` stays.
void sleep_fill_boxes( wisp_world* world, sleep_box* boxes );
/// Entities that are still stir where one that is not reaches them, until none does.
/// @param room sleep_stir_bytes()
void sleep_stir( sleep_box* boxes, int count, void* room );
size_t sleep_stir_bytes( int count );
