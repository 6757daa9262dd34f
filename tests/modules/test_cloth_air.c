// Air on triangles: drag along the relative wind, lift across it.
#include "cloth_fixture.h"

static const float DENSITY = 1.225f; // kg/m^3, at 15 degrees

// A triangle of 0.08 m^2 in the plane y = 0, its normal up; every vertex weighs 10 g.
static wisp_entity add_triangle( wisp_world* world, wisp_vec3 wind, float drag, float lift )
{
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
    wisp_entity e = add_cloth( world, &fabric, surface, &cloth, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    test_mesh_free( &mesh );
    return e;
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
    hosted* h = *state;
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
        hosted h;
        open_world( &h, 4 << i, 1 );
        test_mesh mesh = test_plane( 9, 0.1f );
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
        test_mesh_free( &mesh );
        close_world( &h );
    }
    print_message( "           %.5f m/s, error %+.5f and %+.5f with half the step\n", terminal, error[0], error[1] );
    assert_near( terminal, 1.37, 0.001 );
    // air is applied to the velocity before gravity: g dt / 2 too fast, and first order
    assert_near( error[0], 9.81 / 480.0, 0.1 * 9.81 / 480.0 );
    assert_near( error[1] / error[0], 0.5, 0.05 );
}

WORLD_TEST( air_moves_a_feather_to_the_winds_speed_and_never_beyond )
{
    hosted* h = *state;
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
    hosted* h = *state;
    test_mesh mesh = test_plane( 9, 0.05f );
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
    test_mesh_free( &mesh );
}

WORLD_TEST( wind_that_only_slides_along_does_nothing )
{
    hosted* h = *state;
    wisp_entity e = add_triangle( h->world, ( wisp_vec3 ){ 5.0f, 0.0f, -3.0f }, 1.0f, 1.0f );
    run_steps( h->world, 10, 0.01f );
    assert_true( motion_stats_of( h->world, e ).speed_max == 0.0 );
}

WORLD_TEST( wind_can_change_every_step )
{
    hosted* h = *state;
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
    hosted* h = *state;
    wisp_entity e = add_triangle( h->world, ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f }, 0.0f, 0.0f );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.air" ), 0 );
    assert_int_equal( wisp_set_cloth_wind( h->world, e, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } ), WISP_CONFLICT );
    assert_one_message( wisp_world_message( h->world ) );
}

// Air on a rotated mesh gives the rotated force: the same plate broadside along z.
WORLD_TEST( drag_knows_no_axis )
{
    hosted* h = *state;
    double speed[2];
    for ( int i = 0; i < 2; ++i )
    {
        test_mesh mesh = test_plane( 5, 0.1f );
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
        test_mesh_free( &mesh );
    }
    // positions of 0.3 m in 0.01 s
    assert_near( speed[0] / speed[1], 1.0, 1e-4 );
    assert_true( speed[0] > 0.5 );
}
