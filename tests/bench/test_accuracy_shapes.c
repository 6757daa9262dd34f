// Scenes of frozen hair and of particles in contact of the case `accuracy`, and the closed form of the heavy elastica.
#include "accuracy_scenes.h"
#include "elastica.h"

accuracy_scene_fn accuracy_frozen_clumps, accuracy_boundary_contact;

static void the_elastica_has_the_numbers_of_the_closed_form( void** state )
{
    (void)state;
    // G, drop and reach of the length, by another integration in double
    static const double known[][3] = { { 1.0, 0.12347140, 0.99124640 },
                                       { 10.0, 0.70019972, 0.65635376 },
                                       { 100.0, 0.93752394, 0.15922338 } };
    for ( int i = 0; i < 3; ++i )
    {
        double points[5][2];
        elastica_lay( known[i][0], 5, points );
        assert_true( fabs( -points[4][1] - known[i][1] ) < 1e-6 );
        assert_true( fabs( points[4][0] - known[i][2] ) < 1e-6 );
        assert_true( points[0][0] == 0.0 && points[0][1] == 0.0 );
    }
}

static void frozen_hair_is_the_oracles_with_all_neighbours_only( void** state )
{
    (void)state;
    accuracy_scene scene;
    open_scene( accuracy_frozen_clumps, &scene );
    assert_well_formed( &scene );
    const accuracy_run all = run_setting( &scene, "all neighbours", 1, true );
    const accuracy_run few = run_setting( &scene, "at most 4 neighbours", 1, true );
    assert_true( all.error < 0.1 ); // um: roundings of 0.2 m
    assert_true( measure_of( &scene, &all, "capped %" ) == 0.0 );
    assert_true( few.error > 100.0 );
    assert_true( measure_of( &scene, &few, "capped %" ) > 50.0 );
    assert_true( error_of( &scene, "no clumps" ) > 100.0 );
    assert_same_hash( &scene, "at most 4 neighbours" );
    assert_same_hash( &scene, "all neighbours" );
    close_scene( &scene );
}

static void shorter_steps_of_clumping_come_nearer_at_first_order( void** state )
{
    (void)state;
    accuracy_scene scene;
    open_scene( accuracy_frozen_clumps, &scene );
    const double order = order_between( &scene, "flow in 4 steps", "flow in 16 steps", 4.0 );
    assert_true( fabs( order - 1.0 ) < 0.15 );
    const accuracy_run one = run_setting( &scene, "flow in 1 steps", 1, true );
    assert_true( measure_of( &scene, &one, "to its own oracle um" ) < 0.1 );
    close_scene( &scene );
}

static void what_is_kept_apart_overlaps_less_the_closer_it_is_watched( void** state )
{
    (void)state;
    accuracy_scene scene;
    open_scene( accuracy_boundary_contact, &scene );
    assert_well_formed( &scene );
    const accuracy_run nothing = run_setting( &scene, "nothing", 1, true );
    const accuracy_run particles = run_setting( &scene, "particles, a thickness apart", 1, true );
    const accuracy_run exact = run_setting( &scene, "exact", 1, true );
    assert_true( measure_of( &scene, &nothing, "missed vertices %" ) > 10.0 );
    assert_true( measure_of( &scene, &nothing, "intersections at most" ) > 0.0 );
    assert_true( particles.error < 0.1 * nothing.error );
    assert_true( exact.error < 0.1 * particles.error );
    assert_true( measure_of( &scene, &exact, "intersections at most" ) == 0.0 );
    assert_true( measure_of( &scene, &exact, "missed vertices %" ) == 0.0 );
    assert_same_hash( &scene, "particles, 2 thicknesses apart" );
    close_scene( &scene );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( the_elastica_has_the_numbers_of_the_closed_form ),
        cmocka_unit_test( frozen_hair_is_the_oracles_with_all_neighbours_only ),
        cmocka_unit_test( shorter_steps_of_clumping_come_nearer_at_first_order ),
        cmocka_unit_test( what_is_kept_apart_overlaps_less_the_closer_it_is_watched ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
