// Triangle meshes as bodies and as sheets.
#include "collision_fixture.h"

static const float GRAVITY = 9.8f;
static const float DT = 1.0f / 60.0f;

// A ball of radius 0.3 in closed form or as 8 4^level triangles.
static wisp_entity add_ball( wisp_world* world, bool as_mesh, float scale )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.3f * scale;
    if ( as_mesh == false )
    {
        return add_collider( world, &def );
    }
    test_mesh mesh = test_ball( 4 );
    move_mesh( &mesh, 0.3f * scale, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    def = mesh_body( &mesh );
    wisp_entity e = add_collider( world, &def );
    test_mesh_free( &mesh );
    return e;
}

// A square sheet of side 2 in the plane y = 0 of its frame.
static wisp_entity add_sheet( wisp_world* world, wisp_collider_def* def )
{
    test_mesh mesh = test_plane( 3, 1.0f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -1.0f, 0.0f, -1.0f } );
    *def = mesh_body( &mesh );
    def->double_sided = true;
    wisp_entity e = add_collider( world, def );
    test_mesh_free( &mesh );
    return e;
}

TEST( cloth_lies_on_a_mesh_as_on_the_closed_form )
{
    wisp_motion_stats result[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted* h = new_colliding( 4, 4, 1 );
        add_ball( h->world, k == 1, 1.0f );
        wisp_entity e = add_cloth( h->world, 13, 0.7f, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f }, GRAVITY );
        for ( int n = 0; n < 300; ++n )
        {
            run_for( h->world, DT, 1 );
            const wisp_collision_stats stats = collision_of( h->world, e );
            // rounding in closed form; on a mesh also the offset from the plane of a neighbouring face
            assert_true( stats.penetration <= 0.05f * 0.0166f );
        }
        assert_true( collision_of( h->world, e ).penetration <= 0.01f * 0.0166f );
        assert_true( collision_of( h->world, e ).contacts > 30 );
        result[k] = motion_stats_of( h->world, e );
        free_colliding( h );
    }
    // faces of the mesh lie up to 0.3 (1 - cos( 90 / 32 degrees )), 4e-4 m, inside the ball; cloth folds freely
    assert_near( result[0].centre[1], result[1].centre[1], 0.02 );
    assert_near( result[0].centre[0], result[1].centre[0], 0.02 );
    assert_near( result[0].centre[2], result[1].centre[2], 0.02 );
}

TEST( results_on_a_mesh_scale_with_the_scene )
{
    const float scales[] = { 1.0f, 0.01f, 100.0f };
    double height[3];
    for ( int k = 0; k < 3; ++k )
    {
        hosted* h = new_colliding( 4, 4, 1 );
        add_ball( h->world, true, scales[k] );
        wisp_entity e = add_cloth( h->world, 9, 0.5f * scales[k], ( wisp_vec3 ){ 0.0f, 0.4f * scales[k], 0.0f },
                                   GRAVITY * scales[k] );
        run_for( h->world, DT, 90 );
        assert_true( collision_of( h->world, e ).contacts > 20 );
        assert_true( collision_of( h->world, e ).penetration <= 0.01f * 0.0178f * scales[k] );
        height[k] = motion_stats_of( h->world, e ).centre[1] / (double)scales[k];
        free_colliding( h );
    }
    assert_near( height[1], height[0], 0.01 );
    assert_near( height[2], height[0], 0.01 );
}

COLLISION_TEST( a_particle_at_100_m_s_does_not_tunnel_through_a_sheet )
{
    hosted* h = *state;
    wisp_collider_def def;
    add_sheet( h->world, &def );
    for ( int from_below = 0; from_below < 2; ++from_below )
    {
        float side = from_below ? -1.0f : 1.0f;
        test_mesh mesh = test_triangle( ( wisp_vec3 ){ 0.13f, 0.9f * side, 0.07f }, 0.1f );
        wisp_collision_def collision = wisp_default_collision_def();
        wisp_entity e = add_colliding( h->world, &mesh, &collision );
        test_mesh_free( &mesh );
        const wisp_vec3 fast = { 0.0f, -100.0f * side, 0.0f };
        assert_int_equal( wisp_set_velocity( h->world, e, fast, ( wisp_vec3 ){ 0 } ), WISP_OK );
        for ( int n = 0; n < 5; ++n )
        {
            run_for( h->world, DT, 1 );
            for ( int v = 0; v < 3; ++v )
            {
                assert_true( point_of( h->world, e, v ).y * side > 0.0f );
            }
        }
        assert_true( collision_of( h->world, e ).penetration < 1e-6f );
        assert_true( motion_stats_of( h->world, e ).speed_max < 1e-3 );
    }
}

COLLISION_TEST( a_sheet_at_100_m_s_sweeps_particles_along )
{
    hosted* h = *state;
    wisp_collider_def def;
    wisp_entity double_sided = add_sheet( h->world, &def );
    wisp_entity e = add_cloth( h->world, 7, 0.6f, ( wisp_vec3 ){ 0.03f, 0.7f, 0.02f }, 0.0f );
    for ( int n = 1; n <= 5; ++n )
    {
        // rotating as it moves
        const wisp_transform pose = { about_z( 0.05 * n ), { 0.0f, 100.0f * DT * (float)n, 0.0f } };
        assert_int_equal( wisp_move_collider( h->world, double_sided, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        const wisp_view view = view_of( h->world, e, WISP_SURFACE_POINTS );
        for ( int v = 0; v < view.count; ++v )
        {
            assert_true( wisp_transform_to_local( pose, ( (const wisp_vec3*)view.data )[v] ).y > 0.0f );
        }
    }
}

// Constraints move particles after the search for contacts; those that they pull through a sheet are caught.
TEST( cloth_that_is_torn_through_a_sheet_by_its_pins_stays_on_its_side )
{
    hosted* h = new_colliding( 1, 20, 1 );
    wisp_collider_def def;
    add_sheet( h->world, &def );
    wisp_entity e = add_cloth( h->world, 7, 0.6f, ( wisp_vec3 ){ 0.03f, 0.2f, 0.02f }, GRAVITY );
    const int32_t pin = 24;
    assert_int_equal( wisp_pin( h->world, e, &pin, 1 ), WISP_OK );
    wisp_vec3 target = point_of( h->world, e, pin );
    run_for( h->world, DT, 2 );
    target = point_of( h->world, e, pin );
    for ( int n = 0; n < 30; ++n )
    {
        target.y = n % 2 == 0 ? -0.8f : 0.2f;
        assert_int_equal( wisp_move_pins( h->world, e, &pin, &target, 1 ), WISP_OK );
        run_for( h->world, DT, 1 );
        for ( int v = 0; v < 49; ++v )
        {
            const wisp_vec3 p = point_of( h->world, e, v );
            assert_true( v == pin || p.y > 0.0f || fabsf( p.x ) > 1.0f || fabsf( p.z ) > 1.0f );
        }
    }
    free_colliding( h );
}

TEST( what_starts_inside_a_mesh_leaves_without_flying_off )
{
    hosted* h = new_colliding( 1, 8, 1 );
    add_ball( h->world, true, 1.0f );
    wisp_entity e = add_cloth( h->world, 9, 0.24f, ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f }, 0.0f );
    float edge = 0.03f * ( 2.0f + sqrtf( 2.0f ) ) / 3.0f;
    run_for( h->world, DT, 240 );
    assert_true( collision_of( h->world, e ).penetration < 0.1f * edge );
    const wisp_motion_stats q = motion_stats_of( h->world, e );
    // at most at the limit of ten edges a second
    assert_true( fabs( q.momentum[1] ) / q.mass < 10.0 * (double)edge );
    assert_true( q.centre[1] > 0.2 && q.centre[1] < 2.0 );
    free_colliding( h );
}

TEST( a_mesh_that_moves_is_answered_in_its_own_frame )
{
    double height[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted* h = new_colliding( 2, 4, 1 );
        wisp_entity ball = add_ball( h->world, k == 1, 1.0f );
        wisp_entity e = add_cloth( h->world, 9, 0.4f, ( wisp_vec3 ){ 0.0f, 0.35f, 0.0f }, GRAVITY );
        for ( int n = 1; n <= 60; ++n )
        {
            const wisp_transform pose = { about_z( 0.004 * n ), { 0.0f, 0.02f * (float)n, 0.0f } };
            assert_int_equal( wisp_move_collider( h->world, ball, pose ), WISP_OK );
            run_for( h->world, DT, 1 );
            assert_true( collision_of( h->world, e ).penetration < 0.05f * 0.0142f );
        }
        height[k] = motion_stats_of( h->world, e ).centre[1];
        assert_true( height[k] > 1.2 );
        free_colliding( h );
    }
    assert_near( height[0], height[1], 0.02 );
}

TEST( any_number_of_workers_gives_the_same_bits_on_a_mesh )
{
    const int workers[] = { 1, 2, 3, 8 };
    uint64_t expected = 0;
    for ( int k = 0; k < WISP_COUNT( workers ); ++k )
    {
        hosted* h = new_colliding( 2, 2, workers[k] );
        wisp_entity ball = add_ball( h->world, true, 1.0f );
        wisp_entity e = add_cloth( h->world, 33, 0.9f, ( wisp_vec3 ){ 0.0f, 0.35f, 0.0f }, GRAVITY );
        for ( int n = 1; n <= 40; ++n )
        {
            const wisp_transform pose = { about_z( 0.03 * n ), { 0.005f * (float)n, 0.0f, 0.0f } };
            assert_int_equal( wisp_move_collider( h->world, ball, pose ), WISP_OK );
            run_for( h->world, DT, 1 );
        }
        assert_true( collision_of( h->world, e ).contacts > 50 );
        expected = k == 0 ? wisp_world_hash( h->world ) : expected;
        assert_int_equal( wisp_world_hash( h->world ), expected );
        free_colliding( h );
    }
}

COLLISION_TEST( trees_go_with_their_bodies )
{
    hosted* h = *state;
    wisp_entity e = add_cloth( h->world, 5, 0.4f, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f }, GRAVITY );
    run_for( h->world, DT, 1 );
    wisp_entity first = add_ball( h->world, true, 1.0f );
    assert_int_equal( wisp_remove( h->world, first ), WISP_OK );
    size_t before = wisp_world_memory( h->world );
    for ( int n = 0; n < 5; ++n )
    {
        wisp_entity ball = add_ball( h->world, true, 1.0f );
        assert_true( wisp_world_memory( h->world ) > before + 1000 );
        run_for( h->world, DT, 2 );
        assert_int_equal( wisp_remove( h->world, ball ), WISP_OK );
    }
    run_for( h->world, DT, 60 );
    assert_true( motion_stats_of( h->world, e ).centre[1] < -1.0 );
    add_ball( h->world, true, 1.0f ); // and the rest is freed with the world
}

static void assert_refused( wisp_world* world, const wisp_collider_def* def, const char* word )
{
    wisp_entity e;
    size_t before = wisp_world_memory( world );
    assert_int_equal( wisp_add_collider( world, def, &e ), WISP_BAD_INPUT );
    assert_int_equal( e.index, 0 );
    assert_one_message( wisp_world_message( world ) );
    assert_contains( wisp_world_message( world ), word );
    assert_int_equal( wisp_world_memory( world ), before );
}

COLLISION_TEST( impossible_meshes_are_refused )
{
    hosted* h = *state;
    wisp_entity unused;
    wisp_collider_def plane = wisp_default_collider_def();
    assert_int_equal( wisp_add_collider( h->world, &plane, &unused ), WISP_OK ); // the list of bodies exists now
    test_mesh ball = test_ball( 1 );
    wisp_collider_def def = mesh_body( &ball );
    def.triangle_count -= 1;
    assert_refused( h->world, &def, "3 open edges" );
    def.triangle_count = 0;
    assert_refused( h->world, &def, "triangle" );
    def = mesh_body( &ball );
    def.points = NULL;
    assert_refused( h->world, &def, "point" );
    def = mesh_body( &ball );
    ball.points[5].y = NAN;
    assert_refused( h->world, &def, "point 5" );
    test_mesh_free( &ball );
    ball = test_ball( 1 );
    def = mesh_body( &ball );
    ball.triangles[4] = 99;
    assert_refused( h->world, &def, "99" );
    test_mesh_free( &ball );
    ball = test_ball( 1 );
    def = mesh_body( &ball );
    for ( int t = 0; t < ball.triangle_count; ++t )
    {
        int32_t* corners = ball.triangles + 3 * (size_t)t;
        int32_t first = corners[0];
        corners[0] = corners[1];
        corners[1] = first;
    }
    assert_refused( h->world, &def, "inwards" );
    test_mesh_free( &ball );
}
