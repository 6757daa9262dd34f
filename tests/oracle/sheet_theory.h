/// Closed forms of sheets and chains that hang, slide, fall or drape, in double precision.
#pragma once

/// The catenary of length 1 between two supports of one height (Leibniz, Huygens and Johann Bernoulli 1691): y = a cosh( x / a ) with
/// 2 a sinh( span / 2 a ) = 1.
/// @param span below 1
/// @param s in 0 .. 1, along the curve
/// @param out x from the middle, and y below 0 from the supports
void sheet_catenary( double span, double s, double out[2] );

/// Acceleration along an incline (Coulomb 1785), m/s^2: g ( sin a - mu cos a ), and 0 where friction holds.
double sheet_slide( double gravity, double angle, double friction );

/// The friction from which a rope on a fixed level cylinder does not slide (Euler 1769, with the weight of the part on it): with a from the
/// light side, T' = R cos a + mu ( T + R sin a ), T( 0 ) = light, T( pi ) = heavy, in lengths of rope.
/// @param light,heavy what hangs on both sides, heavy > light > 0
/// @param radius R of the middle of the rope, >= 0; 0: the friction without that weight, log( heavy / light ) / pi
double sheet_capstan( double light, double heavy, double radius );

/// Terminal speed where drag 1/2 rho C A v^2 carries a force (Newton 1687, book II), m/s.
double sheet_terminal_speed( double force, double air_density, double drag_coefficient, double area );
/// Speed after a time from rest, m/s: v = w tanh( a t / w ) with w the terminal speed and a the acceleration without air.
double sheet_fall_speed( double terminal, double acceleration, double time );

/// Bending length of a fabric (Peirce 1930), m: ( D / w )^( 1/3 ) with D in N m and w in N/m^2.
double sheet_bending_length( double rigidity, double weight );
/// Drape coefficient, in percent, by the regression of Cusick 1965 over 130 fabrics: 35.6 c - 3.61 c^2 - 2.59 A + 0.0461 A^2 + 17.0.
/// @param length c, bending length, cm
/// @param shear A, angle at which the fabric buckles in shear, degrees
double sheet_cusick( double length, double shear );
/// The shear angle at which the regression has its least value, degrees.
double sheet_cusick_softest( void );
