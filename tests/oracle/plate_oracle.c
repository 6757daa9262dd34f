#include "plate_oracle.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    NEAR = 5,  // hinges: one, and two of each of its triangles
    KNOWN = 3, // quadratic surfaces
    UNKNOWN = NEAR + KNOWN,
    PATCH = 12, // vertices of a triangle, its neighbours and theirs
};

typedef struct vec2
{
    double x, y;
} vec2;

// A linear form over vertices.
typedef struct form
{
    int count;
    int vertex[4 * NEAR];
    double factor[4 * NEAR];
} form;

typedef struct mesh
{
    vec2* at;
    const int ( *triangle )[3];
    int triangle_count;
    const bool* pinned;
} mesh;

static double cross( vec2 a, vec2 b )
{
    return a.x * b.y - a.y * b.x;
}

static vec2 from_to( const mesh* m, int a, int b )
{
    return ( vec2 ){ m->at[b].x - m->at[a].x, m->at[b].y - m->at[a].y };
}

static double length( vec2 a )
{
    return sqrt( a.x * a.x + a.y * a.y );
}

static double area( const mesh* m, int t )
{
    const int* v = m->triangle[t];
    return 0.5 * cross( from_to( m, v[0], v[1] ), from_to( m, v[0], v[2] ) );
}

// The triangle across the edge from corner k of t. @return -1: none, or the edge is no hinge
static int across( const mesh* m, int t, int k )
{
    const int a = m->triangle[t][k], b = m->triangle[t][( k + 1 ) % 3];
    int found = -1;
    for ( int other = 0; other < m->triangle_count; ++other )
    {
        for ( int n = 0; n < 3; ++n )
        {
            if ( m->triangle[other][n] == b && m->triangle[other][( n + 1 ) % 3] == a )
            {
                found = other;
            }
        }
    }
    return found;
}

static int corner_of( const mesh* m, int t, int vertex )
{
    return m->triangle[t][0] == vertex ? 0 : ( m->triangle[t][1] == vertex ? 1 : 2 );
}

static bool is_rigid( const mesh* m, int t )
{
    const int* v = m->triangle[t];
    return m->pinned != NULL && m->pinned[v[0]] && m->pinned[v[1]] && m->pinned[v[2]];
}

static void add( form* f, int vertex, double factor )
{
    f->vertex[f->count] = vertex;
    f->factor[f->count++] = factor;
}

// Gradient of the linear interpolant of a triangle along n: w_v times the gradient of its barycentric coordinate.
static void add_gradient( const mesh* m, int t, vec2 n, double sign, form* out )
{
    for ( int k = 0; k < 3; ++k )
    {
        const vec2 edge = from_to( m, m->triangle[t][( k + 1 ) % 3], m->triangle[t][( k + 2 ) % 3] );
        const vec2 gradient = { -edge.y / ( 2.0 * area( m, t ) ), edge.x / ( 2.0 * area( m, t ) ) };
        add( out, m->triangle[t][k], sign * ( gradient.x * n.x + gradient.y * n.y ) );
    }
}

// Out of t, across its edge k.
static vec2 normal( const mesh* m, int t, int k )
{
    const vec2 e = from_to( m, m->triangle[t][k], m->triangle[t][( k + 1 ) % 3] );
    return ( vec2 ){ e.y / length( e ), -e.x / length( e ) };
}

// How much steeper the next triangle is than t.
static form jump_of( const mesh* m, int t, int k )
{
    form f = { .count = 0 };
    add_gradient( m, across( m, t, k ), normal( m, t, k ), 1.0, &f );
    add_gradient( m, t, normal( m, t, k ), -1.0, &f );
    return f;
}

// Surfaces of unit curvature.
static double monomial( int n, vec2 p )
{
    return n == 0 ? 0.5 * p.x * p.x : ( n == 1 ? 0.5 * p.y * p.y : sqrt( 0.5 ) * p.x * p.y );
}

static double apply( const mesh* m, const form* f, int n )
{
    double sum = 0.0;
    for ( int i = 0; i < f->count; ++i )
    {
        sum += f->factor[i] * monomial( n, m->at[f->vertex[i]] );
    }
    return sum;
}

// Normal derivative of a monomial at the middle of an edge, less that of the interpolant of t.
static double turn_of( const mesh* m, int t, int k, int n )
{
    const vec2 a = m->at[m->triangle[t][k]], b = m->at[m->triangle[t][( k + 1 ) % 3]], out = normal( m, t, k );
    const vec2 p = { 0.5 * ( a.x + b.x ), 0.5 * ( a.y + b.y ) };
    const double h = sqrt( 0.5 );
    const vec2 gradient =
        n == 0 ? ( vec2 ){ p.x, 0.0 } : ( n == 1 ? ( vec2 ){ 0.0, p.y } : ( vec2 ){ h * p.y, h * p.x } );
    form f = { .count = 0 };
    add_gradient( m, t, out, 1.0, &f );
    return gradient.x * out.x + gradient.y * out.y - apply( m, &f, n );
}

static void eliminate( double a[UNKNOWN][UNKNOWN + 1] )
{
    for ( int p = 0; p < UNKNOWN; ++p )
    {
        int best = p;
        for ( int r = p; r < UNKNOWN; ++r )
        {
            best = fabs( a[r][p] ) > fabs( a[best][p] ) ? r : best;
        }
        double row[UNKNOWN + 1];
        memcpy( row, a[p], sizeof( row ) );
        memcpy( a[p], a[best], sizeof( row ) );
        memcpy( a[best], row, sizeof( row ) );
        for ( int r = 0; r < UNKNOWN; ++r )
        {
            const double factor = r != p ? a[r][p] / a[p][p] : 0.0;
            for ( int c = p; c <= UNKNOWN && factor != 0.0; ++c )
            {
                a[r][c] -= factor * a[p][c];
            }
        }
    }
    for ( int p = 0; p < UNKNOWN; ++p )
    {
        a[p][UNKNOWN] /= a[p][p];
    }
}

// Hinges around one: itself, then those of t, then those beyond. @return whether none of the others touches a rigid triangle
static bool list_near( const mesh* m, int t, int k, form jumps[NEAR], bool present[NEAR] )
{
    const int other = across( m, t, k ), back = corner_of( m, other, m->triangle[t][( k + 1 ) % 3] );
    const int triangles[NEAR] = { t, t, t, other, other };
    const int corners[NEAR] = { k, ( k + 1 ) % 3, ( k + 2 ) % 3, ( back + 1 ) % 3, ( back + 2 ) % 3 };
    bool whole = true;
    for ( int n = 0; n < NEAR; ++n )
    {
        const int next = across( m, triangles[n], corners[n] );
        present[n] = next >= 0;
        jumps[n] = present[n] ? jump_of( m, triangles[n], corners[n] ) : ( form ){ .count = 0 };
        whole = whole && ( n == 0 || !present[n] || ( !is_rigid( m, next ) && !is_rigid( m, triangles[n] ) ) );
    }
    return whole;
}

// The turn of t at its hinge k: the multiples of jumps next to the share by height that are right for every quadratic surface, by
// the conditions of a minimum under constraints.
static form share_of( const mesh* m, int t, int k )
{
    form jumps[NEAR], out = { .count = 0 };
    bool present[NEAR];
    const int other = across( m, t, k );
    const bool whole = list_near( m, t, k, jumps, present );
    const double by_height = area( m, t ) / ( area( m, t ) + area( m, other ) );
    double a[UNKNOWN][UNKNOWN + 1] = { { 0.0 } }, share[NEAR] = { by_height }, trace = 0.0;
    for ( int n = 0; n < NEAR; ++n )
    {
        a[n][n] = 1.0;
        a[n][UNKNOWN] = share[n];
        for ( int q = 0; q < KNOWN; ++q )
        {
            a[n][NEAR + q] = a[NEAR + q][n] = present[n] ? apply( m, jumps + n, q ) : 0.0;
            a[NEAR + q][UNKNOWN] = turn_of( m, t, k, q );
            trace += a[n][NEAR + q] * a[n][NEAR + q];
        }
    }
    for ( int q = 0; q < KNOWN; ++q )
    {
        a[NEAR + q][NEAR + q] = -1e-4 * trace; // damped: hinges in a row say little of some surfaces
    }
    eliminate( a );
    for ( int n = 0; n < NEAR; ++n )
    {
        share[n] = whole ? a[n][UNKNOWN] : share[n];
        share[n] = is_rigid( m, t ) ? 0.0 : ( is_rigid( m, other ) ? ( n == 0 ? 1.0 : 0.0 ) : share[n] );
        for ( int i = 0; i < jumps[n].count && present[n]; ++i )
        {
            bool added = false;
            for ( int v = 0; v < out.count && !added; ++v )
            {
                added = out.vertex[v] == jumps[n].vertex[i];
                out.factor[v] += added ? share[n] * jumps[n].factor[i] : 0.0;
            }
            if ( !added )
            {
                add( &out, jumps[n].vertex[i], share[n] * jumps[n].factor[i] );
            }
        }
    }
    return out;
}

// Energy of turns of a triangle, 1/2 A |kappa|^2 with kappa = sum of l / A d n n, less what its open edges can relax.
static void turn_energy( const mesh* m, int t, const bool open[3], double e[3][3] )
{
    for ( int p = 0; p < 3; ++p )
    {
        for ( int q = 0; q < 3; ++q )
        {
            const vec2 a = normal( m, t, p ), b = normal( m, t, q );
            const double l = length( from_to( m, m->triangle[t][p], m->triangle[t][( p + 1 ) % 3] ) );
            const double k = length( from_to( m, m->triangle[t][q], m->triangle[t][( q + 1 ) % 3] ) );
            const double both = a.x * b.x * a.x * b.x + 2.0 * a.x * b.x * a.y * b.y + a.y * b.y * a.y * b.y;
            e[p][q] = l * k * both / area( m, t );
        }
    }
    for ( int o = 0; o < 3; ++o )
    {
        const double column[3] = { e[0][o], e[1][o], e[2][o] };
        for ( int n = 0; n < 9 && open[o] && column[o] > 0.0; ++n )
        {
            e[n / 3][n % 3] -= column[n / 3] * column[n % 3] / column[o];
        }
    }
}

static int index_of( int* vertices, int* count, int vertex )
{
    int i = 0;
    while ( i < *count && vertices[i] != vertex )
    {
        ++i;
    }
    vertices[i] = vertex;
    *count += i == *count ? 1 : 0;
    return i;
}

static void add_pairs( plate_oracle* plate, const form turns[3], double energy[3][3] )
{
    int vertices[PATCH], count = 0;
    double turn[3][PATCH] = { { 0.0 } };
    for ( int k = 0; k < 3; ++k )
    {
        for ( int n = 0; n < turns[k].count; ++n )
        {
            turn[k][index_of( vertices, &count, turns[k].vertex[n] )] += turns[k].factor[n];
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        for ( int j = i + 1; j < count; ++j )
        {
            double sum = 0.0;
            for ( int n = 0; n < 9; ++n )
            {
                sum += turn[n / 3][i] * energy[n / 3][n % 3] * turn[n % 3][j];
            }
            plate->pairs[plate->pair_count++] = ( plate_oracle_pair ){ vertices[i], vertices[j], -sum };
        }
    }
}

static void add_triangle( const mesh* m, int t, plate_oracle* plate )
{
    form turns[3];
    bool open[3];
    double energy[3][3];
    for ( int k = 0; k < 3; ++k )
    {
        open[k] = across( m, t, k ) < 0;
        turns[k] = open[k] ? ( form ){ .count = 0 } : share_of( m, t, k );
    }
    turn_energy( m, t, open, energy );
    add_pairs( plate, turns, energy );
}

// Coordinates in the plane of the first triangle.
static void flatten( const double3* rest, int count, const int* t, vec2* out )
{
    const double3 e = double3_sub( rest[t[1]], rest[t[0]] );
    const double3 x = double3_scale( 1.0 / double3_length( e ), e );
    const double3 n = double3_cross( e, double3_sub( rest[t[2]], rest[t[0]] ) );
    const double3 y = double3_cross( double3_scale( 1.0 / double3_length( n ), n ), x );
    for ( int v = 0; v < count; ++v )
    {
        const double3 p = double3_sub( rest[v], rest[t[0]] );
        assert( fabs( double3_dot( p, n ) ) <=
                1e-5 * double3_length( n ) * ( double3_length( e ) + double3_length( p ) ) );
        out[v] = ( vec2 ){ double3_dot( p, x ), double3_dot( p, y ) };
    }
}

plate_oracle plate_oracle_create( const double3* rest, int count, const int* triangles, int triangle_count,
                                  const bool* pinned )
{
    plate_oracle plate = { .begin = calloc( (size_t)triangle_count + 1, sizeof( int ) ),
                           .pairs = calloc( (size_t)triangle_count * PATCH * ( PATCH - 1 ) / 2 + 1,
                                            sizeof( plate_oracle_pair ) ) };
    const mesh m = { calloc( (size_t)count, sizeof( vec2 ) ), ( const int( * )[3] )(const void*)triangles,
                     triangle_count, pinned };
    flatten( rest, count, triangles, m.at );
    for ( int t = 0; t < triangle_count; ++t )
    {
        if ( !is_rigid( &m, t ) )
        {
            add_triangle( &m, t, &plate );
        }
        plate.begin[t + 1] = plate.pair_count;
    }
    free( m.at );
    return plate;
}

void plate_oracle_destroy( plate_oracle* plate )
{
    free( plate->pairs );
    free( plate->begin );
    *plate = ( plate_oracle ){ 0 };
}

void plate_oracle_multiply( const plate_oracle* plate, const double3* x, int count, double3* out )
{
    memset( out, 0, (size_t)count * sizeof( double3 ) );
    for ( int n = 0; n < plate->pair_count; ++n )
    {
        const plate_oracle_pair* p = plate->pairs + n;
        const double3 apart = double3_sub( x[p->i], x[p->j] );
        out[p->i] = double3_add_scaled( out[p->i], p->stiffness, apart );
        out[p->j] = double3_add_scaled( out[p->j], -p->stiffness, apart );
    }
}

static double sum_energy( const plate_oracle* plate, int begin, int end, const double3* x )
{
    double sum = 0.0;
    for ( int n = begin; n < end; ++n )
    {
        const double3 apart = double3_sub( x[plate->pairs[n].i], x[plate->pairs[n].j] );
        sum += 0.5 * plate->pairs[n].stiffness * double3_dot( apart, apart );
    }
    return sum;
}

double plate_oracle_energy( const plate_oracle* plate, const double3* x )
{
    return sum_energy( plate, 0, plate->pair_count, x );
}

double plate_oracle_triangle_energy( const plate_oracle* plate, int triangle, const double3* x )
{
    return sum_energy( plate, plate->begin[triangle], plate->begin[triangle + 1], x );
}
