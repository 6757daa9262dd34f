/// A folded chain that falls, in double precision: of masses, by integration, and continuous, in closed form.
#pragma once

#include <stdbool.h>

/// When and how fast the free end of a chain has fallen so far.
typedef struct chain_fall
{
    double time;         ///< of sqrt( L / g )
    double speed;        ///< downwards, of sqrt( g L )
    double energy_error; ///< of the chain against its start, over its weight times its length
    double length_error; ///< largest |l / l0 - 1| of the links
} chain_fall;

/// A chain of length 1 that is folded to one link wide: down, across and up, both of its ends at one height.
/// @param links odd, at least 3 @param points [links + 1] x and y, y upwards, the first one at the origin
void chain_fold( int links, double ( *points )[2] );

/// Rigid links between masses of half of their neighbours, as by Lagrange's equations of the first kind: the
/// tensions of all links follow from their constraints at each stage of a Runge-Kutta step. The first mass is held,
/// all start at rest.
/// @param points [links + 1] links of one length, 1 together @param depth that the last mass falls
/// @param steps for a time of 1; what is left is of the fourth order
/// @return false: too many links, or it never falls so deep within a time of 4
bool chain_fall_of_masses( int links, const double ( *points )[2], double depth, int steps, chain_fall* out );

/// The same of a continuous chain folded to no width, which loses no energy: v^2 = x ( 2 - x ) / ( 1 - x ) (Calkin
/// and March 1989), in time and speed.
chain_fall chain_fall_continuous( double depth );
