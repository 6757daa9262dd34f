// Contact inside the solver (Noh and Jung, section 4 and Fig. 8) in the engine, on bodies of every kind, at rest and moving.
#include "collision_fixture.h"

#include "implicit_linked.h"

static const double DEGREE = 3.14159265358979323846 / 180.0;
static const float GRAVITY = 9.8f;
static const float MARGIN = 0.005f;
static const float DT = 0.01f;

static hosted* new_solved( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_implicit_cloth_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, wisp_default_world_def().iterations, workers );
}

static wisp_entity add_solved( wisp_world* world, const test_mesh* mesh, const wisp_implicit_cloth_def* def,
                               float max_push_out_speed )
{
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = MARGIN;
    collision.max_push_out_speed = max_push_out_speed;
    const wisp_entity e = add_colliding( world, mesh, &collision );
    if ( wisp_set_implicit_cloth( world, e, def ) != WISP_OK )
    {
        fail_msg( "no cloth: %s", wisp_world_message( world ) );
    }
    assert_int_equal( wisp_request_implicit_cloth_stats( world, e, true ), WISP_OK );
    return e;
}

static wisp_implicit_cloth_stats stats_of( wisp_world* world, wisp_entity e )
{
    wisp_implicit_cloth_stats stats;
    assert_int_equal( wisp_read_implicit_cloth_stats( world, e, &stats ), WISP_OK );
    return stats;
}

static test_mesh square( int n, float side, wisp_vec3 middle )
{
    test_mesh mesh = test_plane( n, side / (float)( n - 1 ) );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ middle.x - 0.5f * side, middle.y, middle.z - 0.5f * side } );
    return mesh;
}

// ---- friction on a slope ----

typedef struct incline
{
    hosted* h;
    wisp_entity surface;
    double angle, start;
} incline;

static double along( const incline* i )
{
    const wisp_motion_stats q = motion_stats_of( i->h->world, i->surface );
    return q.centre[0] * cos( i->angle ) + q.centre[1] * sin( i->angle );
}

static double speed_along( const incline* i )
{
    const wisp_motion_stats q = motion_stats_of( i->h->world, i->surface );
    return ( q.momentum[0] * cos( i->angle ) + q.momentum[1] * sin( i->angle ) ) / q.mass;
}

// A patch within the margin of a slope, at rest, and then gravity.
static incline new_incline( double angle, float mu_static, float mu_kinetic, int substeps )
{
    incline i = { .h = new_solved( substeps, 1 ), .angle = angle };
    wisp_collider_def plane = wisp_default_collider_def();
    plane.pose.rotation = about_z( angle );
    plane.static_friction = mu_static;
    plane.kinetic_friction = mu_kinetic;
    add_collider( i.h->world, &plane );
    test_mesh mesh = test_plane( 4, 0.1f );
    const double height = 0.5 * (double)MARGIN;
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const wisp_vec3 p = mesh.points[v];
        mesh.points[v] = ( wisp_vec3 ){ (float)( cos( angle ) * (double)p.x - sin( angle ) * height ),
                                        (float)( sin( angle ) * (double)p.x + cos( angle ) * height ), p.z };
    }
    const wisp_implicit_cloth_def def = linked_def();
    i.surface = add_solved( i.h->world, &mesh, &def, 0.0f );
    test_mesh_free( &mesh );
    give_gravity( i.h->world, i.surface, GRAVITY );
    run_for( i.h->world, DT, 1 ); // it is held from the first step on
    i.start = along( &i );
    return i;
}

TEST( a_patch_sticks_below_the_static_angle_and_slides_above_it )
{
    for ( int k = 0; k < 4; ++k )
    {
        const double limit = atan( 0.3 ) / DEGREE; // 16.7 degrees
        incline below = new_incline( ( limit - 0.5 ) * DEGREE, 0.3f, 0.2f, 1 + k );
        run_for( below.h->world, DT, 300 );
        // held: each step's change of velocity is undone to the last bit, and positions stay
        assert_near( along( &below ), below.start, 1e-6 );
        free_colliding( below.h );
        incline above = new_incline( ( limit + 0.5 ) * DEGREE, 0.3f, 0.2f, 1 + k );
        run_for( above.h->world, DT, 300 );
        assert_true( along( &above ) < above.start - 0.1 );
        free_colliding( above.h );
    }
}

TEST( a_patch_slides_with_what_kinetic_friction_leaves_of_gravity )
{
    const double angles[] = { 20.0, 30.0, 45.0 };
    for ( int k = 0; k < 6; ++k )
    {
        incline i = new_incline( angles[k % 3] * DEGREE, 0.3f, 0.2f, 1 + k / 3 * 3 );
        run_for( i.h->world, DT, 20 ); // the first substeps hold
        const double before = speed_along( &i );
        run_for( i.h->world, DT, 100 );
        const double acceleration = ( before - speed_along( &i ) ) / ( 100.0 * (double)DT );
        const double expected = 9.8 * ( sin( i.angle ) - 0.2 * cos( i.angle ) );
        assert_near( acceleration, expected, 0.02 * expected ); // sliding
        free_colliding( i.h );
    }
}

TEST( friction_stops_what_slides_and_never_turns_it_round )
{
    incline i = new_incline( 5.0 * DEGREE, 0.3f, 0.2f, 1 );
    run_for( i.h->world, DT, 5 );
    const wisp_vec3 push = { (float)( -1.0 * cos( i.angle ) ), (float)( -1.0 * sin( i.angle ) ), 0.0f };
    assert_int_equal( wisp_set_velocity( i.h->world, i.surface, push, ( wisp_vec3 ){ 0 } ), WISP_OK );
    double last = -INFINITY;
    for ( int step = 0; step < 200; ++step )
    {
        run_for( i.h->world, DT, 1 );
        const double speed = speed_along( &i );
        assert_true( speed <= 1e-6 ); // downhill, or at rest
        assert_true( speed >= last - 1e-6 );
        last = speed;
    }
    assert_near( last, 0.0, 1e-6 );
    free_colliding( i.h );
}

// ---- held and released vertices ----

static hosted* lie_on_floor( wisp_entity* body, wisp_entity* e )
{
    hosted* h = new_solved( 1, 1 );
    const wisp_collider_def floor = wisp_default_collider_def();
    *body = add_collider( h->world, &floor );
    test_mesh mesh = square( 6, 0.5f, ( wisp_vec3 ){ 0.0f, 0.4f * MARGIN, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    *e = add_solved( h->world, &mesh, &def, 0.0f );
    test_mesh_free( &mesh );
    give_gravity( h->world, *e, GRAVITY );
    run_for( h->world, DT, 5 );
    return h;
}

TEST( a_cloth_follows_a_floor_that_moves )
{
    wisp_entity body, e;
    SCOPED( close_local ) hosted* h = lie_on_floor( &body, &e );
    const wisp_vec3 velocity = { 0.02f, 0.3f, -0.01f }; // m/s: up, and sideways within the limit of friction
    for ( int step = 1; step <= 50; ++step )
    {
        wisp_transform pose = wisp_default_collider_def().pose;
        const float t = (float)step * DT;
        pose.translation = ( wisp_vec3 ){ t * velocity.x, t * velocity.y, t * velocity.z };
        assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        const wisp_motion_stats q = motion_stats_of( h->world, e );
        // the pose is a float of up to 0.15 m: its difference over a step has an error of 1e-8 m / 0.01 s
        assert_near( q.momentum[0] / q.mass, (double)velocity.x, 3e-6 );
        assert_near( q.momentum[1] / q.mass, (double)velocity.y, 3e-6 );
        assert_near( q.momentum[2] / q.mass, (double)velocity.z, 3e-6 );
    }
    assert_int_equal( stats_of( h->world, e ).sticking, 36 );
}

TEST( a_floor_does_not_pull )
{
    wisp_entity body, e;
    SCOPED( close_local ) hosted* h = lie_on_floor( &body, &e );
    wisp_transform pose = wisp_default_collider_def().pose;
    pose.translation.y = -2.0f; // gone in one step
    assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
    run_for( h->world, DT, 1 ); // a held vertex is held once more, and its pull detected
    const double speed = motion_stats_of( h->world, e ).momentum[1] / motion_stats_of( h->world, e ).mass;
    run_for( h->world, DT, 1 );
    assert_int_equal( stats_of( h->world, e ).sticking, 0 );
    const double later = motion_stats_of( h->world, e ).momentum[1] / motion_stats_of( h->world, e ).mass;
    assert_near( later - speed, -9.8 * (double)DT, 1e-3 );
}

// Gravity along the floor, but for a part of 5e-7: between the hysteresis of 1e-9 of the weight and a thousand times that. The
// floor's normal has one coordinate, so nothing rounds the pull.
TEST( a_pull_of_a_millionth_of_the_weight_releases_and_a_push_as_small_keeps )
{
    for ( int pushes = 0; pushes < 2; ++pushes )
    {
        SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
        wisp_collider_def floor = wisp_default_collider_def();
        add_collider( h->world, &floor );
        test_mesh mesh = square( 6, 0.5f, ( wisp_vec3 ){ 0.0f, 0.4f * MARGIN, 0.0f } );
        const wisp_implicit_cloth_def def = linked_def();
        const wisp_entity e = add_solved( h->world, &mesh, &def, 0.0f );
        test_mesh_free( &mesh );
        const float away = ( pushes == 1 ? -5e-7f : 5e-7f ) * GRAVITY;
        assert_int_equal( wisp_set_gravity( h->world, e, ( wisp_vec3 ){ -GRAVITY, away, 0.0f } ), WISP_OK );
        run_for( h->world, DT, 1 );
        assert_int_equal( stats_of( h->world, e ).sticking, 36 ); // at rest within the margin
        run_for( h->world, DT, 1 );
        const wisp_implicit_cloth_stats stats = stats_of( h->world, e );
        assert_int_equal( stats.released, pushes == 1 ? 0 : 36 );
        assert_int_equal( stats.sticking + stats.sliding, pushes == 1 ? 36 : 0 );
    }
}

TEST( a_corner_that_is_lifted_leaves_while_the_rest_stays )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def();
    add_collider( h->world, &floor );
    SCOPED( test_mesh_free ) test_mesh mesh = square( 9, 0.8f, ( wisp_vec3 ){ 0.0f, 0.4f * MARGIN, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 0.0f );
    give_gravity( h->world, e, GRAVITY );
    run_for( h->world, DT, 5 );
    const int32_t corner = 0;
    assert_int_equal( wisp_pin( h->world, e, &corner, 1 ), WISP_OK );
    for ( int step = 1; step <= 10; ++step )
    {
        wisp_vec3 target = mesh.points[0];
        target.y += 0.01f * (float)step;
        assert_int_equal( wisp_move_pins( h->world, e, &corner, &target, 1 ), WISP_OK );
        run_for( h->world, DT, 1 );
    }
    // a vertex next to the corner hangs in the air; the far corner has not moved
    assert_true( (double)point_of( h->world, e, 1 ).y > 0.03 );
    assert_near( (double)point_of( h->world, e, 80 ).x, (double)mesh.points[80].x, 1e-3 );
    assert_true( stats_of( h->world, e ).sticking + stats_of( h->world, e ).sliding > 40 );
}

// ---- depth ----

TEST( what_begins_inside_is_outside_after_one_step_without_a_cap )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def();
    add_collider( h->world, &floor );
    test_mesh mesh = square( 4, 0.3f, ( wisp_vec3 ){ 0.0f, -0.02f, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 1e5f );
    test_mesh_free( &mesh );
    give_gravity( h->world, e, GRAVITY );
    run_for( h->world, DT, 1 );
    for ( int v = 0; v < 16; ++v )
    {
        assert_near( (double)point_of( h->world, e, v ).y, 0.0, 1e-7 ); // two roundings of 0.02 m
    }
    run_for( h->world, DT, 1 );
    assert_near( motion_stats_of( h->world, e ).speed_max, 0.0, 1e-5 ); // and nothing gains velocity
}

TEST( a_capped_recovery_takes_its_time )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def();
    add_collider( h->world, &floor );
    test_mesh mesh = square( 4, 0.3f, ( wisp_vec3 ){ 0.0f, -0.02f, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 0.1f );
    test_mesh_free( &mesh );
    run_for( h->world, DT, 10 );
    assert_near( (double)point_of( h->world, e, 5 ).y, -0.01, 1e-5 );
    run_for( h->world, DT, 15 );
    assert_near( (double)point_of( h->world, e, 5 ).y, 0.0, 1e-5 );
}

static double lowest( wisp_world* world, wisp_entity e )
{
    const wisp_view view = view_of( world, e, WISP_SURFACE_POINTS );
    double y = INFINITY;
    for ( int v = 0; v < view.count; ++v )
    {
        y = fmin( y, (double)( (const wisp_vec3*)view.data )[v].y );
    }
    return y;
}

TEST( what_falls_fast_lands )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    wisp_collider_def floor = wisp_default_collider_def();
    add_collider( h->world, &floor );
    test_mesh mesh = square( 6, 0.5f, ( wisp_vec3 ){ 0.0f, 0.33f, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 10.0f );
    test_mesh_free( &mesh );
    assert_int_equal( wisp_set_velocity( h->world, e, ( wisp_vec3 ){ 0.0f, -10.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                      WISP_OK );
    give_gravity( h->world, e, GRAVITY );
    for ( int step = 0; step < 60; ++step )
    {
        run_for( h->world, DT, 1 );
        assert_true( lowest( h->world, e ) >= 0.0 );
    }
    assert_true( motion_stats_of( h->world, e ).speed_max < 1e-3 );
}

// ---- drapes ----

typedef struct drape
{
    double deepest, peak, last; // m, J, J
} drape;

static drape drape_on( const wisp_collider_def* body, float height, float seconds_a_step, float stiffness,
                       double time )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    add_collider( h->world, body );
    test_mesh mesh = square( 21, 1.0f, ( wisp_vec3 ){ 0.03f, height, 0.02f } );
    wisp_implicit_cloth_def def = linked_def();
    def.stretch_stiffness = stiffness;
    const wisp_entity e = add_solved( h->world, &mesh, &def, 0.0f );
    test_mesh_free( &mesh );
    give_gravity( h->world, e, GRAVITY );
    drape d = { 0 };
    for ( int step = 0; step < (int)( time / (double)seconds_a_step ); ++step )
    {
        run_for( h->world, seconds_a_step, 1 );
        d.last = motion_stats_of( h->world, e ).kinetic_energy;
        d.peak = fmax( d.peak, d.last );
        d.deepest = fmax( d.deepest, (double)collision_of( h->world, e ).penetration );
    }
    assert_false( wisp_is_halted( h->world, e ) );
    assert_true( stats_of( h->world, e ).sticking > 0 );
    d.deepest = fmax( d.deepest, 0.0 );
    return d;
}

TEST( cloth_on_every_body_comes_to_rest_and_is_never_deeper_than_a_millimetre )
{
    const wisp_collider_kind kinds[] = { WISP_COLLIDER_SPHERE, WISP_COLLIDER_CAPSULE, WISP_COLLIDER_BOX,
                                         WISP_COLLIDER_PLANE };
    for ( int k = 0; k < WISP_COUNT( kinds ); ++k )
    {
        wisp_collider_def body = wisp_default_collider_def();
        body.kind = kinds[k];
        body.radius = 0.25f;
        body.half_length = 0.2f;
        body.half_extent = ( wisp_vec3 ){ 0.25f, 0.25f, 0.25f };
        body.static_friction = 0.3f;
        body.kinetic_friction = 0.2f;
        body.pose.rotation = about_z( kinds[k] == WISP_COLLIDER_CAPSULE ? 90.0 * DEGREE : 0.0 );
        const drape d = drape_on( &body, kinds[k] == WISP_COLLIDER_PLANE ? 0.05f : 0.3f, DT, 200.0f, 15.0 );
        assert_true( d.peak > 1e-3 );
        assert_true( d.last < 1e-4 * d.peak ); // at rest
        assert_true( d.deepest < 1e-3 );
    }
}

TEST( cloth_on_a_mesh_comes_to_rest_like_on_other_bodies )
{
    test_mesh ball = test_ball( 4 ); // radius 1
    move_mesh( &ball, 0.25f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    wisp_collider_def body = wisp_default_collider_def();
    body.kind = WISP_COLLIDER_MESH;
    body.points = ball.points;
    body.triangles = ball.triangles;
    body.point_count = ball.vertex_count;
    body.triangle_count = ball.triangle_count;
    body.static_friction = 0.3f;
    body.kinetic_friction = 0.2f;
    const drape d = drape_on( &body, 0.3f, DT, 200.0f, 15.0 );
    test_mesh_free( &ball );
    assert_true( d.peak > 1e-3 );
    assert_true( d.last < 1e-4 * d.peak );
    assert_true( d.deepest < 1e-3 );
}

TEST( steps_of_a_thirtieth_of_a_second_settle_at_the_stiff_end )
{
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.25f;
    ball.static_friction = 0.3f;
    ball.kinetic_friction = 0.2f;
    const drape d = drape_on( &ball, 0.3f, 1.0f / 30.0f, 350.0f, 15.0 );
    assert_true( d.last < 1e-3 * d.peak );
}

TEST( a_ball_is_driven_through_a_hanging_cloth_without_passing_a_vertex )
{
    SCOPED( close_local ) hosted* h = new_solved( 2, 1 );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.15f;
    ball.pose.translation = ( wisp_vec3 ){ 0.0f, 0.5f, 0.0f };
    const wisp_entity body = add_collider( h->world, &ball );
    test_mesh mesh = square( 17, 1.0f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 0.0f );
    test_mesh_free( &mesh );
    const int32_t corners[] = { 0, 16, 272, 288 };
    assert_int_equal( wisp_pin( h->world, e, corners, 4 ), WISP_OK );
    give_gravity( h->world, e, GRAVITY );
    double deepest = 0.0;
    for ( int step = 1; step <= 105; ++step )
    {
        wisp_transform pose = ball.pose;
        pose.translation.y = 0.5f - 0.008f * (float)step; // 0.8 m/s, to 0.5 m below the corners
        assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        deepest = fmax( deepest, (double)collision_of( h->world, e ).penetration );
    }
    assert_false( wisp_is_halted( h->world, e ) );
    assert_true( lowest( h->world, e ) < -0.45 );
    assert_true( deepest < 1e-3 );
}

TEST( a_groove_of_two_planes_holds_what_lies_in_it )
{
    SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
    for ( int side = -1; side <= 1; side += 2 )
    {
        wisp_collider_def plane = wisp_default_collider_def();
        plane.pose.rotation = about_z( side * 30.0 * DEGREE );
        plane.static_friction = plane.kinetic_friction = 0.1f;
        add_collider( h->world, &plane );
    }
    test_mesh mesh = square( 13, 0.6f, ( wisp_vec3 ){ 0.01f, 0.25f, 0.0f } );
    const wisp_implicit_cloth_def def = linked_def();
    const wisp_entity e = add_solved( h->world, &mesh, &def, 0.0f );
    test_mesh_free( &mesh );
    give_gravity( h->world, e, GRAVITY );
    run_for( h->world, DT, 900 );
    assert_true( (double)collision_of( h->world, e ).penetration < 1e-3 );
    assert_true( motion_stats_of( h->world, e ).kinetic_energy < 1e-6 );
    assert_near( motion_stats_of( h->world, e ).centre[0], 0.0, 0.05 );
}

TEST( collision_may_be_queried_for_before_or_after )
{
    uint64_t hash[2];
    for ( int order = 0; order < 2; ++order )
    {
        SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
        wisp_collider_def floor = wisp_default_collider_def();
        add_collider( h->world, &floor );
        test_mesh mesh = square( 6, 0.5f, ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f } );
        wisp_collision_def collision = wisp_default_collision_def();
        const wisp_implicit_cloth_def def = linked_def();
        const wisp_entity e = add_colliding( h->world, &mesh, &collision );
        assert_int_equal( wisp_set_implicit_cloth( h->world, e, &def ), WISP_OK );
        if ( order == 1 )
        {
            assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_OK );
        }
        test_mesh_free( &mesh );
        give_gravity( h->world, e, GRAVITY );
        run_for( h->world, DT, 50 );
        assert_int_equal( wisp_world_hash_column( h->world, e, WISP_SURFACE_POINTS, &hash[order] ), WISP_OK );
    }
    assert_true( hash[0] == hash[1] );
}
