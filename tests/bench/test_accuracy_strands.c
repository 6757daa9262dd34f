// Scenes of strands of the case `accuracy`: errors fall with their parameter as expected, strands at rest stay there,
// and hashes depend on nothing but the setting.
#include "accuracy_scenes.h"

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
