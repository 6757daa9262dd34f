// Strands on the way to a level of detail at which they are not solved.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_slow;

/// Whether the strands come to rest in this step.
bool strands_slow_is_due( wisp_frame* frame, wisp_entity strands, void* user );
