/// Frames of reference that move, such as the root of a character: a surface or strands feel only a fraction of the frame's motion,
/// and are carried along by the rest (local simulation of NvCloth: linear and angular inertia).
///
///     wisp_moving_frame_def frame = wisp_default_moving_frame_def();
///     frame.linear_inertia = 0.3f;
///     wisp_set_moving_frame( world, entity, &frame );
///     ...
///     wisp_move_frame( world, entity, pose );                                    // before each step
///     wisp_world_step( world, dt );
#pragma once

#include "wisp/shapes.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

/// Fill from wisp_default_moving_frame_def(). Copied.
typedef struct wisp_moving_frame_def
{
    uint32_t size;         ///< bytes; set by wisp_default_moving_frame_def()
    float linear_inertia;  ///< fraction of the frame's displacement that is felt, 0 .. 1, default 1
    float angular_inertia; ///< fraction of the frame's rotation, about its origin, that is felt, 0 .. 1, default 1
    wisp_transform pose;   ///< where the frame is now; default the identity
} wisp_moving_frame_def;

WISP_DEFINITION( moving_frame_def );

/// Give a surface, or strands that move, a frame, or replace it. In each substep the vertices that are not pinned are carried by what they do not feel of the
/// frame's motion: their positions go along, their velocities rotate with it and gain nothing. With 0 for both, a surface moves
/// relative to its frame as if that stood still, in gravity that keeps its direction. With 1 for both the frame is removed, and
/// there is no pass. Pins move only by wisp_move_pins(), motion targets only by wisp_move_motion_targets(). Collision and contact
/// see the whole motion in the world. Velocities that are read are without what carries. Roots of strands move only with their
/// head or surface; strands whose head teleports are carried by that alone.
/// @return WISP_BAD_INPUT a fraction is out of range, or the pose is not finite or beyond 1e6 m; WISP_CONFLICT the entity is neither a
///         surface nor strands with dynamics, or it has an external solver, which keeps earlier positions; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_moving_frame( wisp_world* world, wisp_entity entity, const wisp_moving_frame_def* def );

/// Move the frame so that it reaches a pose at the end of the next step, along a straight line and the shorter rotation. Without
/// another call it rests there. wisp_teleport() moves it with the surface. Does nothing if both fractions are 1.
/// @return WISP_BAD_INPUT the pose is not finite or beyond 1e6 m; WISP_CONFLICT the entity is neither a surface nor strands with dynamics
WISP_API wisp_status wisp_move_frame( wisp_world* world, wisp_entity entity, wisp_transform pose );

/// Limit the speed of each vertex: at the end of a substep a faster velocity is scaled down, and counted
/// (WISP_COUNT_SPEED_LIMITED). Internal damping of cloth comes after it.
/// @param speed m/s, > 0; infinite: no limit, and no pass
/// @return WISP_BAD_INPUT the speed is not above 0; WISP_CONFLICT the entity is neither a surface nor strands with dynamics; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_max_speed( wisp_world* world, wisp_entity entity, float speed );

WISP_END_C
