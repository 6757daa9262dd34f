/// The fall of the scene `strands_swing`, for the scene itself and for bench/reference.
#pragma once

#include "accuracy_reference.h"

#include "strands_bench.h"

/// Scene, facts and size of the reference of one strand, [STRANDS_VERTICES][2] m, horizontal distance and height: all
/// strands fall alike, each in the plane of its own direction.
accuracy_reference strands_swing_reference( void );
