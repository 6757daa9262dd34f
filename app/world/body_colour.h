/// Colours of the bodies of a scene, the same in pictures and recordings.
#pragma once

#include "world_from_scene.h"

/// Return the linear colour of the next body of a scene. @param cloths, balloons 0 before the first; they are counted
wisp_vec3 scene_body_colour( scene_body_kind kind, int* cloths, int* balloons );
