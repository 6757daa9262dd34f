/// What theory says of balloons, in double precision: the Mylar balloon, spheres of springs, jets, and flight through air.
#pragma once

// ---- two discs, joined at the rim and filled ----

/// Two flat discs that bend freely and wrinkle but do not stretch, filled: meridians keep their length a, and
/// z'(x) = -x^2 / sqrt( r^4 - x^4 ) (Paulsen 1994, "What is the shape of a Mylar balloon?"; Mladenov and Oprea 2003).
typedef struct balloon_theory_mylar
{
    double radius;    ///< r / a, of the equator
    double thickness; ///< 2 z(0) / a, between the poles
    double volume;    ///< V / a^3
} balloon_theory_mylar;

balloon_theory_mylar balloon_theory_mylar_shape( void );

// ---- a sphere of springs, filled with an ideal gas ----

/// Links of an even triangle mesh on a sphere, each with tension k (l - d). The skin has the tension
/// sqrt(3) k e / (1 + e) per length, and p = 2 sigma / R (Laplace 1806). Links across edges are sqrt(3) times as long as
/// edges, so they count three times.
typedef struct balloon_theory_sphere
{
    double radius;                ///< m, at rest
    double edge_stiffness;        ///< N/m
    double bend_link_stiffness;   ///< N/m
    double atmosphere, gas_ratio; ///< Pa; V_0 / V_rest, V_0 the volume of the gas at that pressure
} balloon_theory_sphere;

/// @param scale s, of lengths, from the rest shape @return Pa above the atmosphere
double balloon_theory_sphere_pressure( const balloon_theory_sphere* sphere, double scale );
/// The scale s at which the skin holds the pressure of p V = P_atm V_0 (Boyle 1662). gas_ratio >= 1
double balloon_theory_sphere_scale( const balloon_theory_sphere* sphere );

// ---- a jet ----

/// Pressure above the atmosphere, Pa, when the gas has a volume at the pressure of the atmosphere, m^3.
typedef double balloon_theory_pressure( const void* context, double gas_volume );

typedef struct balloon_theory_jet
{
    balloon_theory_pressure* pressure; ///< 0 where the skin is slack
    const void* context;
    double density; ///< kg/m^3, of the gas
    double mass;    ///< kg, of the skin
    double area;    ///< m^2, of the outlet
} balloon_theory_jet;

/// What a jet does while the gas falls from one volume to another: it leaves with v_e = sqrt( 2 p / rho ) (Torricelli 1643, Bernoulli 1738), so
/// dV_0/dt = -A v_e and m dv/dt = rho A v_e^2.
typedef struct balloon_theory_flow
{
    double
        speed; ///< m/s, which the skin gains: rho / m times the integral of v_e over the volume. The area drops out
    double seconds; ///< the integral of 1 / ( A v_e )
} balloon_theory_flow;

balloon_theory_flow balloon_theory_empty( const balloon_theory_jet* jet, double from, double to );

// ---- flight ----

/// How drag depends on the angle between velocity and normal.
typedef enum balloon_theory_drag
{
    BALLOON_THEORY_DRAG_MAX,    ///< against v, max( 0, cos )
    BALLOON_THEORY_DRAG_ABS,    ///< against v, |cos|
    BALLOON_THEORY_DRAG_SIGNED, ///< against v, cos
    BALLOON_THEORY_DRAG_NORMAL, ///< along the normal, cos
    BALLOON_THEORY_DRAG_COUNT,
} balloon_theory_drag;

/// The integral of the law over a sphere in parts of pi R^2: by how much it multiplies the coefficient of drag.
double balloon_theory_drag_factor( balloon_theory_drag law );
/// Speed at which drag 1/2 rho C pi R^2 v^2 (Newton 1687) balances a force. @param coefficient C, with the factor of the law
double balloon_theory_terminal_speed( double force, double air_density, double coefficient, double radius );
