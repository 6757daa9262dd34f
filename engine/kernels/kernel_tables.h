/// Kernel tables, one per compiled instruction set.
#pragma once

#include "wisp/module/kernels.h"

/// Select the widest table that this processor supports and that `cap` allows.
/// @param cap "baseline", "avx2" or "avx512"; null: WISP_ISA in the environment, or no cap if that is unset
/// @return null if the name is unknown, or the build leaves out a set that this processor has; the message gives the name
const wisp_kernels* kernels_select( const char* cap, wisp_error* error );
