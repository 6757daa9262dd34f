/// The vocabulary that modules share. A component that only one module touches lives in that module.
#pragma once

#include "wisp/wisp.h"

/// One line a component: X( enumerator, "name", table, column list )
#define WISP_SHARED_COMPONENTS( X )                                                                                  \
    X( STRAND_REST, "strand.rest", WISP_TABLE_STRAND_ROW )                                                           \
    X( STRAND_POSITION, "strand.position", WISP_TABLE_STRAND_ROW )                                                   \
    X( STRAND_STIFFNESS, "strand.stiffness", WISP_TABLE_STRAND_GROUP )                                               \
    X( STRAND_POINTS, "strand.points", WISP_TABLE_POINT )                                                            \
    X( POINT_WIDTH, "point.width", WISP_TABLE_POINT )                                                                \
    X( POINT_COLOUR, "point.colour", WISP_TABLE_POINT )

#define WISP_STRAND_REST_COLUMNS( X ) X( float, rest, 48 )         /* m, [3][16] a row, as the user gave it */
#define WISP_STRAND_POSITION_COLUMNS( X ) X( float, position, 48 ) /* m, [3][16] a row */
#define WISP_STRAND_STIFFNESS_COLUMNS( X )                                                                           \
    X( float, stretch, 16 ) /* k_s, no unit: 1/k is the relative change of length allowed */                         \
    X( float, bend, 16 )    /* k_b, no unit: 1/k is the share of the largest angle allowed */
#define WISP_STRAND_POINTS_COLUMNS( X ) X( wisp_vec3, points, 1 ) /* m, the user's order */
#define WISP_POINT_WIDTH_COLUMNS( X ) X( float, width, 1 )        /* m, diameter */
#define WISP_POINT_COLOUR_COLUMNS( X ) X( wisp_vec3, colour, 1 )  /* linear red, green, blue in [0, 1] */
