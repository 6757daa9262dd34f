#include "slender_theory.h"

#include <math.h>

// ---- rods ----

static const double PI = 3.14159265358979323846;

double rod_ring_twist( double ratio )
{
    return 2.0 * PI * sqrt( 3.0 ) / ratio;
}

double rod_straight_moment( double tension, double weight )
{
    return 2.0 * sqrt( tension + 0.5 * weight + PI * PI );
}

rod_writhe rod_writhe_of( double angle, double shortening, double ratio )
{
    const double t = cos( 0.5 * angle ), q = sin( 0.5 * angle ), wave = 4.0 * q / shortening, moment = 2.0 * t * wave;
    return ( rod_writhe ){
        .tension = wave * wave,
        .moment = moment,
        .rotation = moment / ratio + 2.0 * angle,
    };
}

rod_writhe rod_writhe_limit( double shortening, double ratio )
{
    return rod_writhe_of( acos( -0.5 * shortening * ratio ), shortening, ratio );
}

// ---- curls ----

enum
{
    THETA,
    SLOPE,
    THETA_BY_END, // derivatives by the angle at the tip
    SLOPE_BY_END,
    FIRST, // beta, phi and their momenta in a solution that is free at the tip
    SECOND = FIRST + 4,
    VALUES = SECOND + 4,
    NEWTON = 40,
    WEIGHTS = 64, // on the way from 0
};

// Derivatives by s. The momenta are p = beta' + theta' phi - M phi and q = c (phi' - theta' beta).
static void slope_of( const curl_rod* rod, double s, const double* y, double* out )
{
    const double load = rod->weight * ( 1.0 - s ), bend = y[SLOPE], moment = rod->in_plane * ( bend - rod->curl );
    out[THETA] = bend;
    out[SLOPE] = load * sin( y[THETA] ) / rod->in_plane;
    out[THETA_BY_END] = y[SLOPE_BY_END];
    out[SLOPE_BY_END] = load * cos( y[THETA] ) / rod->in_plane * y[THETA_BY_END];
    for ( int i = FIRST; i < VALUES; i += 4 )
    {
        const double beta = y[i], phi = y[i + 1], p = y[i + 2], q = y[i + 3];
        out[i] = p + ( moment - bend ) * phi;
        out[i + 1] = q / rod->twist + bend * beta;
        out[i + 2] = -bend * q - moment * bend * beta + load * cos( y[THETA] ) * beta;
        out[i + 3] = bend * ( p + moment * phi ) - moment * out[i] - moment * bend * phi;
    }
}

static void add( const double* y, double h, const double* slope, double* out )
{
    for ( int i = 0; i < VALUES; ++i )
    {
        out[i] = y[i] + h * slope[i];
    }
}

// Runge and Kutta over one piece.
static void move_on( const curl_rod* rod, double s, double h, double* y )
{
    double a[VALUES], b[VALUES], c[VALUES], d[VALUES], t[VALUES];
    slope_of( rod, s, y, a );
    add( y, 0.5 * h, a, t );
    slope_of( rod, s + 0.5 * h, t, b );
    add( y, 0.5 * h, b, t );
    slope_of( rod, s + 0.5 * h, t, c );
    add( y, h, c, t );
    slope_of( rod, s + h, t, d );
    for ( int i = 0; i < VALUES; ++i )
    {
        y[i] += h / 6.0 * ( a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i] );
    }
}

// From the tip, whose moment is 0, to the clamp. @param by_end derivative of the result by `end` @return angle at the clamp
static double shoot( const curl_rod* rod, double end, double* by_end, curl_shape* out )
{
    const double h = 1.0 / CURL_PIECES;
    double y[VALUES] = {
        [THETA] = end, [SLOPE] = rod->curl, [THETA_BY_END] = 1.0, [FIRST] = 1.0, [SECOND + 1] = 1.0
    };
    double before = 1.0;
    out->theta[CURL_PIECES] = end;
    out->aside = out->down = 0.0;
    out->modes = 0;
    for ( int i = CURL_PIECES; i > 0; --i )
    {
        const double from = y[THETA], bent = y[SLOPE];
        move_on( rod, i * h, -h, y );
        // Simpson, with the angle in the middle from the cubic through both ends
        const double middle = 0.5 * ( from + y[THETA] ) + 0.125 * h * ( y[SLOPE] - bent );
        out->aside += h / 6.0 * ( sin( from ) + 4.0 * sin( middle ) + sin( y[THETA] ) );
        out->down += h / 6.0 * ( cos( from ) + 4.0 * cos( middle ) + cos( y[THETA] ) );
        out->theta[i - 1] = y[THETA];
        const double both = y[FIRST] * y[SECOND + 1] - y[FIRST + 1] * y[SECOND];
        out->modes += ( both > 0.0 ) != ( before > 0.0 ) ? 1 : 0;
        before = both;
    }
    *by_end = y[THETA_BY_END];
    return y[THETA];
}

// @param end in: of a nearby equilibrium, out: of this one
static bool solve( const curl_rod* rod, double* end, curl_shape* out )
{
    for ( int i = 0; i < NEWTON; ++i )
    {
        double by_end;
        const double miss = shoot( rod, *end, &by_end, out ) - rod->clamp;
        if ( fabs( miss ) < 1e-10 )
        {
            return by_end > 0.0; // it falls to 0 where the equilibrium folds back
        }
        *end -= fmax( -0.5, fmin( 0.5, miss / by_end ) );
    }
    return false;
}

bool curl_hang( const curl_rod* rod, curl_shape* out )
{
    curl_rod at = *rod;
    double end = rod->clamp + rod->curl;
    bool is_found = true;
    for ( int i = 0; i <= WEIGHTS && is_found; ++i )
    {
        at.weight = rod->weight * i / WEIGHTS;
        is_found = solve( &at, &end, out );
    }
    return is_found;
}

double curl_critical_weight( const curl_rod* rod )
{
    curl_rod at = *rod;
    curl_shape shape;
    double end = rod->clamp + rod->curl, stable_end = end, stable = 0.0, unstable = NAN;
    for ( int i = 0; i <= WEIGHTS && isnan( unstable ); ++i )
    {
        at.weight = rod->weight * i / WEIGHTS;
        if ( solve( &at, &end, &shape ) == false )
        {
            return NAN;
        }
        unstable = shape.modes > 0 ? at.weight : NAN;
        stable = shape.modes > 0 ? stable : at.weight;
        stable_end = shape.modes > 0 ? stable_end : end;
    }
    for ( int i = 0; i < 40 && isnan( unstable ) == false; ++i )
    {
        at.weight = 0.5 * ( stable + unstable );
        end = stable_end;
        if ( solve( &at, &end, &shape ) == false )
        {
            return NAN;
        }
        *( shape.modes > 0 ? &unstable : &stable ) = at.weight;
        stable_end = shape.modes > 0 ? stable_end : end;
    }
    return unstable;
}

// ---- slender bodies ----

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
