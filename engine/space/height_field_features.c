// Edges and corners of height fields that stick out, as those of meshes do (mesh_features.c). Each edge belongs to its corner with the lower
// row and column: one along x, one along z, and the diagonal of the cell.
#include "mesh_features.h"
#include "solid.h"

#include "wisp/module/collision_mesh.h"

enum
{
    ALONG_X,
    ALONG_Z,
    DIAGONAL,
    CORNER,
    PER_SAMPLE, // numbers of a feature
};

typedef struct sample
{
    int i, k;
} sample;

// The other end of an edge, and what the two faces beside it have beyond it: the first face is to its left, seen from above with z down.
static const sample ENDS[3] = { { 1, 0 }, { 0, 1 }, { 1, 1 } };
static const sample BEYOND[3][2] = { { { 1, 1 }, { 0, -1 } }, { { -1, 0 }, { 1, 1 } }, { { 0, 1 }, { 1, 0 } } };

static double3 upward( double3 a, double3 b, double3 c )
{
    const double3 n = double3_unit_or_zero( double3_cross( double3_sub( b, a ), double3_sub( c, a ) ) );
    return n.y < 0.0 ? ( double3 ){ -n.x, -n.y, -n.z } : n;
}

// @param normals [2] receives those of the faces beside an edge @return whether it is a ridge
static bool is_ridge_of_field( const wisp_height_field* f, int i, int k, int kind, double3 normals[2] )
{
    const double3 a = height_field_sample( f, i, k ),
                  b = height_field_sample( f, i + ENDS[kind].i, k + ENDS[kind].k );
    double3 beyond[2];
    for ( int side = 0; side < 2; ++side )
    {
        beyond[side] = height_field_sample( f, i + BEYOND[kind][side].i, k + BEYOND[kind][side].k );
        normals[side] = upward( a, b, beyond[side] );
    }
    const double3 n = double3_cross( normals[0], normals[1] );
    return double3_dot( n, n ) > MESH_FEATURES_PLANE * MESH_FEATURES_PLANE &&
           double3_dot( normals[0], double3_sub( beyond[1], a ) ) < 0.0;
}

// Whether one of the six edges of a corner is a ridge.
static bool is_peak( const wisp_height_field* f, int i, int k, double3* normal )
{
    bool any = false;
    *normal = ( double3 ){ 0.0, 0.0, 0.0 };
    for ( int kind = 0; kind < 3; ++kind )
    {
        for ( int back = 0; back < 2; ++back )
        {
            double3 normals[2];
            any = is_ridge_of_field( f, i - back * ENDS[kind].i, k - back * ENDS[kind].k, kind, normals ) || any;
            *normal = double3_mul_add( double3_mul_add( *normal, 1.0, normals[0] ), 1.0, normals[1] );
        }
    }
    *normal = double3_unit_or_zero( *normal );
    return any;
}

static int clamped( double u, int count )
{
    return u < 0.0 ? 0 : ( u > count - 1.0 ? count - 1 : (int)u );
}

// Whether the box of an edge, or of a corner, overlaps another one.
static bool overlaps( double3 a, double3 b, const float lower[3], const float upper[3] )
{
    return fmin( a.x, b.x ) <= (double)upper[0] && fmax( a.x, b.x ) >= (double)lower[0] &&
           fmin( a.y, b.y ) <= (double)upper[1] && fmax( a.y, b.y ) >= (double)lower[1] &&
           fmin( a.z, b.z ) <= (double)upper[2] && fmax( a.z, b.z ) >= (double)lower[2];
}

int wisp_height_field_find_features( const wisp_height_field* f, const float lower[3], const float upper[3],
                                     bool corners, int32_t* out, int capacity )
{
    const double rate = 1.0 / (double)f->spacing, x = 0.5 * ( f->count_x - 1 ), z = 0.5 * ( f->count_z - 1 );
    const int first_i = clamped( floor( rate * (double)lower[0] + x ) - 1.0, f->count_x ),
              first_k = clamped( floor( rate * (double)lower[2] + z ) - 1.0, f->count_z ),
              last_i = clamped( rate * (double)upper[0] + x, f->count_x ),
              last_k = clamped( rate * (double)upper[2] + z, f->count_z );
    int found = 0;
    for ( int k = first_k; k <= last_k; ++k )
    {
        for ( int i = first_i; i <= last_i; ++i )
        {
            for ( int kind = corners ? CORNER : ALONG_X; kind < ( corners ? PER_SAMPLE : CORNER ); ++kind )
            {
                const sample end = corners ? ( sample ){ 0, 0 } : ENDS[kind];
                double3 normals[2];
                if ( i + end.i < f->count_x && k + end.k < f->count_z && found < capacity &&
                     overlaps( height_field_sample( f, i, k ), height_field_sample( f, i + end.i, k + end.k ), lower,
                               upper ) &&
                     ( corners ? is_peak( f, i, k, normals ) : is_ridge_of_field( f, i, k, kind, normals ) ) )
                {
                    out[found++] = ( k * f->count_x + i ) * PER_SAMPLE + kind;
                }
            }
        }
    }
    return found;
}

wisp_mesh_feature wisp_height_field_feature( const wisp_height_field* f, int32_t feature )
{
    const int number = feature / PER_SAMPLE, kind = feature % PER_SAMPLE, i = number % f->count_x,
              k = number / f->count_x;
    const sample end = kind == CORNER ? ( sample ){ 0, 0 } : ENDS[kind];
    const wisp_vec3 a = double3_narrow( height_field_sample( f, i, k ) ),
                    b = double3_narrow( height_field_sample( f, i + end.i, k + end.k ) );
    return ( wisp_mesh_feature ){ { a, b }, { a, b } };
}

wisp_mesh_sides wisp_height_field_sides( const wisp_height_field* f, int32_t feature )
{
    const int number = feature / PER_SAMPLE, kind = feature % PER_SAMPLE, i = number % f->count_x,
              k = number / f->count_x;
    double3 normals[2];
    const bool sticks_out =
        kind == CORNER ? is_peak( f, i, k, normals ) : is_ridge_of_field( f, i, k, kind, normals );
    const double3 n =
        kind == CORNER ? normals[0] : double3_unit_or_zero( double3_mul_add( normals[0], 1.0, normals[1] ) );
    return ( wisp_mesh_sides ){ double3_narrow( n ), sticks_out, false };
}
