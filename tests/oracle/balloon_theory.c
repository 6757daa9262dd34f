#include "balloon_theory.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

// ---- two discs ----

// Euler's beta function.
static double beta( double p, double q )
{
    return tgamma( p ) * tgamma( q ) / tgamma( p + q );
}

// With t = x / r and u = t^4, the integral of t^n / sqrt( 1 - t^4 ) from 0 to 1 is B( ( n + 1 ) / 4, 1/2 ) / 4. n = 0 is the length of a
// meridian in r, n = 2 its height, and n = 4 the volume in 2 pi r^3 (both halves, by parts).
static double meridian_integral( int n )
{
    return 0.25 * beta( 0.25 * ( n + 1 ), 0.5 );
}

balloon_theory_mylar balloon_theory_mylar_shape( void )
{
    const double r = 1.0 / meridian_integral( 0 );
    return ( balloon_theory_mylar ){ .radius = r,
                                     .thickness = 2.0 * r * meridian_integral( 2 ),
                                     .volume = 2.0 * PI * r * r * r * meridian_integral( 4 ) };
}

// ---- a sphere of springs ----

double balloon_theory_sphere_pressure( const balloon_theory_sphere* sphere, double scale )
{
    const double stiffness = sphere->edge_stiffness + 3.0 * sphere->bend_link_stiffness;
    const double tension = sqrt( 3.0 ) * stiffness * ( scale - 1.0 ) / scale;
    return 2.0 * tension / ( scale * sphere->radius );
}

// The skin holds more the larger it is, up to s = 2, and the gas presses less.
double balloon_theory_sphere_scale( const balloon_theory_sphere* sphere )
{
    double lower = 1.0, upper = cbrt( sphere->gas_ratio );
    for ( int i = 0; i < 60; ++i )
    {
        const double s = 0.5 * ( lower + upper );
        const double gas = sphere->atmosphere * ( sphere->gas_ratio / ( s * s * s ) - 1.0 );
        *( balloon_theory_sphere_pressure( sphere, s ) < gas ? &lower : &upper ) = s;
    }
    return lower;
}

// ---- a jet ----

// With V = to + ( from - to ) u^2 both integrands stay finite where the pressure ends. Midpoints, because it is 0 there.
balloon_theory_flow balloon_theory_empty( const balloon_theory_jet* jet, double from, double to )
{
    enum
    {
        POINTS = 4000,
    };
    balloon_theory_flow flow = { 0.0, 0.0 };
    for ( int i = 0; i < POINTS; ++i )
    {
        const double u = ( i + 0.5 ) / POINTS, volume = to + ( from - to ) * u * u;
        const double part = 2.0 * ( from - to ) * u / POINTS; // dV
        const double speed = sqrt( 2.0 * fmax( 0.0, jet->pressure( jet->context, volume ) ) / jet->density );
        flow.speed += jet->density / jet->mass * speed * part;
        flow.seconds += part / ( jet->area * speed );
    }
    return flow;
}

// ---- flight ----

double balloon_theory_drag_factor( balloon_theory_drag law )
{
    // With dA = 2 pi R^2 dc, c the cosine: the integrals of max( 0, c ), |c| and c from -1 to 1, and of c^2, the part of a force
    // along the normal that is against v.
    static const double factors[BALLOON_THEORY_DRAG_COUNT] = { 1.0, 2.0, 0.0, 4.0 / 3.0 };
    return factors[law];
}

double balloon_theory_terminal_speed( double force, double air_density, double coefficient, double radius )
{
    return sqrt( 2.0 * force / ( air_density * coefficient * PI * radius * radius ) );
}
