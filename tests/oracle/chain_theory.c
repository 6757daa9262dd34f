#include "chain_theory.h"

#include <math.h>
#include <string.h>

enum
{
    MAX_LINKS = 128,
    PIECES = 2000, // of the integral of the continuous chain, even
};

static const double TIME_LIMIT = 4.0;

typedef struct chain
{
    int links;
    double length; // of a link
    double x[MAX_LINKS + 1][2], v[MAX_LINKS + 1][2];
} chain;

void chain_fold( int links, double ( *points )[2] )
{
    const double l = 1.0 / links;
    const int leg = ( links - 1 ) / 2;
    for ( int i = 0; i <= links; ++i )
    {
        points[i][0] = i > leg ? l : 0.0;
        points[i][1] = -l * ( i > leg ? links - i : i );
    }
}

// ---- masses ----

static double inverse_mass( const chain* c, int i )
{
    const double mass = i < c->links ? c->length : 0.5 * c->length;
    return i == 0 ? 0.0 : 1.0 / mass;
}

// Solve a tridiagonal system of links in place of its right-hand side.
static void solve( int n, double* diagonal, const double* off, double* x )
{
    for ( int k = 1; k < n; ++k )
    {
        const double f = off[k - 1] / diagonal[k - 1];
        diagonal[k] -= f * off[k - 1];
        x[k] -= f * x[k - 1];
    }
    for ( int k = n - 1; k >= 0; --k )
    {
        x[k] = ( x[k] - ( k + 1 < n ? off[k] * x[k + 1] : 0.0 ) ) / diagonal[k];
    }
}

// Accelerations. With e_k = x_{k+1} - x_k the second derivative of |e_k|^2 / 2 is e_k . a_k + |e'_k|^2 = 0, and link
// k pulls its ends together by p_k e_k.
static void accelerate( const chain* c, double ( *a )[2] )
{
    double e[MAX_LINKS][2], diagonal[MAX_LINKS], off[MAX_LINKS] = { 0.0 }, pull[MAX_LINKS];
    const int n = c->links;
    for ( int k = 0; k < n; ++k )
    {
        double fast = 0.0, square = 0.0;
        for ( int d = 0; d < 2; ++d )
        {
            e[k][d] = c->x[k + 1][d] - c->x[k][d];
            const double rate = c->v[k + 1][d] - c->v[k][d];
            square += e[k][d] * e[k][d];
            fast += rate * rate;
        }
        diagonal[k] = square * ( inverse_mass( c, k ) + inverse_mass( c, k + 1 ) );
        // gravity moves both ends of a link alike, but not one that is held
        pull[k] = fast - ( k == 0 ? e[k][1] : 0.0 );
        if ( k > 0 )
        {
            off[k - 1] = -inverse_mass( c, k ) * ( e[k - 1][0] * e[k][0] + e[k - 1][1] * e[k][1] );
        }
    }
    solve( n, diagonal, off, pull );
    a[0][0] = a[0][1] = 0.0;
    for ( int i = 1; i <= n; ++i )
    {
        for ( int d = 0; d < 2; ++d )
        {
            const double force = ( i < n ? pull[i] * e[i][d] : 0.0 ) - pull[i - 1] * e[i - 1][d];
            a[i][d] = inverse_mass( c, i ) * force - ( d == 1 ? 1.0 : 0.0 );
        }
    }
}

// base + h ( v, a ) of a stage
static void move_on( const chain* base, const chain* stage, const double ( *a )[2], double h, chain* out )
{
    out->links = base->links;
    out->length = base->length;
    for ( int i = 0; i <= base->links; ++i )
    {
        for ( int d = 0; d < 2; ++d )
        {
            out->x[i][d] = base->x[i][d] + h * stage->v[i][d];
            out->v[i][d] = base->v[i][d] + h * a[i][d];
        }
    }
}

static void step( chain* c, double h )
{
    static const double fractions[] = { 0.5, 0.5, 1.0 }, weights[] = { 1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0 };
    const chain start = *c;
    chain stage = start, sum = start;
    for ( int k = 0; k < 4; ++k )
    {
        double a[MAX_LINKS + 1][2];
        accelerate( &stage, a );
        move_on( &sum, &stage, (const double( * )[2])a, weights[k] * h, &sum );
        if ( k < 3 )
        {
            chain next;
            move_on( &start, &stage, (const double( * )[2])a, fractions[k] * h, &next );
            stage = next;
        }
    }
    *c = sum;
}

static double energy_of( const chain* c )
{
    double energy = 0.0;
    for ( int i = 1; i <= c->links; ++i )
    {
        energy += ( 0.5 * ( c->v[i][0] * c->v[i][0] + c->v[i][1] * c->v[i][1] ) + c->x[i][1] ) / inverse_mass( c, i );
    }
    return energy;
}

static double length_error_of( const chain* c )
{
    double most = 0.0;
    for ( int k = 0; k < c->links; ++k )
    {
        const double l = hypot( c->x[k + 1][0] - c->x[k][0], c->x[k + 1][1] - c->x[k][1] );
        most = fmax( most, fabs( l / c->length - 1.0 ) );
    }
    return most;
}

bool chain_fall_of_masses( int links, const double ( *points )[2], double depth, int steps, chain_fall* out )
{
    if ( links > MAX_LINKS )
    {
        return false;
    }
    chain c = { .links = links, .length = 1.0 / links };
    memcpy( c.x, points, (size_t)( links + 1 ) * sizeof c.x[0] );
    const double h = 1.0 / steps, start = energy_of( &c ), goal = points[links][1] - depth;
    for ( int i = 0; i < (int)TIME_LIMIT * steps; ++i )
    {
        const chain before = c;
        step( &c, h );
        if ( c.x[links][1] <= goal )
        {
            // the part of the step after which it is there, by bisection
            double part = 0.0, below = 1.0;
            for ( int k = 0; k < 60; ++k )
            {
                const double middle = 0.5 * ( part + below );
                c = before;
                step( &c, middle * h );
                *( c.x[links][1] > goal ? &part : &below ) = middle;
            }
            out->time = h * ( i + below );
            out->speed = -c.v[links][1];
            out->energy_error = energy_of( &c ) - start;
            out->length_error = length_error_of( &c );
            return true;
        }
    }
    return false;
}

// ---- continuous ----

chain_fall chain_fall_continuous( double depth )
{
    // dt = dx / v. With x = 1 - cos( p ) the integrand is sqrt( cos( p ) ), which has no pole where the chain
    // starts; by Simpson's rule.
    const double end = acos( 1.0 - depth ), h = end / PIECES;
    double sum = 0.0;
    for ( int i = 0; i <= PIECES; ++i )
    {
        const double weight = i == 0 || i == PIECES ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * sqrt( fmax( cos( h * i ), 0.0 ) );
    }
    return ( chain_fall ){ .time = h / 3.0 * sum, .speed = sqrt( depth * ( 2.0 - depth ) / ( 1.0 - depth ) ) };
}
