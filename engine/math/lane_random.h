/// wisp_random_unit_float() in lanes, bit for bit: lane l draws the number of element (a[l], b[l], c[l]).
///
///   P_random_unit( key, a, b, c )     -> P in [0, 1), 24 bits
///   P_random_signed( key, a, b, c )   -> P in [-1, 1): 2 u - 1, exact
#pragma once

#include "lane.h"
#include "wisp/module/random.h"

#define LANE_P lane8
#include "lane_random_text.h"
#undef LANE_P

#define LANE_P lane16
#include "lane_random_text.h"
#undef LANE_P
