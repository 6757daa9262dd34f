// Surfaces with an external solver among bodies: statistics, plans, memory, and the same bits for every way to run
// them.
#include "collision_sense_fixture.h"

// ---- figures ----

SENSE_TEST( stats_tell_depth_behind_the_surface_and_count_within_the_margin )
{
    hosted* h = *state;
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    plane.thickness = 0.01f;
    add_collider( h->world, &plane );
    // rows of nine vertices a centimetre apart, from 3.5 cm below the plane to 4.5 cm above it
    test_mesh mesh = test_plane( 9, 0.01f );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].y = 0.01f * (float)( v / 9 ) - 0.035f;
    }
    wisp_entity e = add_surface( h->world, &mesh );
    test_mesh_free( &mesh );
    give_solver( h->world, e );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    run_for( h->world, DT, 1 );
    wisp_collision_stats f = collision_of( h->world, e );
    assert_near( f.penetration, 0.035, 1e-8 );
    assert_true( f.thickness == MARGIN + 0.01f );
    assert_int_equal( f.vertex, 0 );
    assert_int_equal( f.contacts, 7 * 9 ); // up to 2.5 cm, within 3 cm
    assert_int_equal( f.dropped, 0 );
    give_velocity( h->world, e, 0.0f, 0.036f / DT, 0.0f );
    run_for( h->world, DT, 1 );
    f = collision_of( h->world, e );
    assert_true( f.penetration == 0.0f );
    assert_int_equal( f.vertex, -1 );
    assert_int_equal( f.contacts, 3 * 9 );
    assert_int_equal( wisp_request_collision_stats( h->world, e, false ), WISP_OK );
    assert_false( is_planned( h->world, "collision.contact_stats" ) );
}

// ---- plans ----

SENSE_TEST( calls_in_either_order_give_the_same_plan )
{
    hosted* h = *state;
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    add_collider( h->world, &plane );
    test_mesh mesh = test_triangle( ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f }, 0.01f );
    wisp_entity e = add_surface( h->world, &mesh );
    test_mesh_free( &mesh );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    assert_true( is_planned( h->world, "collision.find" ) );
    assert_false( is_planned( h->world, "collision.contact_input" ) );
    run_for( h->world, DT, 1 ); // which pushes it out of the margin
    give_solver( h->world, e );
    give_velocity( h->world, e, 0.0f, -0.003f / DT, 0.0f );
    for ( int again = 0; again < 2; ++again )
    {
        // contacts of ours lie idle until somebody calls again
        assert_true( wisp_world_has( h->world, e, WISP_PARTICLE_HALF_SPACES ) == ( again == 0 ) );
        assert_true( is_planned( h->world, "collision.contact_input" ) );
        assert_true( is_planned( h->world, "collision.contact_stats" ) );
        assert_false( is_planned( h->world, "collision.find" ) );
        assert_false( is_planned( h->world, "collision.project" ) );
        assert_false( is_planned( h->world, "collision.stats" ) );
        assert_true( sense( h->world, e ).body != 0 );
        assert_int_equal( collision_of( h->world, e ).contacts, 3 );
        assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    }
}

SENSE_TEST( nothing_to_touch_leaves_no_pass_and_no_memory_of_bodies )
{
    hosted* h = *state;
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    const int bare = wisp_world_plan_passes( h->world );
    assert_false( is_planned( h->world, "collision.contact_input" ) );
    wisp_entity body = add_collider( h->world, &plane );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 2 );
    assert_true( sense( h->world, e ).body != 0 );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
    assert_int_equal( touch_of( h->world, e, 0, 0 ).body, 0 );
    assert_int_equal( sense( h->world, e ).body, 0 );
    add_collider( h->world, &plane );
    assert_true( sense( h->world, e ).body != 0 );
    wisp_collision_def def = thin();
    def.enabled = false;
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
    assert_int_equal( sense( h->world, e ).body, 0 );
    assert_int_equal( collision_of( h->world, e ).contacts, 0 );
}

SENSE_TEST( without_memory_a_call_changes_nothing )
{
    hosted* h = *state;
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    add_collider( h->world, &plane );
    test_mesh mesh = test_plane( 5, 0.01f );
    wisp_entity e = add_surface( h->world, &mesh );
    test_mesh_free( &mesh );
    give_solver( h->world, e );
    const int bare = wisp_world_plan_passes( h->world );
    const wisp_collision_def def = thin();
    bool done = false;
    int refusals = 0;
    for ( int n = 1; done == false && n < 100; ++n )
    {
        test_host_refuse( &h->host, n, true );
        done = wisp_set_collision( h->world, e, &def ) == WISP_OK;
        const bool refused = test_host_has_refused( &h->host );
        test_host_refuse( &h->host, 0, false );
        refusals += refused ? 1 : 0;
        assert_true( done != refused );
        assert_int_equal( wisp_world_plan_passes( h->world ), done ? bare + 1 : bare );
        run_for( h->world, DT, 1 );
    }
    assert_true( done && refusals > 0 );
}

// ---- many particles ----

static wisp_entity busy_scene( wisp_world* world, wisp_entity* ball )
{
    wisp_collider_def def = body_of( WISP_COLLIDER_SPHERE );
    *ball = add_collider( world, &def );
    def = body_of( WISP_COLLIDER_BOX );
    def.pose.translation = ( wisp_vec3 ){ 0.5f, 0.0f, 0.3f };
    add_collider( world, &def );
    def = body_of( WISP_COLLIDER_CAPSULE );
    def.pose.translation = ( wisp_vec3 ){ -0.4f, 0.0f, 0.2f };
    add_collider( world, &def );
    def = body_of( WISP_COLLIDER_PLANE );
    def.pose.translation.y = -0.1f;
    add_collider( world, &def );
    add_mesh( world, false, ( wisp_transform ){ about_z( 0.3 ), { 0.0f, 0.0f, -0.6f } } );
    test_mesh mesh = test_plane( 40, 0.035f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.7f, 0.35f, -0.7f } );
    wisp_entity e = add_surface( world, &mesh );
    test_mesh_free( &mesh );
    give_solver( world, e );
    const wisp_collision_def collision = thin();
    assert_int_equal( wisp_set_collision( world, e, &collision ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    give_velocity( world, e, 0.1f, -2.0f, 0.05f );
    give_gravity( world, e, 9.8f );
    return e;
}

TEST( any_number_of_workers_gives_the_same_bits )
{
    const int workers[] = { 1, 2, 3, 5 };
    uint64_t expected[20];
    for ( int k = 0; k < WISP_COUNT( workers ); ++k )
    {
        hosted* h = new_world( 2, workers[k] );
        wisp_entity ball;
        wisp_entity e = busy_scene( h->world, &ball );
        int most = 0;
        for ( int n = 0; n < WISP_COUNT( expected ); ++n )
        {
            run_busy( h->world, ball, n, n + 1 );
            const uint64_t hash = wisp_world_hash( h->world );
            expected[n] = k == 0 ? hash : expected[n];
            assert_int_equal( hash, expected[n] );
            const int contacts = collision_of( h->world, e ).contacts;
            most = contacts > most ? contacts : most;
        }
        assert_true( most > 100 );
        free_colliding( h );
    }
}

// The same surface, moved as a whole: particles share blocks differently, and the result must not show it.
SENSE_TEST( a_particle_senses_the_same_alone_and_among_others )
{
    hosted* h = *state;
    wisp_entity ball;
    wisp_entity many = busy_scene( h->world, &ball );
    test_mesh mesh = test_plane( 40, 0.035f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.7f, 0.35f, -0.7f } );
    wisp_entity alone[10];
    for ( int k = 0; k < 10; ++k )
    {
        alone[k] = add_probe( h->world, mesh.points[160 * k + 7] );
        give_velocity( h->world, alone[k], 0.1f, -2.0f, 0.05f );
        give_gravity( h->world, alone[k], 9.8f );
    }
    test_mesh_free( &mesh );
    int touched = 0;
    for ( int n = 0; n < 20; ++n )
    {
        run_busy( h->world, ball, n, n + 1 );
        for ( int k = 0; k < 10; ++k )
        {
            for ( int t = 0; t < WISP_MAX_PARTICLE_CONTACTS; ++t )
            {
                const sensed a = touch_of( h->world, alone[k], 0, t ), b = touch_of( h->world, many, 160 * k + 7, t );
                assert_memory_equal( &a, &b, sizeof( a ) );
                touched += a.body != 0 ? 1 : 0;
            }
        }
    }
    assert_true( touched > 50 );
}

SENSE_TEST( a_warm_step_allocates_nothing )
{
    hosted* h = *state;
    wisp_entity ball;
    busy_scene( h->world, &ball );
    run_busy( h->world, ball, 0, 5 );
    const int64_t queried = atomic_load( &h->host.queried );
    run_busy( h->world, ball, 5, 20 );
    assert_int_equal( atomic_load( &h->host.queried ), queried );
}
