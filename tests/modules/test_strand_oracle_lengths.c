// Length constraints of strands on their double-precision oracle: Newton, links, hard starts.
#include "strand_oracle_fixture.h"

#include "oracle/constraint_oracle.h"

// ---- lengths ----

static void one_newton_pass_solves_the_linear_system( void** state )
{
    (void)state;
    // with C' = C + J dp the pass leaves C' = 0: the remaining error of lengths is second order in the initial one
    for ( int measure = 0; measure < 2; ++measure )
    {
        double error[2];
        for ( int k = 0; k < 2; ++k )
        {
            strand_oracle strand = new_crooked( 6, 30, true );
            for ( int i = 1; i < strand.count; ++i )
            {
                const double3 off = double3_scale( k == 0 ? 1e-5 : 1e-6, random_vector( 7, i ) );
                strand.position[i] = double3_add( strand.position[i], off );
            }
            strand_oracle_stretch( &strand, (strand_oracle_measure)measure, 1, 1.0, false, 1.0 );
            error[k] = strand_oracle_strain( &strand );
        }
        assert_close( error[1] / error[0], 1e-2, 5e-3 );
        assert_true( error[0] < 1e-4 );
    }
}

static void both_measures_of_length_find_the_same_strand( void** state )
{
    (void)state;
    strand_oracle a = new_crooked( 8, 30, true );
    kick( &a, 9, 1.0 );
    strand_oracle b = a;
    strand_oracle_predict( &a, NULL, zero, 1e-4 );
    b = a;
    strand_oracle_stretch( &a, STRAND_ORACLE_SQUARE, 8, 1e-3, false, 1e-4 );
    strand_oracle_stretch( &b, STRAND_ORACLE_LENGTH, 8, 1e-3, false, 1e-4 );
    for ( int i = 0; i < a.count; ++i )
    {
        // Newton reaches the nearest solution along other normals: they differ at the second order of (0.1 mm / 1
        // cm)^2
        assert_close( double3_distance( a.position[i], b.position[i] ), 0.0, 1e-4 * 1e-2 * 10.0 );
    }
    assert_true( strand_oracle_strain( &a ) < 1e-13 && strand_oracle_strain( &b ) < 1e-13 );
}

static void a_strand_out_of_tolerance_is_laid_out_from_its_root( void** state )
{
    (void)state;
    strand_oracle strand = new_chain( 5, 0.4, double3_make( 1.0, 0.0, 0.0 ), true );
    strand.position[1] = zero; // no direction: the first takes (0, -1, 0)
    strand.position[2] = double3_make( 0.0, 0.0, 7.0 );
    strand.position[3] = double3_make( 0.0, 0.0, 7.0 ); // that of the one before
    strand.position[4] = double3_make( 3.0, 0.0, 7.0 );
    // no pass of Newton: its result does not matter here
    strand.tension[1] = 5.0;
    for ( int i = 0; i < 5; ++i )
    {
        strand.velocity[i] = double3_make( 1e4, 0.0, 0.0 ); // faster than anything is put
    }
    strand_oracle start = strand;
    assert_true( strand_oracle_stretch( &strand, STRAND_ORACLE_SQUARE, 0, 1e-3, true, 0.01 ) );
    const double3 reference[5] = {
        zero, { 0.0, -0.1, 0.0 }, { 0.0, -0.1, 0.1 }, { 0.0, -0.1, 0.2 }, { 0.1, -0.1, 0.2 }
    };
    for ( int i = 0; i < 5; ++i )
    {
        assert_close( double3_distance( strand.position[i], reference[i] ), 0.0, 1e-15 );
        assert_close( strand.tension[i], 0.0, 0.0 );
        // within the strand's length of the start of the substep it keeps a velocity, at most the predicted one
        assert_close( double3_distance( strand.previous[i], start.previous[i] ), 0.0, 0.0 );
    }
    strand = start;
    strand.previous[2] = double3_make( 0.0, 0.0, 7.0 ); // 7 m away
    strand_oracle_stretch( &strand, STRAND_ORACLE_SQUARE, 0, 1e-3, true, 0.01 );
    assert_close( double3_distance( strand.previous[2], strand.position[2] ), 0.0, 0.0 );
    start.velocity[1] = double3_make( 0.0, 0.0, 1.0 );
    start.velocity[4] = zero;
    strand = start;
    strand_oracle_stretch( &strand, STRAND_ORACLE_SQUARE, 0, 1e-3, true, 0.01 );
    assert_close( double3_distance( strand.previous[1], strand.position[1] ), 0.01, 1e-15 );
    assert_close( double3_distance( strand.previous[4], strand.position[4] ), 0.0, 1e-15 );
    assert_false( strand_oracle_stretch( &strand, STRAND_ORACLE_SQUARE, 0, 1e-3, false, 0.01 ) );
}

static void a_sweep_of_links_is_a_row_of_projections( void** state )
{
    (void)state;
    for ( int k = 0; k < 4; ++k )
    {
        const int stride = 1 + k % 2;
        const strand_oracle_link_rule rule = { 0.7, 2e-3, k < 2 ? 0.0 : 3600.0 };
        strand_oracle strand = new_crooked( 10, 16, true ), reference = strand;
        double rest[16], lambda[16] = { 0.0 }, other[16] = { 0.0 };
        constraint_oracle_skips skips = { { 0 } };
        for ( int i = 0; i < 16; ++i )
        {
            rest[i] = i == 5 ? -1.0 : random_between( 11, i, 0.01, 0.04 );
        }
        for ( int sweep = 0; sweep < 3; ++sweep )
        {
            strand_oracle_link( &strand, rest, lambda, stride, rule );
            for ( int i = 0; i + stride < 16; ++i )
            {
                const int pair[2] = { i, i + stride };
                const constraint_oracle_term term =
                    constraint_oracle_distance( reference.position[i], reference.position[i + stride], rest[i] );
                if ( i != 5 && k < 2 )
                {
                    constraint_oracle_project( &term, pair, reference.weight, rule.stiffness, reference.position,
                                               &skips );
                }
                else if ( i != 5 )
                {
                    constraint_oracle_project_compliant( &term, pair, reference.weight,
                                                         rule.compliance * rule.inverse_dt2, &other[i],
                                                         reference.position, &skips );
                }
            }
        }
        for ( int i = 0; i < 16; ++i )
        {
            assert_close( double3_distance( strand.position[i], reference.position[i] ), 0.0, 1e-15 );
            assert_close( lambda[i], k < 2 ? lambda[i] : other[i], 1e-12 * fabs( other[i] ) );
        }
        assert_close( strand.position[0].x, 0.01 * random_vector( 10, 0 ).x, 1e-18 );
    }
}

// ---- hard starts ----

static void start_badly( strand_oracle* strand, int start )
{
    for ( int i = 1; i < strand->count; ++i )
    {
        const double3 nonmanifold = double3_scale( 0.5, random_vector( 14, i ) );
        if ( start == 1 )
        {
            strand->position[i] = strand->position[0];
        }
        else if ( start == 2 )
        {
            strand->position[i] = double3_add( strand->position[0], nonmanifold );
        }
        else if ( start == 3 )
        {
            strand->position[i] = strand->position[i - i % 3]; // two of three segments have no length
        }
        else if ( start == 4 )
        {
            strand->position[i].x = i % 2 == 1 ? strand->length[0] : 0.0; // folded flat onto itself
            strand->position[i].y = strand->position[i].z = 0.0;
        }
    }
}

static void weigh_badly( strand_oracle* strand, int masses )
{
    for ( int i = 1; i < strand->count; ++i )
    {
        strand->mass[i] *= masses == 1 && i % 2 == 1 ? 1e6 : 1.0;
        strand->mass[i] *= masses == 2 && i + 1 == strand->count ? 1e6 : 1.0;
        strand->weight[i] = 1.0 / strand->mass[i];
    }
}

static void a_bad_start_is_over_within_thirty_substeps( void** state )
{
    (void)state;
    static const int counts[] = { 1, 2, 3, 16, 64 };
    static const double rates[] = { 5.0, 60.0, 600.0 };
    for ( int n = 0; n < 5 * 5 * 3 * 3 * 3; ++n )
    {
        const int count = counts[n % 5], start = n / 5 % 5, masses = n / 25 % 3;
        const double dt = 1.0 / rates[n / 75 % 3], rigidity = n / 225 == 0 ? 0.0 : ( n / 225 == 1 ? 1e-8 : 1e12 );
        strand_oracle strand = new_chain( count, 0.2, double3_make( 0.0, -1.0, 0.0 ), true );
        weigh_badly( &strand, masses );
        strand_oracle_stiffen( &strand, rigidity, rigidity, true, dt );
        strand_oracle_rest_straight( &strand );
        start_badly( &strand, start );
        strand_oracle_settings settings = strand_oracle_default_settings( dt );
        settings.bending = STRAND_ORACLE_BENDING_ROD;
        steps( &strand, &settings, 30 );
        const double strain = strand_oracle_strain( &strand );
        if ( is_finite( &strand ) == false || !( strain <= settings.tolerance ) )
        {
            fail_msg( "%d vertices, start %d, masses %d, dt %g, EI %g: strain %g", count, start, masses, dt, rigidity,
                      strain );
        }
    }
}

static void cheap_lengths_stay_finite_from_a_bad_start( void** state )
{
    (void)state;
    static const int counts[] = { 1, 2, 3, 16, 64 };
    for ( int n = 0; n < 5 * 5 * 3 * 2; ++n )
    {
        const int count = counts[n % 5];
        strand_oracle strand = new_chain( count, 0.2, double3_make( 0.0, -1.0, 0.0 ), true );
        weigh_badly( &strand, n / 25 % 3 );
        start_badly( &strand, n / 5 % 5 );
        strand_oracle_settings settings = settings_of( STRAND_ORACLE_LENGTHS_LINKS, n / 75 == 1, 1.0 / 5.0 );
        settings.bending = STRAND_ORACLE_BENDING_LINKS;
        steps( &strand, &settings, 30 );
        assert_true( is_finite( &strand ) );
    }
}

static void a_shape_without_length_gets_one( void** state )
{
    (void)state;
    double3 points[8] = { { 0.0, 0.0, 0.0 } };
    strand_oracle strand;
    assert_true( strand_oracle_shape( &strand, points, 8 ) );
    for ( int s = 0; s < 7; ++s )
    {
        assert_close( strand.length[s], 1e-6, 0.0 );
    }
    points[7].x = 0.7;
    assert_true( strand_oracle_shape( &strand, points, 8 ) );
    assert_ratio( strand.length[0], 1e-4, 1e-12 );
    assert_false( strand_oracle_shape( &strand, points, 0 ) );
    assert_false( strand_oracle_shape( &strand, points, MAX_STRAND_ORACLE + 1 ) );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( one_newton_pass_solves_the_linear_system ),
        cmocka_unit_test( both_measures_of_length_find_the_same_strand ),
        cmocka_unit_test( a_strand_out_of_tolerance_is_laid_out_from_its_root ),
        cmocka_unit_test( a_sweep_of_links_is_a_row_of_projections ),
        cmocka_unit_test( a_bad_start_is_over_within_thirty_substeps ),
        cmocka_unit_test( cheap_lengths_stay_finite_from_a_bad_start ),
        cmocka_unit_test( a_shape_without_length_gets_one ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
