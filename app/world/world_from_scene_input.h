/// What a user does to a world while it runs: takes hold of a vertex, moves a collider, changes gravity and wind. All of it acts
/// from the next step on, and equal calls before equal steps give equal bits.
#pragma once

#include "world_from_scene.h"

/// A vertex that a user holds.
typedef struct scene_hold
{
    int body, vertex;
    bool was_pinned; ///< of a surface: the scene pins the vertex too
    wisp_vec3 from;  ///< of strands: where the vertex was; m
    wisp_vec3 head;  ///< of strands: how far the head had been dragged then; m
} scene_hold;

/// Take hold of a vertex: of a surface it is pinned; of strands their head comes along.
/// @return WISP_BAD_INPUT no such body or vertex; WISP_CONFLICT the body is not free to be dragged (the message says why)
wisp_status scene_world_grab( scene_world* world, int body, int vertex, scene_hold* out, wisp_error* error );
/// Have a held vertex reach a place at the end of the next step. @param target m
wisp_status scene_world_drag( scene_world* world, const scene_hold* hold, wisp_vec3 target, wisp_error* error );
/// Free a vertex, unless the scene pins it. A head stays where it is.
wisp_status scene_world_let_go( scene_world* world, const scene_hold* hold, wisp_error* error );

/// Have a collider reach a place at the end of the next step, with the rotation that it has. @param place m, of its own origin
/// @return WISP_BAD_INPUT no such body; WISP_CONFLICT it is no collider, or keyframes move it
wisp_status scene_world_move_collider( scene_world* world, int body, wisp_vec3 place, wisp_error* error );

/// Set the gravity of all that moves. @param gravity m/s^2
wisp_status scene_world_set_gravity( scene_world* world, wisp_vec3 gravity, wisp_error* error );
/// Set the wind of all that feels air: cloth, and strands with drag. Cloth without air gets drag with its first wind.
/// @param wind m/s @param felt receives how many entities feel it
wisp_status scene_world_set_wind( scene_world* world, wisp_vec3 wind, int* felt, wisp_error* error );
