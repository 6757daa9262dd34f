// What implicit cloth gives to bodies: the weight that rests on them, the momentum that it loses to them, by Euler and by BDF2.
#include "collision_fixture.h"

#include "implicit_linked.h"

static const float DT = 0.01f, MARGIN = 0.005f;

static hosted* new_solved( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_implicit_cloth_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, wisp_default_world_def().iterations, workers );
}

// A square of n x n vertices with its middle at `at`.
static wisp_entity add_square( wisp_world* world, int n, float side, wisp_vec3 at,
                               const wisp_implicit_cloth_def* def )
{
    test_mesh mesh = test_plane( n, side / (float)( n - 1 ) );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ at.x - 0.5f * side, at.y, at.z - 0.5f * side } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = MARGIN;
    const wisp_entity e = add_colliding( world, &mesh, &collision );
    test_mesh_free( &mesh );
    assert_int_equal( wisp_set_implicit_cloth( world, e, def ), WISP_OK );
    return e;
}

static void add_reaction( wisp_world* world, wisp_entity body, double impulse[3], double torque[3] )
{
    wisp_reaction r;
    assert_int_equal( wisp_read_reaction( world, body, &r ), WISP_OK );
    const wisp_vec3 j = r.impulse, t = r.torque_impulse;
    const double one[3] = { (double)j.x, (double)j.y, (double)j.z },
                 other[3] = { (double)t.x, (double)t.y, (double)t.z };
    for ( int k = 0; k < 3; ++k )
    {
        impulse[k] += one[k];
        torque[k] += other[k];
    }
}

static wisp_implicit_cloth_def tight( wisp_integrator integrator, wisp_implicit_weights weights )
{
    wisp_implicit_cloth_def def = linked_def();
    def.integrator = integrator;
    def.weights = weights;
    def.tolerance = 1e-7f;
    def.max_iterations = 1000;
    return def;
}

// A sheet that falls on a floor and lies there.
TEST( a_floor_carries_the_weight )
{
    for ( int k = 0; k < 4; ++k )
    {
        SCOPED( close_local ) hosted* h = new_solved( 2, 1 );
        wisp_collider_def plane = wisp_default_collider_def();
        plane.mass = k < 2 ? 0.0f : 1e6f; // it moves less than a digit
        const wisp_entity floor = add_collider( h->world, &plane );
        assert_int_equal( wisp_request_reaction( h->world, floor, true ), WISP_OK );
        const wisp_implicit_cloth_def def =
            tight( k % 2 == 0 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2,
                   k < 2 ? WISP_IMPLICIT_WEIGHTS_EFFECTIVE : WISP_IMPLICIT_WEIGHTS_NONE );
        const wisp_entity e = add_square( h->world, 9, 0.4f, ( wisp_vec3 ){ 0.3f, 0.02f, -0.1f }, &def );
        give_gravity( h->world, e, 9.81f );
        run_for( h->world, DT, 100 );
        double impulse[3] = { 0.0 }, torque[3] = { 0.0 };
        for ( int n = 0; n < 10; ++n )
        {
            run_for( h->world, DT, 1 );
            add_reaction( h->world, floor, impulse, torque );
        }
        const wisp_motion_stats q = motion_stats_of( h->world, e );
        const double weight = 9.81 * q.mass, seconds = 10.0 * (double)DT;
        // effective weights keep no momentum of true masses: what friction holds of the strains has a resultant
        const double near = ( k < 2 ? 5e-4 : 1e-5 ) * weight;
        assert_near( impulse[0] / seconds, 0.0, near );
        assert_near( impulse[1] / seconds, -weight, near );
        assert_near( impulse[2] / seconds, 0.0, near );
        // r x F about the origin of the floor, F = ( 0, -weight, 0 )
        assert_near( torque[0] / seconds, q.centre[2] * weight, near );
        assert_near( torque[1] / seconds, 0.0, near );
        assert_near( torque[2] / seconds, -q.centre[0] * weight, near );
    }
}

// A cloth that falls on a ball that moves and turns with friction, and slides from it to a floor. Euler keeps the sum step by step.
// BDF2 has the momentum of two substeps: from the start to rest it is the same.
TEST( bodies_get_what_the_cloth_loses )
{
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_local ) hosted* h = new_solved( 2, 1 );
        wisp_collider_def plane = wisp_default_collider_def(), round = body_of( WISP_COLLIDER_SPHERE );
        plane.pose.translation.y = -0.1f;
        round.radius = 0.2f;
        const wisp_entity bodies[2] = { add_collider( h->world, &plane ), add_collider( h->world, &round ) };
        const wisp_implicit_cloth_def def =
            tight( k == 0 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2, WISP_IMPLICIT_WEIGHTS_NONE );
        const wisp_entity e = add_square( h->world, 13, 0.6f, ( wisp_vec3 ){ 0.05f, 0.25f, 0.02f }, &def );
        give_gravity( h->world, e, 9.81f );
        const double mass = 0.15 * 0.36; // kg, checked below
        double got[2] = { 0.0 }, total[3] = { 0.0 }, last[3] = { 0.0 }, worst = 0.0, torque[3] = { 0.0 };
        for ( int i = 0; i < 2; ++i )
        {
            assert_int_equal( wisp_request_reaction( h->world, bodies[i], true ), WISP_OK );
        }
        const int steps = 300;
        for ( int n = 1; n <= steps; ++n )
        {
            const float way = n < 100 ? 0.004f * (float)n : 0.4f;
            const wisp_transform pose = { about_z( n < 100 ? 0.02 * n : 2.0 ), { way, 0.0f, 0.0f } };
            assert_int_equal( wisp_move_collider( h->world, bodies[1], pose ), WISP_OK );
            run_for( h->world, DT, 1 );
            double now[3] = { 0.0 };
            for ( int i = 0; i < 2; ++i )
            {
                double one[3] = { 0.0 };
                add_reaction( h->world, bodies[i], one, torque );
                got[i] += fabs( one[0] ) + fabs( one[1] );
                for ( int j = 0; j < 3; ++j )
                {
                    now[j] += one[j];
                }
            }
            const wisp_motion_stats q = motion_stats_of( h->world, e );
            for ( int j = 0; j < 3; ++j )
            {
                const double gravity = j == 1 ? -9.81 * mass * (double)DT : 0.0;
                worst = fmax( worst, fabs( q.momentum[j] - last[j] - gravity + now[j] ) );
                last[j] = q.momentum[j];
                total[j] += now[j] - gravity;
            }
        }
        // 10 m/s in all; a solve is exact to 1e-7 of the change of velocity
        assert_true( k == 1 || worst < 2e-5 * mass );
        assert_near( motion_stats_of( h->world, e ).mass, mass, 1e-6 * mass );
        // BDF2 begins with a substep of Euler, after which its momentum is m (3 v - 0) / 2
        const double begun = k == 1 ? 0.5 * 9.81 * 0.5 * (double)DT * mass : 0.0;
        for ( int j = 0; j < 3; ++j )
        {
            assert_near( total[j] + last[j], j == 1 ? -begun : 0.0, ( k == 0 ? 1e-4 : 2e-3 ) * mass );
        }
        assert_true( got[0] > 0.1 * mass && got[1] > 0.1 * mass );
    }
}

// A patch in the corner of a floor and a wall without friction: each stops its own part of the velocity.
TEST( each_body_gets_what_it_stopped )
{
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_local ) hosted* h = new_solved( 1, 1 );
        wisp_collider_def floor = wisp_default_collider_def();
        floor.static_friction = floor.kinetic_friction = 0.0f;
        wisp_collider_def wall = floor;
        wall.pose.rotation = about_z( -1.0 ); // its normal is ( sin 1, cos 1, 0 )
        const wisp_entity bodies[2] = { add_collider( h->world, &floor ), add_collider( h->world, &wall ) };
        wisp_implicit_cloth_def def =
            tight( k == 0 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2, WISP_IMPLICIT_WEIGHTS_NONE );
        def.stretch_stiffness = def.bend_stiffness = def.link_damping = 0.0f;
        const wisp_entity e = add_square( h->world, 2, 0.0001f, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, &def );
        for ( int i = 0; i < 2; ++i )
        {
            assert_int_equal( wisp_request_reaction( h->world, bodies[i], true ), WISP_OK );
        }
        // the last two thirds of the run it lies in the corner
        assert_int_equal( wisp_set_gravity( h->world, e, ( wisp_vec3 ){ -1.0f, -4.0f, 0.0f } ), WISP_OK );
        run_for( h->world, DT, 50 );
        double impulse[2][3] = { { 0.0 } }, torque[3] = { 0.0 };
        for ( int n = 0; n < 100; ++n )
        {
            run_for( h->world, DT, 1 );
            add_reaction( h->world, bodies[0], impulse[0], torque );
            add_reaction( h->world, bodies[1], impulse[1], torque );
        }
        // a (sin 1, cos 1) + b (0, 1) = (1, 4), per mass and second
        const double mass = motion_stats_of( h->world, e ).mass, a = 1.0 / sin( 1.0 ), b = 4.0 - a * cos( 1.0 );
        assert_near( impulse[1][0], -a * sin( 1.0 ) * mass, 1e-4 * mass );
        assert_near( impulse[1][1], -a * cos( 1.0 ) * mass, 1e-4 * mass );
        assert_near( impulse[0][0], 0.0, 1e-4 * mass );
        assert_near( impulse[0][1], -b * mass, 1e-4 * mass );
    }
}

// The order of calls does not count, a request changes no bit of the motion, and workers change none of the reaction.
TEST( requests_come_and_go )
{
    hosted* h[3];
    wisp_entity floor[3], e[3];
    for ( int k = 0; k < 3; ++k )
    {
        h[k] = new_solved( 2, k == 2 ? 3 : 1 );
        const wisp_collider_def plane = wisp_default_collider_def();
        floor[k] = add_collider( h[k]->world, &plane );
        if ( k == 1 )
        {
            assert_int_equal( wisp_request_reaction( h[k]->world, floor[k], true ), WISP_OK );
        }
        const wisp_implicit_cloth_def def = linked_def();
        e[k] = add_square( h[k]->world, 20, 0.5f, ( wisp_vec3 ){ 0.0f, 0.05f, 0.0f }, &def );
        give_gravity( h[k]->world, e[k], 9.81f );
        if ( k == 2 )
        {
            assert_int_equal( wisp_request_reaction( h[k]->world, floor[k], true ), WISP_OK );
        }
    }
    for ( int n = 0; n < 40; ++n )
    {
        for ( int k = 0; k < 3; ++k )
        {
            run_for( h[k]->world, DT, 1 );
        }
        const wisp_view a = view_of( h[0]->world, e[0], WISP_SURFACE_POINTS ),
                        b = view_of( h[1]->world, e[1], WISP_SURFACE_POINTS );
        assert_memory_equal( a.data, b.data, (size_t)a.count * sizeof( wisp_vec3 ) );
        wisp_reaction one, three;
        assert_int_equal( wisp_read_reaction( h[1]->world, floor[1], &one ), WISP_OK );
        assert_int_equal( wisp_read_reaction( h[2]->world, floor[2], &three ), WISP_OK );
        assert_memory_equal( &one, &three, sizeof( one ) );
        assert_true( n < 20 || one.impulse.y < 0.0f );
    }
    // a body that is removed while its impulse is on the way, and a surface that goes
    wisp_reaction r;
    const wisp_collider_def plane = wisp_default_collider_def();
    const wisp_entity second = add_collider( h[1]->world, &plane );
    assert_int_equal( wisp_request_reaction( h[1]->world, second, true ), WISP_OK );
    assert_int_equal( wisp_remove( h[1]->world, floor[1] ), WISP_OK );
    run_for( h[1]->world, DT, 3 );
    assert_int_equal( wisp_read_reaction( h[1]->world, second, &r ), WISP_OK );
    assert_true( r.impulse.y < 0.0f );
    assert_int_equal( wisp_request_reaction( h[1]->world, second, false ), WISP_OK );
    run_for( h[1]->world, DT, 1 );
    assert_int_equal( wisp_request_reaction( h[1]->world, second, true ), WISP_OK );
    assert_int_equal( wisp_remove( h[1]->world, e[1] ), WISP_OK );
    run_for( h[1]->world, DT, 1 );
    assert_int_equal( wisp_read_reaction( h[1]->world, second, &r ), WISP_OK );
    assert_true( r.impulse.x == 0.0f && r.impulse.y == 0.0f && r.impulse.z == 0.0f );
    for ( int k = 0; k < 3; ++k )
    {
        free_colliding( h[k] );
    }
}
