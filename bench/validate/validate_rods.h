/// Cases of rods that are bent and twisted in space, by strands alone.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_ring;    ///< the twist at which a ring leaves its plane
accuracy_scene_fn validate_twisted; ///< the moment at which a rod under tension is no longer straight
accuracy_scene_fn validate_writhe;  ///< rods that have given way to twist in one place
