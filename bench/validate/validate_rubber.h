/// Rubber balloons: the pressure of a sphere with a neo-Hookean skin against its size, over the limit point.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_rubber;
