/// Passes that every world has, and what their files share.
#pragma once

#include "wisp/module/module.h"

wisp_status passes_declare( wisp_registry* registry );

wisp_status passes_declare_particles( wisp_registry* registry );
wisp_status passes_declare_carry( wisp_registry* registry );
wisp_status passes_declare_levels( wisp_registry* registry );
wisp_status passes_declare_max_speed( wisp_registry* registry );
wisp_status passes_declare_tethers( wisp_registry* registry );
wisp_status passes_declare_uncarry( wisp_registry* registry );
wisp_status passes_declare_constraints( wisp_registry* registry );
wisp_status passes_declare_state_check( wisp_registry* registry );
wisp_status passes_declare_surface( wisp_registry* registry );
wisp_status passes_declare_instances( wisp_registry* registry );

/// Passes without a search after one that found no sharp folds: with a search links take a tenth longer.
#define PASSES_BETWEEN_FOLDS 7

/// Let a kernel of links find folded bend links, if the entity has link.folds: while there are some, and from time to time.
/// @return false if there is no memory for their bits, which is reported
bool passes_begin_folds( wisp_frame* frame, const wisp_span* span, wisp_link_args* args );

/// Project the hinges of folded bend links. Their order is that of the links, so bits do not depend on workers.
/// @param folded bits that a kernel of links has stored, from passes_begin_folds()
void passes_open_folds( wisp_frame* frame, const wisp_span* span, const uint64_t* folded );

/// Is a vertex of a triangle pinned? @param position [slot][4]
bool passes_has_pins( const wisp_fabric* fabric, const float* position );

/// Pass: find the folded hinges of an entity with hinge.folds, and project them.
void passes_open_hinges( wisp_frame* frame, const wisp_span* span, void* user );
