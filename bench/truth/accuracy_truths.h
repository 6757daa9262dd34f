/// The truths of `wisp bench accuracy`: one function a scene that has no closed form.
#pragma once

#include "accuracy/accuracy_truth.h"

/// Fill in all of a truth. @param out also after a failure to be given to accuracy_truth_free()
typedef wisp_status accuracy_truth_fn( accuracy_truth* out, wisp_error* error );

accuracy_truth_fn truth_of_hanging_cloth, truth_of_flag, truth_of_balloon_flight, truth_of_balloon_meshes,
    truth_of_strands_swing, truth_of_strands_guides, truth_of_frozen_clumps;
