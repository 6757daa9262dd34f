// Counts and fractions from lengths (boundary particle paper, sections 2 and 3), in double precision.
#include "samples_parts.h"

#include <float.h>
#include <math.h>

// Distance in spacings below which a point coincides with the second end of an edge.
static const double END = 1e-6;

// Minimum and maximum length for a count of n = 0.
static double first_length( const wisp_samples_args* args )
{
    return args->rounding == WISP_ROUND_DOWN ? 0.0 : ( args->rounding == WISP_ROUND_NEAREST ? -0.5 : -1.0 );
}

double samples_count_of( const wisp_samples_args* args, double length )
{
    switch ( args->rounding )
    {
        case WISP_ROUND_NEAREST:
            return floor( length + 0.5 );
        case WISP_ROUND_UP:
            return ceil( length );
        default:
            return floor( length );
    }
}

double samples_points_of( const wisp_samples_args* args, double n, double length )
{
    const double inside = args->policy == WISP_SPACING_EVEN ? n - 1.0 : ceil( length - END ) - 1.0;
    const double points = inside < n ? inside : n;
    return points > 0.0 ? points : 0.0;
}

double samples_fraction( const wisp_samples_args* args, double i, double n, double length )
{
    return args->policy == WISP_SPACING_EVEN ? i / n : i / length;
}

bool samples_may_stay( const wisp_samples_args* args, double n, double length )
{
    const double from = n + first_length( args ), h = (double)args->hysteresis;
    return length > from - h && length < from + 1.0 + h;
}

samples_bounds samples_bounds_of( const wisp_samples_args* args, double n, double points )
{
    // without hysteresis only the points matter, so n = 0 and n = 1 of the even policy are equal
    const double h = (double)args->hysteresis;
    samples_bounds b = { -1.0, DBL_MAX };
    if ( h > 0.0 )
    {
        const double from = n + first_length( args );
        b = ( samples_bounds ){ from - h, from + 1.0 + h };
    }
    else if ( args->policy == WISP_SPACING_EVEN )
    {
        const double from = points + 1.0 + first_length( args );
        b = ( samples_bounds ){ points > 0.0 ? from : -1.0, from + 1.0 };
    }
    if ( args->policy == WISP_SPACING_EXACT )
    {
        const double lower = points > 0.0 ? points + END : -1.0, upper = points + 1.0 + END;
        b.lower = lower > b.lower ? lower : b.lower;
        b.upper = points == n && h > 0.0 ? b.upper : ( upper < b.upper ? upper : b.upper );
    }
    return b;
}

// ---- extents ----

typedef struct double_vector
{
    double x, y, z;
} double_vector;

static double_vector between( const float* a, const float* b )
{
    return ( double_vector ){ (double)b[0] - (double)a[0], (double)b[1] - (double)a[1], (double)b[2] - (double)a[2] };
}

static double dot( double_vector a, double_vector b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static bool is_finite_number( const float* p )
{
    return fabsf( p[0] ) <= FLT_MAX && fabsf( p[1] ) <= FLT_MAX && fabsf( p[2] ) <= FLT_MAX;
}

bool samples_measure_edge( const wisp_samples_args* args, int edge, double* length )
{
    const float* a = args->position + (size_t)args->edges[2 * (size_t)edge] * 4;
    const float* b = args->position + (size_t)args->edges[2 * (size_t)edge + 1] * 4;
    const double d = (double)( args->edge_spacing != NULL ? args->edge_spacing[edge] : args->spacing );
    const double_vector along = between( a, b );
    *length = sqrt( dot( along, along ) ) / d;
    return is_finite_number( a ) && is_finite_number( b );
}

bool samples_measure_triangle( const wisp_samples_args* args, int triangle, samples_extent* out )
{
    const int32_t* slots = args->triangles + 3 * (size_t)triangle;
    const double d = (double)( args->triangle_spacing != NULL ? args->triangle_spacing[triangle] : args->spacing );
    const float* p[3];
    double_vector side[3];
    bool finite = true;
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = args->position + (size_t)slots[k] * 4;
        finite = finite && is_finite_number( p[k] );
    }
    double squared[3];
    int axis = 0;
    for ( int k = 0; k < 3; ++k )
    {
        side[k] = between( p[k], p[( k + 1 ) % 3] );
        squared[k] = dot( side[k], side[k] );
        axis = squared[k] < squared[axis] ? k : axis;
    }
    *out = ( samples_extent ){ .axis = axis, .base = sqrt( squared[axis] ) };
    if ( out->base > 0.0 )
    {
        // u = (c - a) - ((c - a) . s) s; the side from c to a has the opposite direction, which does not change its
        // length
        const double_vector s = side[axis], up = side[( axis + 2 ) % 3];
        const double along = dot( up, s ) / squared[axis];
        const double_vector u = { up.x - along * s.x, up.y - along * s.y, up.z - along * s.z };
        out->height = sqrt( dot( u, u ) ) / d;
        out->base /= d;
    }
    return finite;
}

// ---- lines ----

samples_lines samples_lines_of( const wisp_samples_args* args, const samples_extent* made, const samples_extent* now )
{
    const double n = samples_count_of( args, made->height );
    return ( samples_lines ){
        .args = args,
        .made_base = made->base,
        .made_height = made->height,
        .base = now->base,
        .height = now->height,
        .n = n,
        .most = samples_points_of( args, n, now->height ),
    };
}

bool samples_next_line( samples_lines* lines )
{
    if ( lines->k >= lines->most )
    {
        return false;
    }
    const wisp_samples_args* args = lines->args;
    lines->k += 1.0;
    lines->fraction = samples_fraction( args, lines->k, lines->n, lines->height );
    lines->length = lines->base * ( 1.0 - lines->fraction );
    lines->m = samples_count_of(
        args, lines->made_base * ( 1.0 - samples_fraction( args, lines->k, lines->n, lines->made_height ) ) );
    lines->points = samples_points_of( args, lines->m, lines->length );
    return lines->points > 0.0;
}
