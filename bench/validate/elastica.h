/// The elastica in closed form: a rod clamped horizontally that bends under its own weight (Bickley 1934) and a
/// weight at its free end (Bisshopp and Drucker 1945).
#pragma once

/// theta'' = -( G (1 - s) + P ) cos theta, theta(0) = 0, theta'(1) = 0, for a rod of length 1 that is clamped at the
/// origin along +x and hangs towards -y.
/// @param load G = weight times length^2 over EI, >= 0
/// @param tip P = weight at the free end times length^2 over EI, >= 0
/// @param count of points at equal distances along the rod, at least 2
/// @param points [count] x and y
void elastica_lay_loaded( double load, double tip, int count, double ( *points )[2] );
/// The same without a weight at the free end.
void elastica_lay( double load, int count, double ( *points )[2] );
