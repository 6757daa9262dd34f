/// Loads at which slender things under their own weight lose their shape, from the linear equations of their time, in double precision.
#pragma once

#include <stdbool.h>

/// An upright column, clamped below: theta'' + G (1 - s) theta = 0, theta(0) = 0, theta'(1) = 0 (Greenhill 1881).
/// @return the smallest G = rho g L^3 / EI with a solution
double slender_column_load( void );

/// A blade that is clamped level, on edge: phi'' + k^2 (1 - s)^4 / 4 phi = 0, phi(0) = 0, phi'(1) = 0, for its twist phi (Michell 1899,
/// Prandtl 1899), stiff in its plane.
/// @return the smallest k = rho g L^3 / sqrt( EI GJ ) with a solution
double slender_blade_load( void );

// ---- rod theory ----

/// The twist at which a ring leaves its plane: 2 pi sqrt( 3 ) EI / GJ (Michell 1889; Zajac 1962; Goriely 2006).
/// @param ratio GJ / EI @return rad, from end to end
double rod_ring_twist( double ratio );

/// The moment at which a rod under tension is no longer straight, whose ends keep their directions while one of them
/// moves freely: M^2 / 4 EI = F + pi^2 EI / L^2 (Greenhill 1883). With F + w (1 - s) in place of F, a weight w along
/// the rod, half of w adds to F: what is left out is of the second order, 0.0011 w^2 (L^2 / EI)^2 by perturbation.
/// @param tension F L^2 / EI, at the end that moves @param weight w L^2 / EI @return M L / EI
double rod_straight_moment( double tension, double weight );

/// A rod that gave way to twist in one place, far from its ends (Coyne 1990; van der Heijden and Thompson 2000). With
/// t = M / 2 sqrt( EI F ) and q = sqrt( 1 - t^2 ), the angle between rod and force is
///
///     sin( angle / 2 ) = q sech( q s sqrt( F / EI ) ),   D = 4 q sqrt( EI / F ),   R = M L / GJ + 4 acos( t )
///
/// D is how much nearer the ends are than L, R how far one is turned against the other.
typedef struct rod_writhe
{
    double tension;  ///< F L^2 / EI
    double moment;   ///< M L / EI
    double rotation; ///< R, rad, of one end against the other
} rod_writhe;

/// @param angle rad, the largest one, 2 acos( t ): 0 .. pi @param shortening D / L @param ratio GJ / EI
rod_writhe rod_writhe_of( double angle, double shortening, double ratio );
/// The one with the largest rotation, where cos( angle ) = -D GJ / 2 L EI. Beyond it there is no balance without
/// contact, and a loop forms.
rod_writhe rod_writhe_limit( double shortening, double ratio );

// ---- curl theory ----

enum
{
    CURL_PIECES = 512,
};

typedef struct curl_rod
{
    double curl;     ///< natural curvature times length
    double weight;   ///< G = rho g L^3 / EI; below 0 the rod stands on its clamp
    double twist;    ///< c = GJ / EI, > 0
    double in_plane; ///< b, > 0; 1 is a round rod
    double clamp;    ///< rad, of the tangent at the clamp from down
} curl_rod;

typedef struct curl_shape
{
    double theta[CURL_PIECES + 1]; ///< rad, at equal distances from the clamp to the tip
    double aside, down;            ///< where the tip is
    int modes;                     ///< out of the plane that lower the energy; 0: stable
} curl_shape;

/// The planar equilibrium that follows from the natural arc as the weight grows from 0.
/// @return false: it ends before
bool curl_hang( const curl_rod* rod, curl_shape* out );

/// The weight nearest to 0 at which that equilibrium gives way out of its plane.
/// @param rod its weight ends the search @return NaN: none up to there
double curl_critical_weight( const curl_rod* rod );
