// The check of the state at the end of a step.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_guard;
