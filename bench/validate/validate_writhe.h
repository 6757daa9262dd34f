/// Cases of rods that have given way to twist in one place.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_writhe; ///< their shape and tension
accuracy_scene_fn validate_loop;   ///< the rotation at which they form a loop
