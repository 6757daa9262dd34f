// Links whose bend links give way in sharp folds: which ones stay, and that all others move as without folds.
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

static void short_bend_links_stay_and_are_marked( void** state )
{
    (void)state;
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int t = 0; t < table_count; ++t )
    {
        expect_folds_are_left( tables[t]->link_pbd, true );
        expect_folds_are_left( tables[t]->link_xpbd, true );
        expect_folds_are_left( tables[t]->link_xpbd, false );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( short_bend_links_stay_and_are_marked ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
