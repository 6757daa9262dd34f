/// Bending of xpbd cloth: a matrix a surface, kept by the module, and the pass that solves with it.
#pragma once

#include "cloth_internal.h"

/// @return index of the plate of a surface, -1 without
int cloth_find_plate( const cloth_state* state, wisp_entity entity );
/// Cook the plate of a surface, unless it has one.
wisp_status cloth_add_plate( wisp_world* world, cloth_state* state, wisp_entity surface );
void cloth_remove_plate( cloth_state* state, wisp_entity entity, const wisp_allocator* allocator );

/// The pass.
void cloth_bend( wisp_frame* frame, const wisp_span* span, void* user );
