// The check of the state at the end of a step.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_guard, strands_mend_tension, strands_mend_frames;

/// Return whether an entity was restored in this step.
bool strands_is_faulty( wisp_frame* frame, wisp_entity entity, void* user );
