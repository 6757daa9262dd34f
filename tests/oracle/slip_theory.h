/// A weightless elastic rod or strip between a clamp and a rough floor, which its free end presses: the elastica clamped at one end and
/// hinged at the other of Sano, Yamaguchi and Wada 2017, in double precision. All lengths are in lengths of the rod.
///
/// The clamp is at the origin and points straight at the floor, along x. Of the two ways to bow it bows to +y.
///
///     theta'' = F_x sin theta - F_y cos theta,   theta(0) = 0,   theta'(1) = 0,   tip at (height, aside)
///
/// with the force F of the floor on the tip in EI / L^2. The tip sticks as long as |F_y| <= mu |F_x|.
#pragma once

#include <stdbool.h>

enum
{
    SLIP_PIECES = 256,
};

typedef struct slip_shape
{
    double theta[SLIP_PIECES + 1]; ///< rad, of the tangent from x, at equal distances from the clamp to the tip
    double bend;                   ///< theta'(0)
    double force[2];               ///< F
    double ratio;                  ///< |F_y / F_x|: the smallest mu with which the tip sticks
} slip_shape;

/// The equilibrium that follows from the first mode of buckling as the clamp is lowered, its tip held.
/// @param height of the clamp over the floor, 0.3 to 0.985 @param aside of the tip, -0.1 to 0.1
/// @return false: not found
bool slip_stand( double height, double aside, slip_shape* out );

/// The angle at a distance from the clamp, between pieces.
double slip_angle( const slip_shape* shape, double s );
