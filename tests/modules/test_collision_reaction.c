// Reactions of bodies: what a body gets is minus what surfaces and strands get, in a fixed order, and nothing without a request.
// Restitution: heights of bounces, rest, energy.
#include "collision_fixture.h"
#include "strands.h"

static const float DT = 1.0f / 60.0f;

static wisp_reaction reaction_of( wisp_world* world, wisp_entity body )
{
    wisp_reaction r;
    assert_int_equal( wisp_read_reaction( world, body, &r ), WISP_OK );
    return r;
}

// The momentum and the angular momentum about the origin of the world.
static void motion_of( wisp_world* world, wisp_entity e, double out[6] )
{
    const wisp_motion_stats q = motion_stats_of( world, e );
    const double *c = q.centre, *p = q.momentum, *l = q.angular_momentum;
    const double all[6] = { p[0],
                            p[1],
                            p[2],
                            l[0] + c[1] * p[2] - c[2] * p[1],
                            l[1] + c[2] * p[0] - c[0] * p[2],
                            l[2] + c[0] * p[1] - c[1] * p[0] };
    memcpy( out, all, sizeof( all ) );
}

typedef struct thrown
{
    hosted* h;
    wisp_entity surface, bodies[4];
} thrown;

// A sheet without gravity that is thrown at four bodies, one of which moves and turns.
static thrown new_thrown( bool is_cloth, bool requests, int substeps, int iterations, int workers )
{
    thrown t = { .h = new_colliding( substeps, iterations, workers ) };
    wisp_world* world = t.h->world;
    test_mesh mesh = test_plane( 24, 0.05f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.55f, 0.3f, -0.55f } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = 0.01f;
    t.surface = add_colliding( world, &mesh, &collision );
    test_mesh_free( &mesh );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_true( is_cloth == false || wisp_set_cloth( world, t.surface, &cloth ) == WISP_OK );
    const wisp_collider_kind kinds[] = { WISP_COLLIDER_SPHERE, WISP_COLLIDER_BOX, WISP_COLLIDER_TAPERED_CAPSULE,
                                         WISP_COLLIDER_PLANE };
    for ( int i = 0; i < 4; ++i )
    {
        wisp_collider_def def = body_of( kinds[i] );
        def.radius = 0.2f;
        def.top_radius = 0.1f;
        def.bottom_radius = 0.2f;
        def.restitution = i == 0 ? 0.5f : 0.0f;
        def.pose.translation = ( wisp_vec3 ){ 0.3f * (float)( i % 2 ), i == 3 ? -0.3f : 0.0f, i == 2 ? 0.4f : -0.2f };
        t.bodies[i] = add_collider( world, &def );
        if ( requests )
        {
            assert_int_equal( wisp_request_reaction( world, t.bodies[i], true ), WISP_OK );
        }
    }
    assert_int_equal(
        wisp_set_velocity( world, t.surface, ( wisp_vec3 ){ 0.7f, -3.0f, 0.2f }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ),
        WISP_OK );
    return t;
}

static void step_thrown( thrown* t, int n )
{
    const wisp_transform pose = { about_z( 0.05 * n ), { 0.3f - 0.01f * (float)n, 0.01f * (float)n, -0.2f } };
    assert_int_equal( wisp_move_collider( t->h->world, t->bodies[1], pose ), WISP_OK );
    run_for( t->h->world, DT, 1 );
}

static void check_momentum( bool is_cloth, int substeps, int iterations )
{
    thrown t = new_thrown( is_cloth, true, substeps, iterations, 1 );
    double before[6], touched[4] = { 0.0 };
    run_for( t.h->world, DT, 1 );
    motion_of( t.h->world, t.surface, before );
    for ( int n = 1; n < 40; ++n )
    {
        step_thrown( &t, n );
        double now[6], sum[6] = { 0.0 };
        motion_of( t.h->world, t.surface, now );
        for ( int i = 0; i < 4; ++i )
        {
            const wisp_reaction r = reaction_of( t.h->world, t.bodies[i] );
            const wisp_vec3 j = r.impulse, o = i == 1
                                                   ? ( wisp_vec3 ){ 0.3f - 0.01f * (float)n, 0.01f * (float)n, -0.2f }
                                                   : ( wisp_vec3 ){ 0.3f * (float)( i % 2 ), i == 3 ? -0.3f : 0.0f,
                                                                    i == 2 ? 0.4f : -0.2f };
            const double all[6] = { (double)j.x,
                                    (double)j.y,
                                    (double)j.z,
                                    (double)( r.torque_impulse.x + o.y * j.z - o.z * j.y ),
                                    (double)( r.torque_impulse.y + o.z * j.x - o.x * j.z ),
                                    (double)( r.torque_impulse.z + o.x * j.y - o.y * j.x ) };
            for ( int k = 0; k < 6; ++k )
            {
                sum[k] += all[k];
                touched[i] += fabs( all[k] );
            }
        }
        // 0.6 kg m/s, whose float positions over h sum to less than 1e-6. Distance constraints keep the angular momentum
        // only to the order of the turn in a substep, so only free particles show it. What is moved out of an overlap
        // takes its momentum along, which is no impulse: 4e-6 in these runs.
        for ( int k = 0; k < ( is_cloth ? 3 : 6 ); ++k )
        {
            assert_near( now[k] - before[k], -sum[k], k < 3 ? 1e-6 : 1e-5 );
        }
        memcpy( before, now, sizeof( before ) );
    }
    assert_true( touched[0] > 0.01 && touched[1] > 0.01 && touched[2] > 0.01 && touched[3] > 0.01 );
    free_colliding( t.h );
}

TEST( bodies_get_what_a_surface_loses )
{
    check_momentum( true, 4, 1 );
    check_momentum( true, 2, 3 );
    check_momentum( false, 4, 1 );
    check_momentum( false, 1, 2 );
}

TEST( a_request_changes_no_bit_of_the_motion_and_workers_none_of_the_reaction )
{
    thrown t[3] = { new_thrown( true, false, 4, 1, 1 ), new_thrown( true, true, 4, 1, 1 ),
                    new_thrown( true, true, 4, 1, 3 ) };
    for ( int n = 1; n < 30; ++n )
    {
        for ( int i = 0; i < 3; ++i )
        {
            step_thrown( t + i, n );
        }
        const wisp_view a = view_of( t[0].h->world, t[0].surface, WISP_SURFACE_POINTS );
        const wisp_view b = view_of( t[1].h->world, t[1].surface, WISP_SURFACE_POINTS );
        assert_memory_equal( a.data, b.data, (size_t)a.count * sizeof( wisp_vec3 ) );
        for ( int body = 0; body < 4; ++body )
        {
            const wisp_reaction one = reaction_of( t[1].h->world, t[1].bodies[body] );
            const wisp_reaction three = reaction_of( t[2].h->world, t[2].bodies[body] );
            assert_memory_equal( &one, &three, sizeof( one ) );
        }
    }
    wisp_reaction r;
    assert_int_equal( wisp_read_reaction( t[0].h->world, t[0].bodies[0], &r ), WISP_CONFLICT );
    assert_one_message( wisp_world_message( t[0].h->world ) );
    assert_int_equal( wisp_request_reaction( t[0].h->world, t[0].surface, true ), WISP_CONFLICT );
    // cancelled, and requested again
    assert_int_equal( wisp_request_reaction( t[1].h->world, t[1].bodies[0], false ), WISP_OK );
    assert_int_equal( wisp_read_reaction( t[1].h->world, t[1].bodies[0], &r ), WISP_CONFLICT );
    assert_int_equal( wisp_request_reaction( t[1].h->world, t[1].bodies[0], true ), WISP_OK );
    assert_int_equal( wisp_remove( t[1].h->world, t[1].bodies[2] ), WISP_OK );
    run_for( t[1].h->world, DT, 2 );
    assert_int_equal( wisp_remove( t[1].h->world, t[1].surface ), WISP_OK );
    run_for( t[1].h->world, DT, 1 );
    r = reaction_of( t[1].h->world, t[1].bodies[0] );
    assert_true( r.impulse.x == 0.0f && r.impulse.y == 0.0f && r.impulse.z == 0.0f );
    for ( int i = 0; i < 3; ++i )
    {
        free_colliding( t[i].h );
    }
}

TEST( each_body_gets_what_it_pushed )
{
    hosted* h = new_colliding( 4, 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def(), wall = floor;
    floor.static_friction = floor.kinetic_friction = wall.static_friction = wall.kinetic_friction = 0.0f;
    wall.pose.rotation = about_z( -1.5707963267948966 ); // its normal is +x
    const wisp_entity bodies[2] = { add_collider( h->world, &floor ), add_collider( h->world, &wall ) };
    test_mesh mesh = test_plane( 2, 0.02f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ 0.02f, 0.015f, 0.0f } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = 0.01f;
    const wisp_entity patch = add_colliding( h->world, &mesh, &collision );
    test_mesh_free( &mesh );
    assert_int_equal(
        wisp_set_velocity( h->world, patch, ( wisp_vec3 ){ -1.0f, -1.0f, 0.0f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
        WISP_OK );
    for ( int i = 0; i < 2; ++i )
    {
        assert_int_equal( wisp_request_reaction( h->world, bodies[i], true ), WISP_OK );
    }
    wisp_vec3 sum[2] = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } };
    for ( int n = 0; n < 6; ++n )
    {
        run_for( h->world, DT, 1 );
        for ( int i = 0; i < 2; ++i )
        {
            const wisp_vec3 j = reaction_of( h->world, bodies[i] ).impulse;
            sum[i] = ( wisp_vec3 ){ sum[i].x + j.x, sum[i].y + j.y, sum[i].z + j.z };
        }
    }
    const double m = motion_stats_of( h->world, patch ).mass;
    // all stop: the momentum of 1 m/s down goes to the floor, that to the left to the wall
    assert_near( (double)sum[0].y, -m, 1e-5 * m );
    assert_near( (double)sum[0].x, 0.0, 1e-5 * m );
    assert_near( (double)sum[1].x, -m, 1e-5 * m );
    assert_near( (double)sum[1].y, 0.0, 1e-5 * m );
    free_colliding( h );
}

TEST( what_leaves_the_inside_of_a_body_gives_it_the_velocity_that_it_loses )
{
    hosted* h = new_colliding( 2, 1, 1 );
    const wisp_collider_def floor = wisp_default_collider_def();
    const wisp_entity body = add_collider( h->world, &floor );
    test_mesh mesh = test_plane( 2, 0.1f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ 0.0f, -0.2f, 0.0f } );
    const wisp_collision_def collision = wisp_default_collision_def();
    const wisp_entity patch = add_colliding( h->world, &mesh, &collision );
    test_mesh_free( &mesh );
    assert_int_equal(
        wisp_set_velocity( h->world, patch, ( wisp_vec3 ){ 0.0f, 0.5f, 0.0f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
        WISP_OK );
    assert_int_equal( wisp_request_reaction( h->world, body, true ), WISP_OK );
    run_for( h->world, DT, 1 );
    const wisp_motion_stats q = motion_stats_of( h->world, patch );
    assert_near( q.momentum[1], 0.0, 1e-5 * q.mass );
    assert_near( (double)reaction_of( h->world, body ).impulse.y, 0.5 * q.mass, 1e-5 * q.mass );
    free_colliding( h );
}

// Strands that lie on a floor, with their roots at its height: it carries most of what is not pinned.
TEST( a_floor_carries_the_weight_of_strands )
{
    static const wisp_module* const MODULES[] = { &wisp_strands_module, &wisp_collision_module };
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    h->def = hosted_def( h );
    h->def.modules = MODULES;
    h->def.module_count = WISP_COUNT( MODULES );
    h->def.substeps = 8;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
    const wisp_collider_def plane = wisp_default_collider_def();
    const wisp_entity floor = add_collider( h->world, &plane );
    wisp_vec3 points[2][11];
    const int32_t offsets[3] = { 0, 11, 22 };
    for ( int i = 0; i < 22; ++i )
    {
        points[i / 11][i % 11] = ( wisp_vec3 ){ 0.02f * (float)( i % 11 ), 0.005f, 0.1f * (float)( i / 11 ) };
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points[0];
    def.offsets = offsets;
    def.strand_count = 2;
    wisp_entity hair;
    assert_int_equal( wisp_add_strands( h->world, &def, &hair ), WISP_OK );
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    assert_int_equal( wisp_set_strand_dynamics( h->world, hair, &dynamics ), WISP_OK );
    const wisp_collision_def collision = wisp_default_collision_def();
    assert_int_equal( wisp_set_collision( h->world, hair, &collision ), WISP_OK );
    assert_int_equal( wisp_request( h->world, hair, WISP_MOTION_STATS ), WISP_OK );
    assert_int_equal( wisp_request_reaction( h->world, floor, true ), WISP_OK );
    run_for( h->world, DT, 60 );
    double sum = 0.0;
    for ( int n = 0; n < 60; ++n )
    {
        run_for( h->world, DT, 1 );
        sum += (double)reaction_of( h->world, floor ).impulse.y;
    }
    const wisp_motion_stats q = motion_stats_of( h->world, hair );
    // bending passes 15 % to the roots
    assert_true( -sum > 0.8 * q.mass * 9.81 && -sum < q.mass * 9.81 );
    free_colliding( h );
}

// ---- restitution ----

// A patch of free particles above a body.
static wisp_entity add_patch( wisp_world* world, float height, float thickness )
{
    test_mesh mesh = test_plane( 3, 0.1f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.1f, height + thickness, -0.1f } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = thickness;
    wisp_entity e = add_colliding( world, &mesh, &collision );
    test_mesh_free( &mesh );
    give_gravity( world, e, 9.8f );
    return e;
}

TEST( what_is_dropped_returns_to_the_square_of_the_restitution )
{
    const float values[] = { 0.3f, 0.6f, 0.9f, 1.0f };
    const int substeps = 10;
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        const float e = values[i], height = 1.0f;
        hosted* h = new_colliding( substeps, 1, 1 );
        wisp_collider_def floor = wisp_default_collider_def();
        floor.restitution = e;
        add_collider( h->world, &floor );
        const wisp_entity patch = add_patch( h->world, height, 0.01f );
        double top = 0.0;
        int bounces = 0;
        for ( int n = 0; n < 480 && bounces < 2; ++n )
        {
            const bool rose = n > 0 && motion_stats_of( h->world, patch ).momentum[1] > 0.0;
            run_for( h->world, DT / 4.0f, 1 );
            const wisp_motion_stats q = motion_stats_of( h->world, patch );
            bounces += rose == false && q.momentum[1] > 0.0 ? 1 : 0;
            top = bounces == 1 ? fmax( top, q.centre[1] - 0.01 ) : top;
        }
        assert_true( bounces >= 1 );
        // At v = 4.4 m/s, relative to the height: the substep of the impact loses up to 2 g h / v, the symplectic fall
        // g h / v, and the rise at e v loses g h / ( e v ). The apex is sampled to 1e-4 m.
        const double dt = (double)DT / 4.0 / substeps, expected = (double)( e * e * height );
        const double lost = 9.8 * dt / 4.4 * ( 3.0 + 1.0 / (double)e );
        assert_true( top <= expected * ( 1.0 + 1e-4 ) );
        assert_near( top, expected, expected * lost + 1e-4 );
        free_colliding( h );
    }
}

TEST( what_rests_on_a_bouncy_floor_does_not_jitter )
{
    hosted* h = new_colliding( 8, 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def();
    floor.restitution = 1.0f;
    add_collider( h->world, &floor );
    // it lands at 0.03 m/s; 2 |g| h is 0.04 m/s
    const wisp_entity patch = add_patch( h->world, 5e-5f, 0.01f );
    run_for( h->world, DT, 3 );
    for ( int n = 0; n < 120; ++n )
    {
        run_for( h->world, DT, 1 );
        assert_true( motion_stats_of( h->world, patch ).speed_max < 1e-4 );
    }
    free_colliding( h );
}

TEST( a_bouncing_cloth_gains_no_energy )
{
    hosted* h = new_colliding( 8, 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def(), ball = body_of( WISP_COLLIDER_SPHERE );
    floor.restitution = ball.restitution = 1.0f;
    floor.static_friction = floor.kinetic_friction = ball.static_friction = ball.kinetic_friction = 0.0f;
    add_collider( h->world, &floor );
    add_collider( h->world, &ball );
    const wisp_entity cloth = add_cloth( h->world, 12, 0.8f, ( wisp_vec3 ){ 0.1f, 0.8f, 0.0f }, 9.8f );
    run_for( h->world, DT, 1 );
    double energy = INFINITY, first = 0.0, fastest_up = 0.0;
    for ( int n = 0; n < 120; ++n )
    {
        run_for( h->world, DT, 1 );
        const wisp_motion_stats q = motion_stats_of( h->world, cloth );
        const double now = q.kinetic_energy + q.potential_energy;
        first = n == 0 ? now : first;
        fastest_up = fmax( fastest_up, q.momentum[1] / q.mass );
        // stretch stores and returns energy: 0.2 % of the first
        assert_true( now <= energy + 2e-3 * first );
        energy = fmin( energy, now );
    }
    assert_true( fastest_up > 0.5 );
    free_colliding( h );
}

TEST( a_body_that_moves_throws_what_it_meets )
{
    hosted* h = new_colliding( 10, 1, 1 );
    wisp_collider_def plate = body_of( WISP_COLLIDER_BOX );
    plate.half_extent = ( wisp_vec3 ){ 1.0f, 0.1f, 1.0f };
    plate.restitution = 0.5f;
    plate.pose.translation.y = -0.2f;
    const wisp_entity body = add_collider( h->world, &plate );
    const wisp_entity patch = add_patch( h->world, 0.2f, 0.01f );
    give_gravity( h->world, patch, 0.0f );
    for ( int n = 0; n < 40; ++n )
    {
        const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, -0.2f + 0.02f * (float)( n + 1 ), 0.0f } };
        assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
    }
    // at rest, met at 1.2 m/s: ( 1 + e ) of it
    const wisp_motion_stats q = motion_stats_of( h->world, patch );
    assert_near( q.momentum[1] / q.mass, 1.5 * 0.02 * 60.0, 1e-3 );
    free_colliding( h );
}

COLLISION_TEST( a_restitution_above_one_is_refused )
{
    hosted* h = *state;
    const float bad[] = { -0.1f, 1.1f, NAN };
    for ( int i = 0; i < 3; ++i )
    {
        wisp_collider_def def = wisp_default_collider_def();
        def.restitution = bad[i];
        wisp_entity e;
        assert_int_equal( wisp_add_collider( h->world, &def, &e ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( h->world ), "restitution" ) );
    }
}
