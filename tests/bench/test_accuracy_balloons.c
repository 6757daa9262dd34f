// The scenes of balloons in `wisp bench accuracy`: errors that fall with their parameter, errors that do not, and
// their limits.
#include "accuracy_fixture.h"

accuracy_scene_fn accuracy_balloon_inflate, accuracy_balloon_flight;

static accuracy_scene inflate, flight;

static int make_scenes( void** state )
{
    (void)state;
    expect_made( accuracy_balloon_inflate, &inflate );
    expect_made( accuracy_balloon_flight, &flight );
    return 0;
}

static int drop_scenes( void** state )
{
    (void)state;
    free_scene( &inflate );
    free_scene( &flight );
    return 0;
}

enum
{
    VIRIAL,
    MULTIPLIER,
    GAS_LAW,
    CLOSED_FORM,
    SCALE,
    OWN_VOLUME,
};

static void every_setting_of_a_balloon_has_a_name_of_its_own( void** state )
{
    (void)state;
    expect_names_differ( &inflate );
    expect_names_differ( &flight );
}

// ---- inflation ----

static void pressure_comes_to_the_closed_form_at_second_order( void** state )
{
    (void)state;
    static const char* const readings[] = { "virial", "multiplier" };
    for ( int r = 0; r < WISP_COUNT( readings ); ++r )
    {
        double error[3];
        for ( int i = 0; i < 3; ++i )
        {
            char name[64];
            snprintf( name, sizeof( name ), "xpbd, %s, %d x 1", readings[r], 100 << i );
            error[i] = observe( &inflate, name ).error;
        }
        print_message( "           %s: %.3f, %.3f, %.3f %%\n", readings[r], error[0], error[1], error[2] );
        // half a substep is a quarter of the error, except for higher orders at the coarse end
        assert_true( error[0] / error[1] > 3.4 && error[0] / error[1] < 4.4 );
        assert_true( error[1] / error[2] > 3.7 && error[1] / error[2] < 4.3 );
        assert_true( error[2] < 1.0 );
    }
}

// An icosahedron swells evenly, so its tensions and its volume correspond, apart from the error of the solver.
static void an_icosahedron_is_as_even_as_the_closed_form_requests( void** state )
{
    (void)state;
    const accuracy_run regular = observe( &inflate, "xpbd, virial, 400 x 1" );
    const accuracy_run finer = observe( &inflate, "xpbd, virial, 100 x 1, 642 vertices" );
    assert_true( fabs( regular.measures[OWN_VOLUME] ) < 0.01 );
    assert_true( fabs( regular.measures[SCALE] ) < 0.01 );
    assert_true( finer.error > 5.0 * regular.error );
}

// At rest the constraint gives P_atm ( V_0 - V ) / V_0 and the reading by the gas law P_atm ( V_0 - V ) / V: p /
// P_atm more.
static void the_gas_law_reads_what_the_constraint_does_not_hold( void** state )
{
    (void)state;
    const accuracy_run run = observe( &inflate, "xpbd, gas law, 400 x 1" );
    const double linear = run.measures[MULTIPLIER], more = run.measures[GAS_LAW] / linear - 1.0;
    assert_true( fabs( more - linear / 101325.0 ) < 2e-3 );
    assert_true( more > 0.02 );
}

// A stiffness in (0, 1] depends on the substep: more substeps make the skin of the balloon paper rigid, so that it
// departs from the reference.
static void the_forms_of_the_source_do_not_converge_with_substeps( void** state )
{
    (void)state;
    const accuracy_run few = observe( &inflate, "pbd skin, xpbd volume, virial, 10 x 10" );
    const accuracy_run many = observe( &inflate, "pbd skin, xpbd volume, virial, 50 x 10" );
    assert_true( many.error > 2.0 * few.error );
}

// ---- flight ----

static void a_flight_comes_nearer_to_double_precision_with_substeps( void** state )
{
    (void)state;
    static const int substeps[] = { 10, 40, 160 };
    double last = INFINITY;
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        char name[64];
        snprintf( name, sizeof( name ), "kick, max drag, %d x 1", substeps[i] );
        const double error = observe( &flight, name ).error;
        print_message( "           %s: %.2f mm\n", name, error );
        assert_true( error < 0.7 * last );
        last = error;
    }
    // of a path of 240 mm
    assert_true( last < 4.0 );

    // another drag is another flight, and no setting of the solver compensates for it
    assert_true( observe( &flight, "kick, abs drag, 10 x 1" ).error >
                 2.0 * observe( &flight, "kick, max drag, 10 x 1" ).error );
}

static void momentum_is_what_the_forces_have_given( void** state )
{
    (void)state;
    enum
    {
        NOT_CLOSED = 4,
    };
    const double coarse = observe( &flight, "kick, max drag, 10 x 1" ).measures[NOT_CLOSED];
    const double fine = observe( &flight, "kick, max drag, 80 x 1" ).measures[NOT_CLOSED];
    // in per cent of the momentum; forces are those of one substep of a step
    assert_true( coarse < 2.0 );
    assert_true( fine < 0.5 * coarse );
}

static void a_balloon_has_one_hash_whoever_computes_it( void** state )
{
    (void)state;
    expect_one_hash( &inflate, "xpbd, multiplier, 50 x 1" );
    expect_one_hash( &inflate, "xpbd, virial, 10 x 1, 642 vertices" );
    expect_one_hash( &inflate, "pbd skin, pbd volume, virial, 10 x 10" );
    expect_one_hash( &flight, "kick, max drag, 10 x 1" );
    expect_one_hash( &flight, "spin printed, max drag, 10 x 1" );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_setting_of_a_balloon_has_a_name_of_its_own ),
        cmocka_unit_test( pressure_comes_to_the_closed_form_at_second_order ),
        cmocka_unit_test( an_icosahedron_is_as_even_as_the_closed_form_requests ),
        cmocka_unit_test( the_gas_law_reads_what_the_constraint_does_not_hold ),
        cmocka_unit_test( the_forms_of_the_source_do_not_converge_with_substeps ),
        cmocka_unit_test( a_flight_comes_nearer_to_double_precision_with_substeps ),
        cmocka_unit_test( momentum_is_what_the_forces_have_given ),
        cmocka_unit_test( a_balloon_has_one_hash_whoever_computes_it ),
    };
    return cmocka_run_group_tests( tests, make_scenes, drop_scenes );
}
