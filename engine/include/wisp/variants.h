/// Variants of a method that a host chooses and the engine computes.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// How the brake reads a change of distance (Kim 2026, eq. 17-18, and other readings of it).
typedef enum wisp_gap
{
    WISP_GAP_ABSOLUTE = 0, ///< |r1 - r0|, a large change brakes
    WISP_GAP_SIGNED = 1,   ///< r1 - r0, equations as printed
    WISP_GAP_REVERSED = 2, ///< r0 - r1 in the printed law
    WISP_GAP_NONE = 3,     ///< no brake
} wisp_gap;

WISP_END_C
