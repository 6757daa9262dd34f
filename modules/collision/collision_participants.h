// Participants: surfaces and strands that collide.
#pragma once

#include "collision_state.h"

/// Attach the components of contact to all participants that are enabled, while there is a body, and detach them from
/// the rest. Without memory nothing changes.
wisp_status collision_update_components( wisp_world* world, collision_state* state );
/// The same when one body came or went, which changes nothing for most participants.
wisp_status collision_update_for( wisp_world* world, collision_state* state, const collision_body* body );

/// Remove an entity from the list of participants. @return whether it was there
bool collision_forget_participant( collision_state* state, wisp_entity participant );
