/// The rotation of a body by its inertia, in double precision.
#pragma once

#include "wisp/base.h"

#include <math.h>

static inline void wisp_cross_product( const double a[3], const double b[3], double out[3] )
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/// Solve I w = L for a symmetric I by its adjugate. Where all mass lies on a line I has no inverse, but its two
/// moments across the line are equal, each half the trace, and L is across it too. With all mass at one point w is 0. A body 350
/// times as long as wide counts as a line, because its moment about itself is within the rounding of the sums.
/// @param i xx, yy, zz, xy, xz, yz of I
static inline void wisp_solve_inertia( const double i[6], const double l[3], double w[3] )
{
    const double xx = i[0], yy = i[1], zz = i[2], xy = i[3], xz = i[4], yz = i[5];
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double determinant = xx * a + xy * b + xz * c, scale = xx + yy + zz;
    if ( fabs( determinant ) <= 1e-6 * scale * scale * scale )
    {
        for ( int k = 0; k < 3; ++k )
        {
            w[k] = scale > 0.0 ? 2.0 * l[k] / scale : 0.0;
        }
        return;
    }
    const double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
    w[0] = ( a * l[0] + b * l[1] + c * l[2] ) / determinant;
    w[1] = ( b * l[0] + d * l[1] + e * l[2] ) / determinant;
    w[2] = ( c * l[0] + e * l[1] + f * l[2] ) / determinant;
}
