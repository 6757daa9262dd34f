/// Each file of kernel_sources is compiled once per instruction set, named by WISP_KERNEL_ISA. The same function
/// has one symbol per table. Helpers stay static.
#pragma once

#include "lane_vec.h"

#include "wisp/fabric.h"
#include "wisp/skin.h"
#include "wisp/module/kernels.h"

#include <float.h>

#define KERNEL( name ) LANE_JOIN( name##_, WISP_KERNEL_ISA )

/// Minimum squared length of a vector with a direction. Below it the vector loses significant digits.
#define KERNEL_MIN_SQUARED 1e-30f

#define WISP_KERNEL( result, name, ... ) result KERNEL( name )( __VA_ARGS__ );
#include "wisp/module/kernel_list.h"
