// The scene `closed_forms` of `wisp bench accuracy`: its references equal published values, and errors fall with the
// expected order.
#include "accuracy_fixture.h"

accuracy_scene_fn accuracy_closed_forms;

enum
{
    MEASURED,
    REFERENCE,
    STRAIN,
    MOMENTUM,
    POINTS_MAX = 8,
};

static accuracy_scene scene;

static int make_scene( void** state )
{
    (void)state;
    expect_made( accuracy_closed_forms, &scene );
    return 0;
}

static int drop_scene( void** state )
{
    (void)state;
    free_scene( &scene );
    return 0;
}

static void every_closed_form_has_settings_of_its_own( void** state )
{
    (void)state;
    expect_names_differ( &scene );
}

// Digits of tables, and of the reference for a value without a formula in this program.
static void references_are_what_the_references_print( void** state )
{
    (void)state;
    assert_true( fabs( observe( &scene, "terminal velocity of a plate, m/s, substeps 1" ).measures[REFERENCE] -
                       1.37000 ) < 6e-6 );
    assert_true( fabs( observe( &scene, "lift of 0.14 m of helium, N, level 0" ).measures[REFERENCE] - 0.11799 ) <
                 6e-6 );
    // 32 links hang a little lower than a rope
    assert_true( fabs( observe( &scene, "sag of a catenary, m, substeps 5" ).measures[REFERENCE] - 0.26543751 ) <
                 3e-4 );
    // 16 masses of 1 g, and 136 weights in all on links of 100 N/m
    const double longer = observe( &scene, "elastic bar under its weight, m, substeps 5" ).measures[REFERENCE];
    assert_true( fabs( longer - 136.0 * 0.001 * 9.81 / 100.0 ) < 1e-12 );
}

// ---- orders ----

typedef struct series_check
{
    const char* series;
    double finest; // error in %, at the finest parameter
    double slack;  // of the observed order
} series_check;

// Second order holds once a substep is short for the stiffest link, so the coarse end is lower.
static const series_check checks[] = {
    { "fall of a cloth in 0.5 s, m", 0.03, 0.1 },
    { "angular momentum of a cloth after 0.5 s, N m s", 0.5, 0.2 },
    { "falling plate after 0.1 s, m/s", 0.25, 0.1 },
    { "terminal velocity of a plate, m/s", 0.4, 0.1 },
    { "sliding, 20 deg, mu 0.2, m", 0.2, 0.15 },
    { "sliding, 40 deg, mu 0.5, m", 0.25, 0.15 },
    { "elastic bar under its weight, m", 0.5, 0.1 },
    { "sag of a catenary, m", 0.1, 0.2 },
    { "elastica, G = 10, drop / L", 0.5, 0.3 },
    { "lift of 0.14 m of helium, N", 0.3, 0.2 },
    { "gas through an outlet in 0.2 s, m3", 0.1, 0.4 },
};

static void errors_fall_at_the_promised_order( void** state )
{
    (void)state;
    for ( int c = 0; c < WISP_COUNT( checks ); ++c )
    {
        double parameter[POINTS_MAX], error[POINTS_MAX], promised = NAN;
        int count = 0;
        for ( int i = 0; i < scene.setting_count && count < POINTS_MAX; ++i )
        {
            if ( strcmp( scene.settings[i].series, checks[c].series ) == 0 )
            {
                promised = scene.settings[i].order;
                parameter[count] = scene.settings[i].parameter;
                error[count++] = run_setting( &scene, i, 1, true ).error;
            }
        }
        assert_true( count >= 3 );
        const accuracy_order order = accuracy_observed_order( parameter, error, count );
        print_message( "           %s: order %.2f, promised %.0f, finest %.4f %%\n", checks[c].series, order.slope,
                       promised, error[count - 1] );
        assert_int_equal( order.used, count );
        assert_true( fabs( order.slope - promised ) < checks[c].slack );
        assert_true( error[count - 1] < checks[c].finest );
    }
}

// At rest the result depends on the springs, not on the number of iterations.
static void a_bar_that_has_converged_is_as_long_as_its_springs_say( void** state )
{
    (void)state;
    const accuracy_run once = observe( &scene, "elastic bar by iterations, m, iterations 1" );
    const accuracy_run often = observe( &scene, "elastic bar by iterations, m, iterations 64" );
    assert_true( once.error > 10.0 );
    assert_true( often.error < 1e-3 );
}

static void what_friction_holds_does_not_creep( void** state )
{
    (void)state;
    assert_true( observe( &scene, "sticking, 11 deg, mu 0.2, m, substeps 20" ).error == 0.0 );
    assert_true( observe( &scene, "sticking, 26 deg, mu 0.5, m, substeps 20" ).error == 0.0 );
    // at the next angle nothing holds it, so friction held it here
    assert_true( observe( &scene, "sliding, 20 deg, mu 0.2, m, substeps 20" ).measures[MEASURED] > 0.1 );
}

static void free_fall_strains_nothing_and_keeps_momentum( void** state )
{
    (void)state;
    const accuracy_run fall = observe( &scene, "fall of a cloth in 0.5 s, m, substeps 20" );
    // roundings of coordinates of 1 m over edges of 2 cm, in per cent
    assert_true( fall.measures[STRAIN] < 1e-3 );
    assert_true( fall.measures[MOMENTUM] < 1e-2 );
}

// Its triangles never become equilateral, so the limit of fine spheres differs from the smooth one.
static void a_fine_sphere_is_within_two_per_cent_of_a_smooth_one( void** state )
{
    (void)state;
    assert_true( observe( &scene, "sphere stretched by 5 %, 2 sigma / R, Pa, level 4" ).error < 1.5 );
    assert_true( observe( &scene, "elastica, G = 1, drop / L, cells 24" ).error < 0.5 );
}

static void a_closed_form_has_one_hash_whoever_computes_it( void** state )
{
    (void)state;
    expect_one_hash( &scene, "angular momentum of a cloth after 0.5 s, N m s, substeps 5" );
    expect_one_hash( &scene, "falling plate after 0.1 s, m/s, substeps 5" );
    expect_one_hash( &scene, "sliding, 20 deg, mu 0.2, m, substeps 5" );
    expect_one_hash( &scene, "lift of 0.14 m of helium, N, level 4" );
    expect_one_hash( &scene, "gas through an outlet in 0.2 s, m3, substeps 50" );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_closed_form_has_settings_of_its_own ),
        cmocka_unit_test( references_are_what_the_references_print ),
        cmocka_unit_test( errors_fall_at_the_promised_order ),
        cmocka_unit_test( a_bar_that_has_converged_is_as_long_as_its_springs_say ),
        cmocka_unit_test( what_friction_holds_does_not_creep ),
        cmocka_unit_test( free_fall_strains_nothing_and_keeps_momentum ),
        cmocka_unit_test( a_fine_sphere_is_within_two_per_cent_of_a_smooth_one ),
        cmocka_unit_test( a_closed_form_has_one_hash_whoever_computes_it ),
    };
    return cmocka_run_group_tests( tests, make_scene, drop_scene );
}
