/// The fall of the scene `strands_swing`, for the scene itself and for bench/truth.
#pragma once

#include "accuracy_truth.h"

#include "strands_bench.h"

/// Scene, facts and size of the truth of one strand, [STRANDS_VERTICES][2] m, how far along and how high: all fall alike, each
/// in the plane of its own direction.
accuracy_truth strands_swing_truth( void );
