// Kernels of closest points: every table gives the same bits, distances and weights agree with double precision, and
// the plane across the normal separates the two sides.
#include "kernels_fixture.h"

#include "contact_oracle.h"
#include "random_vector.h"

enum
{
    CLOSEST_GROUPS = 512,
    PAIRS = 8 * CLOSEST_GROUPS,
    SIDES_OF_NEAR = 7, // inside, three edges, three corners
};

// Relative to the size of a pair: sums of about eight numbers of at most that size, each rounded.
static const double ROUNDING = 8.0 * (double)FLT_EPSILON;

typedef enum pair_shape
{
    SEGMENTS,
    TRIANGLE,
} pair_shape;

static const pair_shape SHAPES[] = { SEGMENTS, TRIANGLE };

typedef struct pairs
{
    pair_shape shape;
    int kind;
    _Alignas( 64 ) float point[4 * PAIRS][4];
    int32_t point_x4[4][8 * CLOSEST_GROUPS];
    float distance[8 * CLOSEST_GROUPS];
    float weight[CLOSEST_GROUPS][4][8];
    float normal[CLOSEST_GROUPS][3][8];
} pairs;

static float* corner( pairs* s, int pair, int k )
{
    return s->point[s->point_x4[k][pair] / 4];
}

static double3 at( pairs* s, int pair, int k )
{
    return double3_from( corner( s, pair, k ) );
}

static void put( pairs* s, int pair, int k, double3 p )
{
    const float xyz[3] = { (float)p.x, (float)p.y, (float)p.z };
    memcpy( corner( s, pair, k ), xyz, sizeof( xyz ) );
}

static double3 blend( double3 a, double t, double3 b )
{
    return double3_add( a, double3_scale( t, double3_sub( b, a ) ) );
}

static void fill_random( pairs* s, pair_shape shape )
{
    s->shape = shape;
    for ( int i = 0; i < PAIRS; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            s->point_x4[k][i] = 4 * ( ( 4 * i + k ) * 37 % ( 4 * PAIRS ) );
            corner( s, i, k )[3] = k % 2 == 0 ? NAN : 1.0f; // not read
            put( s, i, k, random_vector( i, k, 1.0 ) );
        }
    }
}

static pairs* new_pairs( pair_shape shape )
{
    pairs* s = new_aligned( sizeof( pairs ) );
    fill_random( s, shape );
    return s;
}

static void run( const wisp_kernels* kernels, pairs* s, bool requests_weights, int begin, int end )
{
    const wisp_closest_args args = {
        .xyzw = s->point[0],
        .point_x4 = { s->point_x4[0], s->point_x4[1], s->point_x4[2], s->point_x4[3] },
        .distance = s->distance,
        .weight = requests_weights ? s->weight : NULL,
        .normal = requests_weights ? s->normal : NULL,
    };
    ( s->shape == TRIANGLE ? kernels->closest_triangle : kernels->closest_segments )( &args, begin, end );
}

// ---- pairs of all kinds ----

static void make_random( pairs* s )
{
    (void)s;
}

// A point next to the inside of a triangle, to an edge or to a corner, between 1e-5 and 1e-3 of its size away.
static void make_near_triangle( pairs* s, int i )
{
    const double3 a = at( s, i, 1 ), b = at( s, i, 2 ), c = at( s, i, 3 );
    const double3 n = double3_unit( double3_cross( double3_sub( b, a ), double3_sub( c, a ) ) );
    const double v = (double)test_random_float( i, 20, 0.0f, 1.0f ),
                 w = (double)test_random_float( i, 21, 0.0f, 1.0f );
    const double d = pow( 10.0, (double)test_random_float( i, 22, -5.0f, -3.0f ) );
    const int side = i % SIDES_OF_NEAR;
    if ( side == 0 )
    {
        put( s, i, 0, double3_add( blend( a, v, blend( b, w, c ) ), double3_scale( i % 2 == 0 ? d : -d, n ) ) );
    }
    else
    {
        const double3 from = at( s, i, 1 + side % 3 ), to = at( s, i, 1 + ( side + 1 ) % 3 );
        put( s, i, 0,
             double3_add( blend( from, side < 4 ? v : 0.0, to ),
                          double3_scale( d, double3_unit( random_vector( i, 9, 1.0 ) ) ) ) );
    }
}

// Segments that nearly meet: inside of both, an end and the inside of another, or ends. Some nearly parallel.
static void make_near_segments( pairs* s, int i )
{
    const double3 a = at( s, i, 0 ), b = at( s, i, 1 ), u = double3_sub( b, a );
    const double d = pow( 10.0, (double)test_random_float( i, 22, -5.0f, -3.0f ) );
    const double x = i % 3 == 0 ? 0.0 : (double)test_random_float( i, 20, 0.0f, 1.0f );
    const double y = i % 5 < 2 ? 0.0 : (double)test_random_float( i, 21, 0.0f, 1.0f );
    double3 along = random_vector( i, 8, 1.0 );
    if ( i % 4 == 0 )
    {
        along = double3_add( u, double3_scale( pow( 10.0, -(double)( i % 6 ) ), along ) );
    }
    const double3 away =
        i % 5 == 0 ? double3_unit( random_vector( i, 9, 1.0 ) ) : double3_unit( double3_cross( u, along ) );
    const double3 meet = double3_add( blend( a, x, b ), double3_scale( d, away ) );
    put( s, i, 2, double3_sub( meet, double3_scale( y, along ) ) );
    put( s, i, 3, double3_add( meet, double3_scale( 1.0 - y, along ) ) );
}

static void make_near( pairs* s )
{
    for ( int i = 0; i < PAIRS; ++i )
    {
        ( s->shape == TRIANGLE ? make_near_triangle : make_near_segments )( s, i );
    }
}

// Widths from a tenth to nothing, the thin corner before, inside and behind the edge across, points near and far.
static void make_slivers( pairs* s )
{
    for ( int i = 0; i < PAIRS; ++i )
    {
        const int first = s->shape == TRIANGLE ? 1 : 0;
        const int corners[3] = { first + i % 3, first + ( i + 1 ) % 3, first + ( i + 2 ) % 3 };
        const double3 a = at( s, i, corners[0] ), b = at( s, i, corners[1] );
        const double x = (double)test_random_float( i, 20, -1.0f, 2.0f );
        const double width = i % 9 == 0 ? 0.0 : pow( 10.0, -(double)( i % 9 ) );
        const double3 thin = double3_add( blend( a, x, b ), random_vector( i, 8, width ) );
        put( s, i, corners[2], thin );
        if ( i % 2 == 0 )
        {
            const double3 near = blend( blend( a, (double)test_random_float( i, 23, -0.1f, 1.1f ), b ),
                                        (double)test_random_float( i, 24, 0.0f, 1.0f ), thin );
            const double away = pow( 10.0, (double)test_random_float( i, 22, -5.0f, 0.0f ) );
            put( s, i, s->shape == TRIANGLE ? 0 : 3, double3_add( near, random_vector( i, 9, away ) ) );
        }
    }
}

// Edges of a few centimetres, 50 m from the origin, both far apart and near.
static void make_far( pairs* s )
{
    make_near( s );
    for ( int i = 0; i < PAIRS; ++i )
    {
        const double3 origin = double3_make( 50.0, -50.0, 50.0 );
        for ( int k = 0; k < 4; ++k )
        {
            put( s, i, k, double3_add( origin, double3_scale( i % 2 == 0 ? 0.05 : 0.5, at( s, i, k ) ) ) );
        }
    }
}

// Corners of a coarse lattice: many are equal, collinear or coplanar, and differences do not round.
static void make_lattice( pairs* s )
{
    for ( int i = 0; i < PAIRS; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            put( s, i, k,
                 double3_make( 0.25 * test_random( i, 3 * k, 3 ), 0.25 * test_random( i, 3 * k + 1, 3 ),
                               0.25 * test_random( i, 3 * k + 2, i % 2 == 0 ? 1 : 3 ) ) );
        }
    }
}

// A tenth of a millimetre, and a hundred kilometres.
static void make_all_sizes( pairs* s )
{
    make_near( s );
    for ( int i = 0; i < PAIRS; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            put( s, i, k, double3_scale( i % 2 == 0 ? 1e-4 : 1e5, at( s, i, k ) ) );
        }
    }
}

// NaN and infinity, in each corner in turn, and differences that are too large for a float.
static void make_strange( pairs* s )
{
    static const float STRANGE[] = { NAN, INFINITY, -INFINITY, FLT_MAX };
    make_slivers( s );
    for ( int i = 0; i < PAIRS; ++i )
    {
        corner( s, i, i % 4 )[i / 4 % 3] = STRANGE[i / 12 % 4];
    }
}

typedef void make_fn( pairs* s );

static make_fn* const KINDS[] = { make_random,  make_near,      make_slivers, make_far,
                                  make_lattice, make_all_sizes, make_strange };

// ---- every table ----

static void fill_pairs( void* state, int variant )
{
    pairs* s = state;
    fill_random( s, SHAPES[variant % WISP_COUNT( SHAPES )] );
    s->kind = variant / WISP_COUNT( SHAPES );
    KINDS[s->kind]( s );
}

static void run_pairs( const wisp_kernels* kernels, void* state, int begin, int end )
{
    run( kernels, state, true, begin, end );
}

TEST( distances_alone_are_the_same_and_nothing_else_is_written )
{
    for ( int n = 0; n < WISP_COUNT( SHAPES ); ++n )
    {
        SCOPED( free_local ) pairs *expected = new_pairs( SHAPES[n] ), *found = new_pairs( SHAPES[n] );
        run( widest_table(), expected, true, 0, CLOSEST_GROUPS );
        run( widest_table(), found, false, 0, CLOSEST_GROUPS );
        assert_memory_equal( found->distance, expected->distance, sizeof( found->distance ) );
        for ( int i = 0; i < PAIRS; ++i )
        {
            assert_true( found->weight[i / 8][0][i % 8] == 0.0f && found->normal[i / 8][0][i % 8] == 0.0f );
        }
    }
}

// ---- against double precision ----

// Reference values of one pair, and the kernel's result.
typedef struct found_pair
{
    double3 x[4];
    int first; // corners of the first side
    contact_oracle_closest reference;
    double distance, size;
    float weight[4];
    double3 normal;
} found_pair;

static found_pair read_pair( pairs* s, int i )
{
    const int first = s->shape == TRIANGLE ? 1 : 2, g = i / 8, l = i % 8;
    found_pair f = { .first = first, .distance = (double)s->distance[8 * g + l] };
    for ( int k = 0; k < 4; ++k )
    {
        f.x[k] = at( s, i, k );
        f.weight[k] = s->weight[g][k][l];
    }
    f.normal = lane_vector( s->normal[g], l );
    f.reference =
        first == 1 ? contact_oracle_point_triangle( f.x[0], f.x + 1 ) : contact_oracle_segments( f.x, f.x + 2 );
    for ( int k = 0; k < 4; ++k )
    {
        f.size = fmax( f.size, double3_distance( f.x[k], f.x[3] ) );
        f.size = fmax( f.size, double3_distance( f.x[k], f.x[1] ) );
    }
    return f;
}

static void check_weights( const found_pair* f, int number )
{
    float sums[2] = { 0.0f, 0.0f };
    double3 between = double3_make( 0.0, 0.0, 0.0 );
    for ( int k = 0; k < 4; ++k )
    {
        const int side = k < f->first ? 0 : 1;
        const float weight = side == 0 ? f->weight[k] : -f->weight[k];
        assert_true( weight >= 0.0f && weight <= 1.0f );
        sums[side] += weight;
        // minus the first corner, which changes nothing if all weights sum to zero
        between = double3_add( between, double3_scale( (double)f->weight[k], double3_sub( f->x[k], f->x[0] ) ) );
    }
    assert_true( sums[0] == 1.0f && sums[1] == 1.0f );
    assert_near( double3_length( between ), f->reference.distance, ROUNDING * f->size,
                 "length of the weighted sum of pair", number );
}

// By how much the plane across the normal separates the sides, negative if it does not.
static double parted( const found_pair* f )
{
    double lower = INFINITY, upper = -INFINITY;
    for ( int k = 0; k < 4; ++k )
    {
        const double along = double3_dot( f->normal, double3_sub( f->x[k], f->x[0] ) );
        lower = k < f->first ? fmin( lower, along ) : lower;
        upper = k < f->first ? upper : fmax( upper, along );
    }
    return lower - upper;
}

static void check_normal( const found_pair* f, int number )
{
    if ( f->distance == 0.0 )
    {
        assert_true( double3_length( f->normal ) == 0.0 );
        return;
    }
    assert_near( double3_length( f->normal ), 1.0, 4.0 * (double)FLT_EPSILON, "length of the normal of pair",
                 number );
    assert_near( parted( f ), f->reference.distance, 2.0 * ROUNDING * f->size, "what parts pair", number );
    if ( f->reference.distance >= 1e-4 * f->size )
    {
        // A vector with an error of a rounding of the size, four times the threshold that decides. Two points of a
        // side may be equally near up to a rounding of the square, so they can differ by its root.
        const double most = 4.0 * ROUNDING * f->size / f->reference.distance + sqrt( 16.0 * (double)FLT_EPSILON );
        assert_near( double3_angle( f->normal, f->reference.normal ), 0.0, fmin( most, 1e-2 ),
                     "angle of the normal of pair", number );
    }
}

static void check_pairs( void* start, void* end )
{
    (void)start;
    pairs* s = end;
    for ( int i = 0; i < PAIRS && KINDS[s->kind] != make_strange; ++i )
    {
        const int number = ( s->kind * 10 + (int)s->shape ) * 100000 + i;
        const found_pair f = read_pair( s, i );
        assert_near( f.distance, f.reference.distance, ROUNDING * f.size, "distance of pair", number );
        check_weights( &f, number );
        check_normal( &f, number );
    }
}

TEST_KERNEL( closest_points_are_those_of_the_oracle, pairs, WISP_COUNT( KINDS ) * WISP_COUNT( SHAPES ), 0,
             CLOSEST_GROUPS, 77, fill_pairs, run_pairs, check_pairs )

// ---- cases by hand ----

static void put_four( pairs* s, int pair, const float xyz[4][3] )
{
    for ( int k = 0; k < 4; ++k )
    {
        memcpy( corner( s, pair, k ), xyz[k], sizeof( xyz[k] ) );
    }
}

TEST( points_that_coincide_have_no_distance_and_no_normal )
{
    static const float SAME[][4][3] = {
        { { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 } },
        { { 1, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } },
        { { 0, 0, 0 }, { 2, 0, 0 }, { 1, 0, 0 }, { 1, 0, 0 } },
        { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, -1 }, { 0, 0, 3 } },
    };
    static const float ON_TRIANGLE[][4][3] = {
        { { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 } },
        { { 1, 0, 0 }, { 0, 0, 0 }, { 2, 0, 0 }, { 0, 2, 0 } },
        { { 0, 2, 0 }, { 0, 0, 0 }, { 2, 0, 0 }, { 0, 2, 0 } },
        { { 1, 1, 1 }, { 0, 0, 0 }, { 2, 2, 2 }, { 4, 4, 4 } },
    };
    for ( int n = 0; n < WISP_COUNT( SHAPES ); ++n )
    {
        SCOPED( free_local ) pairs* s = new_pairs( SHAPES[n] );
        for ( int i = 0; i < 8; ++i )
        {
            put_four( s, i, SHAPES[n] == TRIANGLE ? ON_TRIANGLE[i % 4] : SAME[i % 4] );
        }
        run( widest_table(), s, true, 0, 1 );
        for ( int i = 0; i < 8; ++i )
        {
            const found_pair f = read_pair( s, i );
            assert_true( f.distance == 0.0 && double3_length( f.normal ) == 0.0 );
            check_weights( &f, i );
        }
    }
}

// Where the two sides meet up to rounding, the direction of the difference is meaningless; faces and edges have a
// better one.
TEST( sides_that_meet_inside_keep_the_normal_of_the_face )
{
    for ( int n = 0; n < WISP_COUNT( SHAPES ); ++n )
    {
        pairs* s = new_pairs( SHAPES[n] );
        for ( int i = 0; i < PAIRS; ++i )
        {
            const double v = (double)test_random_float( i, 20, 0.1f, 0.4f ),
                         w = (double)test_random_float( i, 21, 0.1f, 0.4f );
            const double3 a = at( s, i, 0 ), b = at( s, i, 1 ), c = at( s, i, 2 ), d = at( s, i, 3 );
            if ( SHAPES[n] == TRIANGLE )
            {
                put( s, i, 0, double3_add( blend( b, v, c ), double3_scale( w, double3_sub( d, b ) ) ) );
            }
            else
            {
                const double3 to = double3_sub( blend( a, v, b ), double3_scale( w, c ) );
                put( s, i, 3, double3_scale( 1.0 / ( 1.0 - w ), to ) );
            }
        }
        run( widest_table(), s, true, 0, CLOSEST_GROUPS );
        for ( int i = 0; i < PAIRS; ++i )
        {
            const found_pair f = read_pair( s, i );
            const double3 u = SHAPES[n] == TRIANGLE ? double3_sub( f.x[2], f.x[1] ) : double3_sub( f.x[1], f.x[0] ),
                          foreign =
                              SHAPES[n] == TRIANGLE ? double3_sub( f.x[3], f.x[1] ) : double3_sub( f.x[3], f.x[2] ),
                          face = double3_cross( u, foreign );
            if ( double3_length( face ) < 0.01 * double3_length( u ) * double3_length( foreign ) )
            {
                continue; // in its own plane, up to a hundredth
            }
            assert_true( f.distance <= ROUNDING * f.size );
            if ( f.distance > 0.0 )
            {
                const double sine = fabs( double3_dot( f.normal, face ) ) / double3_length( face );
                // the width is known to a rounding, and is at least a hundredth of the size
                assert_near( sine, 1.0, 100.0 * ROUNDING, "cosine of the face and the normal of pair", i );
            }
        }
        free( s );
    }
}

TEST( what_is_not_finite_has_no_finite_distance )
{
    for ( int n = 0; n < WISP_COUNT( SHAPES ); ++n )
    {
        SCOPED( free_local ) pairs *s = new_pairs( SHAPES[n] ), *clean = new_pairs( SHAPES[n] );
        make_strange( s );
        make_slivers( clean );
        run( widest_table(), clean, true, 0, CLOSEST_GROUPS );
        for ( int i = 0; i < PAIRS; i += 2 )
        {
            memcpy( corner( s, i, i % 4 ), corner( clean, i, i % 4 ), 3 * sizeof( float ) );
        }
        run( widest_table(), s, true, 0, CLOSEST_GROUPS );
        for ( int i = 0; i < PAIRS; ++i )
        {
            // neighbours in a group are not affected
            const float found = s->distance[i];
            assert_true( i % 2 == 0 ? found == clean->distance[i] : !isfinite( found ) );
        }
    }
}
