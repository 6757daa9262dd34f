/// Cases of sheets and strands whose motion or rest has a closed form.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_catenary; ///< a strip hung between two supports against the catenary
accuracy_scene_fn validate_incline;  ///< sheets on inclines against the law of Coulomb
accuracy_scene_fn validate_terminal; ///< sheets and balloons in air against their terminal speed
