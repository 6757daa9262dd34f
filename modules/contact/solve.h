// Projection of contact constraints.
#pragma once

#include "constraints.h"
#include "contact_mesh.h"

/// Begin an iteration: the first one with the impulses that pairs had in the substep before.
void contact_begin_rows( const contact_work* work, bool is_first );

/// Keep the impulses for the next substep.
void contact_keep_impulses( const contact_work* work );

/// Project all constraints once, with friction.
/// @param is_turn those alone that were near at the last call without it
void contact_project_rows( const contact_work* work, bool is_turn );

/// Push pairs apart that are closer than their gap, at a bounded speed and without giving them velocity.
void contact_recover( const contact_work* work );

enum
{
    CONTACT_COLOURS = 64,
};

/// Fixed blocks of constraints, each of one kind. Blocks of one colour share no point.
typedef struct contact_colouring
{
    int count;
    int32_t* begin;                      // [count + 1] first row
    int32_t* colour_of;                  // [count]
    int32_t* order;                      // [count] blocks by colour
    int32_t colour[CONTACT_COLOURS + 1]; // first of a colour in `order`
    uint64_t* of_point;                  // [point] a bit for each colour that has it
    float** hold;                        // [point] half space that presses on it most; null: none
    uint64_t* near;                      // [count] a bit for each row that presses or nearly does
    wisp_buffer buffers[4], point_buffer;
} contact_colouring;

/// Make room for the points of the contact mesh.
/// @return false without memory
bool contact_reserve_colouring( const contact_work* work );

/// Cut the constraints into blocks and colour them.
wisp_status contact_colour_rows( const contact_work* work, wisp_error* error );
