// Damping of the difference from a rigid motion (Mueller et al. 2007, section 3.5).
#include "cloth_fixture.h"

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
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.warp_compliance = cloth.weft_compliance = 1e12f;
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.internal_damping = rate;
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
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
    hosted* h = *state;
    const float rate = 5.0f;
    test_mesh mesh = test_plane( 9, 0.1f );
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
    test_mesh_free( &mesh );
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
    test_mesh mesh = sheet_of( side );
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
    test_mesh_free( &mesh );
}

WORLD_TEST( damping_takes_no_turning )
{
    for ( int i = 0; i < WISP_COUNT( SIDES ); ++i )
    {
        check_turning( *state, SIDES[i] );
    }
}

// Ten turns a second, with damping so strong that only the rigid motion remains after a step.
static void check_rigid_turn( hosted* h, int side )
{
    test_mesh mesh = sheet_of( side );
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
    test_mesh_free( &mesh );
}

WORLD_TEST( a_rigid_turn_lives_through_any_damping )
{
    for ( int i = 0; i < WISP_COUNT( SIDES ); ++i )
    {
        check_rigid_turn( *state, SIDES[i] );
    }
}

// Half a metre along a direction, of this width; it turns about an axis.
static void check_line( hosted* h, wisp_vec3 along, wisp_vec3 foreign, float width, wisp_vec3 turning,
                        double tolerance )
{
    test_mesh mesh = test_plane( 5, 0.1f );
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
    test_mesh_free( &mesh );
}

// A body with all mass on a line has no moment of inertia about it, and still turns about the others.
WORLD_TEST( a_body_that_is_a_line_keeps_turning )
{
    const wisp_vec3 x = { 1.0f, 0.0f, 0.0f }, y = { 0.0f, 1.0f, 0.0f }, slanted = { 0.6f, 0.48f, 0.64f },
                    aside = { -0.8f, 0.36f, 0.48f };
    // positions of 0.5 m are rounded to 3e-8 m of 5e-5 m per step at the ends
    check_line( *state, x, y, 0.0f, y, 2e-3 );
    check_line( *state, slanted, aside, 0.0f, aside, 2e-3 );
    check_line( *state, slanted, aside, 1e-7f, aside, 2e-3 );
    // its moment about its own axis is lost in the rounding of the sums
    const wisp_vec3 both = { slanted.x + aside.x, slanted.y + aside.y, slanted.z + aside.z };
    for ( float width = 1e-3f; width > 1e-8f; width *= 0.5f )
    {
        check_line( *state, slanted, aside, width, both, 2e-3 );
    }
}

// A ribbon a hundred times as long as it is wide still turns about itself.
WORLD_TEST( a_ribbon_keeps_its_spin )
{
    const wisp_vec3 slanted = { 0.6f, 0.48f, 0.64f }, aside = { -0.8f, 0.36f, 0.48f };
    check_line( *state, slanted, aside, 5e-3f, slanted, 0.05 );
}

WORLD_TEST( a_pinned_cloth_comes_to_rest_and_a_loose_vertex_is_no_pin )
{
    hosted* h = *state;
    test_mesh mesh = test_plane( 5, 0.1f );
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
    test_mesh_free( &mesh );
}

WORLD_TEST( damping_of_zero_has_no_pass )
{
    hosted* h = *state;
    test_mesh mesh = test_plane( 3, 0.1f );
    wisp_entity e = add_damped( h->world, &mesh, 1.0f, NULL, 0 );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.damping" ), 1 );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_status( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "cloth.damping" ), 0 );
    test_mesh_free( &mesh );
}
