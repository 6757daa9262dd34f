/// Pins of a surface that go along with another surface: the waist of a skirt on the skin of a character, a flag on a sail.
/// A pin keeps its place against the triangle that is closest to it when it is attached: barycentric coordinates, and an offset
/// that turns with the triangle.
///
///     wisp_attach_pins( world, skirt, waist, waist_count, figure );
///     wisp_move_pins( world, figure, all, skinned, vertex_count );    // before each step, as always
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_attachments_module;

/// Pin vertices where they are and attach them to the closest points of another surface. From the next step on they reach, at the
/// end of each step, where that surface takes them: pinned vertices of it count with their targets, others as moving on
/// with the velocity that they have at the start of the step. Vertices that were attached before change their place. The other surface
/// is not pulled. Strands have wisp_root_strands().
/// @param vertices [count] in the user's order
/// @param to another surface, with triangles, which has no attached pins itself
/// @return WISP_BAD_INPUT a vertex is out of range; WISP_CONFLICT the module is not registered, `to` is the surface itself, has
///         no triangles or has attached pins, or pins are attached to `surface`; WISP_STALE_ID; WISP_NO_MEMORY. Nothing changes then
WISP_API wisp_status wisp_attach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                                       wisp_entity to );

/// Detach vertices: they stay pinned where they are, and wisp_move_pins() or wisp_unpin() is free to take them. Vertices that
/// are not attached are left as they are. Unpinning a vertex, and removing the other surface, detach too.
/// @param vertices [count] in the user's order
/// @return WISP_BAD_INPUT a vertex is out of range; WISP_CONFLICT the module is not registered; WISP_STALE_ID
WISP_API wisp_status wisp_detach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count );

WISP_END_C
