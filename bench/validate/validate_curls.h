/// Cases of rods with a natural curvature that hang from a clamp.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_curl;       ///< tips in the plane of the curl
accuracy_scene_fn validate_bend_twist; ///< the weight at which curls leave their plane
