// All substeps in one pass.
#pragma once

#include "wisp/module/module.h"

wisp_fused_fn strands_substeps;
