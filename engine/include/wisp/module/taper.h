/// A tapered capsule as a family of balls: their centres are on the y axis and their radii linear in y. The distance of a point
/// from the hull of all balls is its distance from the ball around
///
///   c = clamp( y - slope rho, lower, upper ),   radius( c ) = middle - sine c,   rho^2 = x^2 + z^2
///
/// because the distance from the ball around c is a convex function of c, and its minimum is where the vector from c to the point
/// has the constant sine of the cone. With equal radii the sine is 0, and all operations are those of a capsule.
#pragma once

#include <math.h>

#include "wisp/module/shapes.h"

typedef struct wisp_taper
{
    double lower, upper; // m, of the centres on the y axis
    double middle;       // m, radius at y = 0
    double sine, cosine; // of the angle between the normals of the cone and the xz plane
    double slope;        // sine / cosine
} wisp_taper;

static inline wisp_taper wisp_taper_of( const wisp_shape* s )
{
    const double top = (double)s->top_radius, bottom = (double)s->bottom_radius, half = (double)s->half_length;
    const double difference = bottom - top, length = 2.0 * half;
    // one ball holds the other
    const bool is_ball = fabs( difference ) >= length;
    const double centre = difference > 0.0 ? -half : ( difference < 0.0 ? half : 0.0 ),
                 sine = is_ball ? 0.0 : difference / length, cosine = sqrt( 1.0 - sine * sine );
    wisp_taper t;
    t.lower = is_ball ? centre : -half;
    t.upper = is_ball ? centre : half;
    t.middle = is_ball ? ( top > bottom ? top : bottom ) : 0.5 * ( top + bottom );
    t.sine = sine;
    t.cosine = cosine;
    t.slope = sine / cosine;
    return t;
}
