#include "elastica.h"

#include <math.h>
#include <stdbool.h>

enum
{
    PRIMITIVES = 4000, // at least this many for the whole curve
};

typedef struct elastica_place
{
    double theta, slope, x, y;
} elastica_place;

typedef struct elastica_loads
{
    double weight, tip;
} elastica_loads;

// theta'' of what hangs behind a place
static double turn( const elastica_loads* loads, double s, double theta )
{
    return -( loads->weight * ( 1.0 - s ) + loads->tip ) * cos( theta );
}

// One piece by Runge and Kutta.
static void move_on( const elastica_loads* loads, double s, double h, elastica_place* p )
{
    const double k1 = p->slope, m1 = turn( loads, s, p->theta );
    const double k2 = p->slope + 0.5 * h * m1, m2 = turn( loads, s + 0.5 * h, p->theta + 0.5 * h * k1 );
    const double k3 = p->slope + 0.5 * h * m2, m3 = turn( loads, s + 0.5 * h, p->theta + 0.5 * h * k2 );
    const double k4 = p->slope + h * m3, m4 = turn( loads, s + h, p->theta + h * k3 );
    const double next = p->theta + h / 6.0 * ( k1 + 2.0 * k2 + 2.0 * k3 + k4 ), middle = 0.5 * ( p->theta + next );
    p->x += h * cos( middle );
    p->y -= h * sin( middle ); // theta grows downwards
    p->theta = next;
    p->slope += h / 6.0 * ( m1 + 2.0 * m2 + 2.0 * m3 + m4 );
}

// @param start theta'(0) @return the smallest theta' on the way, which grows with it. Not that at the tip: under a
//        large load a rod that is bent too little swings back, and may end with any slope
static double shoot( const elastica_loads* loads, double start, int count, double ( *points )[2] )
{
    const int each = ( PRIMITIVES + count - 2 ) / ( count - 1 ), primitives = each * ( count - 1 );
    elastica_place p = { .slope = start };
    double least = start;
    points[0][0] = points[0][1] = 0.0;
    for ( int i = 0; i < primitives; ++i )
    {
        move_on( loads, (double)i / primitives, 1.0 / primitives, &p );
        least = fmin( least, p.slope );
        if ( ( i + 1 ) % each == 0 )
        {
            points[( i + 1 ) / each][0] = p.x;
            points[( i + 1 ) / each][1] = p.y;
        }
    }
    return least;
}

void elastica_lay_loaded( double load, double tip, int count, double ( *points )[2] )
{
    const elastica_loads loads = { load, tip };
    // A moment that turned the rod past the vertical would have to be larger than sqrt( 2 ( G + P ) ) allows.
    double lower = 0.0, upper = sqrt( 2.0 * ( load + tip ) );
    for ( int i = 0; i < 100; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        const bool is_too_much = shoot( &loads, middle, count, points ) > 0.0;
        lower = is_too_much ? lower : middle;
        upper = is_too_much ? middle : upper;
    }
}

void elastica_lay( double load, int count, double ( *points )[2] )
{
    elastica_lay_loaded( load, 0.0, count, points );
}
