// Definition of strands.
#pragma once

#include "strands_state.h"

/// Find the state of the module for an entity. @return WISP_CONFLICT the module is not registered, or the entity has no
/// strands with dynamics; WISP_STALE_ID it does not exist
wisp_status strands_find( wisp_world* world, wisp_entity strands, strands_state** state );

/// Check a definition against its ranges, itself and the strands. @return WISP_BAD_INPUT, WISP_CONFLICT
wisp_status strands_check_definition( wisp_world* world, wisp_entity strands, const strands_state* state,
                                      const wisp_strand_dynamics_def* def );
/// @return WISP_BAD_INPUT a vector is not finite or longer than `most`
wisp_status strands_check_vector( wisp_world* world, const char* name, wisp_vec3 v, float most );

/// Lay the frames of rods along the present shape, with their natural twist.
void strands_lay_frames( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Mark rest curvature as outdated; the next step computes it.
void strands_reset_rest( wisp_world* world, wisp_entity strands, const strands_state* state );
