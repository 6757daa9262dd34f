/// The heavy elastica in closed form: a rod clamped horizontally that bends under its own weight.
#pragma once

/// theta'' = -G (1 - s) cos theta, theta(0) = 0, theta'(1) = 0, for a rod of length 1 that is clamped at the origin along +x and
/// hangs towards -y.
/// @param load G = weight times length^2 over EI, > 0
/// @param count of points at equal distances along the rod, at least 2
/// @param points [count] x and y
void elastica_lay( double load, int count, double ( *points )[2] );
