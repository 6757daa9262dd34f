// Kernels of coarse sheets: links and their band against the oracle in double precision, prolongation by its sums, and the same bits
// from every table.
#include "kernels_fixture.h"

#include "coarse_oracle.h"

enum
{
    LINKS = 256,
    ROWS = 2 * LINKS, // every link has its own
    CHAIN = 4,        // vertices of a chain
    SLOTS = CHAIN * LINKS,
    FINER = 128, // rows that follow
};

typedef struct batch
{
    _Alignas( 64 ) float position[ROWS][4], particle[SLOTS][4];
    int32_t a_x4[LINKS], b_x4[LINKS], chain_begin[LINKS / 8 + 1], chain_x4[LINKS / 8 * CHAIN][8];
    float rest[LINKS], compliance[LINKS], lower[LINKS], lambda[LINKS], factor[LINKS], chain_rest[LINKS];
    _Alignas( 64 ) float target[FINER][4], value[ROWS][4];
    int32_t parent_x4[FINER / 8][WISP_FABRIC_PARENTS][8];
    float weight[FINER / 8][WISP_FABRIC_PARENTS][8];
} batch;

static void put( float* quad, int item, int first, float w )
{
    for ( int k = 0; k < 3; ++k )
    {
        quad[k] = test_random_float( item, first + k, -1.0f, 1.0f );
    }
    quad[3] = w;
}

static batch* new_batch( void )
{
    batch* s = aligned_alloc( 64, ( sizeof( batch ) + 63 ) / 64 * 64 );
    assert_non_null( s );
    memset( s, 0, sizeof( *s ) );
    for ( int i = 0; i < LINKS; ++i )
    {
        put( s->position[2 * i], i, 0, i % 7 == 0 ? 0.0f : 0.5f * (float)( i % 5 + 1 ) );
        put( s->position[2 * i + 1], i, 3, i % 14 == 0 ? 0.0f : 1.5f );
        s->a_x4[i] = 8 * i;
        s->b_x4[i] = 8 * i + 4;
        s->rest[i] = test_random_float( i, 6, 0.3f, 2.5f );
        s->lower[i] = s->rest[i] * test_random_float( i, 7, 0.7f, 1.0f );
        s->compliance[i] = i % 3 == 0 ? 0.0f : 1e-3f;
        s->chain_rest[i] = s->rest[i] * test_random_float( i, 8, 1.0f, 1.3f );
        for ( int e = 0; e < CHAIN; ++e )
        {
            put( s->particle[CHAIN * i + e], i, 10 + 3 * e, 1.0f );
            for ( int k = 0; k < 3; ++k )
            {
                s->particle[CHAIN * i + e][k] *= 0.3f;
            }
            s->chain_x4[i / 8 * CHAIN + e][i % 8] = 4 * ( CHAIN * i + e );
        }
        s->chain_begin[i / 8 + 1] = ( i / 8 + 1 ) * CHAIN;
    }
    for ( int r = 0; r < ROWS; ++r )
    {
        put( s->value[r], r, 30, 0.0f );
    }
    for ( int i = 0; i < FINER; ++i )
    {
        put( s->target[i], i, 40, i % 5 == 0 ? 0.0f : 2.0f );
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            s->parent_x4[i / 8][k][i % 8] = 4 * ( ( i * 5 + k * 17 ) % ROWS );
            s->weight[i / 8][k][i % 8] = i / 8 == 3 && k == 2 ? 0.0f : 0.25f * (float)( k == 0 ? 2 : 1 );
        }
    }

    // ends on each other
    memcpy( s->position[2 * 9 + 1], s->position[2 * 9], 3 * sizeof( float ) );
    return s;
}

static wisp_level_link_args level_args( batch* s )
{
    return ( wisp_level_link_args ){
        .position = s->position[0],
        .a_x4 = s->a_x4,
        .b_x4 = s->b_x4,
        .rest = s->rest,
        .compliance = s->compliance,
        .lower = s->lower,
        .lambda = s->lambda,
        .factor = s->factor,
        .inverse_dt2 = 3600.0f,
        .particle = s->particle[0],
        .chain_begin = s->chain_begin,
        .chain_x4 = (const int32_t( * )[8])s->chain_x4,
        .chain_rest = s->chain_rest,
    };
}

static wisp_prolong_args prolong_args( batch* s )
{
    return ( wisp_prolong_args ){ s->target[0], s->target[0], s->value[0], s->parent_x4[0][0], s->weight[0][0] };
}

static void run_all( const wisp_kernels* kernels, batch* s )
{
    const wisp_level_link_args links = level_args( s );
    const wisp_prolong_args prolong = prolong_args( s );
    kernels->level_band( &links, 0, LINKS );
    kernels->level_prepare( &links, 0, LINKS );
    kernels->level_link( &links, 0, LINKS );
    kernels->level_link( &links, 0, LINKS );
    kernels->prolong( &prolong, 0, FINER / 8 );
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    batch *first = new_batch(), *start = new_batch();
    run_all( tables[0], first );
    assert_memory_not_equal( first, start, sizeof( batch ) );
    for ( int t = 1; t < count; ++t )
    {
        batch* other = new_batch();
        run_all( tables[t], other );
        assert_memory_equal( first, other, sizeof( batch ) );
        free( other );
    }
    free( first );
    free( start );
}

static double3 at( const batch* s, int row )
{
    return double3_from( s->position[row] );
}

TEST( a_link_pushes_no_more_than_its_chain_is_compressed )
{
    batch* s = new_batch();
    const wisp_level_link_args args = level_args( s );
    int stretched = 0, slack = 0, pushing = 0;
    widest_table()->level_band( &args, 0, LINKS );
    for ( int i = 0; i < LINKS; ++i )
    {
        const double length = double3_length( double3_sub( at( s, 2 * i ), at( s, 2 * i + 1 ) ) );
        double chain = 0.0;
        for ( int e = 1; e < CHAIN; ++e )
        {
            chain += double3_length( double3_sub( double3_from( s->particle[CHAIN * i + e] ),
                                                  double3_from( s->particle[CHAIN * i + e - 1] ) ) );
        }
        const double expected = coarse_oracle_lower( length, (double)s->rest[i], chain, (double)s->chain_rest[i] );
        assert_near( (double)s->lower[i], expected, 1e-6, "lower", i );
        stretched += length >= (double)s->rest[i] ? 1 : 0;
        slack += length < (double)s->rest[i] && expected <= length ? 1 : 0;
        pushing += length < (double)s->rest[i] && expected > length ? 1 : 0;
    }
    assert_true( stretched > 5 && slack > 5 && pushing > 5 );
    free( s );
}

TEST( links_move_as_the_oracle_says_with_what_they_accumulate )
{
    batch *s = new_batch(), *start = new_batch();
    const wisp_level_link_args args = level_args( s );
    widest_table()->level_prepare( &args, 0, LINKS );
    for ( int pass = 0; pass < 3; ++pass )
    {
        widest_table()->level_link( &args, 0, LINKS );
    }
    int pushes = 0, pulls = 0;
    for ( int i = 0; i < LINKS; ++i )
    {
        coarse_oracle_link link = { (double)s->rest[i], (double)s->lower[i], 3600.0 * (double)s->compliance[i], 0.0 };
        double3 a = at( start, 2 * i ), b = at( start, 2 * i + 1 );
        for ( int pass = 0; pass < 3; ++pass )
        {
            coarse_oracle_project( &link, (double)start->position[2 * i][3], (double)start->position[2 * i + 1][3],
                                   &a, &b );
        }
        assert_near( (double)s->lambda[i], link.lambda, 1e-5, "lambda", i );
        assert_near( double3_length( double3_sub( a, at( s, 2 * i ) ) ), 0.0, 1e-5, "first end", i );
        assert_near( double3_length( double3_sub( b, at( s, 2 * i + 1 ) ) ), 0.0, 1e-5, "second end", i );
        assert_true( s->position[2 * i][3] == start->position[2 * i][3] );
        pushes += link.lambda > 0.0 ? 1 : 0;
        pulls += link.lambda < 0.0 ? 1 : 0;
    }
    assert_true( pushes > 20 && pulls > 20 );
    free( s );
    free( start );
}

TEST( rows_follow_their_parents_unless_they_are_pinned )
{
    batch *s = new_batch(), *start = new_batch();
    const wisp_prolong_args args = prolong_args( s );
    widest_table()->prolong( &args, 0, FINER / 8 );
    for ( int i = 0; i < FINER; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            double expected = (double)start->target[i][k];
            for ( int p = 0; p < WISP_FABRIC_PARENTS && start->target[i][3] > 0.0f; ++p )
            {
                expected +=
                    (double)s->weight[i / 8][p][i % 8] * (double)s->value[s->parent_x4[i / 8][p][i % 8] / 4][k];
            }
            assert_near( (double)s->target[i][k], expected, start->target[i][3] > 0.0f ? 4.0 * FLT_EPSILON : 0.0,
                         "row", i );
        }
    }
    free( s );
    free( start );
}
