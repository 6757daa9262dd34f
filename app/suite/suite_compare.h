/// How far a motion is from a reference: positions, fine curvature, energy.
#pragma once

#include "suite_match.h"

/// @param frame_count first frames that are compared
/// @param name of the motion, in messages
/// @return WISP_BAD_INPUT the motions have other bodies, or start elsewhere (the message names the body); WISP_NO_MEMORY
wisp_status suite_compare( const suite_motion* motion, const suite_motion* reference, int frame_count,
                           const char* name, suite_comparison* out, wisp_error* error );

/// The fine curvature of a motion's surfaces in parts of that of another one: the root of the ratio of both sums, over all inner vertices and
/// some first frames, of the squared normal part of the graph Laplacian (the mean of the neighbours less the vertex). The tangential part
/// is left out because it tells how even a mesh is.
/// @return NaN: there is no surface, the meshes differ, or the other one has no curvature
double suite_detail( const suite_motion* motion, const suite_motion* reference, int frame_count );
