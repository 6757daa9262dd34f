// What slows and drives cloth. Air on triangles: drag along the relative wind, lift across it. Damping of the difference
// from a rigid motion (Mueller et al. 2007, section 3.5). Gusts: velocities that triangles facing them pass to their
// vertices, against the oracle's wind key of the boundary particle paper's program, and in the language of scenes.
#include "boundary_fixture.h"
#include "boundary_oracle_fixture.h"
#include "cloth_fixture.h"

// ---- air ----

static const float DENSITY = 1.225f; // kg/m^3, at 15 degrees

// A triangle of 0.08 m^2 in the plane y = 0, its normal up; every vertex weighs 10 g.
static wisp_entity add_triangle( wisp_world* world, wisp_vec3 wind, float drag, float lift )
{
    SCOPED( test_mesh_free )
    test_mesh mesh = triangle_mesh( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.4f },
                                    ( wisp_vec3 ){ 0.4f, 0.0f, 0.0f } );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = 0.01f;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.air_density = DENSITY;
    cloth.wind = wind;
    cloth.drag_coefficient = drag;
    cloth.lift_coefficient = lift;
    return add_cloth( world, &fabric, surface, &cloth, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
}

// The force of a wind of 3 m/s at an angle to the plane, from the momentum of one short step, N.
static wisp_vec3 force_at( wisp_world* world, double degrees, float drag, float lift )
{
    const double angle = degrees * 3.14159265358979 / 180.0;
    const float dt = 1e-3f;
    wisp_entity e = add_triangle(
        world, ( wisp_vec3 ){ (float)( 3.0 * cos( angle ) ), (float)( 3.0 * sin( angle ) ), 0.0f }, drag, lift );
    run_steps( world, 1, dt );
    wisp_motion_stats q = motion_stats_of( world, e );
    assert_status( world, wisp_remove( world, e ), WISP_OK );
    return ( wisp_vec3 ){ (float)( q.momentum[0] / (double)dt ), (float)( q.momentum[1] / (double)dt ),
                          (float)( q.momentum[2] / (double)dt ) };
}

// 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') u / |u| ) ) with |u . n| = |u| sin a.
WORLD_TEST( force_on_a_triangle_is_that_of_the_formula )
{
    const double degrees[] = { 0.0, 30.0, 90.0, -30.0 };
    for ( int i = 0; i < WISP_COUNT( degrees ); ++i )
    {
        const double angle = degrees[i] * 3.14159265358979 / 180.0, s = sin( angle ), c = cos( angle );
        const double scale = 0.5 * (double)DENSITY * 0.08 * 9.0 * fabs( s );
        const wisp_vec3 drag = force_at( h->world, degrees[i], 1.28f, 0.0f );
        const wisp_vec3 lift = force_at( h->world, degrees[i], 0.0f, 0.9f );
        // the implicit step lowers the force by dt w k / 3 with k = 0.5 rho A |u| C = 0.18 N s/m: 0.6 %; at 10 g a
        // position of 0.4 m is rounded to 3e-8 m, so a force to 3 x 0.01 kg x 3e-8 m / 1e-6 s^2 = 9e-4 N at worst
        assert_near( (double)drag.x, 1.28 * scale * c, 0.008 * scale + 9e-4 );
        assert_near( (double)drag.y, 1.28 * scale * s, 0.008 * scale + 9e-4 );
        // across the wind: n' - (u . n') u with n' = +-y on the leeward side
        double side = s < 0.0 ? -1.0 : 1.0;
        assert_near( (double)lift.x, 0.9 * scale * side * -s * c, 0.008 * scale + 9e-4 );
        assert_near( (double)lift.y, 0.9 * scale * side * c * c, 0.008 * scale + 9e-4 );
        assert_near( (double)lift.x * c + (double)lift.y * s, 0.0, 9e-4 );
        assert_near( (double)lift.z, 0.0, 1e-6 );
    }
}

// A plate of 0.15 kg/m^2 with a coefficient of 1.28: v_t = sqrt( 2 m g / (rho C A) ), v = v_t tanh( g t / v_t ).
TEST( a_plate_falls_broadside_at_its_terminal_velocity )
{
    const double terminal = sqrt( 2.0 * 0.15 * 9.81 / ( (double)DENSITY * 1.28 ) );
    double error[2];
    for ( int i = 0; i < 2; ++i )
    {
        SCOPED( close_world ) hosted h;
        open_world( &h, 4 << i, 1 );
        SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.1f );
        wisp_fabric_def fabric = test_fabric_def( &mesh );
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.drag_coefficient = 1.28f;
        cloth.air_density = DENSITY;
        wisp_entity e = add_cloth( h.world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
        run_steps( h.world, 6, 1.0f / 60.0f );
        // the symplectic step is up to g dt early
        assert_near( motion_stats_of( h.world, e ).speed_max, terminal * tanh( 9.81 * 0.1 / terminal ),
                     9.81 / 240.0 );
        run_steps( h.world, 174, 1.0f / 60.0f );
        wisp_motion_stats q = motion_stats_of( h.world, e );
        error[i] = -q.momentum[1] / q.mass - terminal;
    }
    print_message( "           %.5f m/s, error %+.5f and %+.5f with half the step\n", terminal, error[0], error[1] );
    assert_near( terminal, 1.37, 0.001 );
    // air is applied to the velocity before gravity: g dt / 2 too fast, and first order
    assert_near( error[0], 9.81 / 480.0, 0.1 * 9.81 / 480.0 );
    assert_near( error[1] / error[0], 0.5, 0.05 );
}

WORLD_TEST( air_moves_a_feather_to_the_winds_speed_and_never_beyond )
{
    const wisp_vec3 wind = { 0.0f, 20.0f, 0.0f };
    wisp_entity e = add_triangle( h->world, wind, 1000.0f, 0.0f );
    for ( int i = 0; i < 50; ++i )
    {
        run_steps( h->world, 1, 0.2f );
        // far from the origin a velocity is a rounded difference
        assert_true( motion_stats_of( h->world, e ).speed_max <= 20.0 + 1e-3 );
    }
    assert_near( motion_stats_of( h->world, e ).momentum[1] / 0.03, 20.0, 0.05 );
}

// Lift does no work in the frame of the wind, so nothing becomes faster than its weight makes it, however light it is.
WORLD_TEST( lift_adds_no_energy_to_what_is_light )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.05f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 1e-4f;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.lift_coefficient = 0.5f;
    cloth.air_density = DENSITY;
    const wisp_entity e = add_cloth( h->world, &fabric, surface, &cloth, ( wisp_vec3 ){ 3.0f, -9.81f, 0.0f } );
    for ( int i = 0; i < 60; ++i )
    {
        run_steps( h->world, 1, 1.0f / 60.0f );
        const double fallen = 10.26 * ( i + 1 ) / 60.0;
        assert_true( motion_stats_of( h->world, e ).kinetic_energy <
                     1.05 * 0.5 * motion_stats_of( h->world, e ).mass * fallen * fallen );
    }
}

WORLD_TEST( wind_that_only_slides_along_does_nothing )
{
    wisp_entity e = add_triangle( h->world, ( wisp_vec3 ){ 5.0f, 0.0f, -3.0f }, 1.0f, 1.0f );
    run_steps( h->world, 10, 0.01f );
    assert_true( motion_stats_of( h->world, e ).speed_max == 0.0 );
}

WORLD_TEST( wind_can_change_every_step )
{
    wisp_entity e = add_triangle( h->world, ( wisp_vec3 ){ 0 }, 1.0f, 0.0f );
    run_steps( h->world, 1, 0.01f );
    assert_true( motion_stats_of( h->world, e ).speed_max == 0.0 );
    uint64_t plans = wisp_world_counter( h->world, WISP_COUNT_PLANS );
    for ( int i = 1; i <= 5; ++i )
    {
        assert_status( h->world, wisp_set_cloth_wind( h->world, e, ( wisp_vec3 ){ 0.0f, (float)i, 0.0f } ), WISP_OK );
        run_steps( h->world, 1, 0.01f );
    }
    assert_true( motion_stats_of( h->world, e ).momentum[1] > 0.0 );
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_PLANS ), plans );
}

WORLD_TEST( a_cloth_without_coefficients_has_no_air )
{
    add_triangle( h->world, ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f }, 0.0f, 0.0f );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.air" ), 0 );
}

// Wind on cloth without drag blows as on cloth with a drag coefficient of 1, bit for bit; what is no cloth has none.
WORLD_TEST( the_first_wind_gives_a_drag_coefficient_of_one )
{
    const wisp_vec3 wind = { 0.0f, 5.0f, 1.0f };
    const wisp_entity e = add_triangle( h->world, ( wisp_vec3 ){ 0 }, 0.0f, 0.0f );
    const wisp_entity given = add_triangle( h->world, ( wisp_vec3 ){ 0 }, 0.0f, 0.0f );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.wind = wind, cloth.drag_coefficient = 1.0f;
    assert_status( h->world, wisp_set_cloth( h->world, given, &cloth ), WISP_OK );
    assert_status( h->world, wisp_set_cloth_wind( h->world, e, wind ), WISP_OK );
    run_steps( h->world, 5, 0.01f );
    const wisp_motion_stats blown = motion_stats_of( h->world, e ), told = motion_stats_of( h->world, given );
    assert_memory_equal( &blown, &told, sizeof( blown ) );
    assert_true( blown.momentum[1] > 0.0 );
    wisp_entity bare;
    assert_status( h->world, wisp_add_instance( h->world, e, NULL, &bare ), WISP_OK );
    expect_refusal( h->world, wisp_set_cloth_wind( h->world, bare, wind ), WISP_CONFLICT, "is no cloth" );
}

// Air on a rotated mesh gives the rotated force: the same plate broadside along z.
WORLD_TEST( drag_knows_no_axis )
{
    double speed[2];
    for ( int i = 0; i < 2; ++i )
    {
        SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.1f );
        for ( int v = 0; v < mesh.vertex_count && i == 1; ++v )
        {
            mesh.points[v] = ( wisp_vec3 ){ mesh.points[v].x, mesh.points[v].z, 0.0f };
        }
        wisp_fabric_def fabric = test_fabric_def( &mesh );
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.drag_coefficient = 1.0f;
        cloth.lift_coefficient = 0.5f;
        cloth.wind = i == 0 ? ( wisp_vec3 ){ 0.0f, 4.0f, 0.0f } : ( wisp_vec3 ){ 0.0f, 0.0f, 4.0f };
        wisp_entity e = add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, ( wisp_vec3 ){ 0 } );
        run_steps( h->world, 10, 0.01f );
        wisp_motion_stats q = motion_stats_of( h->world, e );
        speed[i] = ( i == 0 ? q.momentum[1] : q.momentum[2] ) / q.mass;
    }
    // positions of 0.3 m in 0.01 s
    assert_near( speed[0] / speed[1], 1.0, 1e-4 );
    assert_true( speed[0] > 0.5 );
}

// ---- damping ----

static const float DT = 1.0f / 480.0f;

static wisp_entity add_damped( wisp_world* world, const test_mesh* mesh, float rate, const int32_t* pins,
                               int pin_count )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = pin_count;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.internal_damping = rate;
    return add_cloth( world, &fabric, surface, &cloth, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
}

// All links as soft as possible: only damping acts on the velocities.
static void unlink_all( wisp_world* world, wisp_entity e, float rate )
{
    SET( world, e, cloth, d.warp_compliance = d.weft_compliance = 1e12f, d.bending = WISP_CLOTH_BENDING_NONE,
         d.internal_damping = rate );
}

static void shake( wisp_world* world, wisp_entity e, int vertex_count, float speed )
{
    for ( int v = 0; v < vertex_count; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            velocity_of( world, e, v )[k] += test_random_float( v, k, -speed, speed );
        }
    }
}

// Energy of a motion without the rigid part, J.
static double energy_of_shaking( wisp_motion_stats q, double rigid )
{
    return q.kinetic_energy - rigid;
}

WORLD_TEST( shaking_dies_at_the_given_rate_and_momentum_stays )
{
    const float rate = 5.0f;
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.1f );
    wisp_entity e = add_damped( h->world, &mesh, rate, NULL, 0 );
    unlink_all( h->world, e, rate );
    assert_status( h->world,
                   wisp_set_velocity( h->world, e, ( wisp_vec3 ){ 0.5f, 0.25f, -0.5f }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    shake( h->world, e, mesh.vertex_count, 0.1f );
    run_steps( h->world, 1, DT );
    wisp_motion_stats first = motion_stats_of( h->world, e );
    const int steps = 96;
    run_steps( h->world, steps, DT );
    wisp_motion_stats last = motion_stats_of( h->world, e );
    for ( int k = 0; k < 3; ++k )
    {
        // velocities are differences of positions near 1 m, rounded to 6e-8 m, over 1/480 s: 3e-5 m/s per step and
        // vertex, averaged over 81 vertices and 96 steps
        assert_near( last.momentum[k] / last.mass, first.momentum[k] / first.mass, 1e-4 );
    }
    // the remainder of the shaking: v <- v / (1 + rate dt) in every step. A little of it turned the body, which stays
    double moving = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        moving += 0.5 * first.momentum[k] * first.momentum[k] / first.mass;
    }
    double kept = energy_of_shaking( last, moving ) / energy_of_shaking( first, moving );
    double expected = pow( 1.0 + (double)rate * (double)DT, -2.0 * steps );
    print_message( "           %.4f of the energy of shaking is left, 1 / (1 + rate dt)^2n is %.4f\n", kept,
                   expected );
    assert_near( kept, expected, 0.05 );
}

// A sheet of 0.8 m, whose sums run over one block, over two, or over the maximum number.
static const int SIDES[] = { 9, 45, 300 };

static test_mesh sheet_of( int side )
{
    return test_plane( side, 0.8f / (float)( side - 1 ) );
}

// The angular momentum of each step is computed before and after damping by a step without damping: the change is the
// same.
static void check_turning( hosted* h, int side )
{
    SCOPED( test_mesh_free ) test_mesh mesh = sheet_of( side );
    wisp_entity damped = add_damped( h->world, &mesh, 50.0f, NULL, 0 ),
                free = add_damped( h->world, &mesh, 0.0f, NULL, 0 );
    unlink_all( h->world, damped, 50.0f );
    unlink_all( h->world, free, 0.0f );
    const wisp_entity both[2] = { damped, free };
    wisp_motion_stats q[2];
    for ( int i = 0; i < 2; ++i )
    {
        assert_status( h->world,
                       wisp_set_velocity( h->world, both[i], ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f },
                                          ( wisp_vec3 ){ 0.5f, 2.0f, -1.0f } ),
                       WISP_OK );
        shake( h->world, both[i], mesh.vertex_count, 0.2f );
    }
    run_steps( h->world, 1, DT );
    for ( int i = 0; i < 2; ++i )
    {
        q[i] = motion_stats_of( h->world, both[i] );
    }
    for ( int k = 0; k < 3; ++k )
    {
        // velocities are stored as floats: 81 masses of 1.5e-3 kg at 0.5 m, each rounded to 1e-7 m/s
        assert_near( q[0].angular_momentum[k], q[1].angular_momentum[k], 1e-8 );
        assert_near( q[0].momentum[k], q[1].momentum[k], 2e-8 );
    }
    assert_true( q[0].kinetic_energy < q[1].kinetic_energy );
}

WORLD_TEST( damping_takes_no_turning )
{
    for ( int i = 0; i < WISP_COUNT( SIDES ); ++i )
    {
        check_turning( h, SIDES[i] );
    }
}

// Ten turns a second, with damping so strong that only the rigid motion remains after a step.
static void check_rigid_turn( hosted* h, int side )
{
    SCOPED( test_mesh_free ) test_mesh mesh = sheet_of( side );
    wisp_entity e = add_damped( h->world, &mesh, 1e6f, NULL, 0 );
    unlink_all( h->world, e, 1e6f );
    assert_status(
        h->world,
        wisp_set_velocity( h->world, e, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, ( wisp_vec3 ){ 0.0f, 10.0f, 0.0f } ),
        WISP_OK );
    run_steps( h->world, 1, 1e-4f );
    wisp_motion_stats first = motion_stats_of( h->world, e );
    run_steps( h->world, 1, 1e-4f );
    wisp_motion_stats second = motion_stats_of( h->world, e );
    // positions turn along a chord in a step: their moment of inertia grows by (w dt)^2 = 1e-6
    assert_near( second.angular_momentum[1] / first.angular_momentum[1], 1.0, 1e-4 );
    assert_near( second.kinetic_energy / first.kinetic_energy, 1.0, 1e-4 );
}

WORLD_TEST( a_rigid_turn_lives_through_any_damping )
{
    for ( int i = 0; i < WISP_COUNT( SIDES ); ++i )
    {
        check_rigid_turn( h, SIDES[i] );
    }
}

// Half a metre along a direction, of this width; it turns about an axis.
static void check_line( hosted* h, wisp_vec3 along, wisp_vec3 foreign, float width, wisp_vec3 turning,
                        double tolerance )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_vec3 line[25];
    for ( int v = 0; v < 25; ++v )
    {
        const float x = 0.02f * (float)v, y = 0.25f * width * (float)( v % 5 );
        line[v] =
            ( wisp_vec3 ){ x * along.x + y * foreign.x, x * along.y + y * foreign.y, x * along.z + y * foreign.z };
    }
    wisp_surface_def surface = support_weightless_surface_def();
    surface.points = line;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_entity e = add_cloth( h->world, &fabric, surface, &cloth, ( wisp_vec3 ){ 0 } );
    unlink_all( h->world, e, 1e6f );
    assert_status( h->world, wisp_set_velocity( h->world, e, ( wisp_vec3 ){ 0 }, turning ), WISP_OK );
    run_steps( h->world, 1, 1e-4f );
    wisp_motion_stats first = motion_stats_of( h->world, e );
    run_steps( h->world, 10, 1e-4f );
    wisp_motion_stats last = motion_stats_of( h->world, e );
    const double w[3] = { (double)turning.x, (double)turning.y, (double)turning.z };
    double before = 0.0, after = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        before += w[k] * first.angular_momentum[k];
        after += w[k] * last.angular_momentum[k];
    }
    assert_true( before > 0.0 );
    assert_near( after / before, 1.0, tolerance );
    assert_true( last.kinetic_energy <= first.kinetic_energy * ( 1.0 + tolerance ) );
}

// A body with all mass on a line has no moment of inertia about it, and still turns about the others.
WORLD_TEST( a_body_that_is_a_line_keeps_turning )
{
    const wisp_vec3 x = { 1.0f, 0.0f, 0.0f }, y = { 0.0f, 1.0f, 0.0f }, slanted = { 0.6f, 0.48f, 0.64f },
                    aside = { -0.8f, 0.36f, 0.48f };
    // positions of 0.5 m are rounded to 3e-8 m of 5e-5 m per step at the ends
    check_line( h, x, y, 0.0f, y, 2e-3 );
    check_line( h, slanted, aside, 0.0f, aside, 2e-3 );
    check_line( h, slanted, aside, 1e-7f, aside, 2e-3 );
    // its moment about its own axis is lost in the rounding of the sums
    const wisp_vec3 both = { slanted.x + aside.x, slanted.y + aside.y, slanted.z + aside.z };
    for ( float width = 1e-3f; width > 1e-8f; width *= 0.5f )
    {
        check_line( h, slanted, aside, width, both, 2e-3 );
    }
}

// A ribbon a hundred times as long as it is wide still turns about itself.
WORLD_TEST( a_ribbon_keeps_its_spin )
{
    const wisp_vec3 slanted = { 0.6f, 0.48f, 0.64f }, aside = { -0.8f, 0.36f, 0.48f };
    check_line( h, slanted, aside, 5e-3f, slanted, 0.05 );
}

WORLD_TEST( a_pinned_cloth_comes_to_rest_and_a_loose_vertex_is_no_pin )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.1f );
    const int32_t pin = 0;
    wisp_entity pinned = add_damped( h->world, &mesh, 100.0f, &pin, 1 );
    // the same mesh with an unreferenced vertex: it has no mass, so it is pinned
    mesh.points = realloc( mesh.points, 26 * sizeof( wisp_vec3 ) );
    assert_non_null( mesh.points );
    mesh.points[mesh.vertex_count++] = ( wisp_vec3 ){ 5.0f, 5.0f, 5.0f };
    int before = h->log.count;
    wisp_entity loose = add_damped( h->world, &mesh, 100.0f, NULL, 0 );
    assert_int_equal( h->log.count, before + 1 );
    assert_int_equal( h->log.level, WISP_LOG_WARNING );
    assert_one_message( h->log.last );
    const wisp_entity both[2] = { pinned, loose };
    for ( int i = 0; i < 2; ++i )
    {
        assert_status( h->world,
                       wisp_set_velocity( h->world, both[i], ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                       WISP_OK );
    }
    run_steps( h->world, 100, 0.01f );
    wisp_motion_stats q = motion_stats_of( h->world, loose );
    assert_near( q.momentum[1] / q.mass, 1.0, 1e-4 );
    assert_true( motion_stats_of( h->world, pinned ).speed_max < 1e-3 );
    const wisp_vec3 at = point_of( h->world, loose, 25 );
    assert_true( at.x == 5.0f && at.y == 5.0f && at.z == 5.0f );
}

WORLD_TEST( damping_of_zero_has_no_pass )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 3, 0.1f );
    wisp_entity e = add_damped( h->world, &mesh, 1.0f, NULL, 0 );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.damping" ), 1 );
    wisp_cloth_def cloth = undamped_cloth();
    assert_status( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.damping" ), 0 );
}

// ---- gusts ----

static const wisp_vec3 GUST = { 0.5f, 0.25f, 0.5f }; // m/s, of that program

static const float* column_of( ball_world* b, wisp_component component )
{
    return wisp_world_column( b->world, b->ball, component, 0 );
}

// A ball that has fallen for a while, so that positions and velocities are of no special kind.
static ball_world* fallen_ball( void )
{
    ball_world* b = ball_open( 3, 1, NULL );
    ball_steps( b, 7 );
    return b;
}

TEST( a_gust_is_that_of_the_oracle )
{
    for ( int per_triangle = 0; per_triangle < 2; ++per_triangle )
    {
        SCOPED( ball_close ) ball_world* b = fallen_ball();
        const wisp_fabric* f = wisp_world_fabric( b->world, b->ball );
        const float *x = column_of( b, WISP_PARTICLE_POSITION ), *v = column_of( b, WISP_PARTICLE_VELOCITY );
        const size_t count = (size_t)f->vertex_count;
        double3 *points = checked_calloc( count, sizeof( double3 ) ),
                *expected = checked_calloc( count, sizeof( double3 ) );
        double* w = checked_calloc( count, sizeof( double ) );
        int *hits = checked_calloc( count, sizeof( int ) ), missed = 0, pinned = 0, most = 0;
        for ( int i = 0; i < f->vertex_count; ++i )
        {
            const size_t slot = 4 * (size_t)f->vertex_slot[i];
            points[i] = double3_from( x + slot );
            expected[i] = double3_from( v + slot );
            w[i] = (double)x[slot + 3];
        }
        SCOPED( balloon_mesh_destroy )
        balloon_mesh mesh = mesh_of( points, f->vertex_count, b->mesh.triangles, b->mesh.triangle_count );
        const int sum = boundary_oracle_gust( &mesh, w, double3_widen( GUST ), per_triangle == 1, expected, hits );
        assert_int_equal( wisp_apply_gust( b->world, b->ball, GUST, per_triangle == 1 ), WISP_OK );
        for ( int i = 0; i < f->vertex_count; ++i )
        {
            const double3 found = double3_from( v + 4 * (size_t)f->vertex_slot[i] );
            // a product and a sum in floats
            const double rounding = 0x1p-23 * ( 1.0 + hits[i] + double3_length( expected[i] ) );
            assert_close( double3_distance( found, expected[i] ), 0.0, rounding );
            missed += hits[i] == 0 ? 1 : 0;
            pinned += w[i] == 0.0 ? 1 : 0;
            most = hits[i] > most ? hits[i] : most;
        }
        assert_int_equal( pinned, 2 );
        assert_true( sum > f->vertex_count / 3 && missed > f->vertex_count / 4 );
        assert_int_equal( most, per_triangle == 1 ? 6 : 1 );
        void* blocks[] = { points, expected, w, hits };
        for ( int k = 0; k < WISP_COUNT( blocks ); ++k )
        {
            free( blocks[k] );
        }
    }
}

// Of a free sheet: every vertex belongs to a triangle that the gust meets, from one side. A step of any length moves it by the
// gust times the step.
TEST( a_gust_does_not_depend_on_the_step_and_meets_one_side_of_a_sheet )
{
    static const float STEPS[] = { 1.0f / 240.0f, 1.0f / 20.0f };
    for ( int n = 0; n < 4; ++n )
    {
        const bool from_the_front = n < 2;
        SCOPED( ball_close ) ball_world* b = ball_open( 1, 1, NULL );
        SCOPED( test_mesh_free ) test_mesh sheet = test_plane( 5, 0.1f );
        const wisp_fabric_def fabric = test_fabric_def( &sheet );
        const wisp_entity e = test_surface_of( b->world, &fabric, support_weightless_surface_def() );
        // normals of the sheet are along +y
        const wisp_vec3 gust = { 0.25f, from_the_front ? -0.5f : 0.5f, 0.0f };
        assert_int_equal( wisp_request( b->world, e, WISP_SURFACE_POINTS ), WISP_OK );
        assert_int_equal( wisp_apply_gust( b->world, e, gust, false ), WISP_OK );
        const float dt = STEPS[n % 2];
        assert_int_equal( wisp_world_step( b->world, dt ), WISP_OK );
        for ( int i = 0; i < sheet.vertex_count; ++i )
        {
            const wisp_vec3 p = point_of( b->world, e, i ), start = sheet.points[i];
            const double fraction = from_the_front ? (double)dt : 0.0;
            // two substeps, each a rounding of a coordinate below 0.5 m
            assert_close( (double)p.x - (double)start.x, fraction * (double)gust.x, 0x1p-24 );
            assert_close( (double)p.y - (double)start.y, fraction * (double)gust.y, 0x1p-24 );
        }
    }
}

TEST( a_gust_that_cannot_be_is_refused_by_name )
{
    SCOPED( ball_close ) ball_world* b = fallen_ball();
    const uint64_t before = wisp_world_hash( b->world );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 0.0f, NAN, 0.0f }, false ),
                    WISP_BAD_INPUT, "gust: got (0, nan, 0) m/s" );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 2e6f, 0.0f, 0.0f }, true ),
                    WISP_BAD_INPUT, "at most 1e6 m/s" );
    const wisp_entity strands = test_add_strands( b->world, 2, 3 );
    expect_refusal( b->world, wisp_apply_gust( b->world, strands, GUST, false ), WISP_CONFLICT, "not a surface" );
    assert_int_equal( wisp_remove( b->world, strands ), WISP_OK );
    test_host_refuse( &b->host, 1, true );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, GUST, false ), WISP_NO_MEMORY, "gust" );
    test_host_refuse( &b->host, 0, false );
    assert_true( wisp_world_hash( b->world ) == before );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, GUST, false ), WISP_OK );
    assert_true( wisp_world_hash( b->world ) != before );
}

TEST( no_gust_changes_no_bit_and_gusts_that_add_up_have_a_limit )
{
    SCOPED( ball_close ) ball_world* b = fallen_ball();
    const uint64_t before = wisp_world_hash( b->world );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 0.0f, -0.0f, 0.0f }, true ), WISP_OK );
    assert_true( wisp_world_hash( b->world ) == before );
    // six triangles meet at a vertex, so that it would get more than the limit; and so would a second gust
    const wisp_vec3 storm = { 9e5f, 0.0f, 0.0f };
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, storm, true ), WISP_BAD_INPUT,
                    "would be faster than 1e6 m/s" );
    assert_true( wisp_world_hash( b->world ) == before );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, storm, false ), WISP_OK );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, storm, false ), WISP_BAD_INPUT,
                    "would be faster than 1e6 m/s" );
}
