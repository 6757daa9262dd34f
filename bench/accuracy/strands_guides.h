/// The head of the scene `strands_guides`, for the scene itself and for bench/reference.
#pragma once

#include "accuracy_reference.h"

#include "strands_head.h"

enum
{
    SHAKE_SIDE = 24, // strands along an edge, a multiple of 4
    SHAKE_VERTICES = 20,
    SHAKE_STEPS = 45,
    SHAKE_OBSERVATION = 5,
    SHAKE_OBSERVATIONS = SHAKE_STEPS / SHAKE_OBSERVATION,
    // Compared: every fifth strand, so that every position in a block of 4 x 4 occurs, and every second vertex up to
    // the tip.
    SHAKE_STRIDE = 5,
    SHAKE_SEEN = ( SHAKE_SIDE * SHAKE_SIDE + SHAKE_STRIDE - 1 ) / SHAKE_STRIDE,
    SHAKE_SEEN_VERTICES = SHAKE_VERTICES / 2,
};

wisp_status shake_make_hair( strands_shape* out, wisp_error* error );
/// The number of a compared vertex. @param place in 0 .. SHAKE_SEEN * SHAKE_SEEN_VERTICES - 1 @return its index in
/// the shape
int shake_seen_vertex( int place );
/// Scene, facts and size of the reference, [observations][strands][vertices][3] m, of all strands simulated.
accuracy_reference strands_guides_reference( const strands_shape* hair );
