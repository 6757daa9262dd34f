// Scenes of frozen hair and of particles in contact of the case `accuracy`.
#include "accuracy_scenes.h"

TEST( fewer_neighbours_are_another_shape )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "frozen_clumps", &suite, &scene );
    assert_well_formed( &scene );
    assert_true( error_of( &scene, "neighbours, max_neighbours=256" ) == 0.0 );
    assert_true( error_of( &scene, "neighbours, max_neighbours=4" ) > 0.1 );
    assert_true( error_of( &scene, "iterations, iterations=0" ) > 0.1 );
    assert_same_hash( &scene, "neighbours, max_neighbours=4" );
    assert_same_hash( &scene, "neighbours, max_neighbours=256" );
    close_suite( &suite, &scene );
}

TEST( shorter_steps_of_clumping_come_nearer )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "frozen_flow", &suite, &scene );
    const double order = order_between( &scene, "flow, steps=4", "flow, steps=16", 4.0 );
    assert_true( order > 0.6 && order < 1.15 );
    close_suite( &suite, &scene );
}

TEST( what_is_kept_apart_overlaps_less_the_closer_it_is_watched )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "boundary_contact", &suite, &scene );
    assert_well_formed( &scene );
    const accuracy_run nothing = run_setting( &scene, "nothing", 1, true );
    const accuracy_run spheres = run_setting( &scene, "spheres, layer", 1, true );
    const accuracy_run exact = run_setting( &scene, "exact", 1, true );
    assert_true( measure_of( &scene, &nothing, "missed vertices, %" ) > 10.0 );
    assert_true( measure_of( &scene, &nothing, "max intersections" ) > 0.0 );
    assert_true( spheres.error < 0.1 * nothing.error && exact.error < 0.1 * nothing.error );
    assert_true( measure_of( &scene, &exact, "max intersections" ) == 0.0 );
    assert_true( measure_of( &scene, &exact, "missed vertices, %" ) == 0.0 );
    assert_same_hash( &scene, "spheres, layer" );
    close_suite( &suite, &scene );
}
