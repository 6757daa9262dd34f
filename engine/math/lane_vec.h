/// wisp/module/vec.h in lanes: eight or sixteen vectors of three floats, one a lane, operation by operation as there.
///
///   Pv_set1( v )  Pv_load( rows ) Pv_store( rows, v )     rows: all x, all y, all z, aligned as P_load
///   Pv_add Pv_sub Pv_scale Pv_mul_add Pv_dot Pv_cross Pv_length Pv_select
///   Pv_rotate( axis, sine, cosine, v )  Pv_basis( t, &b1, &b2 )
#pragma once

#include "lane.h"
#include "wisp/base.h"

#define LANE_P lane8
#define LANE_COUNT 8
#include "lane_vec_text.h"
#undef LANE_P
#undef LANE_COUNT

#define LANE_P lane16
#define LANE_COUNT 16
#include "lane_vec_text.h"
#undef LANE_P
#undef LANE_COUNT
