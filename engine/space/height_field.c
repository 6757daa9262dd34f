// Height fields. The solid is everything below a piecewise linear surface over the xz plane, so whether a point is inside is a
// comparison of heights, and the surface at the same x and z bounds its distance: only cells within that distance are
// searched, outwards from the cell of the point. Beyond the border the heights of the border go on, so of the cells there only
// the row and the column of the point can be the nearest.
#include "solid.h"

#include "mesh_bvh.h"

#include "wisp/module/collision_mesh.h"

// ---- features ----

// Edges and corners of height fields that stick out, as those of meshes do (mesh_features.c). Each edge belongs to its corner with the lower
// row and column: one along x, one along z, and the diagonal of the cell.

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

// ---- height field ----

bool height_field_is_solid( const wisp_height_field* f )
{
    return f->heights != NULL && f->count_x >= 2 && f->count_z >= 2 && f->spacing > 0.0f && f->spacing <= FLT_MAX;
}

double3 height_field_sample( const wisp_height_field* f, int i, int k )
{
    const int ci = i < 0 ? 0 : ( i >= f->count_x ? f->count_x - 1 : i );
    const int ck = k < 0 ? 0 : ( k >= f->count_z ? f->count_z - 1 : k );
    const double s = (double)f->spacing;
    return ( double3 ){ ( i - 0.5 * ( f->count_x - 1 ) ) * s,
                        (double)f->heights[(size_t)ck * (size_t)f->count_x + (size_t)ci],
                        ( k - 0.5 * ( f->count_z - 1 ) ) * s };
}

// The two triangles of a cell, which face upwards.
static void corners_of( const wisp_height_field* f, int i, int k, int half, double3 corner[3] )
{
    corner[0] = height_field_sample( f, i, k );
    corner[1] = half == 0 ? height_field_sample( f, i, k + 1 ) : height_field_sample( f, i + 1, k + 1 );
    corner[2] = half == 0 ? height_field_sample( f, i + 1, k + 1 ) : height_field_sample( f, i + 1, k );
}

static double3 normal_of( const double3 c[3] )
{
    return double3_unit_or_zero( double3_cross( double3_sub( c[1], c[0] ), double3_sub( c[2], c[0] ) ) );
}

// Coordinates in cells. Far outside the field is constant along the axis, so the cell there may stand for all beyond.
static double cell_coordinate( double x, double spacing, int count )
{
    const double u = x / spacing + 0.5 * ( count - 1 );
    return u < -1e8 ? -1e8 : ( u > 1e8 ? 1e8 : u );
}

typedef struct field_search
{
    const wisp_height_field* field;
    double3 p, nearest, normal;
    double least; // m^2
} field_search;

static void search_cell( field_search* s, int i, int k )
{
    for ( int half = 0; half < 2; ++half )
    {
        double3 c[3];
        corners_of( s->field, i, k, half, c );
        const double3 q = closest_on_triangle( s->p, c[0], c[1], c[2] ), d = double3_sub( s->p, q );
        const double squared = double3_dot( d, d );
        if ( squared < s->least )
        {
            s->least = squared;
            s->nearest = q;
            s->normal = normal_of( c );
        }
    }
}

static double beside( double u, int cell )
{
    return u < cell ? cell - u : ( u > cell + 1 ? u - ( cell + 1 ) : 0.0 );
}

static int nearest_cell( int cell, int count )
{
    return cell < 0 ? 0 : ( cell > count - 2 ? count - 2 : cell );
}

// Searches the cells of a row, `apart` cells away.
static void search_row( field_search* s, double u, int i, int k, double apart )
{
    const int count = s->field->count_x, first = nearest_cell( i, count );
    const double spacing = (double)s->field->spacing;
    if ( first != i )
    {
        search_cell( s, i, k );
    }
    for ( int d = 0; d < count - 1; ++d )
    {
        const int sides[2] = { first + d, first - d };
        bool is_near = false;
        for ( int side = 0; side < ( d == 0 ? 1 : 2 ); ++side )
        {
            const double away = beside( u, sides[side] );
            const bool is_cell = sides[side] >= 0 && sides[side] <= count - 2;
            if ( is_cell && spacing * spacing * ( away * away + apart * apart ) < s->least )
            {
                search_cell( s, sides[side], k );
                is_near = true;
            }
        }
        if ( is_near == false )
        {
            return;
        }
    }
}

static void search_rows( field_search* s, double u, double w, int i, int k )
{
    const int count = s->field->count_z, first = nearest_cell( k, count );
    const double spacing = (double)s->field->spacing;
    if ( first != k )
    {
        search_row( s, u, i, k, 0.0 );
    }
    for ( int d = 0; d < count - 1; ++d )
    {
        const int sides[2] = { first + d, first - d };
        bool is_near = false;
        for ( int side = 0; side < ( d == 0 ? 1 : 2 ); ++side )
        {
            const double apart = beside( w, sides[side] );
            const bool is_row = sides[side] >= 0 && sides[side] <= count - 2;
            if ( is_row && spacing * apart * spacing * apart < s->least )
            {
                search_row( s, u, i, sides[side], apart );
                is_near = true;
            }
        }
        if ( is_near == false )
        {
            return;
        }
    }
}

static void find_below( const wisp_height_field* f, double3 p, int* i, int* k, double3 corner[3] )
{
    const double u = cell_coordinate( p.x, (double)f->spacing, f->count_x );
    const double w = cell_coordinate( p.z, (double)f->spacing, f->count_z );
    *i = (int)floor( u );
    *k = (int)floor( w );
    corners_of( f, *i, *k, w - *k >= u - *i ? 0 : 1, corner );
}

void height_field_closest( const wisp_height_field* f, double3 p, wisp_surface_point* s )
{
    int i, k;
    double3 c[3];
    find_below( f, p, &i, &k, c );
    const double3 normal = normal_of( c );
    const double gap = p.y - ( c[0].y - ( normal.x * ( p.x - c[0].x ) + normal.z * ( p.z - c[0].z ) ) / normal.y );
    const double3 under = { p.x, p.y - gap, p.z };
    field_search search = { f, p, under, normal, gap * gap };
    search_rows( &search, cell_coordinate( p.x, (double)f->spacing, f->count_x ),
                 cell_coordinate( p.z, (double)f->spacing, f->count_z ), i, k );
    const double distance = sqrt( search.least );
    const double tiny = 1e-9 * (double)f->spacing;
    const double3 away = double3_scale( double3_sub( p, search.nearest ), distance > tiny ? 1.0 / distance : 0.0 );
    const double side = gap < 0.0 ? -1.0 : 1.0;
    s->point = double3_narrow( search.nearest );
    s->normal = double3_narrow( distance > tiny ? double3_scale( away, side ) : search.normal );
    s->distance = (float)( side * distance );
}

// ---- paths ----

// Clips the path by the plane of a triangle, within the triangle seen from above.
static double enter_triangle( const double3 c[3], double3 from, double3 step, double first, double last,
                              double3* normal )
{
    const double3 n = normal_of( c );
    const double height = double3_dot( n, double3_sub( from, c[0] ) ), speed = double3_dot( n, step );
    const double before = height + first * speed, after = height + last * speed;
    if ( !( speed < 0.0 ) || after > 0.0 )
    {
        return SOLID_NEVER;
    }
    *normal = n;
    return before <= 0.0 ? first : -height / speed;
}

// Returns the next time at which u + t v is a whole number from `lower` to `upper`, after a time.
static double next_line( double u, double v, double time, double lower, double upper )
{
    if ( v == 0.0 )
    {
        return SOLID_NEVER;
    }
    const double at = u + time * v;
    const double line = v > 0.0 ? fmax( floor( at + 1e-9 ) + 1.0, lower ) : fmin( ceil( at - 1e-9 ) - 1.0, upper );
    return line < lower || line > upper ? SOLID_NEVER : ( line - u ) / v;
}

// Walks through the cells that the path crosses, seen from above, and through the halves of each.
double height_field_enter( const wisp_height_field* f, double3 from, double3 step, double3* normal )
{
    const double s = (double)f->spacing;
    const double u = from.x / s + 0.5 * ( f->count_x - 1 ), w = from.z / s + 0.5 * ( f->count_z - 1 );
    const double du = step.x / s, dw = step.z / s;
    double time = 0.0;
    while ( time < 1.0 )
    {
        // lines of the grid and diagonals; beyond the border there is none
        const double x = f->count_x - 1, z = f->count_z - 1;
        double end = fmin( fmin( next_line( u, du, time, 0.0, x ), next_line( w, dw, time, 0.0, z ) ),
                           next_line( w - u, dw - du, time, -x, z ) );
        end = end < 1.0 ? end : 1.0;
        double3 c[3];
        int i, k;
        find_below( f, double3_mul_add( from, 0.5 * ( time + end ), step ), &i, &k, c );
        const double found = enter_triangle( c, from, step, time, end, normal );
        if ( found <= 1.0 )
        {
            return found;
        }
        time = end > time ? end : 1.0;
    }
    return SOLID_NEVER;
}
