// Cloth against closed forms: springs, chains, pendulums, momentum, energy. Cloth carried by coarse sheets: against the
// oracle in double precision, against converged motion and closed forms, at rest, and with everything else that acts on a
// cloth.
#include "cloth_fixture.h"

#include "oracle/coarse_oracle.h"

// Threads along y that stretch by `compliance`, with no other support: rungs and diagonals of 1e11 m/N and more carry
// less than 1e-11 N.
static wisp_cloth_def threads_alone( float compliance )
{
    wisp_cloth_def cloth = undamped_cloth();
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
    SCOPED( close_world ) hosted h;
    open_world( &h, substeps, iterations );
    SCOPED( test_mesh_free )
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
    return -0.1 - (double)point_of( h.world, e, 2 ).y;
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
    SCOPED( close_world ) hosted h;
    open_world( &h, substeps, iterations );
    const float link = 0.05f, mass = 1e-3f, compliance = 0.04f;
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 2, CHAIN_LINKS + 1, link, link );
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
    SCOPED( close_world ) hosted h;
    open_world( &h, substeps, 1 );
    const float spacing = 1.0f / (float)( columns - 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( columns, 2, spacing, spacing );
    SCOPED( free_local ) wisp_vec3* start = checked_calloc( (size_t)mesh.vertex_count, sizeof( wisp_vec3 ) );
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
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    assert_status( h.world, wisp_set_damping( h.world, e, 6.0f ), WISP_OK );
    run_steps( h.world, 240, 1.0f / 60.0f );
    return -(double)point_of( h.world, e, columns / 2 ).y;
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
    SCOPED( close_world ) hosted h;
    open_world( &h, substeps, 1 );
    const double length = 0.5, angle = degrees * 3.14159265358979 / 180.0;
    SCOPED( test_mesh_free )
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
    wisp_cloth_def cloth = undamped_cloth();
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
    SCOPED( close_world ) hosted h;
    open_world( &h, substeps, 2 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.05f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    wisp_cloth_def cloth = undamped_cloth();
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

// A level sheet of n x n vertices, its side a metre, held at two corners.
typedef struct sheet_setting
{
    int n, substeps, coarse_substeps;
    bool is_free;
    float compliance, damping;
    bool bends; // by links
} sheet_setting;

static wisp_entity add_sheet( hosted* h, const sheet_setting* s )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( s->n, 1.0f / (float)( s->n - 1 ) );
    const int32_t pins[2] = { 0, s->n - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = s->bends;
    fabric.coarse_sheets = true;
    fabric.attachments = pins;
    fabric.attachment_count = s->is_free ? 0 : 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 0.2f;
    surface.pins = pins;
    surface.pin_count = s->is_free ? 0 : 2;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = s->bends ? WISP_CLOTH_BENDING_LINKS : WISP_CLOTH_BENDING_NONE;
    cloth.warp_compliance = cloth.weft_compliance = s->compliance;
    cloth.shear_compliance = 2.0f * s->compliance;
    cloth.coarse_substeps = s->coarse_substeps;
    wisp_entity e = add_cloth( h->world, &fabric, surface, &cloth, EARTH );
    assert_status( h->world, wisp_set_damping( h->world, e, s->damping ), WISP_OK );
    return e;
}

static const float* positions_of( wisp_world* world, wisp_entity e )
{
    return wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
}

// ---- the oracle ----

// Two levels with one substep of the sheet in each of two, and with two in one; a step so long that it limits the history; pins that
// are no attachments of the fabric, so they are between the rows of the sheets; and substeps so short that sheets relax less.
TEST( a_step_is_that_of_the_oracle )
{
    const sheet_setting settings[] = { { 53, 2, 1, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, true, 1e-3f, 0.0f, false },
                                       { 53, 5, 1, false, 1e-3f, 0.0f, false } };
    const double dts[] = { 1.0 / 60.0, 1.0 / 60.0, 1.0 / 20.0, 1.0 / 60.0, 1.0 / 60.0 };
    const int steps[] = { 12, 12, 4, 6, 6 };
    const int32_t between[] = { 1, 5 * 53 + 18, 5 * 53 + 19, 27 * 53 + 40 };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        SCOPED( close_world ) hosted h;
        open_world( &h, settings[i].substeps, 1 );
        wisp_entity e = add_sheet( &h, &settings[i] );
        const wisp_fabric* f = wisp_world_fabric( h.world, e );
        assert_int_equal( f->level_count, 2 );
        if ( settings[i].is_free )
        {
            assert_status( h.world, wisp_pin( h.world, e, between, WISP_COUNT( between ) ), WISP_OK );
        }
        SCOPED( coarse_oracle_free ) coarse_oracle oracle;
        coarse_oracle_make( f, positions_of( h.world, e ), &oracle );
        oracle.gravity = double3_widen( EARTH );
        oracle.compliance = (double)settings[i].compliance;
        oracle.substeps = settings[i].coarse_substeps;
        double worst = 0.0;
        for ( int step = 0; step < steps[i]; ++step )
        {
            run_steps( h.world, 1, (float)dts[i] );
            for ( int k = 0; k < settings[i].substeps; ++k )
            {
                coarse_oracle_step( &oracle, dts[i] / settings[i].substeps );
            }
            const float* position = positions_of( h.world, e );
            for ( int slot = 0; slot < f->vertex_count; ++slot )
            {
                const double3 d = double3_sub( double3_from( position + 4 * slot ), oracle.x[slot] );
                worst = fmax( worst, double3_length( d ) );
            }
        }
        print_message( "           %d x %d: %.2g m from the oracle after %d steps\n", settings[i].substeps,
                       settings[i].coarse_substeps, worst, steps[i] );

        // it has fallen by 0.2 m; without the limit, the last one would be millimetres off
        assert_true( worst < 1e-5 );
    }
}

// ---- accuracy ----

static wisp_vec3* run_for( const sheet_setting* s, int steps, int* count )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, s->substeps, 1 );
    wisp_entity e = add_sheet( &h, s );
    run_steps( h.world, steps, 1.0f / 60.0f );
    const wisp_view view = view_of( h.world, e, WISP_SURFACE_POINTS );
    wisp_vec3* points = checked_calloc( (size_t)view.count, sizeof( wisp_vec3 ) );
    memcpy( points, view.data, (size_t)view.count * sizeof( wisp_vec3 ) );
    *count = (int)view.count;
    return points;
}

static double distance_of( const sheet_setting* s, const wisp_vec3* reference, int steps )
{
    int count;
    SCOPED( free_local ) wisp_vec3* points = run_for( s, steps, &count );
    double sum = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        const double d = vec_distance( points[v], reference[v] );
        sum += d * d;
    }
    return sqrt( sum / count );
}

TEST( one_substep_is_nearer_to_the_converged_motion_than_forty )
{
    const sheet_setting converged = { 65, 320, 0, false, 1e-3f, 0.0f, false },
                        forty = { 65, 40, 0, false, 1e-3f, 0.0f, false };
    const sheet_setting carried = { 65, 1, 2, false, 1e-3f, 0.0f, false },
                        twice = { 65, 2, 1, false, 1e-3f, 0.0f, false };
    int count;
    SCOPED( free_local ) wisp_vec3* reference = run_for( &converged, 20, &count );
    const double plain = distance_of( &forty, reference, 20 ), one = distance_of( &carried, reference, 20 ),
                 two = distance_of( &twice, reference, 20 );
    print_message( "           40 plain substeps %.1f mm, 1 x 2 %.1f mm, 2 x 1 %.1f mm\n", 1e3 * plain, 1e3 * one,
                   1e3 * two );
    assert_true( one < 0.5 * plain && two < 0.5 * plain );
}

// Without links that act, second order is exact for a constant acceleration.
TEST( a_sheet_that_falls_freely_follows_the_parabola )
{
    for ( int coarse = 1; coarse <= 4; coarse *= 2 )
    {
        const sheet_setting falling = { 33, 1, coarse, true, 1e-3f, 0.0f, false };
        SCOPED( close_world ) hosted h;
        open_world( &h, 1, 1 );
        wisp_entity e = add_sheet( &h, &falling );
        run_steps( h.world, 60, 1.0f / 60.0f );
        const double fallen = -(double)point_of( h.world, e, 33 * 16 + 16 ).y;
        print_message( "           %d: fallen by %.4f m after 1 s, and 4.905 expected\n", coarse, fallen );
        assert_true( fabs( fallen - 4.905 ) < 1e-3 );
        assert_true( fabs( (double)velocity_of( h.world, e, 5 )[1] + 9.81 ) < 0.01 );
    }
}

// Sheets let it drift with 0.1 m/s, and took 5 % of what gravity gave it.
TEST( a_free_sheet_that_shakes_keeps_its_momentum )
{
    for ( int substeps = 1; substeps <= 10; substeps += 9 )
    {
        const sheet_setting flying = { 33, substeps, 1, true, 0.0f, 0.0f, true };
        hosted h;
        open_world( &h, substeps, 1 );
        wisp_entity e = add_sheet( &h, &flying );
        for ( int32_t v = 0; v < 33 * 33; ++v )
        {
            const wisp_vec3 u = { 0.5f * sinf( 5.0f * (float)v ), sinf( 0.3f * (float)v ),
                                  0.5f * cosf( 7.0f * (float)v ) };
            assert_status( h.world, wisp_set_vertex_velocities( h.world, e, &v, &u, 1 ), WISP_OK );
        }
        run_steps( h.world, 1, 1.0f / 60.0f );
        const wisp_motion_stats before = motion_stats_of( h.world, e );
        run_steps( h.world, 60, 1.0f / 60.0f );
        const wisp_motion_stats after = motion_stats_of( h.world, e );
        for ( int k = 0; k < 3; ++k )
        {
            const double change = ( after.momentum[k] - before.momentum[k] ) / after.mass;
            const double way = after.centre[k] - before.centre[k] - before.momentum[k] / before.mass;
            print_message( "           %d: %.2g m/s, %.2g m\n", substeps, change, way );
            assert_near( change, k == 1 ? -9.81 : 0.0, 3e-3 ); // rounding of floats at 10 m/s
            assert_near( way, k == 1 ? -4.905 : 0.0, 3e-3 );
        }
        close_world( &h );
    }
}

// ---- energy ----

static double energy_of( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float *p = positions_of( world, e ), *v = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    double sum = 0.0;
    for ( int i = 0; i < 4 * f->vertex_count; i += 4 )
    {
        const double mass = p[i + 3] > 0.0f ? 1.0 / (double)p[i + 3] : 0.0;
        const double squared =
            (double)( v[i] * v[i] ) + (double)( v[i + 1] * v[i + 1] ) + (double)( v[i + 2] * v[i + 2] );
        sum += mass * ( 0.5 * squared + 9.81 * (double)p[i + 1] );
    }
    return sum;
}

TEST( a_swing_of_fifteen_seconds_gains_no_energy )
{
    const sheet_setting settings[] = { { 33, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 33, 2, 1, false, 0.0f, 0.0f, false } };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        SCOPED( close_world ) hosted h;
        open_world( &h, settings[i].substeps, 1 );
        wisp_entity e = add_sheet( &h, &settings[i] );
        const double start = energy_of( h.world, e );
        double most = start;
        for ( int step = 0; step < 900; ++step )
        {
            run_steps( h.world, 1, 1.0f / 60.0f );
            most = fmax( most, energy_of( h.world, e ) );
        }
        assert_true( most <= start + 0.002 ); // 0.2 kg fall by 0.5 m: 1 J
        assert_false( wisp_is_halted( h.world, e ) );
    }
}

// What second order adds to free corners alone made them flutter with 1 m/s in short substeps, and whole corrections inextensible
// ones with several.
TEST( corners_do_not_flutter_in_short_substeps )
{
    const int substeps[] = { 2, 5 };
    const float compliance[] = { 1e-5f, 0.0f };
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        const sheet_setting carried = { .n = 33,
                                        .substeps = substeps[i],
                                        .coarse_substeps = 1,
                                        .compliance = compliance[i],
                                        .damping = 4.0f,
                                        .bends = true };
        hosted h;
        open_world( &h, carried.substeps, 1 );
        wisp_entity e = add_sheet( &h, &carried );
        run_steps( h.world, 1600, 1.0f / 240.0f );
        double fastest = 0.0;
        for ( int step = 0; step < 200; ++step )
        {
            run_steps( h.world, 1, 1.0f / 240.0f );
            fastest = fmax( fastest, (double)motion_stats_of( h.world, e ).speed_max );
        }
        print_message( "           %.2g m/s\n", fastest );
        assert_true( fastest < 0.3 );
        close_world( &h );
    }
}

// ---- what acts on a cloth ----

TEST( pins_that_move_take_the_sheet_along )
{
    const sheet_setting carried = { 33, 1, 2, false, 1e-4f, 2.0f, false };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    const int32_t pins[2] = { 0, 32 };
    run_steps( h.world, 120, 1.0f / 60.0f );
    for ( int step = 0; step < 120; ++step )
    {
        const float x = 0.02f * (float)( step + 1 );
        const wisp_vec3 targets[2] = { { x, 0.0f, 0.0f }, { x + 1.0f, 0.0f, 0.0f } };
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, 1.0f / 60.0f );
        assert_true( fabsf( point_of( h.world, e, 0 ).x - x ) < 1e-5f );
    }
    const wisp_vec3 tip = point_of( h.world, e, 32 * 33 + 16 );
    assert_true( tip.x > 1.2f && tip.y < -0.5f );
    assert_true( (double)motion_stats_of( h.world, e ).strain_mean < 0.02 );
}

// Pins that no row of a coarse sheet stands on, as copies of a fabric have: the sheet is held by them, and moves with them.
TEST( pins_between_rows_hold_the_sheet )
{
    const sheet_setting carried = { 49, 1, 2, true, 1e-4f, 2.0f, false };
    const int32_t pins[2] = { 12 * 49 + 13, 12 * 49 + 35 };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    assert_status( h.world, wisp_pin( h.world, e, pins, 2 ), WISP_OK );
    wisp_vec3 targets[2] = { point_of( h.world, e, pins[0] ), point_of( h.world, e, pins[1] ) };
    for ( int step = 0; step < 240; ++step )
    {
        targets[0].x += step < 60 ? 0.02f : 0.0f;
        targets[1].x += step < 60 ? 0.02f : 0.0f;
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, 1.0f / 60.0f );
        // the pins start with a jerk
        assert_true( step < 20 || (double)motion_stats_of( h.world, e ).strain_mean < 0.03 );
    }
    const wisp_motion_stats rest = motion_stats_of( h.world, e );
    print_message( "           at rest: %.2g m/s, strain %.3f %%\n", (double)rest.speed_max,
                   100.0 * (double)rest.strain_mean );
    assert_true( (double)rest.speed_max < 0.4 && (double)rest.strain_mean < 0.02 );
}

// What changes a sheet from outside: it goes on from there, without a jump of its own.
TEST( teleports_velocities_pins_and_other_steps_leave_no_kick )
{
    const sheet_setting carried = { 33, 1, 2, true, 1e-4f, 0.0f, false };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    assert_status( h.world, wisp_set_gravity( h.world, e, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
    run_steps( h.world, 10, 1.0f / 60.0f );
    assert_status( h.world, wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 1.0f, 2.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    run_steps( h.world, 30, 1.0f / 60.0f );
    run_steps( h.world, 30, 1.0f / 120.0f );
    const wisp_vec3 p = point_of( h.world, e, 7 );
    assert_true( fabs( (double)p.x - 7.0 / 32.0 - 0.75 ) < 1e-4 && fabs( (double)p.y - 1.5 ) < 1e-4 );
    wisp_transform motion = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 100.0f, 0.0f, 0.0f } };
    assert_status( h.world, wisp_teleport( h.world, e, motion, true ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_true( fabs( (double)point_of( h.world, e, 7 ).x - 7.0 / 32.0 - 101.75 ) < 1e-3 );
    const int32_t pin = 0;
    assert_status( h.world, wisp_pin( h.world, e, &pin, 1 ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_status( h.world, wisp_unpin( h.world, e, &pin, 1 ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_true( is_finite( h.world, e ) );
    assert_true( (double)motion_stats_of( h.world, e ).speed_max < 10.0 );
}
