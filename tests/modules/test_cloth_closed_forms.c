// Cloth against closed forms: springs, chains, pendulums, momentum, energy.
#include "cloth_fixture.h"

// Threads along y that stretch by `compliance`, with no other support: rungs and diagonals of 1e11 m/N and more carry
// less than 1e-11 N.
static wisp_cloth_def threads_alone( float compliance )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.warp = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    cloth.warp_compliance = compliance;
    cloth.weft_compliance = 1e12f;
    cloth.shear_compliance = 0.0f;
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    return cloth;
}

// Displacement of a vertex of 0.1 kg on one spring of 100 N/m, m. The third corner only completes the triangle.
static double spring_extension( int substeps, int iterations, float seconds )
{
    hosted h;
    open_world( &h, substeps, iterations );
    test_mesh mesh = triangle_mesh( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, ( wisp_vec3 ){ 0.1f, -0.1f, 0.0f },
                                    ( wisp_vec3 ){ 0.0f, -0.1f, 0.0f } );
    const int32_t pins[2] = { 0, 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = 0.1f;
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = threads_alone( 0.01f );
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    assert_status( h.world, wisp_set_damping( h.world, e, 60.0f ), WISP_OK );
    run_steps( h.world, (int)( 3.0f / seconds ), seconds );
    double extension = -0.1 - (double)point_of( h.world, e, 2 ).y;
    test_mesh_free( &mesh );
    close_world( &h );
    return extension;
}

TEST( a_spring_stretches_by_m_g_over_k_at_any_step_and_iteration_count )
{
    const int iterations[] = { 1, 2, 10 };
    const float seconds[] = { 1.0f / 30.0f, 1.0f / 60.0f, 1.0f / 480.0f };
    for ( int i = 0; i < WISP_COUNT( iterations ); ++i )
    {
        for ( int s = 0; s < WISP_COUNT( seconds ); ++s )
        {
            // a single constraint is solved exactly by one iteration; a position of 0.1 m is rounded to 7e-9 m, and a
            // stiffness of k dt^2 / m turns a rounding in every step into 1 / 0.004 of it at 1/480 s
            assert_near( spring_extension( 1, iterations[i], seconds[s] ), 0.1 * 9.81 / 100.0, 2e-6 );
        }
    }
}

enum
{
    CHAIN_LINKS = 16,
};

// Relative error of the length of two chains of 16 links that hang under their weight: dL = c m g n (n + 1) / 2.
static double chain_error( int substeps, int iterations )
{
    hosted h;
    open_world( &h, substeps, iterations );
    const float link = 0.05f, mass = 1e-3f, compliance = 0.04f;
    test_mesh mesh = hanging_mesh( 2, CHAIN_LINKS + 1, link, link );
    const int32_t pins[2] = { 0, 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = mass;
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = threads_alone( compliance );
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    // the first mode of the chain has sqrt(k / m) pi / 2n = 15 rad/s; this is critical damping
    assert_status( h.world, wisp_set_damping( h.world, e, 30.0f ), WISP_OK );
    run_steps( h.world, 120, 1.0f / 60.0f );
    double extension = -(double)CHAIN_LINKS * (double)link - (double)point_of( h.world, e, 2 * CHAIN_LINKS ).y;
    test_mesh_free( &mesh );
    close_world( &h );
    return extension / ( (double)compliance * (double)mass * 9.81 * CHAIN_LINKS * ( CHAIN_LINKS + 1 ) / 2.0 ) - 1.0;
}

// One pass per substep leaves an error of the order of w dt^2 / c, so halving dt quarters it. More passes reach the
// floor of floats: a vertex at 0.8 m moves in steps of 6e-8 m, so a residual below 3e-8 m of g dt^2 = 4.3e-5 m at
// 1/480 s, 7e-4 of the weight, is lost.
TEST( a_bar_stretches_by_its_compliance_whatever_iterations_and_step )
{
    const int converged[][2] = { { 1, 64 }, { 2, 64 }, { 4, 16 }, { 4, 64 }, { 8, 16 } };
    for ( int i = 0; i < WISP_COUNT( converged ); ++i )
    {
        assert_near( chain_error( converged[i][0], converged[i][1] ), 0.0, 7e-4 );
    }
    double error2 = chain_error( 2, 1 ), error4 = chain_error( 4, 1 ), error8 = chain_error( 8, 1 );
    print_message( "           one pass, 2, 4, 8 substeps: %+.4f %+.4f %+.4f\n", error2, error4, error8 );
    assert_near( error2 / error4, 4.0, 0.3 );
    assert_near( error4 / error8, 4.0, 0.3 );
}

// ---- a chain between two pins ----

// Sag of a strip of length 1 m between pins 0.8 m apart, m.
static double sag_of_strip( int columns, int substeps )
{
    hosted h;
    open_world( &h, substeps, 1 );
    const float spacing = 1.0f / (float)( columns - 1 );
    test_mesh mesh = hanging_mesh( columns, 2, spacing, spacing );
    wisp_vec3* start = checked_calloc( (size_t)mesh.vertex_count, sizeof( wisp_vec3 ) );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        // the rest shape is flat; the strip starts as a V of its own length between the pins, 0.3 m deep
        double s = (double)( v % columns ) / (double)( columns - 1 );
        start[v] = ( wisp_vec3 ){ (float)( 0.8 * s ), (float)( -0.3 * ( 1.0 - fabs( 2.0 * s - 1.0 ) ) ),
                                  v < columns ? 0.0f : spacing };
    }
    const int32_t pins[4] = { 0, columns - 1, columns, 2 * columns - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = 1e-3f;
    surface.points = start;
    surface.pins = pins;
    surface.pin_count = 4;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    assert_status( h.world, wisp_set_damping( h.world, e, 6.0f ), WISP_OK );
    run_steps( h.world, 240, 1.0f / 60.0f );
    double sag = -(double)point_of( h.world, e, columns / 2 ).y;
    free( start );
    test_mesh_free( &mesh );
    close_world( &h );
    return sag;
}

// A chain of 40 links is within 0.05 % of the curve. One pass per substep leaves a stretch of the order of dt^2:
// doubling the substeps should quarter the error, and does so by 3.3 to 3.9 here.
TEST( a_pinned_strip_hangs_in_a_catenary )
{
    double error[4];
    for ( int i = 0; i < WISP_COUNT( error ); ++i )
    {
        error[i] = sag_of_strip( 41, 4 << i ) / 0.26543751 - 1.0;
        assert_true( i == 0 || error[i] < error[i - 1] / 3.0 );
    }
    print_message( "           4, 8, 16, 32 substeps: %+.4f %+.4f %+.4f %+.4f\n", error[0], error[1], error[2],
                   error[3] );
    assert_near( error[3], 0.0, 0.01 );
}

// ---- pendulum ----

// Period over sqrt(L/g) of a rigid triangle that swings about its pinned edge from `degrees`, the mean of four
// swings.
static double pendulum_period( double degrees, int substeps )
{
    hosted h;
    open_world( &h, substeps, 1 );
    const double length = 0.5, angle = degrees * 3.14159265358979 / 180.0;
    test_mesh mesh = triangle_mesh( ( wisp_vec3 ){ 0.0f, 0.0f, -0.2f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.2f },
                                    ( wisp_vec3 ){ 0.0f, (float)-length, 0.0f } );
    const wisp_vec3 start[3] = { mesh.points[0],
                                 mesh.points[1],
                                 { (float)( length * sin( angle ) ), (float)( -length * cos( angle ) ), 0.0f } };
    const int32_t pins[2] = { 0, 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.points = start;
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    double last = (double)start[2].x, intersections[9];
    int count = 0;
    for ( int i = 0; count < 9 && i < 4000; ++i )
    {
        run_steps( h.world, 1, 1.0f / 240.0f );
        double x = (double)point_of( h.world, e, 2 ).x;
        if ( x * last < 0.0 )
        {
            intersections[count++] = ( (double)i + last / ( last - x ) ) / 240.0;
        }
        last = x;
    }
    assert_int_equal( count, 9 );
    test_mesh_free( &mesh );
    close_world( &h );
    return ( intersections[8] - intersections[0] ) / 4.0 / sqrt( length / 9.81 );
}

// The integrator loses energy of the order of the step, more for larger swings, and a smaller swing has a shorter
// period: the error falls with the substeps. At 1/960 s that loss dominates; 90 degrees use four times as many
// substeps.
TEST( a_triangle_on_its_edge_swings_with_a_pendulums_period )
{
    const struct
    {
        double degrees, ratio, tolerance; // ratio: 2/pi K(sin(a/2))
        int substeps;
    } swings[] = {
        { 10.0, 1.00190719, 1e-3, 4 },
        { 30.0, 1.01740880, 2e-3, 4 },
        { 60.0, 1.07318201, 1e-2, 4 },
        { 90.0, 1.18034060, 1e-2, 16 },
    };
    for ( int i = 0; i < WISP_COUNT( swings ); ++i )
    {
        double small = 2.0 * 3.14159265358979 * swings[i].ratio;
        double error = pendulum_period( swings[i].degrees, swings[i].substeps ) / small - 1.0;
        assert_near( error, 0.0, swings[i].tolerance );
        assert_true( fabs( error ) < fabs( pendulum_period( swings[i].degrees, 1 ) / small - 1.0 ) );
    }
}

// ---- conserved quantities ----

typedef struct drift
{
    double linear, angular; // change of momentum relative to the sum of its absolute values
} drift;

static double norm( const double v[3] )
{
    return sqrt( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
}

// A creased cloth that turns, flies and wobbles for a second without gravity.
static drift drift_of( wisp_cloth_bending bending, int substeps )
{
    hosted h;
    open_world( &h, substeps, 2 );
    test_mesh mesh = test_plane( 9, 0.05f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = bending;
    cloth.bend_rigidity = 1e-4f;
    cloth.warp_compliance = cloth.weft_compliance = 1e-3f;
    wisp_entity e = add_cloth( h.world, &fabric, support_weightless_surface_def(), &cloth, ( wisp_vec3 ){ 0 } );
    assert_status(
        h.world,
        wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 0.1f, -0.2f, 0.3f }, ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } ),
        WISP_OK );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            velocity_of( h.world, e, v )[k] += test_random_float( v, k, -0.2f, 0.2f );
        }
    }
    run_steps( h.world, 1, 1e-6f );
    wisp_motion_stats before = motion_stats_of( h.world, e );
    run_steps( h.world, 60, 1.0f / 60.0f );
    wisp_motion_stats after = motion_stats_of( h.world, e );
    double change[3], turn[3];
    for ( int k = 0; k < 3; ++k )
    {
        change[k] = after.momentum[k] - before.momentum[k];
        turn[k] = after.angular_momentum[k] - before.angular_momentum[k];
    }
    test_mesh_free( &mesh );
    close_world( &h );
    return ( drift ){ norm( change ) / norm( before.momentum ), norm( turn ) / norm( before.angular_momentum ) };
}

// Constraint forces come in opposite pairs, so momentum is kept up to rounding. A velocity is a difference of
// positions of half a metre, rounded to 3e-8 m, over 1/240 s and more: 7e-6 m/s per substep of 0.37 m/s, 240 times.
// Angular momentum is taken about positions that moved in the substep, so its error is first order: half the step
// loses half.
TEST( constraints_keep_momentum_and_lose_turning_with_the_step_alone )
{
    for ( int b = 0; b < WISP_CLOTH_BENDING_COUNT; ++b )
    {
        drift two = drift_of( (wisp_cloth_bending)b, 2 ), four = drift_of( (wisp_cloth_bending)b, 4 );
        assert_true( two.linear < 1e-3 && four.linear < 1e-3 );
        assert_near( four.angular / two.angular, 0.5, 0.07 );
    }
}

typedef struct energy_stats
{
    double above_start; // highest energy relative to that of the start
    double rise;        // largest rise of energy above its earlier minimum; both relative to the energy of the fall
} energy_stats;

static energy_stats energy_of_hanging( int substeps )
{
    hosted h;
    open_world( &h, substeps, 1 );
    test_mesh mesh = test_plane( 17, 0.05f );
    const int32_t pins[2] = { 0, 16 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.attachments = pins;
    fabric.attachment_count = 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    double least = 0.0, highest = -1e30, rise = 0.0, depth = 0.0;
    for ( int i = 0; i < 1000; ++i )
    {
        run_steps( h.world, 1, 1.0f / 60.0f );
        wisp_motion_stats q = motion_stats_of( h.world, e );
        double energy = q.kinetic_energy + q.potential_energy;
        highest = fmax( highest, energy );
        rise = fmax( rise, energy - least );
        least = fmin( least, energy );
        depth = fmin( depth, q.potential_energy );
    }
    test_mesh_free( &mesh );
    close_world( &h );
    return ( energy_stats ){ highest / -depth, rise / -depth };
}

// Potential energy is 0 at the start, so a positive total was created by the solver. A cloth that one pass per
// substep leaves stretched releases that as a rise: it falls with the stretch, at second order in the step.
TEST( a_hanging_cloth_never_has_more_energy_than_it_began_with )
{
    energy_stats ten = energy_of_hanging( 10 ), forty = energy_of_hanging( 40 );
    print_message( "           rises by %.4f of the fall with 10 substeps, %.4f with 40\n", ten.rise, forty.rise );
    assert_true( ten.above_start <= 0.0 && forty.above_start <= 0.0 );
    assert_true( ten.rise < 0.12 );
    assert_true( forty.rise < 0.02 );
}
