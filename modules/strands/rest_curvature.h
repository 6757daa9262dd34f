// Rest curvature and twist of curled rods.
#pragma once

#include "strands_state.h"

/// Pass strands.rest, due when the length of a substep changes: the stiffness that a substep can solve depends on it.
bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user );
