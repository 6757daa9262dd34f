// Bending against the elastica: rigidity in N m, whatever the mesh, the kind of hinge and the size of the strip. A strip
// between free edges has the rigidity of the sheet times its width, since Poisson's ratio of bending is 0. A strip of
// 1 m x 0.2 m, clamped by two rows of pins, hangs out under its own weight as the heavy elastica does, on a grid and on an
// irregular mesh, as xpbd cloth and as implicit cloth.
#include "cloth_fixture.h"
#include "implicit_cloth_fixture.h"

typedef enum strip_mesh
{
    EQUILATERAL,
    RIGHT,
} strip_mesh;

typedef struct beam
{
    strip_mesh mesh;
    wisp_cloth_bending bending;
    double load;   // G = rho g L^3 / EI of the strip
    int cells;     // along the length
    double length; // m
} beam;

// The first cell is pinned, and is rigid as far as its triangles have three pins: to the middle of a slanted edge of equilateral
// triangles, to the second row of right ones. There the strip is clamped.
static test_mesh strip_of( const beam* b )
{
    const bool equal = b->mesh == EQUILATERAL;
    const double a = b->length / ( equal ? b->cells + 0.5 : b->cells ), clamp = equal ? 0.75 * a : a;
    const int columns = b->cells + 2;
    test_mesh m = hanging_mesh( columns, 2, 1.0f, 1.0f );
    m.triangle_count = 0;
    for ( int i = 0; i < columns; ++i )
    {
        m.points[i] = ( wisp_vec3 ){ (float)( a * i - clamp ), 0.0f, 0.0f };
        m.points[columns + i] = ( wisp_vec3 ){ (float)( a * ( equal ? i + 0.5 : i ) - clamp ), 0.0f,
                                               (float)( equal ? a * sqrt( 0.75 ) : a ) };
    }
    for ( int i = 0; i + 1 < columns; ++i )
    {
        int p = i, q = i + 1, r = columns + i, s = r + 1;
        const int32_t one[6] = { p, r, q, q, r, s }, other[6] = { p, r, s, p, s, q };
        memcpy( m.triangles + 6 * (size_t)i, equal || i % 2 == 0 ? one : other, sizeof( one ) );
        m.triangle_count += 2;
    }
    return m;
}

static wisp_cloth_def cloth_of( const beam* b )
{
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = b->bending;
    cloth.bend_rigidity = (float)( 0.15 * 9.81 * b->length * b->length * b->length / b->load );
    return cloth;
}

static double hang_out( const beam* b )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 32, 64 );
    SCOPED( test_mesh_free ) test_mesh mesh = strip_of( b );
    const int columns = b->cells + 2;
    const int32_t pins[4] = { 0, 1, columns, columns + 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = b->mesh == EQUILATERAL ? 3 : 4;
    wisp_cloth_def cloth = cloth_of( b );
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    // the first mode has 3.516 sqrt(g / (G L)) rad/s and critical damping; it has 12 time constants to settle
    double slowest = 3.516 * sqrt( 9.81 / ( b->load * b->length ) );
    assert_status( h.world, wisp_set_damping( h.world, e, (float)( 2.0 * slowest ) ), WISP_OK );
    const float seconds = (float)( sqrt( b->length / 0.1 ) / 60.0 );
    run_steps( h.world, (int)( 12.0 / slowest / (double)seconds ), seconds );
    assert_false( wisp_is_halted( h.world, e ) );
    const wisp_vec3 p = point_of( h.world, e, columns - 1 ), q = point_of( h.world, e, 2 * columns - 1 );
    return -0.5 * ( (double)p.y + (double)q.y ) / b->length;
}

static const wisp_cloth_bending KINDS[] = { WISP_CLOTH_BENDING_DIHEDRAL, WISP_CLOTH_BENDING_ISOMETRIC };

// The heavy elastica: theta'' = -G (1 - s) cos theta. The clamped strip has other loads, and implicit cloth.
static const double DROP_AT_10 = 0.70019972; // over the length

TEST( rigidity_does_not_depend_on_the_mesh_or_its_resolution )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        for ( int cells = 5; cells <= 15; cells += 10 )
        {
            const double equal = hang_out( &( beam ){ EQUILATERAL, KINDS[k], 10.0, cells, 0.1 } );
            const double right = hang_out( &( beam ){ RIGHT, KINDS[k], 10.0, cells, 0.1 } );
            print_message( "           %2d cells: %.4f equilateral, %.4f right, %.4f\n", cells, equal, right,
                           DROP_AT_10 );
            assert_near( equal / DROP_AT_10, 1.0, 0.02 );
            // second order in the angle of a cell where the strip bends most
            assert_near( right / DROP_AT_10, 1.0, 0.2 / cells );
        }
    }
}

// The same load G at ten times the size is the same shape. Steps are scaled likewise, so only rounding differs: a
// float loses up to half of 7e-9 m of g dt^2 = 2.7e-6 m at 0.1 m.
TEST( rigidity_is_in_units_so_size_does_not_matter )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        const double small = hang_out( &( beam ){ EQUILATERAL, KINDS[k], 10.0, 6, 0.1 } );
        const double large = hang_out( &( beam ){ EQUILATERAL, KINDS[k], 10.0, 6, 1.0 } );
        assert_near( small / large, 1.0, 0.005 );
    }
}

// ---- a crease ----

// Four by four vertices creased along the third column by 0.5 rad.
static test_mesh creased_mesh( void )
{
    test_mesh m = test_plane( 4, 0.1f );
    for ( int v = 0; v < m.vertex_count; ++v )
    {
        m.points[v].y = v % 4 == 3 ? 0.1f * sinf( 0.5f ) : 0.0f;
        m.points[v].x = v % 4 == 3 ? 0.2f + 0.1f * cosf( 0.5f ) : m.points[v].x;
    }
    return m;
}

// Distance of the flap's end from the other end after two seconds without gravity, m.
static double span_in_the_end( const wisp_cloth_def* cloth, bool born_creased )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 4, 4 );
    SCOPED( test_mesh_free ) test_mesh flat = test_plane( 4, 0.1f ), creased = creased_mesh();
    wisp_fabric_def fabric = test_fabric_def( born_creased ? &creased : &flat );
    fabric.hinges = true;
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.points = creased.points;
    wisp_entity e = add_cloth( h.world, &fabric, surface, cloth, ( wisp_vec3 ){ 0 } );
    assert_status( h.world, wisp_set_damping( h.world, e, 20.0f ), WISP_OK );
    run_steps( h.world, 120, 1.0f / 60.0f );
    return vec_distance( point_of( h.world, e, 4 ), point_of( h.world, e, 7 ) );
}

TEST( a_crease_of_the_rest_shape_stays_and_another_opens )
{
    const double crease = sqrt( 0.05 + 0.04 * cos( 0.5 ) ),
                 flat = 0.3; // two sides of 0.2 and 0.1 m, and flat
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bend_rigidity = 1e-3f;
    for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
    {
        cloth.solver = (wisp_solver)solver;
        cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
        // an angle is computed to 4e-7 rad, and every step may change it by as much
        assert_near( span_in_the_end( &cloth, true ), crease, 1e-5 );
        assert_near( span_in_the_end( &cloth, false ), flat, 1e-4 );
        cloth.bending = WISP_CLOTH_BENDING_ISOMETRIC; // has no rest angle: it flattens any crease
        assert_near( span_in_the_end( &cloth, false ), flat, 1e-4 );
        cloth.bending = WISP_CLOTH_BENDING_NONE;
        assert_near( span_in_the_end( &cloth, false ), crease, 1e-5 );
    }
}

WORLD_TEST( bending_that_is_chosen_brings_its_pass_and_no_other )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    wisp_entity e = add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
    const char* const names[2][2] = { { "cloth.bending", "hinges.dihedral_pbd" },
                                      { "cloth.bending", "hinges.isometric_pbd" } };
    int bare = wisp_world_plan_passes( h->world );
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
        {
            cloth.bending = KINDS[k];
            cloth.solver = (wisp_solver)solver;
            assert_status( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
            assert_int_equal( wisp_world_plan_passes( h->world ), bare + 2 ); // that of sharp folds
            step( h->world );
            assert_int_equal( count_passes_named( h->world, names[k][solver] ), 1 );
            assert_int_equal( count_passes_named( h->world, "hinges.folds" ), 1 );
        }
    }
}

// A closed rough ball, or a blade of two close sheets, hangs from a vertex for two seconds. @return the mean strain
static double strain_of_solid( float size, float flatness, const wisp_cloth_def* cloth, float density, float gravity )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 10, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_ball( 3 );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const wisp_vec3 p = mesh.points[v];
        const float radius = size * test_random_float( v, 0, 0.6f, 1.4f );
        mesh.points[v] = ( wisp_vec3 ){ radius * p.x, radius * flatness * p.y, radius * p.z };
    }
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    wisp_surface_def surface = support_weightless_surface_def();
    const int32_t pin = 0;
    surface.pins = &pin;
    surface.pin_count = 1;
    surface.area_density = density;
    const wisp_entity e = add_cloth( h.world, &fabric, surface, cloth, ( wisp_vec3 ){ 0.0f, -gravity, 0.0f } );
    run_steps( h.world, 120, 1.0f / 60.0f );
    const double strain = motion_stats_of( h.world, e ).strain_mean;
    assert_false( wisp_is_halted( h.world, e ) );
    return strain;
}

// Gravity moves a vertex by 27 um in a substep, so a mesh of a millimetre has large strain with or without bending;
// bending must not add to it.
TEST( small_and_thin_solids_are_no_more_strained_with_dihedral_bending )
{
    const float sizes[] = { 0.1f, 0.03f, 0.01f, 1e-3f, 1e-4f }, flatness[] = { 1.0f, 2e-3f };
    for ( int k = 0; k < WISP_COUNT( sizes ) * WISP_COUNT( flatness ); ++k )
    {
        const float size = sizes[k / 2], flat = flatness[k % 2];
        wisp_cloth_def cloth = undamped_cloth();
        cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
        const double bent = strain_of_solid( size, flat, &cloth, 0.15f, 9.81f );
        cloth.bending = WISP_CLOTH_BENDING_NONE;
        const double slack = strain_of_solid( size, flat, &cloth, 0.15f, 9.81f );
        if ( !( bent < 2.0 * slack + 0.02 ) )
        {
            fail_msg( "size %g, flatness %g: strain %g, without bending %g", (double)size, (double)flat, bent,
                      slack );
        }
    }
}

// The same solid at 2^-10 to 2^10 of its size with the same accelerations over its size: gravity grows with it, D with its square
// where the masses stay. No constant of the engine has a length, and powers of two round nothing, so every bit of strain is the same.
TEST( strain_is_the_same_at_all_sizes )
{
    const wisp_cloth_bending kinds[] = { WISP_CLOTH_BENDING_LINKS, WISP_CLOTH_BENDING_DIHEDRAL,
                                         WISP_CLOTH_BENDING_ISOMETRIC };
    for ( int k = 0; k < 4 * WISP_COUNT( kinds ); ++k )
    {
        double strain[3];
        for ( int n = 0; n < WISP_COUNT( strain ); ++n )
        {
            const float size = ldexpf( 1.0f, 10 * ( n - 1 ) );
            wisp_cloth_def cloth = undamped_cloth();
            cloth.bending = kinds[k / 4];
            cloth.solver = k & 2 ? WISP_SOLVER_XPBD : WISP_SOLVER_PBD;
            cloth.bend_rigidity *= size * size;
            strain[n] = strain_of_solid( size, k & 1 ? 2e-3f : 1.0f, &cloth, 0.15f / ( size * size ), 9.81f * size );
        }
        assert_true( strain[1] > 1e-4 && strain[1] < 0.1 );
        assert_true( strain[0] == strain[1] && strain[2] == strain[1] );
    }
}

// ---- a clamped strip ----

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
static test_mesh clamped_mesh( bool irregular, int32_t pins[2 * ROWS] )
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
    SET( world, e, cloth, d.bending = kind == BY_ANGLE ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC,
         d.bend_rigidity = rigidity );
}

static wisp_entity clamped_strip( hosted* h, solver_kind kind, bool irregular, double load, int substeps )
{
    open_implicit( h, substeps );
    int32_t pins[2 * ROWS];
    SCOPED( test_mesh_free ) test_mesh mesh = clamped_mesh( irregular, pins );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = 2 * ROWS;
    wisp_entity e = test_surface_of( h->world, &fabric, surface );
    set_material( h->world, e, kind, (float)( 0.15 * 9.81 / load ) );
    assert_status( h->world, wisp_request( h->world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

// Drop of the tip at rest, in m.
static double hang_out_clamped( solver_kind kind, bool irregular, double load, int substeps )
{
    SCOPED( close_world ) hosted h;
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
                const double drop =
                    hang_out_clamped( (solver_kind)k, irregular != 0, exact->load, substeps ) / exact->drop;
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
    SCOPED( close_world ) hosted h;
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
        SCOPED( close_world ) hosted h;
        open_implicit( &h, 4 );
        int32_t pins[2 * ROWS];
        SCOPED( test_mesh_free ) test_mesh mesh = clamped_mesh( true, pins );
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
    }
    assert_true( tip[0] < -0.1 );
    assert_near( tip[1], tip[0], 1e-5 );
}
