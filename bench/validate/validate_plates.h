/// Cases of sheets that are wide enough to bend both ways, under their own weight.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_lateral_buckling; ///< the load at which a level sheet on edge turns aside
accuracy_scene_fn validate_plate_column;     ///< the load at which an upright sheet gives way
