/// Rows of pieces that ask others, of many kinds: what tests of the kernels of pieces look at.
#pragma once

#include "kernels_fixture.h"

#include "contact_oracle.h"

enum
{
    ROWS = 3,
    PIECES = 8 * ROWS,
    CORNERS = 3,
    POINTS = 2 * PIECES * CORNERS,
    ROOM = PIECES * PIECES + 8,
};

typedef enum piece_shape
{
    EDGES,  // edges ask edges
    FACES,  // points ask triangles
    SHAPES, // how many shapes there are
} piece_shape;

/// Side 0 asks. Where it asks itself, side 1 is not looked at.
typedef struct scene
{
    _Alignas( 64 ) wisp_piece_row row[2][ROWS];
    _Alignas( 64 ) float point[POINTS][4];
    piece_shape shape;
    int seed, corners[2], rows[2], count[2];
    float within, seen;
    bool is_own;
    wisp_box box[2];
    int found;
    int32_t of[ROOM], first[ROOM], second[ROOM], point4[4][ROOM];
    float least[8];
} scene;

// ---- scenes ----

static inline int asked_side( const scene* s )
{
    return s->shape == EDGES && s->is_own ? 0 : 1;
}

static inline int32_t* point4_of( scene* s, int side, int piece, int k )
{
    wisp_piece_row* row = s->row[side] + piece / 8;
    return ( k < 2 ? row->point4[k] : row->third4 ) + piece % 8;
}

static inline float* corner( scene* s, int side, int piece, int k )
{
    return s->point[*point4_of( s, side, piece, k ) / 4];
}

static inline int32_t item_of( const scene* s, int side, int piece )
{
    return s->row[side][piece / 8].item[piece % 8];
}

static inline double3 vector_of( const float* p )
{
    return double3_make( (double)p[0], (double)p[1], (double)p[2] );
}

static inline double3 at( scene* s, int side, int piece, int k )
{
    return vector_of( corner( s, side, piece, k ) );
}

static inline void put( scene* s, int side, int piece, int k, double3 p )
{
    const float xyz[3] = { (float)p.x, (float)p.y, (float)p.z };
    memcpy( corner( s, side, piece, k ), xyz, sizeof( xyz ) );
}

static inline double3 random_vector( int a, int b, double size )
{
    const float most = (float)size;
    return double3_make( (double)test_random_float( a, 3 * b, -most, most ),
                         (double)test_random_float( a, 3 * b + 1, -most, most ),
                         (double)test_random_float( a, 3 * b + 2, -most, most ) );
}

static inline double3 unit( double3 v )
{
    return double3_scale( 1.0 / double3_length( v ), v );
}

/// Pieces are not called in the order of their lanes. The last lanes may have none: their points are those of others.
static inline void name_pieces( scene* s, int side )
{
    s->rows[side] = 1 + ( s->seed + 2 * side ) % ROWS;
    s->count[side] = 8 * s->rows[side] - ( s->seed + side ) % 5;
    for ( int i = 0; i < 8 * s->rows[side]; ++i )
    {
        s->row[side][i / 8].item[i % 8] = i < s->count[side] ? 2 * ( i * 7 % PIECES ) + side : -1;
        for ( int k = 0; k < s->corners[side]; ++k )
        {
            const int lane = i < s->count[side] ? i : 0;
            *point4_of( s, side, i, k ) = 4 * ( ( ( side * PIECES + lane ) * CORNERS + k ) * 37 % POINTS );
        }
    }
}

/// Pieces of sizes from 1 to 1/8; the sides are up to 3 apart.
static inline scene* new_scene( piece_shape shape, int seed )
{
    scene* s = aligned_alloc( 64, sizeof( scene ) );
    assert_non_null( s );
    memset( s, 0, sizeof( *s ) );
    s->shape = shape;
    s->seed = seed;
    s->is_own = seed % 3 == 0;
    s->corners[0] = shape == EDGES ? 2 : 1;
    s->corners[1] = shape == EDGES ? 2 : 3;
    s->within = test_random_float( seed, 0, 0.05f, 0.4f );
    s->seen = s->within + test_random_float( seed, 1, 0.0f, 1.0f );
    const double apart = (double)test_random_float( seed, 2, 0.0f, 3.0f );
    const double3 aside = double3_scale( apart, unit( random_vector( seed, 3, 1.0 ) ) );
    for ( int side = 0; side < 2; ++side )
    {
        name_pieces( s, side );
        for ( int i = 0; i < s->count[side]; ++i )
        {
            const int number = ( 2 * seed + side ) * PIECES + i;
            const double3 middle = double3_add( random_vector( number, 10, 1.0 ), double3_scale( side, aside ) );
            for ( int k = 0; k < s->corners[side]; ++k )
            {
                const double size = 1.0 / ( 1 << seed % 4 );
                put( s, side, i, k, double3_add( middle, random_vector( number, 11 + k, size ) ) );
            }
        }
    }
    return s;
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

/// A point inside of a piece.
static inline double3 inside( scene* s, int side, int piece )
{
    double3 p = at( s, side, piece, 0 );
    for ( int k = 1; k < s->corners[side]; ++k )
    {
        const double t = (double)test_random_float( s->seed, 100 * side + 4 * piece + k, 0.0f, 1.0f );
        p = double3_add( p, double3_scale( t, double3_sub( at( s, side, piece, k ), p ) ) );
    }
    return p;
}

/// The insides of pieces meet those of others but for twice of what is asked.
static inline void make_crossing( scene* s )
{
    const int asked = asked_side( s );
    for ( int i = 0; i < s->count[0]; ++i )
    {
        const double3 to = inside( s, asked, ( i + 1 ) % s->count[asked] );
        const double3 near = random_vector( s->seed, 200 + i, 2.0 * (double)s->within );
        const double3 way = double3_sub( double3_add( to, near ), inside( s, 0, i ) );
        for ( int k = 0; k < s->corners[0]; ++k )
        {
            put( s, 0, i, k, double3_add( at( s, 0, i, k ), way ) );
        }
    }
}

/// Of no length, or with all corners in one line; others are near.
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
    make_crossing( s );
}

/// Askers lie where the asked lie; of some the points are the same, all of them or the first.
static inline void make_twins( scene* s )
{
    const int asked = asked_side( s );
    for ( int i = 0; i < s->count[0]; ++i )
    {
        const int twin = ( i + 1 ) % s->count[asked];
        for ( int k = 0; k < s->corners[0]; ++k )
        {
            const int other = ( k + i ) % s->corners[1];
            put( s, 0, i, k, at( s, asked, twin, other ) );
            if ( i % 4 == 0 || ( i % 4 == 1 && k == 0 ) )
            {
                *point4_of( s, 0, i, k ) = *point4_of( s, asked, twin, other );
            }
        }
    }
}

/// Corners of a lattice: in one line, in one plane or the same, and differences have no rounding.
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

static make_fn* const KINDS[] = { make_random, make_parallel, make_crossing, make_degenerate,
                                  make_twins,  make_lattice,  make_strange };

/// Around what is a number.
static inline wisp_box box_around( scene* s, int side )
{
    wisp_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for ( int i = 0; i < s->count[side] * s->corners[side]; ++i )
    {
        const float* p = corner( s, side, i / s->corners[side], i % s->corners[side] );
        for ( int k = 0; k < 3; ++k )
        {
            box.low[k] = fminf( box.low[k], p[k] );
            box.high[k] = fmaxf( box.high[k], p[k] );
        }
    }
    return box;
}

static inline wisp_piece_near_job job_of( scene* s )
{
    const int asked = asked_side( s );
    return ( wisp_piece_near_job ){
        .askers = s->row[0],
        .rows = s->row[asked],
        .asker_rows = s->rows[0],
        .row_count = s->rows[asked],
        .asker_box = s->box,
        .box = s->box + asked,
        .within = s->within,
        .seen = s->seen,
        .least = s->least,
        .is_own = s->is_own,
        .number = s->seed,
    };
}

static inline void look( const wisp_kernels* kernels, scene* s )
{
    const wisp_piece_near_job job = job_of( s );
    const wisp_piece_pairs to = {
        s->of, s->first, s->second, { s->point4[0], s->point4[1], s->point4[2], s->point4[3] }
    };
    s->found = ( s->shape == EDGES ? kernels->edges_near : kernels->points_near )( &job, 1, &to );
}

static inline void run( const wisp_kernels* kernels, scene* s )
{
    for ( int side = 0; side < 2; ++side )
    {
        kernels->piece_place( s->point[0], s->row[side], s->corners[side], 0, 1 );
        kernels->piece_place( s->point[0], s->row[side], s->corners[side], 1, s->rows[side] );
        s->box[side] = box_around( s, side );
    }
    for ( int l = 0; l < 8; ++l )
    {
        s->least[l] = INFINITY;
    }
    look( kernels, s );
}

/// Two pieces alone, placed and looked at by the widest table.
static inline scene* make_two( piece_shape shape, float points[4][3], float within, float seen )
{
    scene* s = new_scene( shape, 1 );
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
        put( s, side, 0, side == 0 ? k : k - s->corners[0], vector_of( points[k] ) );
    }
    run( widest_table(), s );
    return s;
}

// ---- what they are ----

static inline int piece_of( const scene* s, int side, int32_t item )
{
    int piece = 0;
    while ( piece < s->count[side] && item_of( s, side, piece ) != item )
    {
        ++piece;
    }
    assert_true( piece < s->count[side] ); // else it is not there
    return piece;
}

static inline bool share_a_point( scene* s, int asker, int asked )
{
    bool shared = false;
    for ( int i = 0; i < s->corners[0] * s->corners[1]; ++i )
    {
        shared = shared || *point4_of( s, 0, asker, i % s->corners[0] ) ==
                               *point4_of( s, asked_side( s ), asked, i / s->corners[0] );
    }
    return shared;
}

/// NaN if one of them has a point that is no number.
static inline double distance_of( scene* s, int asker, int asked )
{
    double3 x[4];
    double sum = 0.0;
    for ( int k = 0; k < 4; ++k )
    {
        x[k] = k < s->corners[0] ? at( s, 0, asker, k ) : at( s, asked_side( s ), asked, k - s->corners[0] );
        sum += x[k].x + x[k].y + x[k].z;
    }
    const contact_oracle_closest truth =
        s->shape == FACES ? contact_oracle_point_triangle( x[0], x + 1 ) : contact_oracle_segments( x, x + 2 );
    return isnan( sum ) ? sum : truth.distance;
}

/// Is a piece farther from the other side's box than what is looked at?
static inline bool is_beyond( scene* s, int side, int piece, const wisp_box* box )
{
    double farthest = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        float low = INFINITY, high = -INFINITY;
        for ( int c = 0; c < s->corners[side]; ++c )
        {
            low = fminf( low, corner( s, side, piece, c )[k] );
            high = fmaxf( high, corner( s, side, piece, c )[k] );
        }
        // as far as a piece reaches to one side of its middle it is taken to reach to the other
        const wisp_piece_row* row = s->row[side] + piece / 8;
        const float middle = row->middle[k][piece % 8], reach = fmaxf( high - middle, middle - low );
        farthest = fmax( farthest, (double)( box->low[k] - ( middle + reach ) ) );
        farthest = fmax( farthest, (double)( middle - reach - box->high[k] ) );
    }
    return farthest > (double)s->seen + 1e-5;
}

// ---- every table ----

/// Which NaN comes out of arithmetic on NaNs is nobody's promise.
static inline void assert_same_numbers( const float* found, const float* expected, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        assert_true( isnan( expected[i] ) ? isnan( found[i] ) : memcmp( found + i, expected + i, 4 ) == 0 );
    }
}

static inline void assert_same_rows( const wisp_piece_row* found, const wisp_piece_row* expected )
{
    assert_same_numbers( found->middle[0], expected->middle[0], 24 );
    assert_same_numbers( found->arm[0], expected->arm[0], 24 );
    assert_same_numbers( found->other_arm[0][0], expected->other_arm[0][0], 48 );
    assert_same_numbers( found->normal[0], expected->normal[0], 24 );
    assert_same_numbers( found->rounded, expected->rounded, 8 );
}

static inline void assert_same_pieces( const scene* found, const scene* expected )
{
    const size_t size = (size_t)expected->found * sizeof( int32_t );
    for ( int r = 0; r < 2 * ROWS; ++r )
    {
        assert_same_rows( found->row[0] + r, expected->row[0] + r );
    }
    assert_int_equal( found->found, expected->found );
    assert_memory_equal( found->of, expected->of, size );
    assert_memory_equal( found->first, expected->first, size );
    assert_memory_equal( found->second, expected->second, size );
    for ( int k = 0; k < 4; ++k )
    {
        assert_memory_equal( found->point4[k], expected->point4[k], size );
    }
    assert_memory_equal( found->least, expected->least, sizeof( found->least ) );
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
    int32_t point4[4][LIST];
} point_sets;

static inline point_sets make_sets( int seed )
{
    point_sets s;
    for ( int i = 0; i < SET_POINTS; ++i )
    {
        s.point4[i / LIST][i % LIST] = 4 * ( i * 37 % SET_POINTS );
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
    return s->point[s->point4[set][i] / 4];
}
