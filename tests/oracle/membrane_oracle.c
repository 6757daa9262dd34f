#include "membrane_oracle.h"

#include <math.h>
#include <string.h>

// Energy over A G of the stretches s1 and s2: ( s1^2 + s2^2 + 1 / ( s1 s2 )^2 - 3 ) / 2 (Treloar 1943).
// @param tension_field the least energy over all widths below s2, and below s1: wrinkles (Pipkin 1986)
static double membrane_oracle_density( double s1, double s2, bool tension_field )
{
    double a = s1 > s2 ? s1 : s2, b = s1 > s2 ? s2 : s1;
    if ( tension_field )
    {
        a = a < 1.0 ? 1.0 : a;
        b = b < 1.0 / sqrt( a ) ? 1.0 / sqrt( a ) : b;
    }
    return 0.5 * ( a * a + b * b + 1.0 / ( a * b * a * b ) - 3.0 );
}

// ---- geometry: the triangle at rest in its plane, and its deformation gradient ----

static double dot( const double a[3], const double b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

typedef struct plane_triangle
{
    double by[3][2]; // D: derivatives of the columns of F by the corners, 1/m
    double area;     // m^2
} plane_triangle;

static plane_triangle flatten( double rest[3][3] )
{
    double e[3], g[3];
    for ( int i = 0; i < 3; ++i )
    {
        e[i] = rest[1][i] - rest[0][i];
        g[i] = rest[2][i] - rest[0][i];
    }
    const double a = sqrt( dot( e, e ) ), b = dot( e, g ) / a, h = sqrt( dot( g, g ) - b * b );
    return ( plane_triangle ){
        .by = { { -1.0 / a, b / ( a * h ) - 1.0 / h }, { 1.0 / a, -b / ( a * h ) }, { 0.0, 1.0 / h } },
        .area = 0.5 * a * h,
    };
}

static void measure_gradient( const plane_triangle* plane, double position[3][3], double f[2][3] )
{
    memset( f, 0, 6 * sizeof( double ) );
    for ( int corner = 0; corner < 3; ++corner )
    {
        for ( int i = 0; i < 3; ++i )
        {
            f[0][i] += plane->by[corner][0] * position[corner][i];
            f[1][i] += plane->by[corner][1] * position[corner][i];
        }
    }
}

// Angle of the larger principal stretch in the triangle.
static double principal_angle( double f[2][3] )
{
    return 0.5 * atan2( 2.0 * dot( f[0], f[1] ), dot( f[0], f[0] ) - dot( f[1], f[1] ) );
}

static void turn( double f[2][3], double angle, double out[2][3] )
{
    for ( int i = 0; i < 3; ++i )
    {
        out[0][i] = cos( angle ) * f[0][i] + sin( angle ) * f[1][i];
        out[1][i] = cos( angle ) * f[1][i] - sin( angle ) * f[0][i];
    }
}

// J, of a triangle where it is.
static double membrane_oracle_energy( const membrane_oracle_triangle* triangle )
{
    membrane_oracle_triangle mine = *triangle, *t = &mine;
    const plane_triangle plane = flatten( t->rest );
    double f[2][3], g[2][3];
    measure_gradient( &plane, t->position, f );
    turn( f, principal_angle( f ), g );
    return plane.area * t->stiffness *
           membrane_oracle_density( sqrt( dot( g[0], g[0] ) ), sqrt( dot( g[1], g[1] ) ), t->tension_field );
}

void membrane_oracle_forces( const membrane_oracle_triangle* triangle, double out[3][3] )
{
    membrane_oracle_triangle above = *triangle, below = *triangle;
    const double step = 1e-5 * sqrt( flatten( above.rest ).area );
    for ( int corner = 0; corner < 3; ++corner )
    {
        for ( int i = 0; i < 3; ++i )
        {
            above.position[corner][i] += step;
            below.position[corner][i] -= step;
            out[corner][i] = ( membrane_oracle_energy( &above ) - membrane_oracle_energy( &below ) ) / ( 2.0 * step );
            above.position[corner][i] = below.position[corner][i] = triangle->position[corner][i];
        }
    }
}

// ---- the step of a triangle ----

// The largest eigenvalue of sum w D D'.
static double largest_mobility( const membrane_oracle_triangle* t, const plane_triangle* plane )
{
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        xx += t->inverse_mass[k] * plane->by[k][0] * plane->by[k][0];
        xy += t->inverse_mass[k] * plane->by[k][0] * plane->by[k][1];
        yy += t->inverse_mass[k] * plane->by[k][1] * plane->by[k][1];
    }
    return 0.5 * ( xx + yy ) + sqrt( 0.25 * ( xx - yy ) * ( xx - yy ) + xy * xy );
}

static double slope( double s1, double s2, bool tension_field )
{
    const double d = 1e-6 * s1;
    return ( membrane_oracle_density( s1 + d, s2, tension_field ) -
             membrane_oracle_density( s1 - d, s2, tension_field ) ) /
           ( 2.0 * d );
}

// The root of a - start + c dE/da, which grows with a.
static double relax_one( double start, double other, double c, bool tension_field )
{
    double low = 1e-4, high = 100.0;
    for ( int i = 0; i < 60; ++i )
    {
        const double a = sqrt( low * high );
        const bool above = a - start + c * slope( a, other, tension_field ) > 0.0;
        high = above ? a : high;
        low = above ? low : a;
    }
    return sqrt( low * high );
}

void membrane_oracle_project( membrane_oracle_triangle* t, double dt )
{
    const plane_triangle plane = flatten( t->rest );
    const double mobility = largest_mobility( t, &plane ), c = dt * dt * plane.area * t->stiffness * mobility;
    double f[2][3], g[2][3];
    measure_gradient( &plane, t->position, f );
    const double angle = principal_angle( f );
    turn( f, angle, g );
    const double start[2] = { sqrt( dot( g[0], g[0] ) ), sqrt( dot( g[1], g[1] ) ) };
    double s[2] = { start[0], start[1] };
    for ( int i = 0; i < 400; ++i )
    {
        s[0] = relax_one( start[0], s[1], c, t->tension_field );
        s[1] = relax_one( start[1], s[0], c, t->tension_field );
    }
    double stress[2][3], q[2][3];
    for ( int i = 0; i < 3; ++i )
    {
        stress[0][i] = ( start[0] - s[0] ) / mobility * g[0][i] / start[0];
        stress[1][i] = ( start[1] - s[1] ) / mobility * g[1][i] / start[1];
    }
    turn( stress, -angle, q );
    for ( int corner = 0; corner < 3; ++corner )
    {
        for ( int i = 0; i < 3; ++i )
        {
            t->position[corner][i] -=
                t->inverse_mass[corner] * ( plane.by[corner][0] * q[0][i] + plane.by[corner][1] * q[1][i] );
        }
    }
}

// ---- closed forms ----

double membrane_oracle_sphere_pressure( double stiffness, double radius, double s )
{
    return 2.0 * stiffness / radius * ( 1.0 / s - pow( s, -7.0 ) );
}

double membrane_oracle_limit_point( void )
{
    return pow( 7.0, 1.0 / 6.0 );
}
