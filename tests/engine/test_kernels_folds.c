// Sharp folds: bend links that give way, and that all other links move as without folds; hinges that are found.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

enum
{
    EDGES = CONSTRAINTS / 2, // the rest are bend links
};

static const float* end_of( const constraints* s, int c, int end )
{
    return body( (constraints*)(uintptr_t)s, c, end );
}

static double length_of( const constraints* s, int c )
{
    return double3_distance( double3_from( end_of( s, c, 0 ) ), double3_from( end_of( s, c, 1 ) ) );
}

static bool is_folded( const constraints* s, int c )
{
    return c >= EDGES && 2.0 * length_of( s, c ) < (double)s->rest[c];
}

// Every third link is far too short.
static constraints* new_folds( void )
{
    constraints* s = aligned_alloc( 64, ( sizeof( constraints ) + 63 ) / 64 * 64 );
    assert_non_null( s );
    make_constraints( s, true );
    for ( int c = 0; c < CONSTRAINTS; c += 3 )
    {
        s->rest[c] = (float)( 2.5 * length_of( s, c ) );
    }
    return s;
}

typedef void link_kernel( const wisp_link_args* args, int begin, int end );

static void expect_folds_are_left( link_kernel* kernel, bool keeps_lambda )
{
    constraints *start = new_folds(), *all = new_folds(), *most = new_folds();
    int32_t number[CONSTRAINTS];
    uint8_t folded[CONSTRAINTS / 8] = { 0 };
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        number[c] = c;
    }
    wisp_link_args plain = link_args( all ), args = link_args( most );
    plain.lambda = keeps_lambda ? plain.lambda : NULL;
    args.lambda = keeps_lambda ? args.lambda : NULL;
    args.constraint = number, args.edge_count = EDGES, args.folded = folded;
    kernel( &plain, 0, CONSTRAINTS );
    kernel( &args, 0, CONSTRAINTS );
    int found = 0;
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        const bool is_left = is_folded( start, c );
        const constraints* expected = is_left ? start : all;
        assert_int_equal( folded[c / 8] >> c % 8 & 1, is_left );
        for ( int k = 0; k < 2; ++k )
        {
            assert_memory_equal( end_of( most, c, k ), end_of( expected, c, k ), 4 * sizeof( float ) );
        }
        assert_true( most->lambda[c] == expected->lambda[c] );
        found += is_left;
    }
    assert_true( found > CONSTRAINTS / 8 && found < CONSTRAINTS / 2 );
    free( start );
    free( all );
    free( most );
}

TEST( short_bend_links_stay_and_are_marked )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int t = 0; t < table_count; ++t )
    {
        expect_folds_are_left( tables[t]->link_pbd, true );
        expect_folds_are_left( tables[t]->link_xpbd, true );
        expect_folds_are_left( tables[t]->link_xpbd, false );
    }
}

enum
{
    SEARCHED = CONSTRAINTS - 8, // whole groups, not all of them
    HINGES = SEARCHED - 3,      // the last group is padded
};

// Groups outside the range stay as they are; the padding of the last group is k and l at one place.
static void expect_hinges_are_found( const wisp_kernels* kernels, constraints* s, const float* span2 )
{
    uint8_t folded[GROUPS];
    memset( folded, 0xa5, sizeof( folded ) );
    const wisp_fold_args args = { s->position[0], s->slot_x4[0][0], span2, folded };
    kernels->hinge_find_folds( &args, 8, SEARCHED );
    int found = 0;
    for ( int c = 8; c < SEARCHED; ++c )
    {
        const float *k = body( s, c, 2 ), *l = body( s, c, 3 );
        const float x = l[0] - k[0], y = l[1] - k[1], z = l[2] - k[2];
        const bool near = 4.0f * ( x * x + y * y + z * z ) < span2[c];
        assert_int_equal( folded[c / 8] >> c % 8 & 1, near );
        found += near;
    }
    assert_true( found > CONSTRAINTS / 8 && found < CONSTRAINTS / 2 );
    assert_int_equal( folded[0], 0xa5 );
    assert_int_equal( folded[GROUPS - 1], 0xa5 );
}

// A quarter of the square is a bound that many distances meet exactly; one place is not a number.
TEST( hinges_nearer_than_half_their_span_are_found )
{
    constraints* s = new_folds();
    float span2[CONSTRAINTS] = { 0.0f };
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        const float *k = body( s, c, 2 ), *l = body( s, c, 3 );
        const float x = l[0] - k[0], y = l[1] - k[1], z = l[2] - k[2], square = x * x + y * y + z * z;
        span2[c] =
            c < HINGES ? ( c % 3 == 0 ? 4.0f * square : square * test_random_float( c, 17, 3.0f, 5.0f ) ) : 0.0f;
    }
    for ( int c = HINGES; c < CONSTRAINTS; ++c )
    {
        set_slot( s, c, 3, s->slot_x4[c / 8][2][c % 8] / 4 );
    }
    body( s, 17, 2 )[1] = NAN;
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int t = 0; t < table_count; ++t )
    {
        expect_hinges_are_found( tables[t], s, span2 );
    }
    free( s );
}
