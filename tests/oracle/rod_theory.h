/// Twisted rods, from closed forms, in double precision. L is the length of a rod, EI and GJ are its rigidities.
#pragma once

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
