/// How far a motion is from a reference: positions, fine curvature, energy.
#pragma once

#include "suite_motion.h"

// ---- points that are the same place of a body, also where meshes differ: by the start of both ----

/// A place as a mean of up to three vertices.
typedef struct suite_place
{
    int vertices[3]; ///< of all points of a frame
    float weights[3];
} suite_place;

/// Places that two motions have in common: the vertices of the coarser body of each pair.
typedef struct suite_match
{
    suite_place *one, *other; ///< [count]
    int count;
} suite_match;

/// Match bodies by their names; those that only one motion has are left out. A place of a surface is sought on the triangles of the other one, a place of a strand at the same part of its
/// length.
/// @param out to be released, after a failure too
/// @return WISP_BAD_INPUT the bodies are others, or start elsewhere (the message names the body); WISP_NO_MEMORY
wisp_status suite_match_motions( const suite_motion* one, const suite_motion* other, const char* name,
                                 suite_match* out, wisp_error* error );
void suite_match_release( suite_match* match );

/// Root of the mean square distance over all places of some frames, m. NaN if a coordinate is.
/// @param most receives the largest distance, m; may be null
double suite_distance( const suite_match* match, const suite_motion* one, const suite_motion* other, int first_frame,
                       int frame_count, double* most );

/// Root of the mean square distance of all points of all frames from their start, m.
double suite_drift( const suite_motion* motion );

/// The diagonal of the box around all points at the start, m.
double suite_motion_size( const suite_motion* motion );

/// @param name of the motion, in messages
/// @return WISP_BAD_INPUT the motions have other bodies, or start elsewhere (the message names the body); WISP_NO_MEMORY
wisp_status suite_compare( const suite_motion* motion, const suite_reference* reference, const char* name,
                           suite_comparison* out, wisp_error* error );

/// The fine curvature of a motion's surfaces in parts of that of another one: the root of the ratio of both sums, over all inner vertices and
/// some frames, of the squared normal part of the graph Laplacian (the mean of the neighbours less the vertex). The tangential part
/// is left out because it tells how even a mesh is.
/// @return NaN: there is no surface, the meshes differ, or the other one has no curvature
double suite_detail( const suite_motion* motion, const suite_motion* reference, int first_frame, int frame_count );
