// The flight of a balloon in `wisp bench accuracy`: its error falls with its substeps.
#include "accuracy_scenes.h"

accuracy_scene_fn accuracy_balloon_flight;

static accuracy_scene flight;

static int make_scene( void** state )
{
    (void)state;
    open_scene( accuracy_balloon_flight, &flight );
    return 0;
}

static int drop_scene( void** state )
{
    (void)state;
    close_scene( &flight );
    return 0;
}

TEST( every_setting_of_a_flight_has_a_name_of_its_own )
{
    assert_well_formed( &flight );
}

TEST( a_flight_comes_nearer_to_double_precision_with_substeps )
{
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
}

TEST( momentum_is_what_the_forces_have_given )
{
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

TEST( a_flight_has_one_hash_whoever_computes_it )
{
    assert_same_hash( &flight, "kick, max drag, 10 x 1" );
}

TEST_GROUP( make_scene, drop_scene )
