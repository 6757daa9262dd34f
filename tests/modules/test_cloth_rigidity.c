// What a rigidity in N m means: a strip of 1 m x 0.2 m, clamped by two rows of pins, hangs out under its own weight as the heavy
// elastica does, on a grid and on an irregular mesh, as xpbd cloth and as implicit cloth.
#include "implicit_cloth_fixture.h"

enum
{
    CELLS = 20, // along the strip; the clamp has one more
    WIDE = 4,   // across
    COLUMNS = CELLS + 2,
    ROWS = WIDE + 1,
};

typedef enum solver_kind
{
    BY_ANGLE,
    BY_CURVATURE,
    IMPLICIT,
    SOLVER_KINDS,
} solver_kind;

static const char* const SOLVER_NAMES[SOLVER_KINDS] = { "dihedral", "isometric", "implicit" };

// G = rho g L^3 / D, and the drop of the tip over the length: theta'' = -G (1 - s) cos theta.
typedef struct elastica
{
    double load, drop;
} elastica;

static const elastica ELASTICAS[] = {
    { 0.3, 0.03745790 }, { 3.0, 0.33964839 }, { 30.0, 0.87309242 }, { 300.0, 0.96500636 }
};

// The strip ends where its pins end, at x = 0. Irregular: inner vertices and those of the tip's sides move by 0.3 of a cell, and
// each cell takes its shorter diagonal.
static test_mesh strip_mesh( bool irregular, int32_t pins[2 * ROWS] )
{
    const double cell = 1.0 / CELLS;
    test_mesh m = hanging_mesh( COLUMNS, ROWS, 1.0f, 1.0f );
    m.triangle_count = 0;
    for ( int v = 0; v < COLUMNS * ROWS; ++v )
    {
        const int i = v % COLUMNS, j = v / COLUMNS;
        const double out = irregular && i > 1 ? 0.3 : 0.0;
        const double along = i < COLUMNS - 1 ? out * (double)test_random_float( v, 1, -1.0f, 1.0f ) : 0.0;
        const double across = j > 0 && j < WIDE ? out * (double)test_random_float( v, 2, -1.0f, 1.0f ) : 0.0;
        m.points[v] = ( wisp_vec3 ){ (float)( cell * ( i - 1 + along ) ), 0.0f, (float)( cell * ( j + across ) ) };
    }
    for ( int n = 0; n < ( COLUMNS - 1 ) * WIDE; ++n )
    {
        const int32_t a = n / ( COLUMNS - 1 ) * COLUMNS + n % ( COLUMNS - 1 ), b = a + 1, c = a + COLUMNS, d = c + 1;
        const double falling = vec_distance( m.points[a], m.points[d] ),
                     rising = vec_distance( m.points[b], m.points[c] );
        const int32_t one[6] = { a, c, d, a, d, b }, other[6] = { a, c, b, b, c, d };
        memcpy( m.triangles + 3 * (size_t)m.triangle_count, falling < rising ? one : other, sizeof( one ) );
        m.triangle_count += 2;
    }
    for ( int j = 0; j < ROWS; ++j )
    {
        pins[2 * j] = j * COLUMNS;
        pins[2 * j + 1] = j * COLUMNS + 1;
    }
    return m;
}

static void set_material( wisp_world* world, wisp_entity e, solver_kind kind, float rigidity )
{
    if ( kind == IMPLICIT )
    {
        wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
        cloth.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
        cloth.weights = WISP_IMPLICIT_WEIGHTS_NONE;
        cloth.stretch_stiffness = 1000.0f;
        cloth.bend_rigidity = rigidity;
        assert_status( world, wisp_set_implicit_cloth( world, e, &cloth ), WISP_OK );
        return;
    }
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = kind == BY_ANGLE ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC;
    cloth.bend_rigidity = rigidity;
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
}

static wisp_entity clamped_strip( hosted* h, solver_kind kind, bool irregular, double load, int substeps )
{
    open_implicit( h, substeps );
    int32_t pins[2 * ROWS];
    test_mesh mesh = strip_mesh( irregular, pins );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = 2 * ROWS;
    wisp_entity e = test_surface_of( h->world, &fabric, surface );
    set_material( h->world, e, kind, (float)( 0.15 * 9.81 / load ) );
    assert_status( h->world, wisp_request( h->world, e, WISP_SURFACE_POINTS ), WISP_OK );
    test_mesh_free( &mesh );
    return e;
}

// Drop of the tip at rest, in m.
static double hang_out( solver_kind kind, bool irregular, double load, int substeps )
{
    hosted h;
    const wisp_entity e = clamped_strip( &h, kind, irregular, load, substeps );
    assert_status( h.world, wisp_set_gravity( h.world, e, EARTH ), WISP_OK );
    // the first mode of a stiff strip, and the swing of a soft one; damped critically, with twelve of its times to settle
    const double slowest = fmax( 3.516 * sqrt( 9.81 / load ), 3.0 );
    assert_status( h.world, wisp_set_damping( h.world, e, (float)( 2.0 * slowest ) ), WISP_OK );
    run_steps( h.world, (int)( 12.0 / slowest * 60.0 ), 1.0f / 60.0f );
    assert_false( wisp_is_halted( h.world, e ) );
    double drop = 0.0;
    for ( int j = 0; j < ROWS; ++j )
    {
        drop -= (double)point_of( h.world, e, j * COLUMNS + COLUMNS - 1 ).y / ROWS;
    }
    close_world( &h );
    return drop;
}

static void compare_with_elasticas( int substeps, double tolerance )
{
    for ( int k = 0; k < SOLVER_KINDS; ++k )
    {
        for ( int irregular = 0; irregular < 2; ++irregular )
        {
            for ( int n = 0; n < WISP_COUNT( ELASTICAS ); ++n )
            {
                const elastica* exact = ELASTICAS + n;
                const double drop = hang_out( (solver_kind)k, irregular != 0, exact->load, substeps ) / exact->drop;
                print_message( "           %2d substeps, %-9s, %-9s, G = %5.1f: %.4f of the drop\n", substeps,
                               SOLVER_NAMES[k], irregular ? "irregular" : "grid", exact->load, drop );
                assert_near( drop, 1.0, tolerance );
            }
        }
    }
}

// What is left is the stretch of links that one pass a substep leaves, 1 % under the full weight.
TEST( a_strip_hangs_out_as_the_elastica_at_ten_substeps )
{
    compare_with_elasticas( 10, 0.03 );
}

// What is left is the mesh: 1/12 of the squared cell where the strip bends most, over the length of the bend.
TEST( a_strip_hangs_out_as_the_elastica_once_converged )
{
    compare_with_elasticas( 40, 0.01 );
}

// Ten seconds of a strip on edge, which gravity bends in its plane. @return how often the tip's way out of the plane becomes larger
static double grow_sideways( solver_kind kind, bool irregular, double load )
{
    hosted h;
    const wisp_entity e = clamped_strip( &h, kind, irregular, load, 40 );
    const int tip = WIDE / 2 * COLUMNS + COLUMNS - 1;
    assert_status( h.world, wisp_set_damping( h.world, e, 2.0f ), WISP_OK );
    assert_status( h.world, wisp_set_gravity( h.world, e, ( wisp_vec3 ){ 0.0f, 0.02f, -9.81f } ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_status( h.world, wisp_set_gravity( h.world, e, ( wisp_vec3 ){ 0.0f, 0.0f, -9.81f } ), WISP_OK );
    run_steps( h.world, 150, 1.0f / 60.0f );
    const double start = (double)point_of( h.world, e, tip ).y;
    run_steps( h.world, 600, 1.0f / 60.0f );
    const double end = (double)point_of( h.world, e, tip ).y;
    close_world( &h );
    return end / start;
}

// The critical load of a plate on edge, five times as long as wide: rho g L^3 / D = 20.65. It is the least eigenvalue of
// D |curvature|^2 + stress : grad w grad w over 60 polynomials, with the stress of a beam under its weight. Towards a beam it
// falls to 12.85 sqrt( EI GJ ) / ( D b ) = 18.17 (Timoshenko and Gere 1961).
TEST( a_strip_on_edge_buckles_at_the_load_of_a_plate )
{
    const double critical = 20.65;
    for ( int k = 0; k < SOLVER_KINDS; ++k )
    {
        for ( int irregular = 0; irregular < 2; ++irregular )
        {
            const double below = grow_sideways( (solver_kind)k, irregular != 0, 0.95 * critical );
            const double above = grow_sideways( (solver_kind)k, irregular != 0, 1.05 * critical );
            print_message( "           %-9s, %-9s: %.3f times in 10 s below the critical load, %.3f above\n",
                           SOLVER_NAMES[k], irregular ? "irregular" : "grid", below, above );
            assert_true( fabs( below ) < 0.5 );
            assert_true( above > 1.5 );
        }
    }
}

// Pins that come later clamp as those that were there when the cloth was set.
TEST( pins_that_come_later_clamp_too )
{
    double tip[2];
    for ( int later = 0; later < 2; ++later )
    {
        hosted h;
        open_implicit( &h, 4 );
        int32_t pins[2 * ROWS];
        test_mesh mesh = strip_mesh( true, pins );
        wisp_fabric_def fabric = test_fabric_def( &mesh );
        fabric.hinges = true;
        fabric.bend_links = false;
        wisp_surface_def surface = support_weightless_surface_def();
        surface.pins = pins;
        surface.pin_count = later ? 0 : 2 * ROWS;
        fabric.attachments = pins;
        fabric.attachment_count = 2 * ROWS;
        wisp_entity e = test_surface_of( h.world, &fabric, surface );
        set_material( h.world, e, BY_CURVATURE, 0.1f );
        assert_status( h.world, wisp_request( h.world, e, WISP_SURFACE_POINTS ), WISP_OK );
        run_steps( h.world, 2, 1.0f / 60.0f );
        assert_status( h.world, wisp_pin( h.world, e, pins, 2 * ROWS ), WISP_OK );
        assert_status( h.world, wisp_set_gravity( h.world, e, EARTH ), WISP_OK );
        run_steps( h.world, 60, 1.0f / 60.0f );
        tip[later] = (double)point_of( h.world, e, COLUMNS - 1 ).y;
        test_mesh_free( &mesh );
        close_world( &h );
    }
    assert_true( tip[0] < -0.1 );
    assert_near( tip[1], tip[0], 1e-5 );
}
