/// State of the module. Private to this folder. Rows of vectors are [slot / 8][3][8], as lanes read them.
#pragma once

#include "motion_constraints.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

typedef struct motion_settings
{
    float stiffness[2];  // of largest distances and backstops; 1 by xpbd
    float compliance[2]; // m/N; 0 by pbd
    int32_t moves;       // motion_progress
} motion_settings;

/// What the start of a step has to do with the targets.
typedef enum motion_progress
{
    MOTION_STILL = 0,
    MOTION_ENDS = 1, // they moved in the last step
    MOTION_NEW = 2,  // they were moved since, or their limits changed
} motion_progress;

#define MOTION_SETTINGS( X ) X( motion_settings, settings, 1 )
#define MOTION_DISTANCE( X )                                                                                         \
    X( float, target, 3 )       /* m, at the end of the step */                                                      \
    X( float, displacement, 3 ) /* m, in the step */                                                                 \
    X( float, next, 3 )         /* m, targets of the host for the end of the next step */                            \
    X( float, max_distance, 1 ) /* m */                                                                              \
    X( float, bound, 4 )        /* of the kernel motion_targets */
#define MOTION_BACKSTOP( X )                                                                                         \
    X( float, normal, 3 )                                                                                            \
    X( float, change, 3 )                                                                                            \
    X( float, next, 3 )                                                                                              \
    X( float, distance, 1 )  /* m */                                                                                 \
    X( float, curvature, 1 ) /* 1/m */
/// Exists with several iterations of compliant constraints only.
#define MOTION_LAMBDA( X ) X( float, lambda, 2 ) /* N s^2, [slot / 8][2][8]; of the substep */

typedef struct motion_state
{
    wisp_component settings, distance, backstop, lambda;
    bool has_iterations;
} motion_state;
