/// The references of `wisp bench accuracy`: one function a scene that has no closed form.
#pragma once

#include "accuracy/accuracy_reference.h"

/// Fill in all of a reference. @param out also after a failure to be given to accuracy_reference_free()
typedef wisp_status accuracy_reference_fn( accuracy_reference* out, wisp_error* error );

accuracy_reference_fn reference_of_hanging_cloth, reference_of_flag, reference_of_balloon_flight,
    reference_of_balloon_meshes, reference_of_strands_swing, reference_of_strands_guides, reference_of_frozen_clumps;
