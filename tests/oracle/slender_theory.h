/// Loads at which slender things under their own weight lose their shape, from the linear equations of their time, in double precision.
#pragma once

/// An upright column, clamped below: theta'' + G (1 - s) theta = 0, theta(0) = 0, theta'(1) = 0 (Greenhill 1881).
/// @return the smallest G = rho g L^3 / EI with a solution
double slender_column_load( void );

/// A blade that is clamped level, on edge: phi'' + k^2 (1 - s)^4 / 4 phi = 0, phi(0) = 0, phi'(1) = 0, for its twist phi (Michell 1899,
/// Prandtl 1899), stiff in its plane.
/// @return the smallest k = rho g L^3 / sqrt( EI GJ ) with a solution
double slender_blade_load( void );
