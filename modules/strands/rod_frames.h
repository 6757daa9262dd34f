// Frames of rods.
#pragma once

#include "strands_state.h"

/// Return the smallest rotation from the z axis to a direction.
wisp_quat strands_rotation_to( wisp_vec3 d );

/// Turn a frame by the smallest rotation that takes its z axis along e. Without a length it stays.
wisp_quat strands_carry_frame( wisp_quat q, wisp_vec3 e );

/// Turn a frame about its z axis. @param angle rad
wisp_quat strands_twist_frame( wisp_quat q, double angle );

/// Return the natural twist at vertex i of a strand of `count` vertices, rad. @param twist rad/m
double strands_natural_twist( const float* length, int row, int i, int count, int lane, double twist );

/// Add lines for the axes of frames: those of segments, or of clamps where segments have none. As wisp_state_hooks.lines.
void strands_add_frames( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                         wisp_line_list* list );

/// Lay the frames of a group from the clamps outward, with their natural twist.
/// @param length [row][16] m @param twist rad/m
void strands_lay_group( const wisp_strand_topology* topology, const float* position, const float* clamp,
                        const float* root, const float* length, float twist, float* frame, int group );
