/// How bodies begin: vertices that are somewhere else than at rest.
#pragma once

#include "stability.h"

/// The box around points.
typedef struct stability_box
{
    double lower[3], upper[3], middle[3];
    double size; ///< the longest edge, m
} stability_box;

stability_box stability_box_of( const wisp_vec3* points, int count );

/// Where vertices begin. @param origin that is reflected in @param rest [count] @param out [count]
void stability_place( stability_start start, const stability_box* box, const double origin[3], const wisp_vec3* rest,
                      int count, wisp_vec3* out );

double stability_distance( wisp_vec3 a, wisp_vec3 b );
/// The farthest way between two sets of points; NaN if a coordinate is.
double stability_farthest( const wisp_vec3* a, const wisp_vec3* b, int count );
/// Steps of these seconds in a time, at least one.
int stability_frames( double seconds, double step );

/// What all bodies of a size are held to; the caller adds energy, and what is special to it.
/// @param scale of lengths, that times go with @param substep s
stability_limits stability_usual_limits( double size, double scale, double step, double substep );
/// s, that a body of this scale is watched.
double stability_duration( double scale );

/// What hangs on soft links bounces slowly: it comes to rest while it is watched only if they are stretched less than this.
#define STABILITY_SOFT 4.0
