#include "boundary_oracle.h"

#include <stdlib.h>
#include <string.h>

// ---- sampling ----

int boundary_oracle_gust( const balloon_mesh* mesh, const double* w, double3 gust, bool per_face, double3* v,
                          int* hits )
{
    int total = 0;
    memset( hits, 0, (size_t)mesh->vertex_count * sizeof( int ) );
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int* c = mesh->triangles + 3 * t;
        const double3* x = mesh->positions;
        const double3 n = boundary_oracle_face_normal( ( const double3[3] ){ x[c[0]], x[c[1]], x[c[2]] } );
        for ( int k = 0; k < 3 && double3_dot( n, gust ) < 0.0; ++k )
        {
            if ( w[c[k]] > 0.0 && ( per_face || hits[c[k]] == 0 ) )
            {
                v[c[k]] = double3_add( v[c[k]], gust );
                hits[c[k]] += 1;
                total += 1;
            }
        }
    }
    return total;
}

bool boundary_oracle_sphere( balloon_mesh* mesh, int slices, int stacks, double radius )
{
    const double pi = 3.14159265358979323846;
    const int rings = stacks - 1, south = slices * rings + 1;
    *mesh = ( balloon_mesh ){ .vertex_count = slices * rings + 2, .triangle_count = 2 * slices * rings };
    mesh->positions = calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    mesh->triangles = calloc( 3 * (size_t)mesh->triangle_count, sizeof( int ) );
    if ( mesh->positions == NULL || mesh->triangles == NULL )
    {
        balloon_mesh_destroy( mesh );
        return false;
    }
    mesh->positions[0] = double3_make( 0.0, radius, 0.0 );
    mesh->positions[south] = double3_make( 0.0, -radius, 0.0 );
    int* out = mesh->triangles;
    for ( int n = 0; n < slices * rings; ++n )
    {
        // ring r, slice s; `east` is the next on the ring, `below` the ring or the pole further south
        const int r = n / slices, s = n % slices, east = 1 + r * slices + ( s + 1 ) % slices, here = 1 + n;
        const double polar = pi * ( r + 1 ) / stacks, around = 2.0 * pi * s / slices;
        mesh->positions[here] = double3_make( radius * sin( polar ) * cos( around ), radius * cos( polar ),
                                              -radius * sin( polar ) * sin( around ) );
        const bool first = r == 0, last = r == rings - 1;
        const int below = last ? south : here + slices, below_east = last ? south : east + slices;
        const int corner[6] = { here, below, east, east, below, below_east };
        memcpy( out, corner, 3 * sizeof( int ) );
        out += 3;
        if ( !last )
        {
            memcpy( out, corner + 3, 3 * sizeof( int ) );
            out += 3;
        }
        if ( first )
        {
            const int cap[3] = { 0, here, east };
            memcpy( out, cap, sizeof( cap ) );
            out += 3;
        }
    }
    return true;
}

// ---- boundary ----

static const double3 zero = { 0.0, 0.0, 0.0 };

// Counts and places.

int boundary_oracle_count( double length, double d, boundary_oracle_rounding rounding )
{
    const double ratio = length / d;
    switch ( rounding )
    {
        case BOUNDARY_ORACLE_NEAREST:
            return (int)floor( ratio + 0.5 );
        case BOUNDARY_ORACLE_UP:
            return (int)ceil( ratio );
        default:
            return (int)floor( ratio );
    }
}

bool boundary_oracle_may_stay( int count, double length, double d, boundary_oracle_rounding rounding,
                               double hysteresis )
{
    // lower bound of the ratios with count 0, for each rounding
    const double lower[] = { 0.0, -0.5, -1.0 };
    const double ratio = length / d, from = count + lower[rounding];
    return ratio > from - hysteresis && ratio < from + 1.0 + hysteresis;
}

int boundary_oracle_points( int n, double length, double d, boundary_oracle_policy policy )
{
    if ( policy == BOUNDARY_ORACLE_EVEN )
    {
        return n > 1 ? n - 1 : 0;
    }
    int points = 0;
    while ( points < n && ( points + 1 ) * d < length - 1e-6 * d )
    {
        ++points;
    }
    return points;
}

double boundary_oracle_fraction( int i, int n, double length, double d, boundary_oracle_policy policy )
{
    return policy == BOUNDARY_ORACLE_EVEN ? (double)i / n : i * d / length;
}

// Lines inside a triangle.

boundary_oracle_axis boundary_oracle_axis_on( const double3 corner[3], int edge )
{
    boundary_oracle_axis axis = { .edge = edge, .a = edge, .b = ( edge + 1 ) % 3, .c = ( edge + 2 ) % 3 };
    const double3 a = corner[axis.a], base = double3_sub( corner[axis.b], a ),
                  side = double3_sub( corner[axis.c], a );
    axis.base = double3_length( base );
    axis.foot = a;
    if ( axis.base == 0.0 )
    {
        return axis;
    }
    axis.along = double3_scale( 1.0 / axis.base, base );
    axis.foot = double3_add_scaled( a, double3_dot( side, axis.along ), axis.along );
    const double3 u = double3_add_scaled( side, -double3_dot( side, axis.along ), axis.along );
    axis.height = double3_length( u );
    axis.upward = axis.height > 0.0 ? double3_scale( 1.0 / axis.height, u ) : zero;
    return axis;
}

boundary_oracle_axis boundary_oracle_axis_of( const double3 corner[3] )
{
    // squares, so that sides whose lengths round to the same number are still told apart
    int shortest = 0;
    double least = INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        const double3 side = double3_sub( corner[( k + 1 ) % 3], corner[k] );
        shortest = double3_dot( side, side ) < least ? k : shortest;
        least = fmin( least, double3_dot( side, side ) );
    }
    return boundary_oracle_axis_on( corner, shortest );
}

double boundary_oracle_height_printed( const boundary_oracle_axis* axis, const double3 corner[3] )
{
    return double3_dot( axis->along, corner[axis->a] );
}

double boundary_oracle_line_length( double base, double q )
{
    return base * ( 1.0 - q );
}

void boundary_oracle_weights( const boundary_oracle_axis* axis, double q, double r, double weight[3] )
{
    weight[axis->a] = ( 1.0 - q ) * ( 1.0 - r );
    weight[axis->b] = ( 1.0 - q ) * r;
    weight[axis->c] = q;
}

static double area_of( double3 a, double3 b, double3 c )
{
    return 0.5 * double3_length( double3_cross( double3_sub( b, a ), double3_sub( c, a ) ) );
}

bool boundary_oracle_weights_by_area( const double3 corner[3], double3 y, double weight[3] )
{
    const double area = area_of( corner[0], corner[1], corner[2] );
    for ( int k = 0; k < 3; ++k )
    {
        weight[k] = area > 0.0 ? area_of( y, corner[( k + 1 ) % 3], corner[( k + 2 ) % 3] ) / area : 0.0;
    }
    return area > 0.0;
}

// Normals.

double3 boundary_oracle_unit( double3 v )
{
    const double length = double3_length( v );
    return length >= 1e-12 ? double3_scale( 1.0 / length, v ) : zero;
}

double3 boundary_oracle_face_normal( const double3 corner[3] )
{
    const double3 n = double3_cross( double3_sub( corner[1], corner[0] ), double3_sub( corner[2], corner[0] ) );
    const double length = double3_length( n );
    return isfinite( length ) && length > 0.0 ? double3_scale( 1.0 / length, n ) : zero;
}

void boundary_oracle_vertex_normals( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                                     double3* normal )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        normal[i] = zero;
    }
    for ( int t = 0; t < triangle_count; ++t )
    {
        const int* v = triangles + 3 * t;
        const double3 n = boundary_oracle_face_normal( ( const double3[3] ){ x[v[0]], x[v[1]], x[v[2]] } );
        for ( int k = 0; k < 3; ++k )
        {
            normal[v[k]] = double3_add( normal[v[k]], n );
        }
    }
    for ( int i = 0; i < vertex_count; ++i )
    {
        normal[i] = boundary_oracle_unit( normal[i] );
    }
}

double3 boundary_oracle_edge_normal( double3 n0, double3 n1, double tau )
{
    return boundary_oracle_unit( double3_blend( n0, n1, tau ) );
}

double3 boundary_oracle_inner_normal( const double3 normal[3], const boundary_oracle_axis* axis, double q, double r,
                                      boundary_oracle_normals mode )
{
    if ( mode == BOUNDARY_ORACLE_SCANLINE )
    {
        const double3 first = boundary_oracle_edge_normal( normal[axis->a], normal[axis->c], q );
        const double3 last = boundary_oracle_edge_normal( normal[axis->b], normal[axis->c], q );
        return boundary_oracle_edge_normal( first, last, r );
    }
    double weight[3];
    boundary_oracle_weights( axis, q, r, weight );
    double3 sum = zero;
    for ( int k = 0; k < 3; ++k )
    {
        sum = double3_add_scaled( sum, weight[k], normal[k] );
    }
    return boundary_oracle_unit( sum );
}

// Local spacing.

double boundary_oracle_spacing_by_curvature( double d, double gain, double3 n0, double3 n1 )
{
    return d / ( 1.0 + gain * double3_angle( n0, n1 ) );
}

double boundary_oracle_spacing_by_strain( double d, double gain, double length, double rest )
{
    const double factor = 1.0 + fabs( gain ) * ( rest > 0.0 ? fabs( length / rest - 1.0 ) : 0.0 );
    return gain < 0.0 ? d * factor : d / factor;
}

double boundary_oracle_spacing_by_distance( double3 eye, double3 middle, double eye_angle )
{
    return double3_distance( eye, middle ) * eye_angle;
}

double boundary_oracle_local_spacing( const boundary_oracle_criteria* criteria, double d, double3 p0, double3 p1,
                                      double3 n0, double3 n1, double rest )
{
    double queried = INFINITY;
    if ( criteria->curvature_gain != 0.0 )
    {
        queried = fmin( queried, boundary_oracle_spacing_by_curvature( d, criteria->curvature_gain, n0, n1 ) );
    }
    if ( criteria->strain_gain != 0.0 )
    {
        queried = fmin( queried, boundary_oracle_spacing_by_strain( d, criteria->strain_gain,
                                                                    double3_distance( p0, p1 ), rest ) );
    }
    if ( criteria->eye_angle > 0.0 )
    {
        queried = fmin( queried, boundary_oracle_spacing_by_distance( criteria->eye, double3_blend( p0, p1, 0.5 ),
                                                                      criteria->eye_angle ) );
    }
    queried = isinf( queried ) ? d : queried;
    return fmin( fmax( queried, criteria->least ), criteria->most );
}

double boundary_oracle_triangle_spacing( const double edge_spacing[3] )
{
    return fmin( edge_spacing[0], fmin( edge_spacing[1], edge_spacing[2] ) );
}

// Contact.

bool boundary_oracle_contact( int count, double3* x, const double* w, const double* b, double3 unit_normal,
                              double offset, double plane_w, double* plane_move )
{
    double c = -offset, sum = plane_w;
    for ( int i = 0; i < count; ++i )
    {
        c += b[i] * double3_dot( x[i], unit_normal );
        sum += w[i] * b[i] * b[i];
    }
    const bool acts = c < 0.0 && sum > 0.0;
    for ( int i = 0; acts && i < count; ++i )
    {
        x[i] = double3_add_scaled( x[i], -c * w[i] * b[i] / sum, unit_normal );
    }
    if ( plane_move != NULL )
    {
        *plane_move = acts ? plane_w * c / sum : 0.0;
    }
    return acts;
}
