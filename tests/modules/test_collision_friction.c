// What two bodies squeeze; bodies with a mass. Coulomb's law is in tests/claims/friction.yaml, that of the capstan in data/suites/validate.
#include "collision_fixture.h"

static const float GRAVITY = 9.8f;
static const float THICKNESS = 0.01f;

static const float DT = 1.0f / 60.0f;

static wisp_reaction reaction_of( wisp_world* world, wisp_entity body )
{
    wisp_reaction r;
    assert_int_equal( wisp_read_reaction( world, body, &r ), WISP_OK );
    return r;
}

// ---- squeezed ----

// The box of body_of().
static const wisp_vec3 BOX_POINTS[8] = { { -0.3f, -0.2f, -0.25f }, { 0.3f, -0.2f, -0.25f }, { -0.3f, 0.2f, -0.25f },
                                         { 0.3f, 0.2f, -0.25f },   { -0.3f, -0.2f, 0.25f }, { 0.3f, -0.2f, 0.25f },
                                         { -0.3f, 0.2f, 0.25f },   { 0.3f, 0.2f, 0.25f } };
static const int32_t BOX_TRIANGLES[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 },
                                              { 0, 1, 4 }, { 1, 5, 4 }, { 2, 6, 3 }, { 3, 6, 7 },
                                              { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };

// Vertices without links between two bodies that stand `gap` apart. @return m/s, how fast they fall after half a second of gravity
static float squeeze( wisp_collider_kind kind, float gap, float mu, int substeps, double* pressed, double* carried )
{
    SCOPED( close_local ) hosted* h = new_colliding( substeps, 1, 1 );
    test_mesh mesh = test_plane( 9, 0.01f );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        // not in the middle
        mesh.points[v] = ( wisp_vec3 ){ mesh.points[v].x - 0.04f, mesh.points[v].z - 0.04f, 0.2f * gap };
    }
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    const wisp_entity e = add_colliding( h->world, &mesh, &collision );
    wisp_entity bodies[2];
    for ( int i = 0; i < 2; ++i )
    {
        wisp_collider_def def = body_of( kind );
        def.points = BOX_POINTS, def.point_count = 8;
        def.triangles = &BOX_TRIANGLES[0][0], def.triangle_count = 12;
        const float side = i == 0 ? 1.0f : -1.0f;
        def.pose.translation.z = side * ( 0.5f * gap + 0.25f );
        def.static_friction = def.kinetic_friction = mu;
        bodies[i] = add_collider( h->world, &def );
        assert_int_equal( wisp_request_reaction( h->world, bodies[i], true ), WISP_OK );
    }
    test_mesh_free( &mesh );
    give_gravity( h->world, e, GRAVITY );
    run_for( h->world, DT, 30 );
    const wisp_motion_stats q = motion_stats_of( h->world, e );
    *carried = 0.0;
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_reaction r = reaction_of( h->world, bodies[i] );
        pressed[i] = (double)r.impulse.z / ( (double)DT * q.mass );
        *carried -= (double)r.impulse.y / ( (double)DT * q.mass );
    }
    const float speed = -(float)( q.momentum[1] / q.mass );
    // one digit of a position of 1e-3 m in a substep of 1/300 s
    assert_true( fabs( q.momentum[2] ) < 5e-5 * q.mass );
    return speed;
}

TEST( what_two_bodies_squeeze_is_pressed_in_proportion_to_its_depth_and_held_by_friction )
{
    const wisp_collider_kind kinds[] = { WISP_COLLIDER_BOX, WISP_COLLIDER_MESH, WISP_COLLIDER_CONVEX };
    const float gaps[] = { 0.018f, 0.01f, 0.002f };
    for ( int k = 0; k < 3 * WISP_COUNT( kinds ); ++k )
    {
        // 5000 weights at the depth of the thickness
        const double load = 5000.0 * 9.81 * ( 1.0 - 0.5 * (double)gaps[k % 3] / (double)THICKNESS );
        double pressed[2], carried;
        for ( int side = 0; side < 2; ++side )
        {
            // the limit is 2 mu F = m g
            const double mu = ( side == 0 ? 1.05 : 0.95 ) * (double)GRAVITY / ( 2.0 * load );
            const float speed = squeeze( kinds[k / 3], gaps[k % 3], (float)mu, 1 + 4 * side, pressed, &carried );
            assert_near( pressed[0], load, 0.01 * load );
            assert_near( pressed[1], -load, 0.01 * load );
            assert_near( carried, side == 0 ? (double)GRAVITY : 0.95 * (double)GRAVITY, 0.02 * (double)GRAVITY );
            assert_near( speed, side == 0 ? 0.0 : 0.05 * (double)GRAVITY * 0.5, side == 0 ? 1e-5 : 0.06 );
        }
    }
    double pressed[2], carried;
    squeeze( WISP_COLLIDER_BOX, 0.0201f, 0.5f, 4, pressed, &carried );
    assert_true( pressed[0] == 0.0 && pressed[1] == 0.0 && carried == 0.0 );
}

// ---- bodies with a mass ----

// A ball falls on a trampoline, as docs/embedding.md has it. Each top is no higher than the first height; of a ball heavier than
// what it meets none is higher than the one before.
static void bounce_on_trampoline( float mass, int rate, int bounces )
{
    const float height = 0.5f, radius = 0.12f, dt = 1.0f / (float)rate;
    SCOPED( close_local ) hosted* h = new_colliding( 20, 1, 1 );
    const wisp_entity sheet = add_cloth( h->world, 21, 1.6f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, GRAVITY );
    for ( int32_t v = 0; v < 21 * 21; ++v )
    {
        const bool is_rim = v % 21 == 0 || v % 21 == 20 || v / 21 == 0 || v / 21 == 20;
        assert_true( is_rim == false || wisp_pin( h->world, sheet, &v, 1 ) == WISP_OK );
    }
    wisp_collider_def def = body_of( WISP_COLLIDER_SPHERE );
    def.radius = radius;
    def.mass = mass;
    def.pose.translation = ( wisp_vec3 ){ 0.0f, radius + height, 0.0f };
    const wisp_entity ball = add_collider( h->world, &def );
    wisp_transform pose = def.pose;
    float speed = 0.0f, was, top = height + radius;
    for ( int n = 0; bounces > 0 && n < 40 * rate; ++n )
    {
        was = speed;
        speed -= GRAVITY * dt;
        pose.translation.y += speed * dt;
        assert_int_equal( wisp_move_collider( h->world, ball, pose ), WISP_OK );
        run_for( h->world, dt, 1 );
        const wisp_reaction r = reaction_of( h->world, ball );
        speed += r.impulse.y / mass;
        pose = r.pose;
        if ( was > 0.0f && speed <= 0.0f )
        {
            // gravity of half a step, and what the sheet has of its own motion, 2 mm
            assert_true( pose.translation.y < top + GRAVITY * dt * dt + 2e-3f );
            top = mass > 1.0f ? pose.translation.y : top;
            bounces -= 1;
        }
    }
    assert_int_equal( bounces, 0 );
}

TEST( a_body_with_a_mass_gains_nothing_from_a_trampoline )
{
    const int rates[] = { 60, 120, 240 };
    for ( int k = 0; k < WISP_COUNT( rates ); ++k )
    {
        bounce_on_trampoline( 5.0f, rates[k], 20 );
        bounce_on_trampoline( 0.5f, rates[k], 10 );
        bounce_on_trampoline( 0.05f, rates[k], 3 );
    }
}

// A cloth and a body meet without gravity. Together they keep their momentum, and have no more energy than before.
static uint64_t meet_freely( wisp_collider_kind kind, float mass, wisp_collision_features features, float restitution,
                             int substeps, int workers )
{
    SCOPED( close_local ) hosted* h = new_colliding( substeps, 1, workers );
    const wisp_entity e = add_cloth( h->world, 17, 0.8f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, 0.0f );
    SET( h->world, e, collision, d.features = features );
    wisp_collider_def def = body_of( kind );
    const float inertia = 0.04f * mass;
    def.mass = mass;
    def.restitution = restitution;
    def.inertia = ( wisp_vec3 ){ inertia, inertia, inertia };
    def.pose.translation = ( wisp_vec3 ){ 0.05f, 0.4f, 0.02f };
    const wisp_entity body = add_collider( h->world, &def );
    wisp_transform pose = def.pose;
    double v[3] = { 0.3, -2.0, 0.0 };
    wisp_vec3 spin = { 0.0f, 0.0f, 0.0f };
    for ( int n = 0; n < 60; ++n )
    {
        for ( int k = 0; k < 3; ++k )
        {
            ( &pose.translation.x )[k] += (float)( v[k] / 60.0 );
        }
        const wisp_quat q = pose.rotation;
        const float half = 0.5f / 60.0f;
        const wisp_quat turned = { q.x + half * ( spin.x * q.w + spin.y * q.z - spin.z * q.y ),
                                   q.y + half * ( spin.y * q.w + spin.z * q.x - spin.x * q.z ),
                                   q.z + half * ( spin.z * q.w + spin.x * q.y - spin.y * q.x ),
                                   q.w - half * ( spin.x * q.x + spin.y * q.y + spin.z * q.z ) };
        assert_int_equal( wisp_move_collider( h->world, body, ( wisp_transform ){ turned, pose.translation } ),
                          WISP_OK );
        run_for( h->world, DT, 1 );
        const wisp_reaction r = reaction_of( h->world, body );
        pose = r.pose;
        for ( int k = 0; k < 3; ++k )
        {
            v[k] += (double)( &r.impulse.x )[k] / (double)mass;
            ( &spin.x )[k] += ( &r.torque_impulse.x )[k] / inertia;
        }
        const wisp_motion_stats m = motion_stats_of( h->world, e );
        const double mine = (double)mass, squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        const double turns = (double)( spin.x * spin.x + spin.y * spin.y + spin.z * spin.z ) * (double)inertia;
        assert_near( m.momentum[0] + mine * v[0], mine * 0.3, 1e-5 );
        assert_near( m.momentum[1] + mine * v[1], mine * -2.0, 1e-5 );
        assert_true( m.kinetic_energy + 0.5 * ( mine * squared + turns ) < 1.001 * 0.5 * mine * 4.09 );
    }
    assert_true( v[1] > -1.99 );
    return wisp_world_hash( h->world );
}

TEST( a_free_body_and_a_cloth_keep_their_momentum_and_gain_no_energy )
{
    const wisp_collider_kind kinds[] = { WISP_COLLIDER_SPHERE, WISP_COLLIDER_BOX };
    const float masses[] = { 0.01f, 0.1f, 5.0f };
    for ( int k = 0; k < 6; ++k )
    {
        meet_freely( kinds[k / 3], masses[k % 3], WISP_COLLISION_VERTICES, 0.0f, 2, 1 );
        meet_freely( kinds[k / 3], masses[k % 3], WISP_COLLISION_VERTICES, 0.5f, 5, 1 );
        const uint64_t one = meet_freely( kinds[k / 3], masses[k % 3], WISP_COLLISION_ALL, 0.0f, 4, 1 ),
                       three = meet_freely( kinds[k / 3], masses[k % 3], WISP_COLLISION_ALL, 0.0f, 4, 3 );
        assert_true( one == three );
    }
}

TEST( a_body_with_a_mass_lies_on_cloth_on_a_floor )
{
    const float masses[] = { 0.02f, 0.5f };
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_local ) hosted* h = new_colliding( 4, 1, 1 );
        const wisp_collider_def floor = wisp_default_collider_def();
        add_collider( h->world, &floor );
        add_cloth( h->world, 17, 0.4f, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f }, GRAVITY );
        wisp_collider_def def = body_of( WISP_COLLIDER_BOX );
        def.half_extent = ( wisp_vec3 ){ 0.1f, 0.05f, 0.1f };
        def.mass = masses[k];
        def.pose.translation = ( wisp_vec3 ){ 0.0f, 0.2f, 0.0f };
        const wisp_entity body = add_collider( h->world, &def );
        wisp_transform pose = def.pose;
        float speed = 0.0f, rest = 0.0f;
        for ( int n = 0; n < 180; ++n )
        {
            speed -= GRAVITY * DT;
            pose.translation.y += speed * DT;
            assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
            run_for( h->world, DT, 1 );
            const wisp_reaction r = reaction_of( h->world, body );
            speed += r.impulse.y / masses[k];
            pose = r.pose;
            // it never falls through the thickness, and lies still from the first second on: its speed is that of the fall of a step
            assert_true( pose.translation.y > 0.05f && speed < 0.5f );
            assert_true( n < 60 || fabsf( pose.translation.y - rest ) < 1e-5f );
            rest = pose.translation.y;
        }
    }
}
