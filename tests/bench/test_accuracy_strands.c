// Scenes of strands of the case `accuracy`: errors fall with their parameter as expected, strands at rest stay there,
// and hashes depend on nothing but the setting.
#include "accuracy_scenes.h"

TEST( strands_that_fall_come_nearer_at_first_order )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "strands_swing", &suite, &scene );
    assert_well_formed( &scene );

    // The error of the direct solve is that of its substep alone.
    const double order = order_between( &scene, "direct, substeps=4", "direct, substeps=20", 5.0 );
    assert_true( fabs( order - 1.0 ) < 0.1 );
    const double direct = error_of( &scene, "direct, substeps=20" );
    assert_true( direct > 0.1 && direct < 1.5 ); // mm of a strand of 0.95 m: different, but the same fall

    assert_same_hash( &scene, "pbd, 1 substep, iterations=2" );
    close_suite( &suite, &scene );
}

TEST( lengths_cost_sweeps_and_not_direct_solves )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "strands_swing", &suite, &scene );
    const accuracy_run direct = run_setting( &scene, "direct, substeps=2", 1, true );
    const accuracy_run few = run_setting( &scene, "pbd, 1 substep, iterations=2", 1, true );
    const accuracy_run many = run_setting( &scene, "pbd, 1 substep, iterations=128", 1, true );
    assert_true( measure_of( &scene, &direct, "stretch max, %" ) < 0.01 );
    assert_true( measure_of( &scene, &few, "stretch max, %" ) > 10.0 );
    assert_true( measure_of( &scene, &many, "stretch max, %" ) < 0.1 * measure_of( &scene, &few, "stretch max, %" ) );

    // A falling strand cannot have more energy than it started with.
    assert_true( measure_of( &scene, &direct, "energy gained, mJ" ) < 0.0 );
    close_suite( &suite, &scene );
}

TEST( hair_that_is_balanced_stays_where_it_is )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "strands_rest", &suite, &scene );
    assert_well_formed( &scene );
    assert_true( error_of( &scene, "waves, substeps=8" ) < 0.001 ); // mm, over 2 s: it does not jitter either
    assert_true( error_of( &scene, "waves, not balanced" ) > 1.0 );
    assert_same_hash( &scene, "waves, substeps=2" );
    close_suite( &suite, &scene );
}

TEST( balanced_curls_stay_at_any_number_of_substeps )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "strands_rest", &suite, &scene );
    assert_well_formed( &scene );
    // less than half of the hair's 80 um
    assert_true( error_of( &scene, "curls, vertices=32, substeps=32" ) < 0.04 );
    assert_true( error_of( &scene, "curls, vertices=32, substeps=4" ) < 0.04 );
    assert_true( error_of( &scene, "curls, not balanced" ) > 1.0 );
    assert_same_hash( &scene, "curls, vertices=32, substeps=1" );
    close_suite( &suite, &scene );
}

TEST( fewer_guides_miss_more )
{
    wisp_suite suite;
    accuracy_scene scene;
    open_suite( "strands_guides", &suite, &scene );
    assert_well_formed( &scene );

    // A ghost with a guide of its own, and without sway, is where it would be if simulated.
    const accuracy_run all = run_setting( &scene, "all simulated, substeps=10", 1, true );
    const accuracy_run alone = run_setting( &scene, "ghosts as guides, substeps=10, strands=576", 1, true );
    assert_true( fabs( alone.error / all.error - 1.0 ) < 0.02 );
    const double four = error_of( &scene, "ghosts as guides, substeps=10, strands=144" );
    assert_true( four > 1.2 * alone.error );
    assert_true( error_of( &scene, "ghosts as guides, substeps=10, strands=36" ) > four );
    assert_true( error_of( &scene, "all simulated, substeps=1" ) > 2.0 * all.error );
    assert_same_hash( &scene, "ghosts sway, strands=144" );

    // Levels of detail, each of which costs less than the one before.
    static const char* const levels[] = { "full", "fewer substeps", "coarse ghosts" };
    double last = 0.0;
    for ( int i = 0; i < WISP_COUNT( levels ); ++i )
    {
        char name[80];
        snprintf( name, sizeof name, "levels of detail, level=%s", levels[i] );
        const double error = error_of( &scene, name );
        assert_true( error > last );
        last = error;
    }
    assert_same_hash( &scene, "levels of detail, level=both" );
    close_suite( &suite, &scene );
}
