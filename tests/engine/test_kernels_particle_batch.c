// Kernels of particles in blocks: every table gives the same bits as scalar code, particle by particle.
#include "kernels_fixture.h"

enum
{
    COUNT = 256,
    SEEDS = 40,
    BOUNDS = 3,
};

typedef struct block
{
    _Alignas( 64 ) float position[COUNT][4], previous[COUNT][4], place[COUNT][4];
    int32_t slot[COUNT], queried[COUNT], strays[COUNT];
    float now[3][COUNT], old[3][COUNT], from[3][COUNT], to[3][COUNT];
    float path[COUNT], reach[COUNT], clear[COUNT], lower[3], upper[3];
    int begin, end, count, queried_count, stray_count;
} block;

// Some are pinned, some NaN, some too far away to be particles.
static block* new_block( int seed )
{
    block* b = aligned_alloc( 64, ( sizeof( block ) + 63 ) / 64 * 64 );
    assert_non_null( b );
    memset( b, 0, sizeof( *b ) );
    b->begin = seed % 3 * 8;
    b->end = COUNT - seed % 5 * 8;
    for ( int i = 0; i < COUNT; ++i )
    {
        const int key = seed * COUNT + i;
        for ( int k = 0; k < 3; ++k )
        {
            b->position[i][k] = test_random_float( key, k, -1.0f, 1.0f );
            b->previous[i][k] = b->position[i][k] + test_random_float( key, 3 + k, -0.1f, 0.1f );
        }
        b->position[i][3] = i % 5 == seed % 5 ? 0.0f : 2.0f;
        b->previous[i][3] = NAN; // not read
        b->clear[i] = i % 3 == 0 ? INFINITY : test_random_float( key, 6, 0.0f, 0.5f );
    }
    b->position[30][seed % 3] = NAN;
    b->position[41][seed % 3] = 2e9f;
    b->previous[52][seed % 3] = -INFINITY;
    b->previous[63][seed % 3] = NAN;
    b->position[74][3] = NAN;
    return b;
}

static wisp_particle_batch particle_batch_of( block* b )
{
    return (
        wisp_particle_batch ){ b->slot, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] } };
}

static wisp_cull_args sight_of( block* b, int seed )
{
    float r[9];
    for ( int k = 0; k < 9; ++k )
    {
        r[k] = test_random_float( seed, 10 + k, -1.0f, 1.0f );
    }
    const wisp_transform before =
        wisp_transform_make( ( wisp_quat ){ r[0], r[1], r[2], 1.0f }, ( wisp_vec3 ){ r[3], r[4], r[5] } );
    wisp_transform after = before;
    after.translation.x += 0.1f * r[6];
    return ( wisp_cull_args ){
        .batch = particle_batch_of( b ),
        .before = before,
        .after =
            seed % 2 == 0 ? after : wisp_transform_make( ( wisp_quat ){ r[0], r[1], r[2], 1.1f }, after.translation ),
        .shape = (wisp_cull_shape)( seed % BOUNDS ),
        .centre = { 0.1f * r[7], 0.0f, 0.0f },
        .half = { 0.3f, 0.4f, 0.3f },
        .radius = 0.3f,
        .half_length = seed % 4 < 2 ? 0.1f : 0.0f,
        .margin = 0.05f,
        .from = { b->from[0], b->from[1], b->from[2] },
        .to = { b->to[0], b->to[1], b->to[2] },
        .path = b->path,
        .reach = b->reach,
        .clearance = b->clear,
        .candidates = b->queried,
    };
}

static void run( const wisp_kernels* kernels, block* b, int seed )
{
    const wisp_gather_args args = { .position = b->position[0],
                                    .previous = b->previous[0],
                                    .search_origin = b->place[0],
                                    .batch = particle_batch_of( b ),
                                    .lower = b->lower,
                                    .upper = b->upper };
    const wisp_cull_args sight = sight_of( b, seed );
    b->count = kernels->gather_particles( &args, b->begin, b->end );
    b->queried_count = kernels->cull_particles( &sight, b->count );
    for ( int i = b->begin; i < b->end; ++i )
    {
        b->place[i][3] = i % 2 == 0 ? 0.05f : b->place[i][3];
    }
    b->stray_count = kernels->find_displaced( b->previous[0], b->place[0], b->begin, b->end, b->strays );
}

static void assert_same_floats( const float* found, const float* expected, int count )
{
    assert_memory_equal( found, expected, (size_t)count * sizeof( float ) );
}

static void every_table_gives_the_same_bits( void** state )
{
    (void)state;
    const wisp_kernels* tables[MAX_TABLES];
    const int tables_count = usable_tables( tables );
    for ( int i = 0; i < SEEDS * tables_count; ++i )
    {
        const int seed = i % SEEDS;
        block *b = new_block( seed ), *expected = new_block( seed );
        run( tables[i / SEEDS], b, seed );
        run( tables[0], expected, seed );
        assert_int_equal( b->count, expected->count );
        assert_int_equal( b->queried_count, expected->queried_count );
        assert_int_equal( b->stray_count, expected->stray_count );
        assert_memory_equal( b->slot, expected->slot, (size_t)b->count * sizeof( int32_t ) );
        assert_memory_equal( b->queried, expected->queried, (size_t)b->queried_count * sizeof( int32_t ) );
        assert_memory_equal( b->strays, expected->strays, (size_t)b->stray_count * sizeof( int32_t ) );
        for ( int k = 0; k < 3; ++k )
        {
            assert_same_floats( b->now[k], expected->now[k], b->count );
            assert_same_floats( b->old[k], expected->old[k], b->count );
            assert_same_floats( b->from[k], expected->from[k], b->count );
            assert_same_floats( b->to[k], expected->to[k], b->count );
        }
        assert_same_floats( b->path, expected->path, b->count );
        assert_same_floats( b->reach, expected->reach, b->count );
        assert_same_floats( b->clear, expected->clear, b->count );
        assert_same_floats( b->lower, expected->lower, 3 );
        assert_same_floats( b->upper, expected->upper, 3 );
        free( b );
        free( expected );
    }
}

// ---- scalar code ----

static bool is_place( const float* p )
{
    return fabsf( p[0] ) <= 1e9f && fabsf( p[1] ) <= 1e9f && fabsf( p[2] ) <= 1e9f;
}

static void who_moves_is_taken_in_order( void** state )
{
    (void)state;
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        run( widest_table(), b, seed );
        int n = 0;
        float lower[3] = { INFINITY, INFINITY, INFINITY }, upper[3] = { -INFINITY, -INFINITY, -INFINITY };
        for ( int i = b->begin; i < b->end; ++i )
        {
            const float *p = b->position[i], *old = b->previous[i];
            if ( p[3] > 0.0f && is_place( p ) && is_place( old ) )
            {
                assert_int_equal( b->slot[n], i );
                for ( int k = 0; k < 3; ++k )
                {
                    assert_true( b->now[k][n] == p[k] && b->old[k][n] == old[k] );
                    lower[k] = fminf( lower[k], fminf( p[k], old[k] ) );
                    upper[k] = fmaxf( upper[k], fmaxf( p[k], old[k] ) );
                }
                ++n;
            }
            assert_memory_equal( b->place[i], p, 3 * sizeof( float ) );
            assert_true( i % 2 == 0 || b->place[i][3] == INFINITY );
        }
        assert_int_equal( b->count, n );
        assert_memory_equal( b->lower, lower, sizeof( lower ) );
        assert_memory_equal( b->upper, upper, sizeof( upper ) );
        free( b );
    }
}

static void a_block_without_anyone_who_moves_is_nowhere( void** state )
{
    (void)state;
    block* b = new_block( 0 );
    for ( int i = 0; i < COUNT; ++i )
    {
        b->position[i][3] = 0.0f;
    }
    run( widest_table(), b, 0 );
    assert_true( b->count == 0 && b->queried_count == 0 && b->lower[1] == INFINITY && b->upper[1] == -INFINITY );
    free( b );
}

static float length_of( float x, float y, float z )
{
    return sqrtf( x * x + y * y + z * z );
}

static float outside( float distance, float half )
{
    return fmaxf( fabsf( distance ) - half, 0.0f );
}

// The lower bound of the distance.
static float gap_of( const wisp_cull_args* s, wisp_vec3 p, float reach )
{
    if ( s->shape == WISP_CULL_HALF_SPACE )
    {
        return p.y;
    }
    const float box = length_of( outside( p.x - s->centre.x, s->half.x ), outside( p.y - s->centre.y, s->half.y ),
                                 outside( p.z - s->centre.z, s->half.z ) );
    const float y = outside( p.y, s->half_length ), limit = s->radius + reach;
    const bool is_beyond = p.x * p.x + y * y + p.z * p.z > 1.00001f * limit * limit;
    return s->shape == WISP_CULL_ROUND && is_beyond ? INFINITY : box;
}

static void who_is_within_reach_is_queried_and_the_rest_is_clear( void** state )
{
    (void)state;
    int queried_of[BOUNDS] = { 0 }, left_out[BOUNDS] = { 0 };
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block *b = new_block( seed ), *before = new_block( seed );
        run( widest_table(), b, seed );
        const wisp_cull_args s = sight_of( b, seed );
        int queried = 0;
        for ( int i = 0; i < b->count; ++i )
        {
            const wisp_vec3 from = wisp_transform_to_local(
                                s.before, ( wisp_vec3 ){ b->old[0][i], b->old[1][i], b->old[2][i] } ),
                            to = wisp_transform_to_local( s.after,
                                                          ( wisp_vec3 ){ b->now[0][i], b->now[1][i], b->now[2][i] } );
            const float path = length_of( to.x - from.x, to.y - from.y, to.z - from.z ), reach = s.margin + path;
            const bool is_far = gap_of( &s, to, reach ) > reach;
            assert_true( b->from[0][i] == from.x && b->from[1][i] == from.y && b->from[2][i] == from.z );
            assert_true( b->to[0][i] == to.x && b->to[1][i] == to.y && b->to[2][i] == to.z );
            assert_true( b->path[i] == path && b->reach[i] == reach );
            assert_true( b->clear[i] == ( is_far ? fminf( reach, before->clear[i] ) : before->clear[i] ) );
            assert_true( is_far || b->queried[queried] == i );
            queried += is_far ? 0 : 1;
        }
        assert_int_equal( b->queried_count, queried );
        queried_of[s.shape] += queried;
        left_out[s.shape] += b->count - queried;
        free( b );
        free( before );
    }
    for ( int k = 0; k < BOUNDS; ++k )
    {
        assert_true( queried_of[k] > 100 && left_out[k] > 100 );
    }
}

static void who_leaves_its_place_is_a_stray( void** state )
{
    (void)state;
    int all = 0;
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        run( widest_table(), b, seed );
        int n = 0;
        for ( int i = b->begin; i < b->end; ++i )
        {
            const float *p = b->previous[i], *q = b->place[i];
            if ( length_of( p[0] - q[0], p[1] - q[1], p[2] - q[2] ) > q[3] )
            {
                assert_int_equal( b->strays[n++], i );
            }
        }
        assert_int_equal( b->stray_count, n );
        all += n;
        free( b );
    }
    assert_true( all > 1000 && all < SEEDS * COUNT / 2 );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_table_gives_the_same_bits ),
        cmocka_unit_test( who_moves_is_taken_in_order ),
        cmocka_unit_test( a_block_without_anyone_who_moves_is_nowhere ),
        cmocka_unit_test( who_is_within_reach_is_queried_and_the_rest_is_clear ),
        cmocka_unit_test( who_leaves_its_place_is_a_stray ),
    };
    return cmocka_run_group_tests_name( "kernels of particles in blocks", tests, NULL, NULL );
}
