// Contact generation: one block of particles against its bodies, in the order of the bodies.
#pragma once

#include "particle_contacts.h"

/// Add the contacts of a block with one body.
void collision_meet( const collision_find_args* args, const collision_view* view, collision_block* block );

/// Return the columns of the participant of a span, in its substep.
collision_find_args collision_find_args_of( wisp_frame* frame, const wisp_span* span, const collision_state* state );

/// Find the contacts of a block.
void collision_find_block( wisp_frame* frame, const wisp_span* span, const collision_find_args* args, int begin,
                           int end );

/// Find and project the contacts of some groups of a block, as bits, that keeps none.
void collision_find_and_project( wisp_frame* frame, const wisp_span* span, const collision_state* state, int begin,
                                 int end, uint32_t groups );

/// Load the contacts of particles that two bodies squeeze: see squeeze.c.
void collision_squeeze( const collision_find_args* args, const collision_block* block );

/// Do two contacts squeeze something of a thickness of `both` by a depth, m? @param oppose minus the product of their normals
bool collision_is_squeezed( float oppose, float depth, float both );

/// Return the correction with which two contacts begin the substep that squeeze something of a thickness of `both` by a depth, m.
float collision_squeeze_load( float dt, float oppose, float depth, float both );

/// Find two contacts of a particle that oppose each other and press. @return whether there are some
bool collision_find_loaded( const collision_contact* contacts, int count, int* first, int* second );

/// Take from loads what a body with a mass gives way to them within the substep.
void collision_unload( wisp_frame* frame, const collision_state* state, wisp_entity participant, int32_t body );
