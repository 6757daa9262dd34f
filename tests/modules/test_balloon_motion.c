// Rotation, conservation laws and forces of the balloon that statistics and other calls tell: torque, inertia, spin, momentum
// (balloon paper, Eq. 13-17), gas that leaves. Closed forms are in tests/claims. Where a bound is one of doubles, the comment
// gives that of floats.
#include "balloon_engine_fixture.h"

#include "balloon_internal.h"

static double3 vertex_of( const balloon_flight* flight, int vertex )
{
    const float* p =
        balloon_positions( flight ) + 4 * wisp_world_fabric( flight->world, flight->entity )->vertex_slot[vertex];
    return double3_make( (double)p[0], (double)p[1], (double)p[2] );
}

// ---- torque ----

// A body whose particles are almost unconnected: springs of 1e-6 N/m and a millionth of the volume's error. Only the
// jet changes a velocity.
static balloon_scene loose_body( const balloon_mesh* mesh, int outlet )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.bend_links = false;
    scene.substeps = scene.iterations = 1;
    scene.scale = 1.05;
    scene.def.edge_stiffness = 1e-6f;
    scene.def.volume = WISP_SOLVER_PBD;
    scene.def.volume_stiffness = 1e-6f;
    scene.def.gas_ratio = 1.1576f;
    balloon_scene_give_outlet( &scene, outlet, true );
    return scene;
}

// Its jet has the pressure of a stiff skin, about 10 kPa, whose tensions act on no particle.
static balloon_flight start_loose( const balloon_scene* scene )
{
    balloon_flight flight = balloon_start( scene );
    const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
    balloon_skin* skin = wisp_world_column( flight.world, flight.entity, s->skin, 0 );
    skin->edge_stiffness = 1e4f;
    return flight;
}

static balloon_scene loose_pear( const balloon_mesh* mesh )
{
    return loose_body( mesh, balloon_mesh_farthest( mesh, double3_make( 1.0, 0.3, 0.2 ) ) );
}

// The same with an outlet of several vertices: F acts at their mean, which no vertex of the pear has.
TEST( a_jet_of_several_vertices_acts_at_their_centre )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 3 );
    balloon_scene scene = loose_pear( &mesh );
    scene.dt = 1.0f / 600.0f;
    balloon_scene_give_outlet_around( &scene, scene.def.outlet[0], 0.04 );
    const int count = scene.def.outlet_count;
    assert_in_range( count, 6, WISP_BALLOON_MAX_OUTLET );
    SCOPED( balloon_end ) balloon_flight flight = start_loose( &scene );
    double3 centre = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        centre = double3_add_scaled( centre, 1.0 / count, vertex_of( &flight, scene.def.outlet[i] ) );
    }
    balloon_steps( &flight, 1 );
    wisp_balloon_stats f = balloon_read( &flight );
    double3 torque = balloon_oracle_torque( centre, balloon_from( f.centre ), balloon_from( f.jet ) );
    double size = double3_length( torque );
    assert_true( size > 1e-3 );
    balloon_assert_close( double3_distance( balloon_from( f.torque ), torque ) / size, 0.0, 1e-12 );
    for ( int i = 0; i < count; ++i )
    {
        double3 of_one = balloon_oracle_torque( vertex_of( &flight, scene.def.outlet[i] ), balloon_from( f.centre ),
                                                balloon_from( f.jet ) );
        assert_true( double3_distance( of_one, torque ) / size > 0.01 );
    }
    double3 gained = balloon_angular_momentum( &flight ), given = double3_scale( (double)scene.dt, torque );
    // velocities read back from positions: 1.5e-8 m over 1/600 s each
    balloon_assert_close( double3_distance( gained, given ) / double3_length( given ), 0.0, 1e-4 );
}

// Of all edges, since the positions [slot][4] before.
static double largest_strain( const balloon_flight* flight, const float* before )
{
    const wisp_fabric* f = wisp_world_fabric( flight->world, flight->entity );
    const float* after = balloon_positions( flight );
    double largest = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int i = 4 * f->edges[2 * e], j = 4 * f->edges[2 * e + 1];
        const double was = double3_distance( double3_from( before + i ), double3_from( before + j ) );
        const double is = double3_distance( double3_from( after + i ), double3_from( after + j ) );
        largest = fmax( largest, fabs( is / was - 1.0 ) );
    }
    return largest;
}

// Section III.4: a kick and its displacement are both proportional to dt, so lengths change by dt^4
TEST( a_kick_leaves_the_edges_as_long_as_they_are )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    double strain[2];
    for ( int n = 0; n < 2; ++n )
    {
        balloon_scene scene = loose_pear( &mesh );
        scene.dt = n == 0 ? 0.04f : 0.02f;
        scene.def.outlet_area = 5e-5f;
        SCOPED( balloon_end ) balloon_flight flight = start_loose( &scene );
        const size_t bytes = (size_t)( 4 * mesh.vertex_count ) * sizeof( float );
        float* before = memcpy( checked_calloc( 1, bytes ), balloon_positions( &flight ), bytes );
        balloon_steps( &flight, 1 );
        strain[n] = largest_strain( &flight, before );
        free( before );
        const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
        const balloon_body* body = wisp_world_column( flight.world, flight.entity, s->body, 0 );
        double w[3], dt = (double)scene.dt;
        balloon_spin_of( body, balloon_read( &flight ).torque, w );
        // x + dt omega x x stretches by half of (dt omega)^2 at most; omega is dt w
        double most = 0.5 * pow( dt * dt * double3_length( balloon_from( w ) ), 2.0 );
        assert_true( strain[n] <= most + 2e-6 );
        assert_true( strain[n] > 0.5 * most );
    }
    // lengths of floats: 1e-6 of the smaller one, which is 1e-4 at least
    assert_true( strain[1] > 1e-4 );
    balloon_assert_fraction( strain[0] / strain[1], 16.0, 0.05 );
}

// ---- inertia ----

// Eq. 16-17
TEST( the_inertia_is_the_brute_sum_and_that_of_a_shell )
{
    for ( int n = 0; n < 2; ++n )
    {
        balloon_mesh mesh = n == 0 ? balloon_sphere( 4, 0.15 ) : balloon_pear( 4 ); // several blocks of particles
        balloon_scene scene = balloon_scene_of( &mesh );
        scene.place = ( wisp_vec3 ){ 1.0f, -2.0f, 3.0f };
        scene.substeps = 1;
        balloon_flight flight = balloon_start( &scene );
        balloon_oracle b = balloon_oracle_of( &flight, BALLOON_ORDER_PARTED );
        balloon_steps( &flight, 1 );
        const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
        const balloon_body* body = wisp_world_column( flight.world, flight.entity, s->body, 0 );
        double3 c = balloon_oracle_centre( b.x, b.mass, b.vertex_count );
        balloon_oracle_matrix inertia = balloon_oracle_inertia( b.x, b.mass, b.vertex_count, c );
        balloon_assert_fraction( body->mass, b.total_mass, 1e-12 );
        balloon_assert_close( double3_distance( balloon_from( body->centre ), c ), 0.0, 1e-12 );
        for ( int k = 0; k < 3; ++k )
        {
            // I^-1 I e_k = e_k
            const double column[3] = { inertia.m[0][k], inertia.m[1][k], inertia.m[2][k] };
            double back[3];
            balloon_spin_of( body, column, back );
            const double3 unit = { k == 0, k == 1, k == 2 };
            balloon_assert_close( double3_distance( balloon_from( back ), unit ), 0.0, 1e-10 );
            if ( n == 0 )
            {
                balloon_assert_fraction( 1.0 / body->inverse_inertia[k],
                                         balloon_oracle_true_shell_inertia( body->mass, 0.15 ), 0.01 );
            }
        }
        balloon_oracle_destroy( &b );
        balloon_end( &flight );
        balloon_mesh_destroy( &mesh );
    }
}

// "rebuilt every step": a balloon of twice the size is four times as hard to turn
TEST( the_inertia_follows_the_shape )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 2, 0.15 );
    double inverse[2];
    for ( int n = 0; n < 2; ++n )
    {
        balloon_scene scene = balloon_scene_of( &mesh );
        scene.substeps = 1;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        balloon_steps( &flight, 1 );
        float* x = balloon_positions( &flight );
        for ( int i = 0; i < 4 * mesh.vertex_count; ++i )
        {
            x[i] *= i % 4 != 3 && n == 1 ? 2.0f : 1.0f;
        }
        balloon_steps( &flight, 1 );
        const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
        const balloon_body* body = wisp_world_column( flight.world, flight.entity, s->body, 0 );
        inverse[n] = body->inverse_inertia[0];
    }
    balloon_assert_fraction( inverse[0], 4.0 * inverse[1], 1e-5 );
}

// ---- orientation ----

// Eq. 15: a step turns by 2 atan( omega dt / 2 ) = omega dt (1 - (omega dt)^2 / 12)
TEST( an_orientation_stays_of_unit_length_and_its_error_falls_with_dt_squared )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 2, 0.15 );
    for ( int steps = 50; steps <= 200; steps *= 2 )
    {
        balloon_scene scene = balloon_scene_of( &mesh );
        scene.dt = 1.0f / (float)steps;
        scene.substeps = 1;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        const wisp_vec3 still = { 0.0f, 0.0f, 0.0f }, spin = { 0.0f, 0.0f, 2.0f };
        assert_int_equal( wisp_set_velocity( flight.world, flight.entity, still, spin ), WISP_OK );
        const double dt = (double)scene.dt;
        double angle = 0.0, lost = 0.0;
        for ( int n = 0; n < steps; ++n )
        {
            balloon_steps( &flight, 1 );
            const double turn = dt * balloon_read( &flight ).angular_velocity[2];
            angle += turn;
            lost += turn * turn * turn / 12.0;
        }
        const double* q = balloon_read( &flight ).orientation;
        const double norm = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
        const double error = angle - balloon_oracle_angle( ( balloon_oracle_quaternion ){ q[0], q[1], q[2], q[3] } );
        print_message( "           %d steps: %.4f rad, %.1e rad of it lost\n", steps, angle, error );
        assert_true( angle > 1.5 && angle < 2.1 );
        balloon_assert_close( norm, 1.0, 1e-14 );
        balloon_assert_fraction( error, lost, 0.02 );
    }
}

// ---- conservation ----

// Eq. 4, momentum: sum m Dp = 0
TEST( internal_constraints_keep_the_momentum_in_every_step )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    for ( int n = 0; n < 4; ++n )
    {
        balloon_scene scene = balloon_scene_of( &mesh );
        scene.def.solver = n % 2 == 0 ? WISP_SOLVER_XPBD : WISP_SOLVER_PBD;
        scene.def.volume = n / 2 == 0 ? WISP_SOLVER_XPBD : WISP_SOLVER_PBD;
        scene.def.gas_ratio = 1.1f;
        scene.substeps = 1;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        balloon_stir( &flight, 1.0f );
        double worst = 0.0, mass = 0.0;
        for ( int k = 0; k < 50; ++k )
        {
            double3 before = balloon_momentum( &flight );
            balloon_steps( &flight, 1 );
            mass = balloon_motion_stats( &flight ).mass;
            worst = fmax( worst, double3_distance( balloon_momentum( &flight ), before ) / mass );
        }
        // 1e-12 is a bound of doubles. In floats a vertex rounds about 50 times by 1.5e-8 m, over 1/60 s, as a random
        // walk, in the mean of 162: 5e-7 m/s, and the largest of 50 such values
        print_message( "           largest change of mean velocity in a step: %.1e m/s\n", worst );
        balloon_assert_close( worst, 0.0, 3e-6 );
    }
}

// A pin has a place of its own, and moments about the centre of mass are not those of what may move: a body with a pin is left
// alone, as in the oracle. A substep would turn it by 1e-5 m.
TEST( a_pinned_balloon_is_not_turned_back )
{
    static const int32_t pin = 3;
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene scene = balloon_scene_of( &mesh );
    scene.def.gas_ratio = 1.5f;
    scene.def.bend_link_stiffness = scene.def.edge_stiffness;
    scene.gravity = ( wisp_vec3 ){ 1.0f, -9.8f, 0.0f };
    scene.pins = &pin;
    scene.pin_count = 1;
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, BALLOON_ORDER_ENGINE );
    const double3 place = vertex_of( &flight, pin );
    balloon_steps( &flight, 1 );
    balloon_oracle_step( &oracle );
    balloon_assert_close( balloon_distance( &flight, &oracle ), 0.0, 3e-6 ); // ten substeps of floats
    balloon_steps( &flight, 29 );
    balloon_assert_close( double3_distance( vertex_of( &flight, pin ), place ), 0.0, 0.0 );
}

// ---- forces ----

// A pear without bend links, scaled by 1.1, whose stiffness gives the pressure `gauge` (references, section 1).
static balloon_scene pressed_scene( const balloon_mesh* mesh, double gauge )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.bend_links = false;
    scene.scale = 1.1;
    scene.def.gas_ratio = 1.331f;
    scene.dt = 1e-4f;
    scene.substeps = 1;
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, BALLOON_ORDER_ENGINE );
    double sum = 0.0;
    for ( int e = 0; e < oracle.structural_count; ++e )
    {
        sum += oracle.structural[e].rest * oracle.structural[e].rest;
    }
    scene.def.edge_stiffness =
        (float)( gauge / balloon_oracle_true_scaled_pressure( sum, oracle.rest_volume, scene.scale ) );
    return scene;
}

// Sections III.2 and III.3: M dv = -sum mdot v_e n dt, and the lost gas is the gas that flowed out
TEST( what_leaves_the_outlet_is_what_the_body_gains )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene scene = balloon_scene_of( &mesh );
    scene.dt = 1.0f / 600.0f;
    scene.substeps = 1;
    scene.def.gas_ratio = 1.2f;
    balloon_scene_give_outlet( &scene, balloon_mesh_farthest( &mesh, double3_make( 0.4, 1.0, 0.2 ) ), true );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    double3 given = { 0.0, 0.0, 0.0 };
    double blown = 0.0;
    for ( int n = 0; n < 600; ++n )
    {
        balloon_steps( &flight, 1 );
        wisp_balloon_stats f = balloon_read( &flight );
        given = double3_add( given, double3_scale( (double)scene.dt, balloon_from( f.jet ) ) );
        blown += f.mass_flow * (double)scene.dt;
        double missing = ( (double)1.2f * f.rest_volume - f.target_volume ) * 101325.0 * (double)4.0026e-3f /
                         ( BALLOON_ORACLE_GAS_CONSTANT * (double)293.15f );
        // doubles, and differences of V_0 from its start
        balloon_assert_close( f.gas_lost, missing, 1e-13 );
        balloon_assert_close( f.gas_lost, blown, 1e-13 );
    }
    double size = double3_length( given );
    assert_true( size > 1e-3 );
    // each substep rounds positions of up to a metre to 3e-8 m, so a velocity to 2e-5 m/s, and 600 errors add as a
    // random walk
    balloon_assert_close( double3_distance( balloon_momentum( &flight ), given ) / size, 0.0, 1e-3 );
}

// Section III.2: 10 Pa and 50 Pa. The scale of the skin sets its pressure, which is read in the next step.
TEST( the_jet_ends_at_ten_pascal_and_starts_again_only_above_fifty )
{
    const double gauge[] = { 40.0, 50.0, 51.0, 30.0, 11.0, 10.0, 30.0, 50.0, 60.0, 0.0 };
    const bool expected[] = { false, false, true, true, true, false, false, false, true, false };
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 2, 0.15 );
    balloon_scene scene = pressed_scene( &mesh, 1000.0 );
    scene.def.gas_ratio = 2.0f;
    scene.def.outlet_area = 1e-8f;
    balloon_scene_give_outlet( &scene, 3, true );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    const wisp_fabric* fabric = wisp_world_fabric( flight.world, flight.entity );
    double per = 1000.0 / ( 0.1 / 1.21 ); // P = per (s - 1) / s^2
    for ( int n = 0; n < WISP_COUNT( gauge ); ++n )
    {
        // a float's scale gives the pressure to 1e-2 Pa, so test next to the threshold
        double aim = gauge[n] + ( expected[n] ? 0.2 : -0.2 ), e = 0.0;
        for ( int k = 0; k < 20; ++k )
        {
            e = aim / per * ( 1.0 + e ) * ( 1.0 + e );
        }
        float* x = balloon_positions( &flight );
        for ( int slot = 0; slot < fabric->vertex_count; ++slot )
        {
            const float* rest = &fabric->rest[slot].x;
            for ( int k = 0; k < 3; ++k )
            {
                x[4 * slot + k] = (float)( ( 1.0 + e ) * (double)rest[k] );
            }
        }
        memset( balloon_velocities( &flight ), 0, (size_t)fabric->slot_count * 4 * sizeof( float ) );
        balloon_steps( &flight, 1 );
        wisp_balloon_stats f = balloon_read( &flight );
        balloon_assert_close( f.pressure, fmax( 0.0, aim ), 0.1 );
        assert_int_equal( f.outlet_speed > 0.0, expected[n] );
    }
    assert_true( balloon_read( &flight ).jet_starts == 2.0 );
}

// The reported drag is the one that acted: of the velocity before the other forces.
TEST( the_forces_shown_are_the_momentum_gained )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene scene = balloon_scene_in_air( &mesh );
    scene.dt = 1.0f / 240.0f;
    scene.substeps = 1;
    scene.area_density = 0.2f; // heavy, so that it stays near the origin and its velocities are exact enough
    scene.scale = 1.05;
    scene.def.gas_ratio = 1.2f;
    balloon_scene_give_outlet( &scene, 0, true );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_throw( &flight, ( wisp_vec3 ){ 4.0f, 2.0f, -3.0f } );
    for ( int n = 0; n < 10; ++n )
    {
        double3 before = balloon_momentum( &flight );
        balloon_steps( &flight, 1 );
        wisp_balloon_stats f = balloon_read( &flight );
        double3 sum = double3_add( double3_add( balloon_from( f.gravity ), balloon_from( f.buoyancy ) ),
                                   double3_add( balloon_from( f.drag ), balloon_from( f.jet ) ) );
        double3 gained = double3_sub( balloon_momentum( &flight ), before );
        double3 given = double3_scale( (double)scene.dt, sum );
        // about 30 roundings per vertex of 1.5e-8 m over 1/240 s, as a random walk, in the mean of 162 with 0.06 kg
        // in total
        balloon_assert_close( double3_distance( gained, given ), 0.0, 1e-7 );
        assert_true( double3_length( balloon_from( f.drag ) ) > 0.05 && double3_length( given ) > 1e-3 );
    }
}
