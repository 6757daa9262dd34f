/// Start states of bodies: vertices away from their rest positions.
#pragma once

#include "stability.h"

/// The box around points.
typedef struct stability_box
{
    double lower[3], upper[3], middle[3];
    double size; ///< the longest edge, m
} stability_box;

stability_box stability_box_of( const wisp_vec3* points, int count );

/// Start positions of vertices. @param origin centre of reflection @param rest [count] @param out [count]
void stability_place( stability_start start, const stability_box* box, const double origin[3], const wisp_vec3* rest,
                      int count, wisp_vec3* out );

double stability_distance( wisp_vec3 a, wisp_vec3 b );
/// The largest distance between two sets of points; NaN if a coordinate is.
double stability_farthest( const wisp_vec3* a, const wisp_vec3* b, int count );
/// Steps of these seconds in a time, at least one.
int stability_frames( double seconds, double step );

/// Limits common to all bodies of a size; the caller adds energy and special limits.
/// @param scale of lengths, which determines times @param substep s
stability_limits stability_usual_limits( double size, double scale, double step, double substep );
/// s, duration for a body of this scale.
double stability_duration( double scale );

/// Bodies on soft links bounce slowly: they come to rest in time only if their strain is below this.
#define STABILITY_SOFT 4.0
