/// The bodies of a world between its last two steps, for recordings with more frames than steps. Ghosts are on the cubic
/// Hermite curves of wisp_ghosts_between(), which pass through both steps without a corner; all other points, and what
/// collisions and frozen hair add to ghosts, move along straight lines.
#pragma once

#include "run_bodies.h"

typedef struct run_between run_between;

/// @param world must outlive it; its scene has frames_per_step > 1
/// @return null without memory
run_between* run_between_open( const run_bodies* bodies, scene_world* world );

/// Note the points of `bodies`, which run_bodies_load() has filled, as those of the last step.
/// @return WISP_CONFLICT, with a message, if ghosts do not keep what is needed
wisp_status run_between_note( run_between* between, wisp_error* error );

/// Compute the points at a fraction of the time between the last two steps noted.
/// @param fraction in (0, 1)
/// @param points receives [body_count] arrays that are valid until the next call
wisp_status run_between_at( run_between* between, float fraction, const wisp_vec3* const** points,
                            wisp_error* error );

/// Null is allowed.
void run_between_close( run_between* between );
