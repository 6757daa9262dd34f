// Statistics of strands.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_compute_motion_stats, strands_scatter_strain, strands_scatter_speed;
