// Implicit cloth beyond the range of one linear solve and single precision: links so stiff that a mass is lost in
// rounding, and steps so long that BDF2 has no usable history.
#include "implicit_cloth_fixture.h"

enum
{
    SIDE = 10,
};

static const float FRAME = 1.0f / 60.0f; // s

// ---- measured values ----

// Of edges; links resist no compression.
static double largest_strain( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float* x = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    double most = 0.0;
    for ( int i = 0; i < f->edge_count; ++i )
    {
        const size_t a = (size_t)f->edges[2 * i], b = (size_t)f->edges[2 * i + 1];
        const wisp_vec3 p = { x[4 * a], x[4 * a + 1], x[4 * a + 2] }, q = { x[4 * b], x[4 * b + 1], x[4 * b + 2] };
        most = fmax( most, vec_distance( p, q ) / vec_distance( f->rest[a], f->rest[b] ) - 1.0 );
    }
    return most;
}

// Of motion, height and links, J.
static double energy_of( wisp_world* world, wisp_entity e )
{
    const wisp_implicit_cloth_stats stats = stats_of( world, e );
    const float* x = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    const float* v = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    double sum = stats.stretch_energy + stats.bend_energy;
    for ( int i = 0; i < wisp_world_fabric( world, e )->vertex_count; ++i )
    {
        const double mass = x[4 * i + 3] > 0.0f ? 1.0 / (double)x[4 * i + 3] : 0.0, vx = (double)v[4 * i];
        const double vy = (double)v[4 * i + 1], vz = (double)v[4 * i + 2];
        sum += mass * ( 0.5 * ( vx * vx + vy * vy + vz * vz ) + (double)GRAVITY * (double)x[4 * i + 1] );
    }
    return sum;
}

static wisp_entity add_hard_sheet( wisp_world* world, float stiffness, wisp_integrator integrator )
{
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
    def.weights = WISP_IMPLICIT_WEIGHTS_NONE; // so that energies are those of the masses
    def.stretch_stiffness = stiffness;
    def.integrator = integrator;
    const wisp_entity e = add_sheet( world, &def, SIDE, true );
    assert_status( world, wisp_set_damping( world, e, 4.0f ), WISP_OK );
    return e;
}

// ---- stiff links ----

// A cable of stiffness EA and weight W that starts straight between its ends stretches by (1/24)^(1/3) (W /
// EA)^(2/3). The uppermost row, whose links have half the sheet's stiffness, carries at most the whole sheet.
// Rounding of positions is below 1e-5 of a length.
static double strain_of_a_cable( wisp_world* world, wisp_entity e, double stiffness )
{
    const float* x = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    double mass = 0.0;
    for ( int i = 0; i < wisp_world_fabric( world, e )->vertex_count; ++i )
    {
        mass += x[4 * i + 3] > 0.0f ? 1.0 / (double)x[4 * i + 3] : 0.0;
    }
    return cbrt( 1.0 / 24.0 ) * pow( mass * 9.81 / ( 0.5 * stiffness * 0.03125 ), 2.0 / 3.0 );
}

TEST( stiff_links_hang_at_their_length )
{
    static const float STIFFNESSES[] = { 1e4f, 1e6f, 1e8f };
    for ( int n = 0; n < 2 * WISP_COUNT( STIFFNESSES ); ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 2 );
        const wisp_integrator integrator = n % 2 == 0 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2;
        const wisp_entity e = add_hard_sheet( h.world, STIFFNESSES[n / 2], integrator );
        run_steps( h.world, 180, FRAME );
        const double strain = largest_strain( h.world, e );
        if ( !( strain < strain_of_a_cable( h.world, e, (double)STIFFNESSES[n / 2] ) + 1e-4 ) )
        {
            fail_msg( "%g N/m, integrator %d: a strain of %g", (double)STIFFNESSES[n / 2], (int)integrator, strain );
        }
        assert_int_equal( count_of( h.world, WISP_COUNT_HALTED ), 0 );
    }
}

// A sheet that starts with all vertices within a centimetre of their rest positions.
TEST( stiff_links_give_no_more_than_they_had )
{
    static const float STIFFNESSES[] = { 1e4f, 1e6f, 1e8f };
    for ( int n = 0; n < WISP_COUNT( STIFFNESSES ); ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 2 );
        const wisp_entity e = add_hard_sheet( h.world, STIFFNESSES[n], WISP_INTEGRATOR_EULER );
        crumple_sheet( h.world, e, 0.01f, 0.5f );
        run_steps( h.world, 1, FRAME );
        const double first = energy_of( h.world, e );
        double most = first;
        for ( int i = 0; i < 120; ++i )
        {
            run_steps( h.world, 1, FRAME );
            most = fmax( most, energy_of( h.world, e ) );
        }
        // the part of the fall that a substep does not resolve
        if ( !( most <= first + 1e-3 ) )
        {
            fail_msg( "%g N/m: %g J, %g J at first", (double)STIFFNESSES[n], most, first );
        }
    }
}

TEST( what_floats_carry_is_left_as_it_is )
{
    for ( int n = 0; n < 2; ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 2 );
        const wisp_entity e = add_hard_sheet( h.world, n == 0 ? 200.0f : 1e8f, WISP_INTEGRATOR_BDF2 );
        run_steps( h.world, 10, FRAME );
        assert_int_equal( count_of( h.world, WISP_COUNT_STIFFNESS_CLAMPED ), n == 0 ? 0 : 20 );
        assert_int_equal( count_of( h.world, WISP_COUNT_FIRST_ORDER ), n == 0 ? 0 : 20 );
        assert_int_equal( stats_of( h.world, e ).newton_iterations > 1, n == 1 );
    }
}

// ---- BDF2 ----

TEST( bdf2_hangs_in_long_steps )
{
    static const float STEPS[] = { 1.0f / 15.0f, 0.2f };
    for ( int n = 0; n < WISP_COUNT( STEPS ); ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 2 );
        const wisp_entity e = add_hard_sheet( h.world, 200.0f, WISP_INTEGRATOR_BDF2 );
        run_steps( h.world, (int)( 5.0f / STEPS[n] ), STEPS[n] );
        const double strain = largest_strain( h.world, e );
        if ( !( strain < 0.045 ) )
        {
            fail_msg( "steps of %g s: a strain of %g", (double)STEPS[n], strain );
        }
    }
}

// A mass on a link that is always taut, behind a quarter of a second.
static double oscillator_error( int steps )
{
    SCOPED( close_world ) hosted h;
    open_implicit( &h, 1 );
    const double mass = 0.01, stiffness = 10.0, rest = mass * 9.81 / stiffness, seconds = 0.25;
    wisp_implicit_cloth_def def = exact_def();
    def.integrator = WISP_INTEGRATOR_BDF2;
    def.stretch_stiffness = (float)stiffness;
    def.link_damping = 0.0f;
    test_mesh mesh = chain_mesh();
    mesh.points[1].y = -CHAIN_LINK - (float)( 1.5 * rest );
    const wisp_entity e = add_chain( h.world, &def, 1, (float)mass, mesh.points );
    test_mesh_free( &mesh );
    assert_status( h.world, wisp_set_gravity( h.world, e, EARTH ), WISP_OK );
    run_steps( h.world, steps, (float)( seconds / steps ) );
    const double y = (double)point_of( h.world, e, 1 ).y;
    const double exact = -(double)CHAIN_LINK - rest - 0.5 * rest * cos( sqrt( stiffness / mass ) * seconds );
    assert_int_equal( count_of( h.world, WISP_COUNT_FIRST_ORDER ), 0 );
    return fabs( y - exact );
}

TEST( bdf2_is_of_second_order_in_smooth_motion )
{
    const double order = log2( oscillator_error( 64 ) / oscillator_error( 128 ) );
    assert_near( order, 2.0, 0.2 );
}
