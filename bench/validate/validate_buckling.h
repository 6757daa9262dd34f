/// Cases of rods that give way to twist.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_ring;    ///< the twist at which a ring leaves its plane
accuracy_scene_fn validate_twisted; ///< the moment at which a rod under tension is no longer straight
