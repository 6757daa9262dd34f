// The arc, the forces of links and their energies: Noh and Jung, Eq. 2-15.
#include "triangle_oracle.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double3 zero = { 0.0, 0.0, 0.0 };

// ---- the arc ----

// (-1)^n u^2n c_n / (2n+1)! from n = 1: the remainder when cosine and sine cancel, which they do below u = 1.
static double cancelled_series( double u, double ( *coefficient )( int n ) )
{
    double power = 1.0, sum = 0.0;
    for ( int n = 1; n <= 12; ++n )
    {
        power *= -u * u / ( 2.0 * n * ( 2.0 * n + 1.0 ) );
        sum += power * coefficient( n );
    }
    return sum;
}

static double two_n( int n )
{
    return 2.0 * n;
}

static double four_n_one_less_n( int n )
{
    return 4.0 * n * ( 1.0 - n );
}

// G = cos u - sinc u.
static double bow( double u )
{
    return u < 1.0 ? cancelled_series( u, two_n ) : cos( u ) - sin( u ) / u;
}

// 3 G + u sin u.
static double bow_slope( double u )
{
    return u < 1.0 ? cancelled_series( u, four_n_one_less_n ) : 3.0 * bow( u ) + u * sin( u );
}

double triangle_oracle_sinc( double u )
{
    return u == 0.0 ? 1.0 : sin( u ) / u;
}

double triangle_oracle_sinc_inverse( double y )
{
    if ( y >= 1.0 || y <= 0.0 )
    {
        return y >= 1.0 ? 0.0 : pi;
    }
    double u = sqrt( 6.0 * ( 1.0 - y ) );
    for ( int k = 0; k < 20 && fabs( triangle_oracle_sinc( u ) - y ) > 1e-16; ++k )
    {
        // d sinc / du = G / u
        u = fmin( fmax( u - ( triangle_oracle_sinc( u ) - y ) * u / bow( u ), 1e-12 ), pi );
    }
    return u;
}

double triangle_oracle_arc_load( double y )
{
    const double u = triangle_oracle_sinc_inverse( y );
    return u < 1e-6 ? -12.0 : 4.0 * u * u / bow( u );
}

double triangle_oracle_arc_slope( double y )
{
    const double u = triangle_oracle_sinc_inverse( y ), g = bow( u );
    return u < 1e-6 ? 7.2 : 4.0 * u * u * bow_slope( u ) / ( g * g * g );
}

double triangle_oracle_arc_energy( double y )
{
    const double u = triangle_oracle_sinc_inverse( y );
    return 2.0 * u * u;
}

double triangle_oracle_ramped_load( double y, double ramp )
{
    return y < 1.0 ? fmax( triangle_oracle_arc_load( y ), ramp * ( y - 1.0 ) ) : 0.0;
}

double triangle_oracle_ramped_slope( double y, double ramp )
{
    if ( y >= 1.0 )
    {
        return 0.0;
    }
    return triangle_oracle_arc_load( y ) < ramp * ( y - 1.0 ) ? ramp : triangle_oracle_arc_slope( y );
}

// Whether the arc's load is above the ramp, or, for `slope`, is steeper.
static bool is_above( double y, double ramp, bool slope )
{
    return slope ? triangle_oracle_arc_slope( y ) > ramp : triangle_oracle_arc_load( y ) > ramp * ( y - 1.0 );
}

// Find the length between two lengths where that changes, by bisection.
static double changes_between( double low, double high, double ramp, bool slope )
{
    const bool at_low = is_above( low, ramp, slope );
    for ( int k = 0; k < 100; ++k )
    {
        const double middle = 0.5 * ( low + high );
        *( is_above( middle, ramp, slope ) == at_low ? &low : &high ) = middle;
    }
    return 0.5 * ( low + high );
}

double triangle_oracle_ramped_energy( double y, double ramp )
{
    const double at = fmax( y, 0.0 ), of_ramp = 0.5 * ramp * ( 1.0 - at ) * ( 1.0 - at );
    if ( at >= 1.0 )
    {
        return 0.0;
    }
    // The arc's load is concave in y, so it exceeds the ramp in a single interval of lengths; the difference is
    // largest where both slopes are equal.
    const double top = is_above( 0.0, ramp, true ) ? changes_between( 0.0, 1.0, ramp, true ) : 0.0;
    if ( !is_above( top, ramp, false ) )
    {
        return of_ramp;
    }
    const double upper = changes_between( top, 1.0, ramp, false );
    const double lower = is_above( 0.0, ramp, false ) ? 0.0 : changes_between( 0.0, top, ramp, false );
    if ( at >= upper )
    {
        return of_ramp;
    }
    const double arc = triangle_oracle_arc_energy( fmax( at, lower ) ) - triangle_oracle_arc_energy( upper );
    const double under = at < lower ? of_ramp - 0.5 * ramp * ( 1.0 - lower ) * ( 1.0 - lower ) : 0.0;
    return 0.5 * ramp * ( 1.0 - upper ) * ( 1.0 - upper ) + arc + under;
}

// ---- forces ----

// (5) to (8): a link that is shorter than at rest has no stretch.
static void stretch_term( const triangle_oracle_link* link, triangle_oracle_term* term )
{
    const double beyond = term->length - link->length;
    if ( beyond > 0.0 )
    {
        term->force = link->stretch * beyond;
        term->k1 = link->stretch;
        term->k2 = link->stretch * ( 1.0 - link->length / term->length );
    }
}

// (9) to (13): a link that is longer than at rest has no bend.
static void bend_term( const triangle_oracle_link* link, bool full, triangle_oracle_term* term )
{
    const double l = link->length, y = term->length / l;
    if ( y < 1.0 && link->bend > 0.0 )
    {
        const double ramp = link->ramp * l * l * l / link->bend;
        term->force = link->bend / ( l * l ) * triangle_oracle_ramped_load( y, ramp );
        term->k1 = link->bend / ( l * l * l ) * triangle_oracle_ramped_slope( y, ramp );
        term->k2 = full ? term->force / term->length : 0.0;
    }
}

triangle_oracle_term triangle_oracle_term_at( const triangle_oracle* cloth, int link, const double3* x )
{
    const triangle_oracle_link* l = cloth->link + link;
    const double3 way = double3_sub( x[l->j], x[l->i] );
    triangle_oracle_term term = { .length = double3_length( way ) };
    if ( term.length > 0.0 )
    {
        term.direction = double3_scale( 1.0 / term.length, way );
        if ( l->bends )
        {
            bend_term( l, cloth->params.jacobian == TRIANGLE_ORACLE_JACOBIAN_FULL, &term );
        }
        else
        {
            stretch_term( l, &term );
        }
    }
    term.force *= l->scale;
    term.k1 *= l->scale;
    term.k2 *= l->scale;
    return term;
}

void triangle_oracle_forces( const triangle_oracle* cloth, const double3* x, double3* force )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = zero;
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_term term = triangle_oracle_term_at( cloth, k, x );
        force[i] = double3_add_scaled( force[i], term.force, term.direction );
        force[j] = double3_add_scaled( force[j], -term.force, term.direction );
    }
    double3* bent = calloc( (size_t)cloth->count, sizeof( double3 ) );
    plate_oracle_multiply( &cloth->plate, x, cloth->count, bent );
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = double3_add_scaled( force[i], -cloth->params.bend_rigidity, bent[i] );
    }
    free( bent );
}

void triangle_oracle_damping_forces( const triangle_oracle* cloth, const double3* x, const double3* v,
                                     double3* force )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = zero;
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_term term = triangle_oracle_term_at( cloth, k, x );
        const double3 apart = double3_sub( v[i], v[j] );
        const double rate = term.length > 0.0 ? cloth->link[k].scale * cloth->link[k].damping : 0.0;
        force[i] = double3_add_scaled( force[i], -rate, apart );
        force[j] = double3_add_scaled( force[j], rate, apart );
    }
}

void triangle_oracle_printed( const triangle_oracle* cloth, const double3* x, const double3* v, double3* force )
{
    double3* damping = calloc( (size_t)cloth->count, sizeof( double3 ) );
    triangle_oracle_forces( cloth, x, force );
    triangle_oracle_damping_forces( cloth, x, v, damping );
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = double3_scale( cloth->weight[i], double3_add( force[i], damping[i] ) );
    }
    free( damping );
}

// ---- energies ----

double triangle_oracle_energy_at( const triangle_oracle* cloth, int link, const double3* x )
{
    const triangle_oracle_link* l = cloth->link + link;
    const double r = double3_distance( x[l->i], x[l->j] ), beyond = fmax( r - l->length, 0.0 );
    if ( !l->bends )
    {
        return l->scale * 0.5 * l->stretch * beyond * beyond;
    }
    if ( !( l->bend > 0.0 ) )
    {
        return 0.0;
    }
    const double ramp = l->ramp * l->length * l->length * l->length / l->bend;
    return l->scale * l->bend / l->length * triangle_oracle_ramped_energy( r / l->length, ramp );
}

static double energy_of( const triangle_oracle* cloth, const double3* x, bool bends )
{
    double sum = 0.0;
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        sum += cloth->link[k].bends == bends ? triangle_oracle_energy_at( cloth, k, x ) : 0.0;
    }
    return sum;
}

double triangle_oracle_stretch_energy( const triangle_oracle* cloth, const double3* x )
{
    return energy_of( cloth, x, false );
}

double triangle_oracle_bend_energy( const triangle_oracle* cloth, const double3* x )
{
    return energy_of( cloth, x, true ) + cloth->params.bend_rigidity * plate_oracle_energy( &cloth->plate, x );
}

double3 triangle_oracle_momentum( const triangle_oracle* cloth )
{
    double3 sum = zero;
    for ( int i = 0; i < cloth->count; ++i )
    {
        sum = double3_add_scaled( sum, cloth->mass[i], cloth->v[i] );
    }
    return sum;
}
