#include "slip_theory.h"

#include <math.h>

enum
{
    NEWTON = 60,
    STAGES = 16, // on the way from the first height
};

static const double FIRST_HEIGHT = 0.985;

typedef struct tip
{
    double bend, x, y; // theta', place
} tip;

// Runge and Kutta from the clamp to the tip. @param u theta'(0), F_x, F_y
static tip shoot( const double* u, double* theta )
{
    const double h = 1.0 / SLIP_PIECES;
    double angle = 0.0, bend = u[0];
    tip out = { 0.0, 0.0, 0.0 };
    theta[0] = 0.0;
    for ( int i = 0; i < SLIP_PIECES; ++i )
    {
        const double a = u[1] * sin( angle ) - u[2] * cos( angle );
        const double angle2 = angle + 0.5 * h * bend, bend2 = bend + 0.5 * h * a;
        const double b = u[1] * sin( angle2 ) - u[2] * cos( angle2 );
        const double angle3 = angle + 0.5 * h * bend2, bend3 = bend + 0.5 * h * b;
        const double c = u[1] * sin( angle3 ) - u[2] * cos( angle3 );
        const double angle4 = angle + h * bend3, bend4 = bend + h * c;
        const double d = u[1] * sin( angle4 ) - u[2] * cos( angle4 );
        const double next = angle + h / 6.0 * ( bend + 2.0 * bend2 + 2.0 * bend3 + bend4 );
        const double next_bend = bend + h / 6.0 * ( a + 2.0 * b + 2.0 * c + d );
        // Simpson, with the angle in the middle from the cubic through both ends
        const double middle = 0.5 * ( angle + next ) + 0.125 * h * ( bend - next_bend );
        out.x += h / 6.0 * ( cos( angle ) + 4.0 * cos( middle ) + cos( next ) );
        out.y += h / 6.0 * ( sin( angle ) + 4.0 * sin( middle ) + sin( next ) );
        angle = next;
        bend = next_bend;
        theta[i + 1] = angle;
    }
    out.bend = bend;
    return out;
}

static double determinant( double m[3][3] )
{
    return m[0][0] * ( m[1][1] * m[2][2] - m[1][2] * m[2][1] ) - m[0][1] * ( m[1][0] * m[2][2] - m[1][2] * m[2][0] ) +
           m[0][2] * ( m[1][0] * m[2][1] - m[1][1] * m[2][0] );
}

// One step of Newton, by Cramer's rule. Derivatives are differences: what is left over decides, not they.
static void improve( double height, double aside, const tip* now, double* u )
{
    const double step = 1e-6, miss[3] = { -now->bend, height - now->x, aside - now->y };
    double m[3][3], theta[SLIP_PIECES + 1], change[3];
    for ( int k = 0; k < 3; ++k )
    {
        double moved[3] = { u[0], u[1], u[2] };
        moved[k] += step;
        const tip next = shoot( moved, theta );
        m[0][k] = ( next.bend - now->bend ) / step;
        m[1][k] = ( next.x - now->x ) / step;
        m[2][k] = ( next.y - now->y ) / step;
    }
    const double whole = determinant( m );
    for ( int k = 0; k < 3; ++k )
    {
        double with[3][3];
        for ( int i = 0; i < 9; ++i )
        {
            with[i / 3][i % 3] = i % 3 == k ? miss[i / 3] : m[i / 3][i % 3];
        }
        change[k] = determinant( with ) / whole;
    }
    for ( int k = 0; k < 3; ++k )
    {
        u[k] += change[k];
    }
}

static bool solve( double height, double aside, double* u, double* theta )
{
    for ( int i = 0; i < NEWTON; ++i )
    {
        const tip now = shoot( u, theta );
        if ( fabs( now.bend ) + fabs( now.x - height ) + fabs( now.y - aside ) < 1e-11 )
        {
            return true;
        }
        improve( height, aside, &now, u );
    }
    return false;
}

bool slip_stand( double height, double aside, slip_shape* out )
{
    // near the first mode of buckling, whose load is the square of 4.4934
    double u[3] = { 1.1, -20.3, 1.1 };
    bool is_found = true;
    for ( int i = 0; i <= STAGES && is_found; ++i )
    {
        const double way = (double)i / STAGES;
        is_found = solve( FIRST_HEIGHT + way * ( height - FIRST_HEIGHT ), way * aside, u, out->theta );
    }
    out->bend = u[0];
    out->force[0] = u[1];
    out->force[1] = u[2];
    out->ratio = fabs( u[2] / u[1] );
    return is_found;
}

double slip_angle( const slip_shape* shape, double s )
{
    const double at = fmax( 0.0, fmin( 1.0, s ) ) * SLIP_PIECES;
    const int piece = (int)fmin( floor( at ), SLIP_PIECES - 1.0 );
    return shape->theta[piece] + ( at - piece ) * ( shape->theta[piece + 1] - shape->theta[piece] );
}
