/// Arguments of the kernels of skinning. All arrays as in wisp/skin.h.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Arguments of skinning of groups of eight points that follow the same number of bones.
typedef struct wisp_skin_args
{
    const float* xyz;            ///< [group][3][8] m, the bind pose, aligned to 32 bytes
    const int32_t* point;        ///< [group][8] where a point goes
    const int32_t ( *bones )[4]; ///< [group][8] bones of a point
    const float ( *weights )[4]; ///< [group][8] sum to 1, the first is the largest; aligned to 16 bytes
    const float* rows;           ///< [bone][16] of wisp_skin_pose, aligned to 16 bytes
    wisp_vec3* out;              ///< [point] m
    int influence_count;         ///< 1 .. 4 bones that a point follows
} wisp_skin_args;

WISP_END_C
