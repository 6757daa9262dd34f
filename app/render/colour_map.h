/// Numbers as colours. Both maps are curves in Oklab (Ottosson 2020), a space in which equal distances look equal, and
/// are computed here from that definition.
#pragma once

#include "wisp/base.h"

typedef enum colour_map
{
    COLOUR_MAP_RISING,    ///< dark violet, blue, green, yellow: lightness increases evenly, also in black and white
    COLOUR_MAP_DIVERGING, ///< blue, light grey in the middle, red: for values with a sign
} colour_map;

/// @param share in [0, 1], clamped. NaN is a mid grey, which neither map contains.
/// @return linear RGB in [0, 1]
wisp_vec3 colour_map_at( colour_map map, float fraction );

/// Colours of many values. Where low and high are equal, all are in the middle.
/// @param low, high the values at the ends of the map
/// @param colours [count] linear RGB
void colour_map_apply( colour_map map, const float* values, int count, float lower, float upper, wisp_vec3* colours );
