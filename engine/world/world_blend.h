/// Points between two steps, for hosts whose frames do not fall on steps.
#pragma once

#include "world.h"

/// Keep the points of the last step. @return false without memory
bool world_keep_points( wisp_world* world );
/// Show points between the kept ones and those of the last step. Without kept points views stay as they are.
/// @param weight of the last step, in [0, 1]
void world_blend_points( wisp_world* world, float weight );

/// @return interpolated rows of an entity, null if the last call was not wisp_world_advance() or the component has none
const void* world_blended_rows( const wisp_world* world, const store_entity* e, wisp_component component );
/// @return points of the step before the last, to be interpolated from; null if none are kept
void* world_kept_rows( wisp_world* world, const store_entity* e, wisp_component component );
