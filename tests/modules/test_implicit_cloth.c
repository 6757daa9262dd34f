// Implicit cloth without bodies: links of a mesh and given links, weights, gravity, pins, damping, energies, and
// counters.
#include "implicit_cloth_fixture.h"

static const float DT = 1.0f / 64.0f; // s

// ---- links ----

static wisp_implicit_cloth_stats links_of( wisp_world* world, const test_mesh* mesh, wisp_implicit_cloth_def* def )
{
    const wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    wisp_entity e = test_surface_of( world, &fabric, surface );
    set_implicit( world, e, def );
    run_steps( world, 1, DT );
    const wisp_implicit_cloth_stats f = stats_of( world, e );
    assert_status( world, wisp_remove( world, e ), WISP_OK );
    return f;
}

static void assert_links( const wisp_implicit_cloth_stats* f, int stretch, int bend, int most )
{
    assert_int_equal( f->stretch_links, stretch );
    assert_int_equal( f->bend_links, bend );
    assert_int_equal( f->max_neighbours, most );
}

IMPLICIT_TEST( edges_stretch_and_opposite_vertices_bend )
{
    wisp_implicit_cloth_def def = exact_def();
    test_mesh lone = triangle_mesh( ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 1, 0, 0 }, ( wisp_vec3 ){ 0, 0, 1 } );
    wisp_implicit_cloth_stats f = links_of( h->world, &lone, &def );
    assert_links( &f, 3, 0, 2 );
    test_mesh_free( &lone );
    test_mesh two = test_plane( 2, 0.1f );
    f = links_of( h->world, &two, &def );
    assert_links( &f, 5, 1, 3 );
    test_mesh_free( &two );
    // 3 x 3: 12 sides and 4 diagonals of squares; a diagonal link over each of its 8 inner edges, 4 of which are diagonals of
    // squares, and the other 4 meet in the middle or around it
    SCOPED( test_mesh_free ) test_mesh nine = test_plane( 3, 0.1f );
    f = links_of( h->world, &nine, &def );
    assert_int_equal( f.stretch_links, 16 );
    assert_int_equal( f.bend_links, 8 );
}

// Each edge of an octahedron has two neighbouring faces whose far corners are poles of one of three axes, and each axis is found
// by four edges.
IMPLICIT_TEST( a_diagonal_found_twice_is_one_link )
{
    wisp_implicit_cloth_def def = exact_def();
    SCOPED( test_mesh_free ) test_mesh octahedron = test_ball( 0 );
    const wisp_implicit_cloth_stats f = links_of( h->world, &octahedron, &def );
    assert_links( &f, 12, 3, 5 );
}

IMPLICIT_TEST( an_edge_that_is_a_diagonal_too_is_two_links_and_one_neighbour )
{
    wisp_implicit_cloth_def def = exact_def();
    wisp_vec3 points[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    int32_t triangles[12] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    const test_mesh tetrahedron = { points, triangles, 4, 4 };
    const wisp_implicit_cloth_stats f = links_of( h->world, &tetrahedron, &def );
    assert_links( &f, 6, 6, 3 );
}

IMPLICIT_TEST( pairs_by_hand_take_the_place_of_the_mesh )
{
    wisp_implicit_cloth_def def = exact_def();
    const int32_t stretch[] = { 0, 1, 1, 0, 1, 3 }, bend[] = { 0, 3, 2, 3, 3, 2, 0, 1 };
    def.stretch_pairs = stretch;
    def.stretch_pair_count = 3;
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 2, 0.1f );
    wisp_implicit_cloth_stats f = links_of( h->world, &mesh, &def );
    assert_links( &f, 2, 0, 2 );
    def.bend_pairs = bend;
    def.bend_pair_count = 4;
    f = links_of( h->world, &mesh, &def );
    assert_links( &f, 2, 3, 3 );
}

// ---- hanging ----

static float length_of_link( wisp_world* world, wisp_entity e, int link )
{
    return (float)vec_distance( point_of( world, e, link ), point_of( world, e, link + 1 ) );
}

// Lengths are below 0.4 m, whose rounding is 3e-8 m; the stretch of a link is the difference of two of those.
static const double HANGING_ROUNDING = 1e-7;

// Neighbours in the chain are 1, 2, 2, 1, so the ends have the weight 2. `effective` halves the mass of the last
// vertex.
IMPLICIT_TEST( weights_are_those_of_neighbours )
{
    const struct
    {
        wisp_implicit_weights weights;
        double load[3]; // in units of a vertex's weight
    } cases[] = {
        { WISP_IMPLICIT_WEIGHTS_NONE, { 3.0, 2.0, 1.0 } },
        { WISP_IMPLICIT_WEIGHTS_EFFECTIVE, { 2.5, 1.5, 0.5 } },
    };
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        wisp_implicit_cloth_def def = exact_def();
        def.weights = cases[n].weights;
        wisp_entity e = add_chain( h->world, &def, 3, 0.01f, NULL );
        assert_status( h->world, wisp_set_gravity( h->world, e, EARTH ), WISP_OK );
        run_steps( h->world, 600, 1.0f / 100.0f );
        for ( int link = 0; link < 3; ++link )
        {
            const double stretch = 0.01 * 9.81 / 200.0 * cases[n].load[link];
            assert_near( length_of_link( h->world, e, link ), (double)CHAIN_LINK + stretch, HANGING_ROUNDING );
        }
        assert_status( h->world, wisp_remove( h->world, e ), WISP_OK );
    }
}

// ---- energies ----

// The load of an arc is F = -12 - 7.2 ( 1 - y ) .., so a link shortened by x = 1 - y stores k_b/L ( 12 x + ... )
// beyond the ramp.
IMPLICIT_TEST( stats_hold_the_energy_of_bending )
{
    static const int32_t PAIR[2] = { 0, 1 };
    wisp_implicit_cloth_def def = exact_def();
    def.bend_pairs = PAIR;
    def.bend_pair_count = 1;
    def.stretch_pairs = PAIR;
    def.stretch_pair_count = 1;
    def.bend_stiffness = 1e-4f;
    def.compression_stiffness = 1e7f; // the arc alone
    def.link_damping = 0.0f;
    test_mesh mesh = triangle_mesh( ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 0.5f, 0, 0 }, ( wisp_vec3 ){ 0, 0, 1 } );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = 1e3f; // it does not move meanwhile
    // y = sin u / u at u = pi / 2
    const wisp_vec3 points[3] = { { 0, 0, 0 }, { 0.31830988f, 0, 0 }, { 0, 0, 1 } };
    surface.points = points;
    wisp_entity e = test_surface_of( h->world, &fabric, surface );
    set_implicit( h->world, e, &def );
    test_mesh_free( &mesh );
    run_steps( h->world, 1, 1e-3f );
    const double u = 1.57079632679, energy = 2.0 * 1e-4 / 0.5 * u * u;
    // the ramp's part is half of load^2 / ramp: 1e-4 of it at most
    assert_near( stats_of( h->world, e ).bend_energy, energy, 1e-4 * energy );
    assert_near( stats_of( h->world, e ).stretch_energy, 0.0, 0.0 );
}

// A sheet of 2.4e-5 kg and more per vertex that hangs at 200 N/m: differences of positions within 0.16 m are rounded
// by 1.5e-8 m. A vertex has up to eight of them, which is 200 N/m 1.2e-7 m dt / m = 0.016 m/s at most.
TEST( repeats_come_to_the_nonlinear_step )
{
    double left[2];
    for ( int n = 0; n < 2; ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 1 );
        wisp_implicit_cloth_def def = exact_def();
        def.newton_iterations = n == 0 ? 1 : 6;
        def.bend_stiffness = 0.0f;
        wisp_entity e = add_sheet( h.world, &def, 6, true );
        run_steps( h.world, 20, DT );
        const wisp_implicit_cloth_stats f = stats_of( h.world, e );
        assert_int_equal( f.newton_iterations, def.newton_iterations );
        assert_int_equal( count_of( h.world, WISP_COUNT_NOT_CONVERGED ), 0 );
        left[n] = f.newton_residual;
    }
    assert_true( left[0] > 1.0 );
    assert_true( left[1] < 0.016 );
}

// ---- what is counted ----

IMPLICIT_TEST( a_solve_that_ends_at_its_limit_is_counted )
{
    wisp_implicit_cloth_def def = exact_def();
    def.max_iterations = 1;
    wisp_entity e = add_sheet( h->world, &def, 6, true );
    run_steps( h->world, 5, DT );
    assert_true( count_of( h->world, WISP_COUNT_NOT_CONVERGED ) >= 4 );
    assert_int_equal( stats_of( h->world, e ).iterations, 1 );
    assert_true( stats_of( h->world, e ).residual > 1e-7f );
    def.max_iterations = 0;
    def.tolerance = 1e-4f;
    const uint64_t before = count_of( h->world, WISP_COUNT_NOT_CONVERGED );
    set_implicit( h->world, e, &def );
    run_steps( h->world, 5, DT );
    assert_int_equal( count_of( h->world, WISP_COUNT_NOT_CONVERGED ), before );
}

// Diagonals half as long as at rest push with k_b/L^2 F, about 16, sideways: far more than masses and edges resist.
IMPLICIT_TEST( sheets_that_push_sideways_meet_no_negative_curvature )
{
    wisp_implicit_cloth_def def = exact_def();
    def.bend_stiffness = 1e-3f;
    def.link_damping = 0.0f;
    wisp_entity e = add_sheet( h->world, &def, 6, true );
    const wisp_fabric* fabric = wisp_world_fabric( h->world, e );
    for ( int v = 0; v < fabric->vertex_count; ++v )
    {
        place_vertex( h->world, e, v,
                      ( wisp_vec3 ){ 0.015f * (float)( v % 6 ), 1e-4f * test_random_float( v, 90, -1.0f, 1.0f ),
                                     0.015f * (float)( v / 6 ) },
                      ( wisp_vec3 ){ 0 } );
    }
    run_steps( h->world, 3, DT );
    assert_int_equal( count_of( h->world, WISP_COUNT_INDEFINITE ), 0 );
    assert_int_equal( count_of( h->world, WISP_COUNT_HALTED ), 0 );
    assert_true( is_finite( h->world, e ) );
}

IMPLICIT_TEST( links_between_coincident_vertices_are_counted )
{
    wisp_implicit_cloth_def def = exact_def();
    test_mesh mesh = chain_mesh();
    mesh.points[2] = mesh.points[1];
    mesh.points[3] = ( wisp_vec3 ){ 0.0f, -2.0f * CHAIN_LINK, 0.0f }; // at rest behind it
    wisp_entity e = add_chain( h->world, &def, 3, 0.01f, mesh.points );
    test_mesh_free( &mesh );
    run_steps( h->world, 3, DT );
    // nothing moves it, so it occurs in each substep
    assert_int_equal( count_of( h->world, WISP_COUNT_DEGENERATE_LINK ), 3 );
    assert_true( is_finite( h->world, e ) );
}

// Three collinear links leave a light vertex nearly free across them: its block of the matrix is a rank-one matrix
// and a part 55000 times smaller. A link of 20 kN/m that carries 0.3 g grows by 1e-7 m; before it is taut it may fall
// g dt^2, 3 mm.
IMPLICIT_TEST( a_light_chain_of_stiff_links_keeps_its_length )
{
    static const int32_t PAIRS[6] = { 0, 1, 1, 2, 2, 3 }, PINS[2] = { 0, 4 };
    wisp_implicit_cloth_def def = linked_def();
    def.stretch_stiffness = 2e4f;
    def.link_damping = 0.0f;
    def.stretch_pairs = PAIRS;
    def.stretch_pair_count = 3;
    test_mesh mesh = chain_mesh();
    for ( int i = 0; i <= CHAIN_FREE; ++i )
    {
        mesh.points[i] = ( wisp_vec3 ){ 0.06f * (float)i, -0.07f * (float)i, 0.083f * (float)i };
    }
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = 1e-4f;
    surface.pins = PINS;
    surface.pin_count = 2;
    wisp_entity e = test_surface_of( h->world, &fabric, surface );
    const double rest = vec_distance( mesh.points[0], mesh.points[1] );
    test_mesh_free( &mesh );
    set_implicit( h->world, e, &def );
    assert_status( h->world, wisp_set_gravity( h->world, e, EARTH ), WISP_OK );
    for ( int i = 0; i < 200; ++i )
    {
        run_steps( h->world, 1, 1.0f / 60.0f );
        for ( int link = 0; link < 3; ++link )
        {
            const double length = (double)length_of_link( h->world, e, link );
            if ( !( length < 1.1 * rest ) )
            {
                fail_msg( "link %d is %g m behind step %d, %g m at rest", link, length, i + 1, rest );
            }
        }
    }
}

TEST( cloth_stays_finite_whatever_it_is_made_of )
{
    for ( int n = 0; n < 48; ++n )
    {
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 1 );
        wisp_implicit_cloth_def def = linked_def();
        def.stretch_stiffness = n % 3 == 0 ? 1e9f : n % 3 == 1 ? 200.0f : 0.0f;
        def.bend_stiffness = n % 2 == 0 ? 1e-6f : 1e3f;
        def.link_damping = n % 5 == 0 ? 1e9f : n % 5 == 1 ? 0.0f : 0.02f;
        def.integrator = n % 8 < 4 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2;
        def.weights = (wisp_implicit_weights)( n % WISP_IMPLICIT_WEIGHTS_COUNT );
        def.newton_iterations = 1 + n % 3;
        wisp_entity e = add_sheet( h.world, &def, 6, n % 2 == 0 );
        crumple_sheet( h.world, e, n % 9 < 3 ? 1.0f : 0.01f, n % 9 < 6 ? 1.0f : 100.0f );
        run_steps( h.world, 30, DT );
        // a cloth that is neither stiff nor crumpled over its own size is never reset
        const bool tame = n % 3 != 0 && n % 2 == 0 && n % 5 > 1 && n % 9 >= 3;
        if ( is_finite( h.world, e ) == false || ( tame && count_of( h.world, WISP_COUNT_HALTED ) > 0 ) )
        {
            fail_msg( "variant %d is halted or not finite", n );
        }
    }
}

// ---- BDF2 ----

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
