/// The references of `wisp bench accuracy`: one function per scene without a closed form.
#pragma once

#include "accuracy/accuracy_reference.h"

/// Fill in all fields of a reference. @param out to be given to accuracy_reference_free() even after a failure
typedef wisp_status accuracy_reference_fn( accuracy_reference* out, wisp_error* error );

accuracy_reference_fn reference_of_balloon_flight, reference_of_balloon_meshes;
