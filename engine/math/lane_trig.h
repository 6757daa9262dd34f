/// trig.h in lanes, bit for bit, with the same bounds:
///
///   P_sincos( x, &sine, &cosine )
///   P_atan2( y, x )
#pragma once

#include "lane.h"

#define LANE_P lane8
#include "trig_text.h"
#undef LANE_P

#define LANE_P lane16
#include "trig_text.h"
#undef LANE_P
