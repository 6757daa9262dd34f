/// Packs of primitives that query others, in many configurations, for tests of the kernels of primitives.
#pragma once

#include "kernels_fixture.h"

#include "contact_oracle.h"
#include "random_vector.h"

enum
{
    ROWS = 3,
    PRIMITIVES = 8 * ROWS,
    CORNERS = 3,
    POINTS = 2 * PRIMITIVES * CORNERS,
    ROOM = PRIMITIVES * PRIMITIVES + 8,
};

typedef enum primitive_shape
{
    EDGES,  // edges query edges
    FACES,  // points query triangles
    SHAPES, // number of shapes
} primitive_shape;

/// Side 0 queries side 1, or itself; then side 1 is not used.
typedef struct scene
{
    _Alignas( 64 ) wisp_primitive_pack row[2][ROWS];
    _Alignas( 64 ) float point[POINTS][4];
    primitive_shape shape;
    int number, seed, corners[2], rows[2], count[2];
    float within, seen;
    bool is_own;
    wisp_aabb box[2];
    int found;
    int32_t of[ROOM], first[ROOM], second[ROOM], point_x4[4][ROOM];
    float least[8];
} scene;

// ---- scenes ----

static inline int queried_side( const scene* s )
{
    return s->shape == EDGES && s->is_own ? 0 : 1;
}

static inline int32_t* point_x4_of( scene* s, int side, int primitive, int k )
{
    wisp_primitive_pack* row = s->row[side] + primitive / 8;
    return ( k < 2 ? row->point_x4[k] : row->third_x4 ) + primitive % 8;
}

static inline float* corner( scene* s, int side, int primitive, int k )
{
    return s->point[*point_x4_of( s, side, primitive, k ) / 4];
}

static inline int32_t item_of( const scene* s, int side, int primitive )
{
    return s->row[side][primitive / 8].item[primitive % 8];
}

static inline double3 at( scene* s, int side, int primitive, int k )
{
    return double3_from( corner( s, side, primitive, k ) );
}

static inline void put( scene* s, int side, int primitive, int k, double3 p )
{
    const float xyz[3] = { (float)p.x, (float)p.y, (float)p.z };
    memcpy( corner( s, side, primitive, k ), xyz, sizeof( xyz ) );
}

/// The order of primitives differs from that of their lanes. The last lanes may be empty: their points are those of
/// others.
static inline void name_primitives( scene* s, int side )
{
    s->rows[side] = 1 + ( s->seed + 2 * side ) % ROWS;
    s->count[side] = 8 * s->rows[side] - ( s->seed + side ) % 5;
    for ( int i = 0; i < 8 * s->rows[side]; ++i )
    {
        s->row[side][i / 8].item[i % 8] = i < s->count[side] ? 2 * ( i * 7 % PRIMITIVES ) + side : -1;
        for ( int k = 0; k < s->corners[side]; ++k )
        {
            const int lane = i < s->count[side] ? i : 0;
            *point_x4_of( s, side, i, k ) = 4 * ( ( ( side * PRIMITIVES + lane ) * CORNERS + k ) * 37 % POINTS );
        }
    }
}

/// Primitives of sizes from 1 to 1/8; the sides are up to 3 apart.
static inline void place_scene( scene* s, primitive_shape shape, int seed )
{
    s->shape = shape;
    s->seed = seed;
    s->is_own = seed % 3 == 0;
    s->corners[0] = shape == EDGES ? 2 : 1;
    s->corners[1] = shape == EDGES ? 2 : 3;
    s->within = test_random_float( seed, 0, 0.05f, 0.4f );
    s->seen = s->within + test_random_float( seed, 1, 0.0f, 1.0f );
    const double apart = (double)test_random_float( seed, 2, 0.0f, 3.0f );
    const double3 aside = double3_scale( apart, double3_unit( random_vector( seed, 3, 1.0 ) ) );
    for ( int side = 0; side < 2; ++side )
    {
        name_primitives( s, side );
        for ( int i = 0; i < s->count[side]; ++i )
        {
            const int number = ( 2 * seed + side ) * PRIMITIVES + i;
            const double3 centre = double3_add( random_vector( number, 10, 1.0 ), double3_scale( side, aside ) );
            for ( int k = 0; k < s->corners[side]; ++k )
            {
                const double size = 1.0 / ( 1 << seed % 4 );
                put( s, side, i, k, double3_add( centre, random_vector( number, 11 + k, size ) ) );
            }
        }
    }
}

static inline void make_random( scene* s )
{
    (void)s;
}

/// Edges of one direction, along an axis or not, next to one line.
static inline void make_parallel( scene* s )
{
    const double3 way = s->seed % 2 == 0 ? double3_make( 1.0, 0.0, 0.0 ) : random_vector( s->seed, 20, 1.0 );
    for ( int side = 0; side < 2; ++side )
    {
        for ( int i = 0; i < s->count[side] && s->corners[side] > 1; ++i )
        {
            const int number = 100 * side + i;
            const double from = (double)test_random_float( s->seed, 600 + number, -1.0f, 1.0f ),
                         length = (double)test_random_float( s->seed, 900 + number, -1.0f, 1.0f );
            const double3 near = random_vector( s->seed, 400 + number, (double)s->within );
            put( s, side, i, 0, double3_add( near, double3_scale( from, way ) ) );
            put( s, side, i, 1, double3_add( at( s, side, i, 0 ), double3_scale( length, way ) ) );
        }
    }
}

/// A point inside of a primitive.
static inline double3 inside( scene* s, int side, int primitive )
{
    double3 p = at( s, side, primitive, 0 );
    for ( int k = 1; k < s->corners[side]; ++k )
    {
        const double t = (double)test_random_float( s->seed, 100 * side + 4 * primitive + k, 0.0f, 1.0f );
        p = double3_add( p, double3_scale( t, double3_sub( at( s, side, primitive, k ), p ) ) );
    }
    return p;
}

/// The insides of primitives meet those of others, apart from twice the query distance.
static inline void make_intersection( scene* s )
{
    const int queried = queried_side( s );
    for ( int i = 0; i < s->count[0]; ++i )
    {
        const double3 to = inside( s, queried, ( i + 1 ) % s->count[queried] );
        const double3 near = random_vector( s->seed, 200 + i, 2.0 * (double)s->within );
        const double3 way = double3_sub( double3_add( to, near ), inside( s, 0, i ) );
        for ( int k = 0; k < s->corners[0]; ++k )
        {
            put( s, 0, i, k, double3_add( at( s, 0, i, k ), way ) );
        }
    }
}

/// Without length, or with all corners collinear; others are near.
static inline void make_degenerate( scene* s )
{
    static const double FROM[] = { 0.0, 1.0, 3.0 };
    for ( int side = 0; side < 2; ++side )
    {
        for ( int i = 0; i < s->count[side]; ++i )
        {
            const double3 a = at( s, side, i, 0 );
            const double3 b = s->corners[side] > 1 && i % 3 == 1 ? at( s, side, i, 1 ) : a;
            for ( int k = 0; k < s->corners[side] && i % 3 < 2; ++k )
            {
                put( s, side, i, k, double3_add( a, double3_scale( FROM[( i / 3 + k ) % 3], double3_sub( b, a ) ) ) );
            }
        }
    }
    make_intersection( s );
}

/// Queries coincide with their targets; some share points, all of them or the first.
static inline void make_twins( scene* s )
{
    const int queried = queried_side( s );
    for ( int i = 0; i < s->count[0]; ++i )
    {
        const int twin = ( i + 1 ) % s->count[queried];
        for ( int k = 0; k < s->corners[0]; ++k )
        {
            const int other = ( k + i ) % s->corners[1];
            put( s, 0, i, k, at( s, queried, twin, other ) );
            if ( i % 4 == 0 || ( i % 4 == 1 && k == 0 ) )
            {
                *point_x4_of( s, 0, i, k ) = *point_x4_of( s, queried, twin, other );
            }
        }
    }
}

/// Corners of a lattice: collinear, coplanar or equal, with differences that do not round.
static inline void make_lattice( scene* s )
{
    for ( int i = 0; i < POINTS; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->point[i][k] = 0.5f * rintf( 2.0f * s->point[i][k] );
        }
    }
}

static inline void make_strange( scene* s )
{
    corner( s, 0, 5, s->seed % s->corners[0] )[s->seed % 3] = NAN;
    corner( s, 1, 2, s->seed % s->corners[1] )[s->seed % 3] = NAN;
}

typedef void make_fn( scene* s );

static make_fn* const KINDS[] = { make_random, make_parallel, make_intersection, make_degenerate,
                                  make_twins,  make_lattice,  make_strange };

/// Around invalid numbers.
static inline wisp_aabb box_around( scene* s, int side )
{
    wisp_aabb box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for ( int i = 0; i < s->count[side] * s->corners[side]; ++i )
    {
        const float* p = corner( s, side, i / s->corners[side], i % s->corners[side] );
        for ( int k = 0; k < 3; ++k )
        {
            box.lower[k] = fminf( box.lower[k], p[k] );
            box.upper[k] = fmaxf( box.upper[k], p[k] );
        }
    }
    return box;
}

static inline wisp_primitive_near_args job_of( scene* s )
{
    const int queried = queried_side( s );
    return ( wisp_primitive_near_args ){
        .queries = s->row[0],
        .packs = s->row[queried],
        .query_pack_count = s->rows[0],
        .pack_count = s->rows[queried],
        .query_aabb = s->box,
        .box = s->box + queried,
        .max_distance = s->within,
        .cull_distance = s->seen,
        .min_distance = s->least,
        .is_self = s->is_own,
        .cluster = s->seed,
    };
}

static inline void look( const wisp_kernels* kernels, scene* s )
{
    const wisp_primitive_near_args args = job_of( s );
    const wisp_primitive_pairs to = {
        s->of, s->first, s->second, { s->point_x4[0], s->point_x4[1], s->point_x4[2], s->point_x4[3] }
    };
    s->found = ( s->shape == EDGES ? kernels->find_near_edges : kernels->find_near_points )( &args, 1, &to );
}

static inline void run( const wisp_kernels* kernels, scene* s )
{
    for ( int side = 0; side < 2; ++side )
    {
        kernels->place_primitives( s->point[0], s->row[side], s->corners[side], 0, 1 );
        kernels->place_primitives( s->point[0], s->row[side], s->corners[side], 1, s->rows[side] );
        s->box[side] = box_around( s, side );
    }
    for ( int l = 0; l < 8; ++l )
    {
        s->least[l] = INFINITY;
    }
    look( kernels, s );
}

/// Two primitives alone, queried by the widest table.
static inline scene* make_two( primitive_shape shape, float points[4][3], float within, float seen )
{
    scene* s = new_aligned( sizeof( scene ) );
    place_scene( s, shape, 1 );
    s->is_own = false;
    s->within = within;
    s->seen = seen;
    for ( int side = 0; side < 2; ++side )
    {
        s->count[side] = s->rows[side] = 1;
        memset( s->row[side][0].item + 1, -1, 7 * sizeof( int32_t ) );
    }
    for ( int k = 0; k < 4; ++k )
    {
        const int side = k < s->corners[0] ? 0 : 1;
        put( s, side, 0, side == 0 ? k : k - s->corners[0], double3_from( points[k] ) );
    }
    run( widest_table(), s );
    return s;
}

// ---- reference values ----

static inline int primitive_of( const scene* s, int side, int32_t item )
{
    int primitive = 0;
    while ( primitive < s->count[side] && item_of( s, side, primitive ) != item )
    {
        ++primitive;
    }
    assert_true( primitive < s->count[side] ); // otherwise it does not exist
    return primitive;
}

static inline bool share_a_point( scene* s, int query, int queried )
{
    bool shared = false;
    for ( int i = 0; i < s->corners[0] * s->corners[1]; ++i )
    {
        shared = shared || *point_x4_of( s, 0, query, i % s->corners[0] ) ==
                               *point_x4_of( s, queried_side( s ), queried, i / s->corners[0] );
    }
    return shared;
}

/// NaN if one of them has a point that is NaN.
static inline double distance_of( scene* s, int query, int queried )
{
    double3 x[4];
    double sum = 0.0;
    for ( int k = 0; k < 4; ++k )
    {
        x[k] = k < s->corners[0] ? at( s, 0, query, k ) : at( s, queried_side( s ), queried, k - s->corners[0] );
        sum += x[k].x + x[k].y + x[k].z;
    }
    const contact_oracle_closest reference =
        s->shape == FACES ? contact_oracle_point_triangle( x[0], x + 1 ) : contact_oracle_segments( x, x + 2 );
    return isnan( sum ) ? sum : reference.distance;
}

/// True if a primitive is farther from the other side's box than the query distance.
static inline bool is_beyond( scene* s, int side, int primitive, const wisp_aabb* box )
{
    double farthest = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        float lower = INFINITY, upper = -INFINITY;
        for ( int c = 0; c < s->corners[side]; ++c )
        {
            lower = fminf( lower, corner( s, side, primitive, c )[k] );
            upper = fmaxf( upper, corner( s, side, primitive, c )[k] );
        }
        // the extent of a primitive on one side of its centre is assumed for the other
        const wisp_primitive_pack* row = s->row[side] + primitive / 8;
        const float centre = row->centre[k][primitive % 8], reach = fmaxf( upper - centre, centre - lower );
        farthest = fmax( farthest, (double)( box->lower[k] - ( centre + reach ) ) );
        farthest = fmax( farthest, (double)( centre - reach - box->upper[k] ) );
    }
    return farthest > (double)s->seen + 1e-5;
}

// ---- sets of points ----

enum
{
    LIST = 24, // points of a set
    SET_POINTS = 4 * LIST,
};

typedef struct point_sets
{
    _Alignas( 64 ) float point[SET_POINTS][4], less[SET_POINTS][4];
    int32_t point_x4[4][LIST];
} point_sets;

static inline point_sets make_sets( int seed )
{
    point_sets s;
    for ( int i = 0; i < SET_POINTS; ++i )
    {
        s.point_x4[i / LIST][i % LIST] = 4 * ( i * 37 % SET_POINTS );
        for ( int k = 0; k < 4; ++k )
        {
            s.point[i][k] = test_random_float( seed, 8 * i + k, k < 3 ? -1.0f : 0.0f, 1.0f );
            s.less[i][k] = test_random_float( seed, 8 * i + 4 + k, -1.0f, 1.0f );
        }
    }
    return s;
}

static inline const float* in_set( const point_sets* s, int set, int i )
{
    return s->point[s->point_x4[set][i] / 4];
}
