// wisp_world_advance(): fixed steps from uneven frames, and points between two steps.
#include "surface_fixture.h"

enum
{
    SIDE = 5,
};

static const float DT = 1.0f / 64.0f; // exact, as are its sums

// A sheet that flies along x at 1 m/s.
static wisp_entity add_flying( wisp_world* world )
{
    test_mesh mesh = test_plane( SIDE, 0.1f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
    assert_status( world, wisp_set_velocity( world, e, ( wisp_vec3 ){ 1, 0, 0 }, ( wisp_vec3 ){ 0 } ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    test_mesh_free( &mesh );
    return e;
}

static double x_of( wisp_world* world, wisp_entity e )
{
    return (double)( (const wisp_vec3*)view_of( world, e, WISP_SURFACE_POINTS ).data )[0].x;
}

static void advance( wisp_world* world, double seconds )
{
    assert_status( world, wisp_world_advance( world, (float)seconds, DT, NULL, NULL ), WISP_OK );
}

WORLD_TEST( points_are_one_step_late_and_smooth )
{
    hosted* h = *state;
    const wisp_entity e = add_flying( h->world );
    advance( h->world, (double)DT );
    double time = (double)DT;
    for ( int i = 0; i < 200; ++i )
    {
        const double seconds = (double)DT / 64.0 * ( 1 + test_random( i, 1, 200 ) );
        time += seconds;
        advance( h->world, seconds );
        assert_true( fabs( x_of( h->world, e ) - ( time - (double)DT ) ) < 1e-4 );
    }
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), (int)( time / (double)DT ) );
}

static void count_call( void* user, wisp_world* world )
{
    assert_non_null( world );
    *(int*)user += 1;
}

WORLD_TEST( each_step_is_announced_and_eight_are_the_most )
{
    hosted* h = *state;
    add_flying( h->world );
    int calls = 0;
    const double frames[] = { 0.25, 0.5, 0.5, 3.0, 100.0, 0.75 };
    const int expected[] = { 0, 0, 1, 4, 12, 13 };
    for ( int i = 0; i < WISP_COUNT( frames ); ++i )
    {
        assert_status( h->world, wisp_world_advance( h->world, (float)frames[i] * DT, DT, count_call, &calls ),
                       WISP_OK );
        assert_int_equal( calls, expected[i] );
        assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), expected[i] );
    }
}

WORLD_TEST( a_step_of_its_own_shows_its_own_points )
{
    hosted* h = *state;
    const wisp_entity e = add_flying( h->world );
    advance( h->world, 2.5 * (double)DT );
    assert_true( fabs( x_of( h->world, e ) - 1.5 * (double)DT ) < 1e-5 );
    assert_status( h->world, wisp_world_step( h->world, DT ), WISP_OK );
    assert_true( fabs( x_of( h->world, e ) - 3.0 * (double)DT ) < 1e-5 );
}

// Interpolation is for display: a hash is that of the step, and a restored state is shown without interpolation.
WORLD_TEST( hashes_and_restored_points_are_those_of_the_step )
{
    hosted* h = *state;
    const wisp_entity e = add_flying( h->world );
    const size_t capacity = wisp_world_snapshot_size( h->world ) + 100000;
    char* bytes = malloc( capacity );
    assert_non_null( bytes );
    advance( h->world, 2.0 * (double)DT );
    const uint64_t hash = hash_of( h->world, e, WISP_SURFACE_POINTS );
    advance( h->world, 0.5 * (double)DT );
    assert_true( hash_of( h->world, e, WISP_SURFACE_POINTS ) == hash );
    assert_true( fabs( x_of( h->world, e ) - 1.5 * (double)DT ) < 1e-5 );
    const size_t size = wisp_world_snapshot_size( h->world );
    assert_true( size <= capacity );
    assert_status( h->world, wisp_world_snapshot( h->world, bytes, size ), WISP_OK );
    advance( h->world, 3.0 * (double)DT );
    assert_status( h->world, wisp_world_restore( h->world, bytes, size ), WISP_OK );
    assert_true( fabs( x_of( h->world, e ) - 2.0 * (double)DT ) < 1e-5 );
    free( bytes );
}

WORLD_TEST( entities_may_come_and_go )
{
    hosted* h = *state;
    const wisp_entity first = add_flying( h->world );
    advance( h->world, 1.5 * (double)DT );
    const wisp_entity second = add_flying( h->world );
    advance( h->world, (double)DT );
    assert_true( fabs( x_of( h->world, first ) - 1.5 * (double)DT ) < 1e-5 );
    advance( h->world, (double)DT );
    assert_true( fabs( x_of( h->world, second ) - 1.5 * (double)DT ) < 1e-5 );
    assert_status( h->world, wisp_remove( h->world, first ), WISP_OK );
    advance( h->world, 0.25 * (double)DT );
    assert_true( isfinite( x_of( h->world, second ) ) );
    advance( h->world, (double)DT );
    assert_true( fabs( x_of( h->world, second ) - 2.75 * (double)DT ) < 1e-5 );
}

WORLD_TEST( a_repeated_call_allocates_nothing )
{
    hosted* h = *state;
    add_flying( h->world );
    advance( h->world, 2.5 * (double)DT );
    const int64_t requests = atomic_load( &h->host.queried );
    for ( int i = 0; i < 20; ++i )
    {
        advance( h->world, 0.7 * (double)DT );
    }
    assert_int_equal( atomic_load( &h->host.queried ), requests );
}

WORLD_TEST( wrong_times_are_refused )
{
    hosted* h = *state;
    const float wrong[][2] = {
        { -1.0f, 1.0f }, { nanf( "" ), 1.0f }, { 1.0f, 0.0f }, { 1.0f, nanf( "" ) }, { 1e7f, 1.0f }
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        assert_int_equal( wisp_world_advance( h->world, wrong[i][0], wrong[i][1], NULL, NULL ), WISP_BAD_INPUT );
        assert_one_message( wisp_world_message( h->world ) );
    }
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), 0 );
}
