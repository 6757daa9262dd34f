// The public interface of worlds: stale handles, requests, views, instances, snapshots, counters; wisp_world_advance():
// fixed steps from uneven frames, and points between two steps; the step clock: substeps of constant length from steps of
// any length, and the interpolation of kinematic targets.
#include "saved_world.h"
#include "surface_fixture.h"
#include "world_fixture.h"

#include "step_clock.h"

// ---- requests and views ----

WORLD_TEST( points_come_out_in_the_users_order )
{
    static const int lengths[] = { 3, 0, 7, 1, 7, 2, 0, 12 };
    SCOPED( test_strands_free ) test_strands s = test_strands_make( lengths, WISP_COUNT( lengths ) );
    wisp_strands_def def = test_strands_def( &s );
    wisp_entity e;
    assert_int_equal( wisp_add_strands( h->world, &def, &e ), WISP_OK );
    assert_int_equal( wisp_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    wisp_view view = view_of( h->world, e, WISP_STRAND_POINTS );
    assert_int_equal( view.count, s.vertex_count );
    assert_int_equal( view.stride, sizeof( wisp_vec3 ) );
    assert_memory_equal( view.data, s.points, (size_t)s.vertex_count * sizeof( wisp_vec3 ) );
}

WORLD_TEST( a_view_of_what_nobody_requests_is_a_conflict )
{
    wisp_entity e = test_add_strands( h->world, 3, 3 );
    const wisp_component wrong[] = { WISP_STRAND_POINTS, WISP_POINT_WIDTH, WISP_STRAND_POSITION, 0, 200 };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_view view = { &view, 1, 1 };
        assert_int_equal( wisp_world_view( h->world, e, wrong[i], &view ), WISP_CONFLICT );
        assert_null( view.data );
        assert_one_message( wisp_world_message( h->world ) );
    }
}

WORLD_TEST( a_request_for_a_component_that_no_module_knows_is_a_conflict )
{
    wisp_entity e = test_add_strands( h->world, 3, 3 );
    assert_int_equal( wisp_request( h->world, e, 0 ), WISP_CONFLICT );
    assert_int_equal( wisp_request( h->world, e, 250 ), WISP_CONFLICT );
    assert_int_equal( wisp_request( h->world, e, UINT16_MAX ), WISP_CONFLICT );
    assert_int_equal( wisp_cancel_request( h->world, e, 250 ), WISP_CONFLICT );
    assert_one_message( wisp_world_message( h->world ) );
}

WORLD_TEST( a_request_brings_a_pass_and_taking_it_back_takes_it_away )
{
    wisp_entity e = test_add_strands( h->world, 3, 3 );
    assert_int_equal( wisp_world_plan_passes( h->world ), 0 );
    assert_int_equal( wisp_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), 1 );
    assert_int_equal( wisp_cancel_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), 0 );
    wisp_view view;
    assert_int_equal( wisp_world_view( h->world, e, WISP_STRAND_POINTS, &view ), WISP_CONFLICT );
}

WORLD_TEST( a_request_taken_back_keeps_rows_that_the_user_gave )
{
    wisp_entity e = test_add_strands( h->world, 3, 3 );
    assert_int_equal( wisp_world_attach( h->world, e, WISP_POINT_WIDTH ), WISP_OK );
    float* width = wisp_world_column( h->world, e, WISP_POINT_WIDTH, 0 );
    width[8] = 5.0f;
    assert_int_equal( wisp_request( h->world, e, WISP_POINT_WIDTH ), WISP_OK );
    assert_int_equal( wisp_cancel_request( h->world, e, WISP_POINT_WIDTH ), WISP_OK );
    assert_true( wisp_world_has( h->world, e, WISP_POINT_WIDTH ) );
    assert_true( ( (const float*)view_of( h->world, e, WISP_POINT_WIDTH ).data )[8] == 5.0f );
}

WORLD_TEST( points_requested_again_are_there_again )
{
    wisp_entity e = test_add_strands( h->world, 3, 3 );
    assert_int_equal( wisp_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    uint64_t hash = hash_of( h->world, e, WISP_STRAND_POINTS );
    assert_int_equal( wisp_cancel_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    assert_int_equal( wisp_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    assert_int_equal( hash_of( h->world, e, WISP_STRAND_POINTS ), hash );
}

WORLD_TEST( strands_without_strands_step_and_show_nothing )
{
    wisp_entity none = add_frozen( h->world, 0, 0 ), empty = add_frozen( h->world, 20, 0 );
    step( h->world );
    assert_int_equal( view_of( h->world, none, WISP_STRAND_POINTS ).count, 0 );
    assert_int_equal( view_of( h->world, empty, WISP_STRAND_POINTS ).count, 0 );
}

// ---- instances and removal ----

WORLD_TEST( an_instance_shares_its_sources_topology_and_starts_at_rest )
{
    wisp_entity source = add_frozen( h->world, 20, 6 ), instance;
    uint64_t at_rest = hash_of( h->world, source, WISP_STRAND_POINTS );
    step( h->world );
    assert_int_not_equal( hash_of( h->world, source, WISP_STRAND_POINTS ), at_rest );

    assert_int_equal( wisp_add_instance( h->world, source, NULL, &instance ), WISP_OK );
    assert_ptr_equal( wisp_world_strands( h->world, instance ), wisp_world_strands( h->world, source ) );
    size_t bytes = (size_t)wisp_world_strands( h->world, source )->row_count * 48 * sizeof( float );
    assert_memory_equal( wisp_world_column( h->world, instance, WISP_STRAND_POSITION, 0 ),
                         wisp_world_column( h->world, source, WISP_STRAND_REST, 0 ), bytes );
    assert_false( wisp_world_has( h->world, instance, WISP_STRAND_STIFFNESS ) );
}

WORLD_TEST( an_instance_starts_in_its_pose )
{
    const wisp_entity source = add_frozen( h->world, 20, 6 );
    const wisp_transform pose = { { 0.0f, 0.0f, 2.0f, 0.0f }, { 3.0f, 0.0f, -2.0f } }; // half a turn about z
    wisp_entity instance, none;
    assert_int_equal( wisp_add_instance( h->world, source, &pose, &instance ), WISP_OK );
    const int rows = wisp_world_strands( h->world, instance )->row_count;
    const float *rest = wisp_world_column( h->world, source, WISP_STRAND_REST, 0 ),
                *placed = wisp_world_column( h->world, instance, WISP_STRAND_REST, 0 );
    for ( int row = 0; row < rows; ++row )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const float *from = rest + row * 48 + lane, *to = placed + row * 48 + lane;
            assert_near( (double)to[0], 3.0 - (double)from[0], 1e-6 );
            assert_near( (double)to[16], -(double)from[16], 1e-6 );
            assert_near( (double)to[32], (double)from[32] - 2.0, 1e-6 );
        }
    }
    assert_memory_equal( wisp_world_column( h->world, instance, WISP_STRAND_POSITION, 0 ), placed,
                         (size_t)rows * 48 * sizeof( float ) );

    wisp_entity again; // its rest shape is that of the instance
    assert_int_equal( wisp_add_instance( h->world, instance, NULL, &again ), WISP_OK );
    assert_memory_equal( wisp_world_column( h->world, again, WISP_STRAND_POSITION, 0 ),
                         wisp_world_column( h->world, instance, WISP_STRAND_REST, 0 ),
                         (size_t)rows * 48 * sizeof( float ) );

    const uint64_t hash = wisp_world_hash( h->world );
    const wisp_transform impossible[] = { { { 0.0f, 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } },
                                          { { 0.0f, 0.0f, 0.0f, 1.0f }, { 2e6f, 0.0f, 0.0f } } };
    for ( int i = 0; i < WISP_COUNT( impossible ); ++i )
    {
        assert_int_equal( wisp_add_instance( h->world, source, impossible + i, &none ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( h->world ), "pose: " ) );
        assert_int_equal( none.index, 0 );
        assert_true( wisp_world_hash( h->world ) == hash );
    }
    step( h->world );
}

WORLD_TEST( an_instance_survives_its_source )
{
    wisp_entity source = add_frozen( h->world, 20, 6 ), instance, second;
    step( h->world );
    uint64_t hash = hash_of( h->world, source, WISP_STRAND_POINTS );
    assert_int_equal( wisp_add_instance( h->world, source, NULL, &instance ), WISP_OK );
    assert_int_equal( wisp_remove( h->world, source ), WISP_OK );
    assert_int_equal( wisp_add_instance( h->world, instance, NULL, &second ), WISP_OK );
    assert_int_equal( wisp_remove( h->world, instance ), WISP_OK );

    wisp_frozen_hair_def def = clumping_def();
    assert_int_equal( wisp_set_frozen_hair( h->world, second, &def ), WISP_OK );
    assert_int_equal( wisp_request( h->world, second, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    assert_int_equal( hash_of( h->world, second, WISP_STRAND_POINTS ), hash );
}

WORLD_TEST( removing_an_entity_leaves_the_others_as_they_are )
{
    wisp_entity entities[5];
    uint64_t hashes[5];
    for ( int i = 0; i < 5; ++i )
    {
        entities[i] = add_frozen( h->world, 5 + 7 * i, 4 + i );
    }
    step( h->world );
    for ( int i = 0; i < 5; ++i )
    {
        hashes[i] = hash_of( h->world, entities[i], WISP_STRAND_POINTS );
    }
    static const int order[] = { 2, 0, 4, 1 };
    for ( int k = 0; k < WISP_COUNT( order ); ++k )
    {
        assert_int_equal( wisp_remove( h->world, entities[order[k]] ), WISP_OK );
        hashes[order[k]] = 0;
        step( h->world );
        for ( int i = 0; i < 5; ++i )
        {
            assert_int_equal( wisp_is_alive( h->world, entities[i] ), hashes[i] != 0 );
            assert_true( hashes[i] == 0 || hash_of( h->world, entities[i], WISP_STRAND_POINTS ) == hashes[i] );
        }
    }
}

// ---- snapshots of a world ----

WORLD_TEST( a_snapshot_needs_room_and_brings_the_state_back )
{
    wisp_entity e = add_frozen( h->world, 20, 6 );
    step( h->world );
    size_t size = wisp_world_snapshot_size( h->world );
    SCOPED( free_local ) void* bytes = checked_malloc( size );
    assert_int_equal( wisp_world_snapshot( h->world, bytes, size - 1 ), WISP_BAD_INPUT );
    assert_int_equal( wisp_world_snapshot( h->world, bytes, size ), WISP_OK );
    uint64_t hash = wisp_world_hash( h->world );
    assert_int_equal( wisp_command_frozen_hair( h->world, e, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
    step( h->world );
    assert_int_not_equal( wisp_world_hash( h->world ), hash );
    assert_int_equal( wisp_world_restore( h->world, bytes, size ), WISP_OK );
    assert_int_equal( wisp_world_hash( h->world ), hash );
    assert_int_equal( wisp_world_restore( h->world, bytes, size - 1 ), WISP_BAD_INPUT );
    assert_one_message( wisp_world_message( h->world ) );
}

WORLD_TEST( a_snapshot_of_strands_cut_differently_is_refused )
{
    // as many strands, vertices, groups and rows, but vertex 6 belongs to another strand
    static const int first[] = { 4, 2, 2 }, second[] = { 4, 3, 1 };
    test_strands a = test_strands_make( first, 3 ), b = test_strands_make( second, 3 );
    wisp_strands_def a_def = test_strands_def( &a ), b_def = test_strands_def( &b );
    wisp_world* other = NULL;
    wisp_entity e;
    assert_int_equal( wisp_world_create( &h->def, &other, NULL ), WISP_OK );
    assert_int_equal( wisp_add_strands( h->world, &a_def, &e ), WISP_OK );
    assert_int_equal( wisp_add_strands( other, &b_def, &e ), WISP_OK );
    test_strands_free( &a );
    test_strands_free( &b );
    const saved_world saved = save_world( h->world );
    wisp_status status = wisp_world_restore( other, saved.bytes, saved.size );
    free( saved.bytes );
    wisp_world_destroy( other );
    assert_int_equal( status, WISP_BAD_INPUT );
}

// A world with these modules, and frozen hair that has run its first command.
static wisp_world* open_frozen_world( const wisp_module* const* modules, int count, wisp_entity* out )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = count;
    def.workers = 1;
    wisp_world* world = NULL;
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    *out = add_frozen( world, 20, 6 );
    step( world );
    return world;
}

TEST( a_snapshot_of_a_world_with_other_modules_goes_on_alike_or_is_refused )
{
    static const wisp_module* const more[] = { &wisp_environment_module, &wisp_strand_appearance_module,
                                               &wisp_frozen_hair_module };
    wisp_entity e, other_e;
    wisp_world* world = open_frozen_world( more + 2, 1, &e );
    wisp_world* other = open_frozen_world( more, 3, &other_e );
    const saved_world saved = save_world( world );
    wisp_status status = wisp_world_snapshot_size( other ) == saved.size
                             ? wisp_world_restore( other, saved.bytes, saved.size )
                             : WISP_BAD_INPUT;
    free( saved.bytes );
    step( world );
    step( other );
    uint64_t hash = hash_of( world, e, WISP_STRAND_POINTS );
    uint64_t other_hash = hash_of( other, other_e, WISP_STRAND_POINTS );
    wisp_world_destroy( world );
    wisp_world_destroy( other );
    assert_true( status == WISP_OK || status == WISP_BAD_INPUT );
    assert_int_equal( other_hash, hash );
}

WORLD_TEST( a_snapshot_of_flat_strands_is_refused_by_deep_ones )
{
    static const wisp_vec3 points[] = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f } };
    static const int32_t offsets[] = { 0, 2 };
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    wisp_world* other = NULL;
    wisp_entity e;
    assert_int_equal( wisp_world_create( &h->def, &other, NULL ), WISP_OK );
    assert_int_equal( wisp_add_strands( other, &def, &e ), WISP_OK );
    def.dimension = 2;
    assert_int_equal( wisp_add_strands( h->world, &def, &e ), WISP_OK );
    const saved_world saved = save_world( h->world );
    wisp_status status = wisp_world_restore( other, saved.bytes, saved.size );
    free( saved.bytes );
    wisp_world_destroy( other );
    assert_int_equal( status, WISP_BAD_INPUT );
}

// ---- counters ----

WORLD_TEST( counters_have_names_and_start_at_zero )
{
    for ( int i = 0; i < WISP_COUNTER_COUNT; ++i )
    {
        assert_int_equal( wisp_world_counter( h->world, (wisp_counter)i ), 0 );
        assert_string_not_equal( wisp_counter_name( (wisp_counter)i ), "unknown" );
    }
    assert_string_equal( wisp_counter_name( WISP_COUNTER_COUNT ), "unknown" );
}

WORLD_TEST( counters_count_what_a_scene_met )
{
    wisp_entity e = add_frozen( h->world, 40, 6 );
    for ( int i = 0; i < 3; ++i )
    {
        step( h->world );
    }
    wisp_frozen_hair_stats report;
    assert_int_equal( wisp_read_frozen_hair_stats( h->world, e, &report ), WISP_OK );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), 3 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_PLANS ), 1 );
    // one command, in the first step
    assert_true( report.neighbours > 0 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_NEIGHBOURS ), report.neighbours );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_SEARCHES ), report.searches );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_CAPPED ), 0 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_COARSE_GRIDS ), report.coarse_grid );
}

WORLD_TEST( a_neighbour_limit_that_bites_is_counted )
{
    wisp_entity e = test_add_strands( h->world, 40, 6 );
    wisp_frozen_hair_def def = clumping_def();
    def.max_neighbours = 1;
    assert_int_equal( wisp_set_frozen_hair( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request( h->world, e, WISP_STRAND_POINTS ), WISP_OK );
    step( h->world );
    assert_true( wisp_world_counter( h->world, WISP_COUNT_CAPPED ) > 0 );
}

// ---- many worlds ----

WORLD_TEST( a_hundred_worlds_live_side_by_side_and_agree )
{
    wisp_world* worlds[100];
    wisp_entity entities[100];
    for ( int i = 0; i < WISP_COUNT( worlds ); ++i )
    {
        assert_int_equal( wisp_world_create( &h->def, worlds + i, NULL ), WISP_OK );
        entities[i] = add_frozen( worlds[i], 20, 5 );
    }
    for ( int i = 0; i < WISP_COUNT( worlds ); ++i )
    {
        step( worlds[i] );
    }
    // one gets a different command, and the others are not affected
    assert_int_equal( wisp_command_frozen_hair( worlds[50], entities[50], ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
                      WISP_OK );
    step( worlds[50] );
    int same = 0;
    for ( int i = 0; i < WISP_COUNT( worlds ); ++i )
    {
        same += wisp_world_hash( worlds[i] ) == wisp_world_hash( worlds[0] ) ? 1 : 0;
    }
    for ( int i = 0; i < WISP_COUNT( worlds ); ++i )
    {
        wisp_world_destroy( worlds[i] );
    }
    assert_int_equal( same, 99 );
}

// ---- frames of any length ----

enum
{
    SIDE = 5,
};

static const float DT = 1.0f / 64.0f; // exact, as are its sums

// A sheet that flies along x at 1 m/s.
static wisp_entity add_flying( wisp_world* world )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.1f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    SET_DEFAULT( world, e, cloth );
    assert_status( world, wisp_set_velocity( world, e, ( wisp_vec3 ){ 1, 0, 0 }, ( wisp_vec3 ){ 0 } ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
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
    const wisp_entity e = add_flying( h->world );
    advance( h->world, 2.5 * (double)DT );
    assert_true( fabs( x_of( h->world, e ) - 1.5 * (double)DT ) < 1e-5 );
    assert_status( h->world, wisp_world_step( h->world, DT ), WISP_OK );
    assert_true( fabs( x_of( h->world, e ) - 3.0 * (double)DT ) < 1e-5 );
}

// Interpolation is for display: a hash is that of the step, and a restored state is shown without interpolation.
WORLD_TEST( hashes_and_restored_points_are_those_of_the_step )
{
    const wisp_entity e = add_flying( h->world );
    const size_t capacity = wisp_world_snapshot_size( h->world ) + 100000;
    SCOPED( free_local ) char* bytes = malloc( capacity );
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
}

WORLD_TEST( entities_may_come_and_go )
{
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
    add_flying( h->world );
    advance( h->world, 2.5 * (double)DT );
    const int64_t requests = atomic_load( &h->host.queried );
    for ( int i = 0; i < 20; ++i )
    {
        advance( h->world, 0.7 * (double)DT );
    }
    assert_int_equal( atomic_load( &h->host.queried ), requests );
}

// Of three steps that are due the second finds a world that cannot step, and the third call makes up for it.
static void spoil_second( void* user, wisp_world* world )
{
    int* calls = user;
    *calls += 1;
    atomic_store( &world->is_stepping, *calls == 2 );
}

WORLD_TEST( steps_that_were_due_when_one_failed_are_made_later )
{
    const wisp_entity e = add_flying( h->world );
    int calls = 0;
    assert_int_equal( wisp_world_advance( h->world, 3.5f * DT, DT, spoil_second, &calls ), WISP_CONFLICT );
    atomic_store( &h->world->is_stepping, false );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), 1 );
    advance( h->world, 0.0 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), 3 );
    assert_near( x_of( h->world, e ), 2.5 * (double)DT, 1e-5 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_CUT_STEPS ), 0 );
    advance( h->world, 20.0 * (double)DT );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_CUT_STEPS ), 1 );
}

// ---- the step clock ----

enum
{
    SUBSTEPS = 8,
    SPLIT = 3,
    LONGEST = 50, // usual steps
};

// Take a step. @return its substeps
static int advance_clock( step_clock* clock, wisp_frame* frame, double dt )
{
    step_clock_advance( clock, (float)dt, SUBSTEPS, LONGEST, false, frame );
    assert_true( step_clock_check( clock ) );
    return frame->substeps;
}

// A frame of two entities: one with the substeps of the world, one that splits each of those into three.
static wisp_frame* new_frame( void )
{
    static plan_entity entities[] = { { .split = 1 }, { .split = SPLIT } };
    static plan p = { .entities = entities, .entity_count = WISP_COUNT( entities ) };
    static wisp_registry registry;
    wisp_frame* frame = checked_calloc( 1, sizeof( wisp_frame ) );
    frame->plan = &p;
    frame->registry = &registry;
    return frame;
}

static const wisp_entity WHOLE = { .index = 1 }, FINER = { .index = 2 };

static double random_dt( int number )
{
    const uint32_t bits = ( (uint32_t)number * 2654435761u ) >> 8;
    return 1e-3 * pow( 50.0, (double)bits / 16777216.0 ); // 1/1000 to 1/20 s
}

TEST( constant_steps_have_the_same_substeps_exactly )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    for ( int i = 0; i < 1500; ++i )
    {
        assert_int_equal( advance_clock( &clock, frame, 1.0 / 60.0 ), SUBSTEPS );
        assert_true( frame->seconds == (float)( 1.0 / 60.0 ) / (float)SUBSTEPS );
        assert_true( wisp_frame_progress( frame, WHOLE, 3 ) == 3.0f / 8.0f );
        assert_true( wisp_frame_progress_left( frame, WHOLE, SUBSTEPS - 1 ) == 1.0f );
        assert_int_equal( wisp_frame_substeps( frame, FINER ), SUBSTEPS * SPLIT );
        assert_true( wisp_frame_dt( frame, FINER ) == frame->seconds / (float)SPLIT );
        assert_true( wisp_frame_progress( frame, FINER, 3 ) == 1.0f / 8.0f );
        assert_true( wisp_frame_progress_left( frame, FINER, SUBSTEPS * SPLIT - 1 ) == 1.0f );
        assert_true( frame->reached == 1.0f && clock.remainder == 0.0 );
    }
}

// Substeps never shrink by more than 0.2 % from step to step, and their sum follows that of the steps within one substep.
TEST( steps_of_any_length_have_substeps_that_barely_change )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    double asked = 0.0, simulated = 0.0, last = 0.0;
    int changes = 0;
    for ( int i = 0; i < 5000; ++i )
    {
        const double dt = (double)(float)random_dt( i );
        asked += dt;
        simulated += advance_clock( &clock, frame, dt ) * (double)frame->seconds;
        assert_true( (double)frame->seconds > 0.997 * last );
        changes += i > 0 && fabs( (double)frame->seconds - last ) > 1e-6 * last ? 1 : 0;
        last = (double)frame->seconds;
        assert_true( fabs( asked - simulated - clock.remainder ) < 1e-5 * asked );
        assert_true( clock.remainder >= 0.0 && clock.remainder < last );
    }
    assert_true( changes <= 3 ); // up to what the longest steps need
}

// A pin with a target for the end of each step moves at constant speed over all substeps.
static void check_steady_target( wisp_entity entity )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    double place = 0.0, from = 0.0, to = 0.0, time = 0.0;
    for ( int i = 0; i < 500; ++i )
    {
        const double dt = (double)(float)random_dt( i );
        time += dt;
        advance_clock( &clock, frame, dt );
        if ( frame->substeps == 0 )
        {
            continue;
        }
        from += (double)frame->reached * ( to - from );
        to = time;
        for ( int s = 0; s < wisp_frame_substeps( frame, entity ); ++s )
        {
            const double before = place;
            place += (double)wisp_frame_progress_left( frame, entity, s ) * ( time - place );
            const double same = from + (double)wisp_frame_progress( frame, entity, s + 1 ) * ( to - from );
            assert_true( fabs( place - same ) < 1e-5 * time );
            assert_true( fabs( ( place - before ) / (double)wisp_frame_dt( frame, entity ) - 1.0 ) < 2e-2 );
        }
        assert_true( fabs( time - place - clock.remainder ) < 1e-5 * time );
    }
    free( frame );
}

TEST( a_steady_target_is_followed_at_a_steady_speed )
{
    check_steady_target( WHOLE );
    check_steady_target( FINER );
}

TEST( a_new_usual_length_is_followed )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    const double lengths[] = { 1.0 / 60.0, 1.0 / 120.0, 1.0 / 30.0 };
    for ( int k = 0; k < 3; ++k )
    {
        for ( int i = 0; i < 1500; ++i )
        {
            advance_clock( &clock, frame, lengths[k] );
        }
        assert_true( clock.usual_dt == (float)lengths[k] );
        assert_true( fabs( (double)frame->seconds * SUBSTEPS / lengths[k] - 1.0 ) < 1e-6 );
    }
}

// Beyond the limit a step is cut, and what is cut is told. No step changes the substeps of others.
TEST( one_long_step_costs_at_most_the_limit )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    for ( int i = 0; i < 200; ++i )
    {
        const float dt = i % 30 == 29 ? 10.0f : i % 30 == 7 ? 0.1f : 1.0f / 60.0f;
        const double cut = step_clock_advance( &clock, dt, SUBSTEPS, 8, false, frame );
        assert_int_equal( frame->substeps, SUBSTEPS * ( dt > 1.0f ? 8 : dt > 0.05f ? 6 : 1 ) );
        assert_true( frame->seconds == 1.0f / 60.0f / (float)SUBSTEPS );
        assert_near( cut, dt > 1.0f ? 10.0 - 8.0 / 60.0 : 0.0, 1e-6 );
        assert_true( clock.remainder == 0.0 );
    }
    assert_near( step_clock_advance( &clock, 10.0f, SUBSTEPS, 1000, false, frame ), 0.0, 0.0 );
    assert_int_equal( frame->substeps, 600 * SUBSTEPS );
}

// Substeps of a sequence of steps are those of 1/60 s in all of its steps behind the first ones.
static void check_usual_length( const double* lengths, int count, int first_ones )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    for ( int i = 0; i < 1000; ++i )
    {
        const double dt = lengths[i < first_ones ? i : first_ones + ( i - first_ones ) % ( count - first_ones )];
        advance_clock( &clock, frame, dt );
        assert_true( i < first_ones || frame->seconds == 1.0f / 60.0f / (float)SUBSTEPS );
        assert_true( i < first_ones || dt < 1.0 / 61.0 || frame->substeps >= SUBSTEPS );
    }
}

TEST( the_usual_length_is_that_of_most_steps )
{
    const double usual = 1.0 / 60.0;
    check_usual_length( ( const double[] ){ usual, 10.0, usual, usual }, 4, 1 ); // a load screen after the first
    check_usual_length( ( const double[] ){ 10.0, usual }, 2, 1 );               // and before
    check_usual_length( ( const double[] ){ 10.0, 3.0, 1e-5, usual }, 4, 3 );    // and two of them, and a trial
    check_usual_length( ( const double[] ){ 0.1, usual }, 2, 1 );                // a short one
    check_usual_length( ( const double[] ){ 2.0 * usual, usual, usual, usual }, 4, 3 );
    check_usual_length( ( const double[] ){ 1.0 / 144.0, usual, usual, usual }, 4, 3 );
    check_usual_length( ( const double[] ){ usual, 0.1, 0.1, usual }, 4, 0 );
    check_usual_length( ( const double[] ){ usual, 1e-5, usual }, 3, 0 );              // tiny ones in between
    check_usual_length( ( const double[] ){ usual, 2.0 * usual }, 2, 0 );              // in turns with longer ones
    check_usual_length( ( const double[] ){ usual, 0.8 * usual, 1.2 * usual }, 3, 0 ); // jitter
}

TEST( tiny_steps_do_not_outnumber_usual_ones )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    for ( int i = 0; i < 20000; ++i )
    {
        advance_clock( &clock, frame, i < 10 || i > 18000 ? 1.0 / 60.0 : 1e-5 ); // 0.2 s of tiny ones
        assert_true( frame->seconds == 1.0f / 60.0f / (float)SUBSTEPS );
    }
}

TEST( hitches_do_not_keep_a_new_length_from_being_followed )
{
    const double lengths[] = { 1.0 / 60.0, 1.0 / 144.0, 1.0 / 30.0 };
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    for ( int k = 0; k < 3; ++k )
    {
        for ( int i = 0; i < 1500; ++i )
        {
            advance_clock( &clock, frame, i % 10 == 9 ? 0.5 : lengths[k] );
        }
        assert_true( clock.usual_dt == (float)lengths[k] );
        assert_true( frame->seconds == (float)lengths[k] / (float)SUBSTEPS );
    }
}

// Who makes steps of a second gets them: the first alone may be a load screen.
TEST( a_second_long_step_makes_them_usual )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    assert_int_equal( advance_clock( &clock, frame, 0.5 ), 30 * SUBSTEPS );
    assert_int_equal( advance_clock( &clock, frame, 0.5 ), SUBSTEPS );
    assert_true( frame->seconds == 0.5f / (float)SUBSTEPS );
}

TEST( a_trial_step_at_the_start_does_not_set_the_usual_length )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    advance_clock( &clock, frame, 1e-6 );
    assert_int_equal( advance_clock( &clock, frame, 1.0 / 60.0 ), SUBSTEPS );
    assert_true( frame->seconds == (float)( 1.0 / 60.0 ) / (float)SUBSTEPS );
}

TEST( a_step_that_must_run_has_one_substep )
{
    step_clock clock = { 0 };
    SCOPED( free_local ) wisp_frame* frame = new_frame();
    advance_clock( &clock, frame, 1.0 / 60.0 );
    assert_int_equal( advance_clock( &clock, frame, 1e-5 ), 0 );
    step_clock_advance( &clock, 1e-5f, SUBSTEPS, LONGEST, true, frame );
    assert_int_equal( frame->substeps, 1 );
    assert_true( fabs( (double)frame->seconds - 2e-5 ) < 1e-9 && clock.remainder == 0.0 );
}

TEST( clocks_that_no_step_leaves_are_refused )
{
    const float nan = nanf( "" );
    assert_true( step_clock_check( &( step_clock ){ 0 } ) );
    assert_false( step_clock_check( &( step_clock ){ .usual_dt = nan } ) );
    assert_false( step_clock_check( &( step_clock ){ .usual_dt = -1.0f } ) );
    assert_false( step_clock_check( &( step_clock ){ .reached = 1.5f } ) );
    assert_false( step_clock_check( &( step_clock ){ .remainder = INFINITY } ) );
    assert_false( step_clock_check( &( step_clock ){ .substep = -1.0 } ) );
    assert_false( step_clock_check( &( step_clock ){ .votes = STEP_CLOCK_MAJORITY + 1 } ) );
    assert_false( step_clock_check( &( step_clock ){ .step_count = -1 } ) );
    assert_false( step_clock_check( &( step_clock ){ .candidate = nan } ) );
}
