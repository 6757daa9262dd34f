/// The tables: one a compiled instruction set.
#pragma once

#include "wisp/module/kernels.h"

/// The widest table that this processor can run and that `cap` allows.
/// @param cap "baseline", "avx2" or "avx512"; null: WISP_ISA in the environment, or no cap if that is unset
/// @return null for another word; the message names it
const wisp_kernels* kernels_select( const char* cap, wisp_error* error );
