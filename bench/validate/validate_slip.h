/// A case of friction and elasticity together.
#pragma once

#include "validate_bodies.h"

enum
{
    VALIDATE_SLIP_MAX_CELLS = 32,
};

accuracy_scene_fn validate_stick_slip; ///< the friction with which the tip of a bowed rod or strip sticks

/// A start for the engine: the first cell straight, for that is how a clamp is said, the tip on the floor, and the elastica between.
/// @param height of the clamp in lengths @param shape [cells + 1]
wisp_status validate_slip_lay( double height, int cells, validate_point* shape, wisp_error* error );
