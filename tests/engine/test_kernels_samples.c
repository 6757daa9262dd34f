// Kernels of points on meshes: every table gives the same bits, blends and normals agree with double precision, and
// bounds of counts are evaluated correctly.
#include "kernels_fixture.h"

enum
{
    SLOTS = RING_SLOTS,
    POINTS = 512,
    SLICES = 64,
    ELEMENTS = 8 * SLICES,
};

// Sums of three products of numbers below 3, each rounded, and the effect on their squares.
static const double ROUNDING = 8.0 * 3.0 * (double)FLT_EPSILON;

typedef struct blends
{
    _Alignas( 64 ) float position[SLOTS][4];
    _Alignas( 64 ) float normal[SLOTS][4];
    _Alignas( 64 ) int32_t parents[POINTS][4];
    _Alignas( 64 ) float weights[POINTS][4];
    _Alignas( 64 ) float xyzw[POINTS][4];
    _Alignas( 64 ) float normals[POINTS][4];
    int32_t ring_begin[SLOTS / 8 + 1];
    int32_t ring_x4[SLOTS / 8 * RING][8];
    _Alignas( 64 ) float means[SLOTS][4];
    int32_t pair_x4[SLICES][2][8], corner_x4[SLICES][3][8];
    float spacing[ELEMENTS], lower[ELEMENTS], upper[ELEMENTS], low_height[ELEMENTS], high_height[ELEMENTS];
    uint8_t held[2][SLICES];
    int returned;
    bool is_strange;
} blends;

static void fill_points( blends* b )
{
    for ( int p = 0; p < POINTS; ++p )
    {
        const int third = p < POINTS / 2 ? 0 : 2;
        float sum = 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            b->parents[p][k] = 4 * test_random( p, k % ( third + 1 ), SLOTS );
            b->weights[p][k] = k < 2 || third != 0 ? test_random_float( p, 3 + k, 0.1f, 1.0f ) : 0.0f;
            sum += b->weights[p][k];
        }
        b->parents[p][1] = 4 * ( ( b->parents[p][0] / 4 + 1 + test_random( p, 11, SLOTS - 1 ) ) % SLOTS );
        for ( int k = 0; k < 3; ++k )
        {
            b->weights[p][k] /= sum;
            b->normals[p][k] = test_random_float( p, 20 + k, -1.0f, 1.0f );
        }
        b->xyzw[p][3] = (float)p;
    }
}

// Triangles of a few sizes, some of them without area, and bounds that are met, missed, or met within rounding.
static void fill_elements( blends* b )
{
    for ( int e = 0; e < ELEMENTS; ++e )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const int32_t slot = 4 * ( ( e * 5 + k * ( 1 + e % 11 ) ) % SLOTS );
            b->corner_x4[e / 8][k][e % 8] = slot;
            if ( k < 2 )
            {
                b->pair_x4[e / 8][k][e % 8] = slot;
            }
        }
        b->spacing[e] = test_random_float( e, 30, 0.05f, 0.5f );
        b->lower[e] = test_random_float( e, 31, -1.0f, 20.0f );
        b->upper[e] = b->lower[e] + test_random_float( e, 32, 0.0f, 40.0f );
        b->low_height[e] = test_random_float( e, 33, -1.0f, 4.0f );
        b->high_height[e] = b->low_height[e] + test_random_float( e, 34, 0.0f, 60.0f );
    }
}

static void make_blends( blends* b )
{
    for ( int v = 0; v < SLOTS; ++v )
    {
        double sum = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            b->position[v][k] = test_random_float( v, k, -3.0f, 3.0f );
            b->normal[v][k] = test_random_float( v, 3 + k, -1.0f, 1.0f );
            sum += (double)b->normal[v][k] * (double)b->normal[v][k];
        }
        for ( int k = 0; k < 3; ++k )
        {
            b->normal[v][k] = (float)( (double)b->normal[v][k] / sqrt( sum ) );
        }
        b->position[v][3] = 0.5f;
    }
    memcpy( b->position[7], b->position[6], sizeof( b->position[7] ) );
    // opposite normals for points that are halfway between them
    for ( int k = 0; k < 3; ++k )
    {
        b->normal[9][k] = -b->normal[8][k];
    }
    fill_points( b );
    for ( int p = 3; p < POINTS; p += 37 )
    {
        const int32_t parents[4] = { 32, 36, 32, 0 };
        const float halves[4] = { 0.5f, 0.5f, 0.0f, 0.0f };
        memcpy( b->parents[p], parents, sizeof( parents ) );
        memcpy( b->weights[p], halves, sizeof( halves ) );
    }
    fill_elements( b );
    make_rings( b->ring_begin, b->ring_x4 );
}

static wisp_extent_args hold_args( blends* b, bool each, int number )
{
    return ( wisp_extent_args ){
        .position = b->position[0],
        .pair_x4 = (const int32_t( * )[2][8])b->pair_x4,
        .corner_x4 = (const int32_t( * )[3][8])b->corner_x4,
        .spacing = 0.2f,
        .element_spacing = each ? b->spacing : NULL,
        .lower = b->lower,
        .upper = b->upper,
        .lower_height = b->low_height,
        .upper_height = b->high_height,
        .unchanged = b->held[number],
    };
}

static void run_blend( const wisp_kernels* kernels, void* state, int begin, int end )
{
    blends* b = state;
    const wisp_blend_args args = {
        .position = b->position[0],
        .normal = b->normal[0],
        .parents = (const int32_t( * )[4])b->parents,
        .weights = (const float( * )[4])b->weights,
        .xyzw = b->xyzw[0],
        .normals = b->normals[0],
    };
    b->returned += kernels->blend_two( &args, begin, end );
    b->returned += kernels->blend_three( &args, POINTS / 2 + begin, POINTS / 2 + end );
}

static void run_ring( const wisp_kernels* kernels, void* state, int begin, int end )
{
    blends* b = state;
    const wisp_ring_args args = { .position = b->position[0],
                                  .ring_begin = b->ring_begin,
                                  .ring_x4 = (const int32_t( * )[8])b->ring_x4 };
    kernels->ring_mean_normal( &args, begin, end, b->means[0] );
}

static void run_hold( const wisp_kernels* kernels, void* state, int begin, int end )
{
    blends* b = state;
    const wisp_extent_args edges = hold_args( b, false, 0 ), triangles = hold_args( b, true, 1 );
    kernels->check_edge_extents( &edges, begin, end );
    kernels->check_triangle_extents( &triangles, begin, end );
}

static void make_strange( blends* b )
{
    b->position[20][0] = NAN;
    b->position[21][1] = INFINITY;
    b->position[22][2] = -INFINITY;
    b->position[23][0] = 1e30f;
    memcpy( b->position[25], b->position[24], 4 * sizeof( float ) );
    b->position[25][0] += 1e-30f;
    memset( b->normal[30], 0, sizeof( b->normal[30] ) );
}

static void fill_blends( void* state, int variant )
{
    blends* b = state;
    make_blends( b );
    b->is_strange = variant == 1;
    if ( b->is_strange )
    {
        make_strange( b );
    }
}

// ---- against double precision ----

static double3 sum_of( float table[][4], const blends* b, int point )
{
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int k = 0; k < 3; ++k )
    {
        const float* p = table[b->parents[point][k] / 4];
        sum = double3_add_scaled( sum, (double)b->weights[point][k], double3_from( p ) );
    }
    return sum;
}

static void check_blend( void* start, void* end )
{
    blends *before = start, *b = end;
    if ( b->is_strange )
    {
        return; // the bits are all that is the same
    }
    int cancelled = 0;
    for ( int p = 0; p < POINTS; ++p )
    {
        const double3 n = sum_of( b->normal, b, p ), found = double3_from( b->normals[p] );
        const double length = double3_length( n );
        const bool is_lost = length < 1e-6;
        assert_true( b->xyzw[p][3] == (float)p );
        assert_true( b->normals[p][3] == ( is_lost ? 1.0f : 0.0f ) );
        assert_near3( double3_from( b->xyzw[p] ), sum_of( b->position, b, p ), ROUNDING, "place of point", p );
        assert_near3( found, is_lost ? double3_from( before->normals[p] ) : double3_unit( n ),
                      is_lost ? 0.0 : ROUNDING / length, "normal of point", p );
        cancelled += is_lost;
    }
    assert_int_equal( b->returned, cancelled );
    assert_int_equal( cancelled, ( POINTS - 3 + 36 ) / 37 );
}

TEST_KERNEL( blends_are_sums_over_parents, blends, 2, 0, POINTS / 2, 8, fill_blends, run_blend, check_blend )

static bool add_face( const float* p, const float* a, const float* c, double3* sum )
{
    const double3 at = double3_from( p );
    const double3 n = double3_cross( double3_sub( double3_from( a ), at ), double3_sub( double3_from( c ), at ) );
    const double length = double3_length( n );
    *sum = length > 0.0 ? double3_add_scaled( *sum, 1.0 / length, n ) : *sum;
    return length > 0.0 && length < 0.05;
}

static void check_ring( void* start, void* end )
{
    (void)start;
    blends* b = end;
    if ( b->is_strange )
    {
        return; // the bits are all that is the same
    }
    int known = 0;
    for ( int v = 0; v < SLOTS; ++v )
    {
        double3 sum = { 0.0, 0.0, 0.0 };
        bool thin = false; // a thin triangle loses the digits of its normal
        for ( int e = 0; e + 1 < RING; ++e )
        {
            const int32_t first = b->ring_x4[v / 8 * RING + e][v % 8] / 4,
                          second = b->ring_x4[v / 8 * RING + e + 1][v % 8] / 4;
            thin = add_face( b->position[v], b->position[first], b->position[second], &sum ) || thin;
        }
        const double length = double3_length( sum );
        if ( thin == false && length > 0.05 )
        {
            // a cross product of sides below 12 with an area above 0.05, over the length of the sum
            assert_near3( double3_from( b->means[v] ), double3_unit( sum ),
                          36.0 / 0.05 * 6.0 * (double)FLT_EPSILON / length, "normal of vertex", v );
            ++known;
        }
        assert_true( b->means[v][3] == 0.0f );
    }
    assert_true( known > SLOTS / 2 );
}

TEST_KERNEL( vertex_normals_are_means_of_unit_normals, blends, 2, 0, SLOTS / 8, 1, fill_blends, run_ring, check_ring )

static bool is_held( const blends* b, int number, int e )
{
    return ( b->held[number][e / 8] >> e % 8 & 1 ) != 0;
}

static int count_held( const blends* b, int number )
{
    int count = 0;
    for ( int e = 0; e < ELEMENTS; ++e )
    {
        count += is_held( b, number, e );
    }
    return count;
}

static bool is_between( double x, float lower, float upper, double margin )
{
    return x > (double)lower - margin && x < (double)upper + margin;
}

// Stored bounds have room for rounding; here they have none, so a rounding is allowed on both sides.
static void check_hold( void* start, void* end )
{
    (void)start;
    blends* b = end;
    if ( b->is_strange )
    {
        return; // the bits are all that is the same
    }
    const double hair = 1e-5;
    for ( int e = 0; e < ELEMENTS; ++e )
    {
        double3 p[3];
        for ( int k = 0; k < 3; ++k )
        {
            p[k] = double3_from( b->position[b->corner_x4[e / 8][k][e % 8] / 4] );
        }
        const double3 n = double3_cross( double3_sub( p[1], p[0] ), double3_sub( p[2], p[0] ) );
        const double base = double3_distance( p[0], p[1] ), d = (double)b->spacing[e], ratio = base / (double)0.2f;
        const double others = fmin( double3_distance( p[0], p[2] ), double3_distance( p[1], p[2] ) );
        const double height = double3_length( n ) / ( base * d );
        const bool in_edge = is_between( ratio, b->lower[e], b->upper[e], is_held( b, 0, e ) ? hair : -hair );
        assert_true( base == 0.0 || in_edge == is_held( b, 0, e ) );
        const double margin = is_held( b, 1, e ) ? hair : -hair, some = is_held( b, 1, e ) ? 0.0 : -1e-3;
        const bool in_triangle = base < others * ( 1.0 + some ) &&
                                 is_between( base / d, b->lower[e], b->upper[e], margin ) &&
                                 is_between( height, b->low_height[e], b->high_height[e], some );
        assert_true( double3_length( n ) < 1e-3 || in_triangle == is_held( b, 1, e ) );
    }
    assert_in_range( count_held( b, 0 ), ELEMENTS / 8, ELEMENTS );
    assert_in_range( count_held( b, 1 ), ELEMENTS / 64, ELEMENTS );
}

TEST_KERNEL( who_is_held_is_within_its_bounds, blends, 2, 0, SLICES, 1, fill_blends, run_hold, check_hold )
