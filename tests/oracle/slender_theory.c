#include "slender_theory.h"

#include <math.h>

enum
{
    PIECES = 4000,
};

// y'' = -load weight( s ) y from y( 0 ) = 0, y'( 0 ) = 1 by Runge and Kutta. @return y'( 1 )
static double slope_at_end( double ( *weight )( double s ), double load )
{
    const double h = 1.0 / PIECES;
    double y = 0.0, v = 1.0;
    for ( int i = 0; i < PIECES; ++i )
    {
        const double s = (double)i / PIECES, a = -load * weight( s ), b = -load * weight( s + 0.5 * h ),
                     c = -load * weight( s + h );
        const double y1 = v, v1 = a * y, y2 = v + 0.5 * h * v1, v2 = b * ( y + 0.5 * h * y1 ), y3 = v + 0.5 * h * v2,
                     v3 = b * ( y + 0.5 * h * y2 ), y4 = v + h * v3, v4 = c * ( y + h * y3 );
        y += h / 6.0 * ( y1 + 2.0 * y2 + 2.0 * y3 + y4 );
        v += h / 6.0 * ( v1 + 2.0 * v2 + 2.0 * v3 + v4 );
    }
    return v;
}

// The slope at the end is 1 without a load and falls through 0 at the first critical one.
static double first_load( double ( *weight )( double s ), double most )
{
    double lower = 0.0, upper = most;
    for ( int i = 0; i < 100; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        *( slope_at_end( weight, middle ) > 0.0 ? &lower : &upper ) = middle;
    }
    return 0.5 * ( lower + upper );
}

static double column_weight( double s )
{
    return 1.0 - s;
}

static double blade_weight( double s )
{
    return 0.25 * pow( 1.0 - s, 4.0 );
}

double slender_column_load( void )
{
    return first_load( column_weight, 12.0 );
}

double slender_blade_load( void )
{
    return sqrt( first_load( blade_weight, 300.0 ) );
}
