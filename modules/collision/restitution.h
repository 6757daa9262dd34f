// Velocities with which particles leave bodies that have a restitution.
#pragma once

#include "particle_contacts.h"

/// Return the normal velocity with which a particle leaves if the body pushes it, m/s; -infinity if it does not bounce.
float collision_bounce( const collision_find_args* args, const collision_view* view, const collision_contact* c,
                        int slot );

/// Give surfaces a column for that while a body has a restitution.
wisp_status collision_update_bounces( wisp_world* world, collision_state* state );
