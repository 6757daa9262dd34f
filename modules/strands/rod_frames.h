// Frames of rods.
#pragma once

#include "wisp/module/module.h"

/// Return the smallest rotation from the z axis to a direction.
wisp_quat strands_rotation_to( wisp_vec3 d );

/// Turn a frame by the smallest rotation that takes its z axis along e. Without a length it stays.
wisp_quat strands_carry_frame( wisp_quat q, wisp_vec3 e );

/// Lay the frames of a group from the clamps outward, without twist.
void strands_lay_group( const wisp_strand_topology* topology, const float* position, const float* clamp,
                        const float* root, float* frame, int group );
