/// The clumps of the scene `frozen_clumps`, for the scene itself and for bench/reference.
#pragma once

#include "accuracy_reference.h"

#include "paper_implementations.h"

wisp_status frozen_clumps_make( paper_scene* out, wisp_error* error );
/// The default settings, with all neighbours.
wisp_frozen_hair_def frozen_clumps_default( const paper_scene* scene );
/// Many short steps of clumping, with the same total length as any other number.
wisp_frozen_hair_def frozen_clumps_flow( const paper_scene* scene, int steps );
/// Scene, facts and size of the reference: [vertices][3] m of the default result, then the same of the flow.
accuracy_reference frozen_clumps_reference( const paper_scene* scene );
