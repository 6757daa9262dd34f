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

/// The components, a row each: X( member, "name", table, columns ).
#define MOTION_COMPONENTS( X )                                                                                       \
    X( settings, "motion_constraints.settings", ENTITY, WISP_COLUMN( motion_settings, settings, 1 ) )                \
    X( distance, "motion_constraints.distance", PARTICLE,                                                            \
       WISP_COLUMN( float, target, 3 ),       /* m, at the end of the step */                                        \
       WISP_COLUMN( float, displacement, 3 ), /* m, in the step */                                                   \
       WISP_COLUMN( float, next, 3 ),         /* m, targets of the host for the end of the next step */              \
       WISP_COLUMN( float, max_distance, 1 ), /* m */                                                                \
       WISP_COLUMN( float, bound, 4 ) /* of the kernel motion_targets */ )                                           \
    X( backstop, "motion_constraints.backstop", PARTICLE, WISP_COLUMN( float, normal, 3 ),                           \
       WISP_COLUMN( float, change, 3 ), WISP_COLUMN( float, next, 3 ), WISP_COLUMN( float, distance, 1 ), /* m */    \
       WISP_COLUMN( float, curvature, 1 ) /* 1/m */ )                                                                \
    X( lambda, "motion_constraints.lambda", PARTICLE,                                                                \
       WISP_COLUMN( float, lambda, 2 ) ) /* N s^2, [slot / 8][2][8]; of the substep */

typedef struct motion_state
{
    MOTION_COMPONENTS( WISP_COMPONENT_MEMBER )
    bool has_iterations;
} motion_state;
