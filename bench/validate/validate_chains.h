/// Cases of chains: strands without bending.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_chain;        ///< hanging chains swing in their two slowest modes
accuracy_scene_fn validate_folded_chain; ///< the free end of a folded chain falls faster than a stone
