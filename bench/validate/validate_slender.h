/// Cases of slender bodies under their own weight.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_cantilever; ///< tips against the heavy elastica
accuracy_scene_fn validate_tip_load;   ///< tips with a weight against the elastica
accuracy_scene_fn validate_column;     ///< the load at which an upright column gives way
accuracy_scene_fn validate_blade;      ///< the load at which a blade turns aside
