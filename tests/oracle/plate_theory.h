/// Loads at which thin plates buckle, by the method of Ritz with polynomials, in double precision. A plate is 0 .. 1 along x and
/// `width` along y, both in lengths of the plate.
///
/// The energy of its deflection w is that of Kirchhoff, 1/2 D of the integral of (w_xx + w_yy)^2 - 2 (1 - nu) (w_xx w_yy - w_xy^2), and the
/// work of the forces N in its plane, 1/2 of the integral of N_xx w_x^2 + 2 N_xy w_x w_y + N_yy w_y^2 (Bryan 1891; Timoshenko and
/// Gere 1961, chapter 9). A plate buckles where their sum stops being positive. Loads found by Ritz fall towards the exact one.
#pragma once

#include <stdbool.h>

#define PLATE_THEORY_MAX_DEGREE 20

typedef enum plate_theory_support
{
    PLATE_CLAMPED_AT_ONE_END, ///< at x = 0; the other edges are free
    PLATE_HINGED_ALL_ROUND,   ///< no deflection at the edges
} plate_theory_support;

typedef struct plate_theory_plate
{
    plate_theory_support support;
    double width;
    double poisson; ///< of bending
    int along,
        across; ///< degrees of deflections along x and y, 1 .. PLATE_THEORY_MAX_DEGREE, besides the factor that holds the edges
} plate_theory_plate;

/// Forces in the plane, per length.
typedef struct plate_theory_forces
{
    double xx, yy, xy;
} plate_theory_forces;

typedef plate_theory_forces plate_theory_field( const void* context, double x, double y );

/// @return the smallest positive factor of the forces, in D / L^2, at which the plate buckles; infinite: there is none below 1e6;
/// NaN: no memory
double plate_theory_factor( const plate_theory_plate* plate, plate_theory_field* forces, const void* context );

/// Elastic constants in the plane: N_xx = along e_xx + cross e_yy, N_yy = cross e_xx + along e_yy, N_xy = shear 2 e_xy. Only their ratios
/// matter to the forces under a weight.
typedef struct plate_theory_membrane
{
    double along, cross, shear;
} plate_theory_membrane;

/// Of an isotropic plate.
plate_theory_membrane plate_theory_isotropic( double poisson );

/// Forces in a plate that is clamped at x = 0 under its own weight.
typedef struct plate_theory_weight plate_theory_weight;

/// Plane stress with the displacement 0 at the clamp, by the method of Ritz.
/// @param is_sideways the weight acts along -y, on a plate on edge; otherwise along -x, on an upright plate
/// @param degree of displacements, 1 .. PLATE_THEORY_MAX_DEGREE
/// @return to be destroyed; null: no memory
plate_theory_weight* plate_theory_weigh( double width, plate_theory_membrane membrane, bool is_sideways, int degree );
void plate_theory_destroy( plate_theory_weight* weight );
/// @param weight a plate_theory_weight* @return forces for a weight of 1 per area and the length 1
plate_theory_field plate_theory_weight_forces;

/// @return the load rho g L^3 / D at which a plate clamped at one end gives way under its own weight (rho per area); NaN: no memory
double plate_theory_load( double width, double poisson, plate_theory_membrane membrane, bool is_sideways );

// ---- sheet theory ----

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
