/// A rod with a constant natural curvature that hangs from a clamp: its equilibria in the plane of its curl, and the weight at which they
/// give way out of that plane, in double precision (the suspended curl of Miller, Lazarus, Audoly and Reis 2014). All lengths are in
/// lengths of the rod, all stiffness in EI, the stiffness against bending out of the plane.
///
/// In the plane, with theta of the tangent from down and b the stiffness against bending in the plane:
///
///     b theta'' = G (1 - s) sin theta,   theta(0) = clamp,   theta'(1) = curl
///
/// Out of it a section turns by beta about the normal in the plane and by phi about the tangent. With M = b (theta' - curl) the second
/// variation of the energy of a Kirchhoff rod is (derived as in Love 1927, chapter 19, for any planar state)
///
///     integral of (beta' + theta' phi)^2 + c (phi' - theta' beta)^2 - 2 M phi beta' - M theta' (phi^2 + beta^2) + G (1 - s) cos theta beta^2
///
/// with beta(0) = phi(0) = 0. It is positive as long as no solution of its Euler equations that is free at s = 1 vanishes at another s
/// (Jacobi's condition).
#pragma once

#include <stdbool.h>

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
