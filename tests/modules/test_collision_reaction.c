// Reactions: what a body gets is minus what surfaces of every solver and strands get, each body its own, in a fixed order, and nothing
// without a request.
#include "collision_fixture.h"

#include "implicit_linked.h"
#include "strands.h"

// ---- solvers ----

typedef enum solver
{
    LOOSE, // particles without links
    LINKS,
    EULER,
    BDF2,
    SOLVERS,
    STRANDS = SOLVERS,
} solver;

static hosted* new_solved( int substeps, int iterations, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_implicit_cloth_module, &wisp_strands_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, iterations, workers );
}

static void solve( wisp_world* world, wisp_entity e, solver by, wisp_implicit_weights weights, float stiffness )
{
    wisp_implicit_cloth_def implicit = linked_def();
    implicit.integrator = by == BDF2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    implicit.weights = weights;
    implicit.stretch_stiffness *= stiffness;
    implicit.bend_stiffness *= stiffness;
    implicit.link_damping *= stiffness;
    implicit.tolerance = 1e-7f;
    implicit.max_iterations = 1000;
    const wisp_cloth_def cloth = undamped_cloth();
    assert_status( world, by == LINKS ? wisp_set_cloth( world, e, &cloth ) : WISP_OK, WISP_OK );
    assert_status( world, by >= EULER ? wisp_set_implicit_cloth( world, e, &implicit ) : WISP_OK, WISP_OK );
}

// A square of n x n vertices with its middle at `at`.
static wisp_entity add_square( wisp_world* world, int n, float side, wisp_vec3 at, float thickness )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( n, side / (float)( n - 1 ) );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ at.x - 0.5f * side, at.y, at.z - 0.5f * side } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = thickness;
    return add_colliding( world, &mesh, &collision );
}

static void request_reaction( wisp_world* world, wisp_entity body )
{
    assert_status( world, wisp_request_reaction( world, body, true ), WISP_OK );
}

static wisp_reaction reaction_of( wisp_world* world, wisp_entity body )
{
    wisp_reaction r;
    assert_status( world, wisp_read_reaction( world, body, &r ), WISP_OK );
    return r;
}

// Add the impulse, and the angular impulse about the origin of the world.
static void add_impulse( const wisp_reaction* r, wisp_vec3 origin, double sum[6] )
{
    const wisp_vec3 j = r->impulse, t = wisp_v3_add( r->torque_impulse, wisp_v3_cross( origin, j ) );
    const double all[6] = { (double)j.x, (double)j.y, (double)j.z, (double)t.x, (double)t.y, (double)t.z };
    for ( int k = 0; k < 6; ++k )
    {
        sum[k] += all[k];
    }
}

// ---- weight ----

// Strands that lie on a floor, with their roots at its height.
static wisp_entity add_lying_strands( wisp_world* world )
{
    wisp_vec3 points[22];
    const int32_t offsets[3] = { 0, 11, 22 };
    for ( int i = 0; i < 22; ++i )
    {
        points[i] = ( wisp_vec3 ){ 0.02f * (float)( i % 11 ), 0.005f, 0.1f * (float)( i / 11 ) };
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points, def.offsets = offsets, def.strand_count = 2;
    wisp_entity hair;
    assert_status( world, wisp_add_strands( world, &def, &hair ), WISP_OK );
    SET_DEFAULT( world, hair, strand_dynamics );
    SET_DEFAULT( world, hair, collision );
    assert_status( world, wisp_request( world, hair, WISP_MOTION_STATS ), WISP_OK );
    return hair;
}

TEST( a_floor_carries_the_weight )
{
    // effective weights keep no momentum of true masses: what friction holds of the strains has a resultant; bending of strands passes
    // 15 % to their roots
    static const struct
    {
        solver by;
        wisp_implicit_weights weights;
        float mass;
        double near; // of the weight
    } cases[] = {
        { LINKS, 0, 0.0f, 1e-4 },
        { EULER, WISP_IMPLICIT_WEIGHTS_EFFECTIVE, 0.0f, 5e-4 },
        { BDF2, WISP_IMPLICIT_WEIGHTS_EFFECTIVE, 0.0f, 5e-4 },
        { EULER, WISP_IMPLICIT_WEIGHTS_NONE, 1e6f, 1e-5 }, // a floor that moves less than a digit
        { BDF2, WISP_IMPLICIT_WEIGHTS_NONE, 1e6f, 1e-5 },
        { STRANDS, 0, 0.0f, 0.2 },
        { STRANDS, 0, 1e6f, 0.2 },
    };
    for ( int k = 0; k < WISP_COUNT( cases ); ++k )
    {
        const bool is_hair = cases[k].by == STRANDS;
        SCOPED( close_local ) hosted* h = new_solved( is_hair ? 8 : 2, 1, 1 );
        wisp_collider_def plane = wisp_default_collider_def();
        plane.mass = cases[k].mass;
        const wisp_entity floor = add_collider( h->world, &plane );
        request_reaction( h->world, floor );
        const wisp_entity e = is_hair ? add_lying_strands( h->world )
                                      : add_square( h->world, 9, 0.4f, ( wisp_vec3 ){ 0.3f, 0.02f, -0.1f }, 0.005f );
        if ( is_hair == false )
        {
            solve( h->world, e, cases[k].by, cases[k].weights, 1.0f );
            give_gravity( h->world, e, 9.81f );
        }
        const int steps = is_hair ? 60 : 10;
        run_for( h->world, 0.01f, 100 );
        double sum[6] = { 0.0 };
        for ( int n = 0; n < steps; ++n )
        {
            run_for( h->world, 0.01f, 1 );
            const wisp_reaction r = reaction_of( h->world, floor );
            add_impulse( &r, ( wisp_vec3 ){ 0 }, sum );
        }
        const wisp_motion_stats q = motion_stats_of( h->world, e );
        const double impulse = 9.81 * q.mass * 0.01 * steps;
        // r x F about the origin of the floor, F = ( 0, -weight, 0 )
        const double expected[6] = { 0.0, -1.0, 0.0, q.centre[2], 0.0, -q.centre[0] };
        for ( int i = 0; i < ( is_hair ? 3 : 6 ); ++i )
        {
            assert_near( sum[i] / impulse, expected[i], cases[k].near );
        }
        assert_true( is_hair == false || -sum[1] < impulse );
    }
}

// ---- momentum ----

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

enum
{
    BODIES = 4,
};

typedef struct thrown
{
    hosted* h;
    wisp_world* world;
    wisp_entity surface, bodies[BODIES];
    wisp_vec3 places[BODIES];
    int steps;
} thrown;

// A sheet without gravity that is thrown at four bodies, one of which moves and turns.
static thrown new_thrown( solver by, bool requests, int substeps, int iterations, int workers )
{
    thrown t = { .h = new_solved( substeps, iterations, workers ) };
    t.world = t.h->world;
    t.surface = add_square( t.world, 24, 1.15f, ( wisp_vec3 ){ 0.025f, 0.3f, 0.025f }, 0.01f );
    solve( t.world, t.surface, by, WISP_IMPLICIT_WEIGHTS_NONE, 1.0f );
    const wisp_collider_kind kinds[] = { WISP_COLLIDER_SPHERE, WISP_COLLIDER_BOX, WISP_COLLIDER_TAPERED_CAPSULE,
                                         WISP_COLLIDER_PLANE };
    for ( int i = 0; i < BODIES; ++i )
    {
        wisp_collider_def def = body_of( kinds[i] );
        def.radius = def.bottom_radius = 0.2f;
        def.top_radius = 0.1f;
        def.restitution = i == 0 ? 0.5f : 0.0f;
        t.places[i] = ( wisp_vec3 ){ 0.3f * (float)( i % 2 ), i == 3 ? -0.3f : 0.0f, i == 2 ? 0.4f : -0.2f };
        def.pose.translation = t.places[i];
        t.bodies[i] = add_collider( t.world, &def );
        if ( requests )
        {
            request_reaction( t.world, t.bodies[i] );
        }
    }
    const wisp_vec3 velocity = { 0.7f, -3.0f, 0.2f }, turn = { 0.0f, 1.0f, 0.0f };
    assert_status( t.world, wisp_set_velocity( t.world, t.surface, velocity, turn ), WISP_OK );
    return t;
}

static void step_thrown( thrown* t )
{
    const int n = ++t->steps;
    t->places[1] = ( wisp_vec3 ){ 0.3f - 0.01f * (float)n, 0.01f * (float)n, -0.2f };
    const wisp_transform pose = { about_z( 0.05 * n ), t->places[1] };
    assert_status( t->world, wisp_move_collider( t->world, t->bodies[1], pose ), WISP_OK );
    run_for( t->world, 1.0f / 60.0f, 1 );
}

// Of 0.6 kg m/s. Distance constraints keep the angular momentum only to the order of the turn in a substep, so only free particles show
// it. What is moved out of an overlap takes its momentum along, which is no impulse, as does what goes to the middle of a squeeze: 2.3e-5 in
// these runs. A solve of implicit cloth is exact to 1e-7 of the change of velocity.
TEST( bodies_get_what_a_surface_loses )
{
    static const struct
    {
        solver by;
        int substeps, iterations;
        double near_turn; // per step; 0: not kept
    } cases[] = {
        { LINKS, 4, 1, 0.0 }, { LINKS, 2, 3, 0.0 }, { LOOSE, 4, 1, 4e-5 }, { LOOSE, 1, 2, 4e-5 }, { EULER, 2, 1, 0.0 }
    };
    for ( int k = 0; k < WISP_COUNT( cases ); ++k )
    {
        thrown t = new_thrown( cases[k].by, true, cases[k].substeps, cases[k].iterations, 1 );
        double before[6], touched[BODIES] = { 0.0 };
        run_for( t.world, 1.0f / 60.0f, 1 );
        motion_of( t.world, t.surface, before );
        for ( int n = 1; n < 40; ++n )
        {
            step_thrown( &t );
            double now[6], sum[6] = { 0.0 };
            motion_of( t.world, t.surface, now );
            for ( int i = 0; i < BODIES; ++i )
            {
                const wisp_reaction r = reaction_of( t.world, t.bodies[i] );
                add_impulse( &r, t.places[i], sum );
                touched[i] += (double)wisp_v3_length( r.impulse );
            }
            for ( int i = 0; i < ( cases[k].near_turn > 0.0 ? 6 : 3 ); ++i )
            {
                assert_near( now[i] - before[i], -sum[i], i < 3 ? 1e-6 : cases[k].near_turn );
            }
            memcpy( before, now, sizeof( before ) );
        }
        assert_true( touched[0] > 1e-3 && touched[1] > 1e-3 && touched[2] > 1e-3 && touched[3] > 1e-3 );
        free_colliding( t.h );
    }
}

// BDF2 has the momentum of two substeps: from the start to rest it is the same. It begins with a substep of Euler, after which its momentum
// is m (3 v - 0) / 2. A cloth falls on a ball that moves and turns with friction, and slides from it to a floor.
TEST( bodies_get_what_a_surface_of_second_order_loses_until_it_rests )
{
    SCOPED( close_local ) hosted* h = new_solved( 2, 1, 1 );
    wisp_collider_def plane = wisp_default_collider_def(), round = body_of( WISP_COLLIDER_SPHERE );
    plane.pose.translation.y = -0.1f;
    round.radius = 0.2f;
    const wisp_entity bodies[2] = { add_collider( h->world, &plane ), add_collider( h->world, &round ) };
    const wisp_entity e = add_square( h->world, 13, 0.6f, ( wisp_vec3 ){ 0.05f, 0.25f, 0.02f }, 0.005f );
    solve( h->world, e, BDF2, WISP_IMPLICIT_WEIGHTS_NONE, 1.0f );
    give_gravity( h->world, e, 9.81f );
    request_reaction( h->world, bodies[0] );
    request_reaction( h->world, bodies[1] );
    double sum[2][6] = { { 0.0 } };
    for ( int n = 1; n <= 300; ++n )
    {
        const float x = n < 100 ? 0.004f * (float)n : 0.4f;
        const wisp_transform pose = { about_z( n < 100 ? 0.02 * n : 2.0 ), { x, 0.0f, 0.0f } };
        assert_status( h->world, wisp_move_collider( h->world, bodies[1], pose ), WISP_OK );
        run_for( h->world, 0.01f, 1 );
        for ( int i = 0; i < 2; ++i )
        {
            const wisp_reaction r = reaction_of( h->world, bodies[i] );
            add_impulse( &r, ( wisp_vec3 ){ 0 }, sum[i] );
        }
    }
    const wisp_motion_stats q = motion_stats_of( h->world, e );
    for ( int j = 0; j < 3; ++j )
    {
        const double given = j == 1 ? -9.81 * q.mass * ( 3.0 + 0.5 * 0.5 * 0.01 ) : 0.0;
        assert_near( q.momentum[j] + sum[0][j] + sum[1][j], given, 2e-3 * q.mass );
    }
    assert_true( -sum[0][1] > 0.1 * q.mass && -sum[1][1] > 0.1 * q.mass );
}

// A patch in the corner of a floor and a wall without friction: each stops its own part of the velocity. A sweep over contacts takes them one
// by one, so its wall stands upright.
TEST( each_body_gets_what_it_stopped )
{
    for ( int by = LOOSE; by < SOLVERS; ++by )
    {
        SCOPED( close_local ) hosted* h = new_solved( by >= EULER ? 1 : 4, 1, 1 );
        wisp_collider_def floor = wisp_default_collider_def();
        floor.static_friction = floor.kinetic_friction = 0.0f;
        wisp_collider_def wall = floor;
        const double tilt = by >= EULER ? 1.0 : 0.5 * acos( -1.0 );
        wall.pose.rotation = about_z( -tilt ); // its normal is ( sin, cos, 0 )
        const wisp_entity bodies[2] = { add_collider( h->world, &floor ), add_collider( h->world, &wall ) };
        const wisp_entity e = add_square( h->world, 2, 0.0001f, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, 0.005f );
        solve( h->world, e, (solver)by, WISP_IMPLICIT_WEIGHTS_NONE, 0.0f );
        request_reaction( h->world, bodies[0] );
        request_reaction( h->world, bodies[1] );
        // the last two thirds of the run it lies in the corner
        assert_status( h->world, wisp_set_gravity( h->world, e, ( wisp_vec3 ){ -1.0f, -4.0f, 0.0f } ), WISP_OK );
        run_for( h->world, 0.01f, 50 );
        double sum[2][6] = { { 0.0 } };
        for ( int n = 0; n < 200; ++n )
        {
            run_for( h->world, 0.01f, n % 2 == 0 );
            const wisp_reaction r = reaction_of( h->world, bodies[n % 2] );
            add_impulse( &r, ( wisp_vec3 ){ 0 }, sum[n % 2] );
        }
        // a (sin, cos) + b (0, 1) = (1, 4), per mass and second
        const double mass = motion_stats_of( h->world, e ).mass, a = 1.0 / sin( tilt ), b = 4.0 - a * cos( tilt );
        assert_near( sum[1][0], -mass, 1e-4 * mass );
        assert_near( sum[1][1], -a * cos( tilt ) * mass, 1e-4 * mass );
        assert_near( sum[0][0], 0.0, 1e-4 * mass );
        assert_near( sum[0][1], -b * mass, 1e-4 * mass );
    }
}

TEST( what_leaves_the_inside_of_a_body_gives_it_the_velocity_that_it_loses )
{
    SCOPED( close_local ) hosted* h = new_solved( 2, 1, 1 );
    const wisp_collider_def floor = wisp_default_collider_def();
    const wisp_entity body = add_collider( h->world, &floor );
    const wisp_entity patch =
        add_square( h->world, 2, 0.1f, ( wisp_vec3 ){ 0.05f, -0.2f, 0.05f }, wisp_default_collision_def().thickness );
    const wisp_vec3 up = { 0.0f, 0.5f, 0.0f };
    assert_status( h->world, wisp_set_velocity( h->world, patch, up, ( wisp_vec3 ){ 0 } ), WISP_OK );
    request_reaction( h->world, body );
    run_for( h->world, 1.0f / 60.0f, 1 );
    const wisp_motion_stats q = motion_stats_of( h->world, patch );
    assert_near( q.momentum[1], 0.0, 1e-5 * q.mass );
    assert_near( (double)reaction_of( h->world, body ).impulse.y, 0.5 * q.mass, 1e-5 * q.mass );
}

// ---- requests ----

static void assert_no_impulse( wisp_world* world, wisp_entity body )
{
    const wisp_reaction r = reaction_of( world, body );
    assert_true( r.impulse.x == 0.0f && r.impulse.y == 0.0f && r.impulse.z == 0.0f );
}

static void check_requests( solver by )
{
    thrown t[3] = { new_thrown( by, false, 4, 1, 1 ), new_thrown( by, true, 4, 1, 1 ),
                    new_thrown( by, true, 4, 1, 3 ) };
    wisp_world* world = t[1].world;
    const wisp_entity* bodies = t[1].bodies;
    for ( int n = 1; n < 30; ++n )
    {
        for ( int i = 0; i < 3; ++i )
        {
            step_thrown( t + i );
        }
        const wisp_view a = view_of( t[0].world, t[0].surface, WISP_SURFACE_POINTS ),
                        b = view_of( world, t[1].surface, WISP_SURFACE_POINTS );
        assert_memory_equal( a.data, b.data, (size_t)a.count * sizeof( wisp_vec3 ) );
        for ( int body = 0; body < BODIES; ++body )
        {
            const wisp_reaction one = reaction_of( world, bodies[body] ),
                                three = reaction_of( t[2].world, t[2].bodies[body] );
            assert_memory_equal( &one, &three, sizeof( one ) );
        }
    }
    wisp_reaction r;
    expect_refusal( t[0].world, wisp_read_reaction( t[0].world, t[0].bodies[0], &r ), WISP_CONFLICT, "reaction" );
    assert_int_equal( wisp_request_reaction( t[0].world, t[0].surface, true ), WISP_CONFLICT );
    // cancelled, and requested again
    assert_status( world, wisp_request_reaction( world, bodies[0], false ), WISP_OK );
    assert_status( world, wisp_read_reaction( world, bodies[0], &r ), WISP_CONFLICT );
    request_reaction( world, bodies[0] );
    // bodies that are removed while their impulse is on the way, one in their place, and a surface that goes
    const wisp_collider_def plane = wisp_default_collider_def();
    assert_status( world, wisp_remove( world, bodies[2] ), WISP_OK );
    const wisp_entity second = add_collider( world, &plane );
    request_reaction( world, second );
    assert_status( world, wisp_remove( world, bodies[3] ), WISP_OK );
    give_gravity( world, t[1].surface, 9.81f );
    run_for( world, 1.0f / 60.0f, 3 );
    assert_true( reaction_of( world, second ).impulse.y < 0.0f );
    assert_status( world, wisp_remove( world, t[1].surface ), WISP_OK );
    run_for( world, 1.0f / 60.0f, 1 );
    assert_no_impulse( world, bodies[0] );
    assert_no_impulse( world, second );
    for ( int i = 0; i < 3; ++i )
    {
        free_colliding( t[i].h );
    }
}

// Calls come in any order: before the solver of the surface, and after.
TEST( a_request_changes_no_bit_of_the_motion_and_workers_none_of_the_reaction )
{
    check_requests( LINKS );
    check_requests( EULER );
}
