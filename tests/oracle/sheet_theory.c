#include "sheet_theory.h"

#include <math.h>

// x = span / 2 a solves sinh( x ) / x = 1 / span, whose left side rises.
static double catenary_of( double span )
{
    double lower = 1e-9, upper = 1.0;
    while ( sinh( upper ) / upper < 1.0 / span )
    {
        upper *= 2.0;
    }
    for ( int i = 0; i < 100; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        *( sinh( middle ) / middle < 1.0 / span ? &lower : &upper ) = middle;
    }
    return span / ( lower + upper );
}

// The length from the lowest point is a sinh( x / a ), and there y = sqrt( a^2 + length^2 ).
void sheet_catenary( double span, double s, double out[2] )
{
    const double a = catenary_of( span );
    out[0] = a * asinh( ( s - 0.5 ) / a );
    out[1] = hypot( a, s - 0.5 ) - hypot( a, 0.5 );
}

double sheet_slide( double gravity, double angle, double friction )
{
    return gravity * fmax( 0.0, sin( angle ) - friction * cos( angle ) );
}

// T( pi ) = light e^(pi mu) + 2 mu R ( 1 + e^(pi mu) ) / ( 1 + mu^2 ) rises with mu.
double sheet_capstan( double light, double heavy, double radius )
{
    const double pi = acos( -1.0 );
    double lower = 0.0, upper = log( heavy / light ) / pi;
    for ( int i = 0; i < 60; ++i )
    {
        const double mu = 0.5 * ( lower + upper ), gain = exp( pi * mu );
        const double held = light * gain + 2.0 * mu * radius * ( 1.0 + gain ) / ( 1.0 + mu * mu );
        *( held < heavy ? &lower : &upper ) = mu;
    }
    return 0.5 * ( lower + upper );
}

double sheet_terminal_speed( double force, double air_density, double drag_coefficient, double area )
{
    return sqrt( 2.0 * force / ( air_density * drag_coefficient * area ) );
}

double sheet_fall_speed( double terminal, double acceleration, double time )
{
    return terminal * tanh( acceleration * time / terminal );
}

double sheet_bending_length( double rigidity, double weight )
{
    return cbrt( rigidity / weight );
}

double sheet_cusick( double length, double shear )
{
    return 35.6 * length - 3.61 * length * length - 2.59 * shear + 0.0461 * shear * shear + 17.0;
}

double sheet_cusick_softest( void )
{
    return 2.59 / ( 2.0 * 0.0461 );
}
