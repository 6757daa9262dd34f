// Cloth as a whole: the meaning of stiffness, far constraints, and cases that broke other engines. Invalid cloth is
// rejected with one message that names the error, and a rejection changes nothing.
#include "cloth_fixture.h"

// ---- threads ----

// A strip of 2 x 9 vertices that hangs under its weight: in double precision, relaxed to rest, and in the engine.
enum
{
    ROWS = 9,
    COUNT = 2 * ROWS,
};

static double compliance_at( const wisp_cloth_def* c, double x, double y )
{
    double along = x * (double)c->warp.x + y * (double)c->warp.y;
    double bottom =
        ( x * x + y * y ) * ( (double)c->warp.x * (double)c->warp.x + (double)c->warp.y * (double)c->warp.y );
    double c2 = along * along / bottom, s2 = 1.0 - c2;
    return (double)c->warp_compliance * c2 * c2 + (double)c->weft_compliance * s2 * s2 +
           (double)c->shear_compliance * s2 * c2;
}

// By descent on the energy of its springs, with `weight` on each vertex.
static double relaxed_extension( const test_mesh* mesh, const wisp_cloth_def* cloth, double weight )
{
    static double p[COUNT][2], pull[COUNT][2], v[COUNT][2];
    memset( v, 0, sizeof( v ) );
    for ( int i = 0; i < COUNT; ++i )
    {
        p[i][0] = (double)mesh->points[i].x;
        p[i][1] = (double)mesh->points[i].y;
    }
    for ( int solve_order = 0; solve_order < 60000; ++solve_order )
    {
        for ( int i = 0; i < COUNT; ++i )
        {
            pull[i][0] = 0.0;
            pull[i][1] = -weight;
        }
        for ( int t = 0; t < mesh->triangle_count; ++t )
        {
            for ( int k = 0; k < 3; ++k )
            {
                int a = mesh->triangles[3 * t + k], b = mesh->triangles[3 * t + ( k + 1 ) % 3];
                double rx = (double)mesh->points[b].x - (double)mesh->points[a].x;
                double ry = (double)mesh->points[b].y - (double)mesh->points[a].y;
                double x = p[b][0] - p[a][0], y = p[b][1] - p[a][1], rest = hypot( rx, ry ), now = hypot( x, y );
                // an edge of two triangles is visited twice, an open one once: only the diagonals and the rungs
                // inside are inner edges of this strip
                bool inner = ( rx != 0.0 && ry != 0.0 ) || ( ry == 0.0 && a / 2 != 0 && a / 2 != ROWS - 1 );
                double tension = ( inner ? 0.5 : 1.0 ) * ( now - rest ) / ( compliance_at( cloth, rx, ry ) * now );
                pull[a][0] += tension * x;
                pull[a][1] += tension * y;
                pull[b][0] -= tension * x;
                pull[b][1] -= tension * y;
            }
        }
        for ( int i = 2; i < COUNT; ++i )
        {
            for ( int k = 0; k < 2; ++k )
            {
                v[i][k] = 0.99 * ( v[i][k] + 0.05 * pull[i][k] * 0.01 );
                p[i][k] += v[i][k];
            }
        }
    }
    return -0.5 * ( p[COUNT - 1][1] + p[COUNT - 2][1] ) - ( ROWS - 1 ) * 0.05;
}

static double hung_extension( const test_mesh* mesh, const wisp_cloth_def* cloth, double weight )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 8, 64 );
    const int32_t pins[2] = { 0, 1 };
    wisp_fabric_def fabric = test_fabric_def( mesh );
    fabric.bend_links = false;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = (float)( weight / 9.81 );
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_entity e = add_cloth( h.world, &fabric, surface, cloth, EARTH );
    assert_status( h.world, wisp_set_damping( h.world, e, 20.0f ), WISP_OK );
    run_steps( h.world, 180, 1.0f / 60.0f );
    double ends = (double)point_of( h.world, e, COUNT - 1 ).y + (double)point_of( h.world, e, COUNT - 2 ).y;
    return -0.5 * ends - ( ROWS - 1 ) * 0.05;
}

TEST( strips_along_warp_weft_and_between_stretch_by_their_compliances )
{
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 2, ROWS, 0.05f, 0.05f );
    const wisp_vec3 warps[] = { { 0.0f, 1.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 1.0f, 1.0f, 0.0f } };
    const char* const names[] = { "warp", "weft", "45 degrees" };
    double extension[3];
    for ( int i = 0; i < WISP_COUNT( warps ); ++i )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.bending = WISP_CLOTH_BENDING_NONE;
        cloth.warp = warps[i];
        cloth.warp_compliance = 0.01f;
        cloth.weft_compliance = 0.03f;
        cloth.shear_compliance = 0.4f;
        extension[i] = hung_extension( &mesh, &cloth, 0.01 );
        double expected = relaxed_extension( &mesh, &cloth, 0.01 );
        print_message( "           %-10s %.6f m, relaxed in double %.6f m\n", names[i], extension[i], expected );
        // a position of 0.4 m is rounded to 1.5e-8 m of g dt^2 = 4e-5 m
        assert_near( extension[i] / expected, 1.0, 2e-3 );
    }
    assert_true( extension[0] < 0.5 * extension[1] );
    assert_true( extension[2] > extension[0] );
}

// ---- stretch of a hanging cloth ----

typedef struct hanging
{
    int n;
    double side; // m
    wisp_solver solver;
    bool bend_links, tethers, coarse;
    float compliance, vertex_mass;
    int substeps, iterations;
    float seconds;
    bool corners_alone; // pinned there, else the whole row
    bool still;         // damped, else free
} hanging;

typedef struct stretch
{
    double sag;           // m, displacement of the middle of the last row from its rest position
    double largest, mean; // strain, averaged over the second half of the time
} stretch;

static stretch hang( const hanging* c, double time )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, c->substeps, c->iterations );
    const int n = c->n;
    const float spacing = (float)( c->side / ( n - 1 ) );
    SCOPED( test_mesh_free )
    test_mesh mesh = c->still ? hanging_mesh( n, n, spacing, spacing ) : test_plane( n, spacing );
    int32_t pins[128];
    int pin_count = 0;
    for ( int i = 0; i < n; i += c->corners_alone ? n - 1 : 1 )
    {
        pins[pin_count++] = i;
    }
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = c->bend_links;
    fabric.tethers = c->tethers;
    fabric.coarse_sheets = c->coarse;
    fabric.attachments = pins;
    fabric.attachment_count = pin_count;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = c->vertex_mass;
    surface.pins = pins;
    surface.pin_count = pin_count;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.solver = c->solver;
    cloth.bending = c->bend_links ? WISP_CLOTH_BENDING_LINKS : WISP_CLOTH_BENDING_NONE;
    cloth.warp_compliance = cloth.weft_compliance = c->compliance;
    cloth.shear_compliance = 2.0f * c->compliance;
    cloth.tethers = c->tethers;
    cloth.coarse_substeps = c->coarse ? 2 : 0;
    wisp_entity e = add_cloth( h.world, &fabric, surface, &cloth, EARTH );
    assert_status( h.world, wisp_set_damping( h.world, e, c->still ? 10.0f : 0.0f ), WISP_OK );
    int steps = (int)( time / (double)c->seconds ), counted = 0;
    stretch s = { 0 };
    for ( int i = 0; i < steps; ++i )
    {
        run_steps( h.world, 1, c->seconds );
        if ( i >= steps / 2 )
        {
            wisp_motion_stats q = motion_stats_of( h.world, e );
            s.largest += q.strain_max;
            s.mean += q.strain_mean;
            counted += 1;
        }
    }
    s.largest /= counted;
    s.mean /= counted;
    s.sag = -c->side - (double)point_of( h.world, e, n * ( n - 1 ) + n / 2 ).y;
    assert_int_equal( count_passes_named( h.world, "surface.levels" ),
                      wisp_world_fabric( h.world, e )->level_count > 0 && c->coarse ? 1 : 0 );
    return s;
}

// A sheet of links of the same compliance is the same sheet on any mesh, apart from its border: n columns of links
// carry n - 1 columns of mass, so the sheet of 17 is 3 % stiffer than that of 33.
TEST( static_stretch_does_not_depend_on_the_vertex_count )
{
    for ( int cross = 0; cross < 2; ++cross )
    {
        hanging c = { .n = 17,
                      .side = 0.8,
                      .bend_links = cross == 1,
                      .compliance = 0.02f,
                      .substeps = 8,
                      .iterations = 24,
                      .seconds = 1.0f / 60.0f,
                      .still = true };
        stretch coarse = hang( &c, 2.5 );
        c.n = 33;
        stretch fine = hang( &c, 2.5 );
        print_message( "           %s bend links: %.5f m with 17 x 17, %.5f m with 33 x 33\n", cross ? "with" : "no",
                       coarse.sag, fine.sag );
        assert_near( coarse.sag / fine.sag, 1.0, 0.03 );
    }
}

// The hanging cloth of performance.md: 64 x 64, two corners, 1 kg per vertex.
static hanging big_cloth( void )
{
    return ( hanging ){ .n = 64,
                        .side = 63 * 0.05,
                        .solver = WISP_SOLVER_PBD,
                        .bend_links = true,
                        .vertex_mass = 1.0f,
                        .substeps = 10,
                        .iterations = 1,
                        .seconds = 1.0f / 60.0f,
                        .corners_alone = true };
}

TEST( tethers_bound_the_stretch_of_a_hanging_cloth )
{
    hanging c = big_cloth();
    c.tethers = true;
    stretch with = hang( &c, 2.6 );
    c.tethers = false;
    stretch without = hang( &c, 2.6 );
    print_message( "           with tethers %.2f %% max, %.3f %% mean; without %.1f %%, %.3f %%\n",
                   100.0 * with.largest, 100.0 * with.mean, 100.0 * without.largest, 100.0 * without.mean );
    assert_true( with.largest < 0.05 );
    assert_true( with.largest < 0.2 * without.largest );
}

TEST( coarse_sheets_do_in_one_substep_what_ten_cannot )
{
    hanging c = big_cloth();
    c.coarse = true;
    c.solver = WISP_SOLVER_XPBD;
    c.substeps = 1;
    stretch s = hang( &c, 2.6 );
    print_message( "           1 substep, coarse sheets: %.2f %% max, %.3f %% mean\n", 100.0 * s.largest,
                   100.0 * s.mean );
    assert_true( s.largest < 0.15 );
    assert_true( s.mean < 0.009 );
}

// ---- hard cases ----

WORLD_TEST( a_pin_that_jumps_a_hundred_metres_takes_its_cloth_along )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.1f );
    const int32_t pin = 0;
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = &pin;
    surface.pin_count = 1;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_entity e = add_cloth( h->world, &fabric, surface, &cloth, EARTH );
    assert_status( h->world, wisp_set_damping( h->world, e, 5.0f ), WISP_OK );
    const wisp_vec3 far = { 100.0f, 0.0f, 0.0f };
    assert_status( h->world, wisp_move_pins( h->world, e, &pin, &far, 1 ), WISP_OK );
    run_steps( h->world, 1200, 0.01f );
    assert_true( is_finite( h->world, e ) );
    assert_false( wisp_is_halted( h->world, e ) );
    const wisp_vec3 at = point_of( h->world, e, 0 ), other = point_of( h->world, e, 80 );
    assert_true( at.x == 100.0f );
    // a diagonal of 1.13 m hangs from it, with as much stretch as one pass per step leaves
    assert_true( vec_distance( at, other ) < 1.5 );
}

WORLD_TEST( bad_meshes_are_cloth_all_the_same )
{
    // a square, its first triangle twice and once reversed, one without area, an unreferenced vertex
    const wisp_vec3 points[] = { { 0, 0, 0 },    { 0.1f, 0, 0 }, { 0.1f, 0, 0.1f },
                                 { 0, 0, 0.1f }, { 0.2f, 0, 0 }, { 1, 1, 1 } };
    const int32_t triangles[] = { 0, 2, 1, 0, 3, 2, 0, 2, 1, 0, 1, 2, 0, 1, 4 };
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = points;
    fabric.triangles = triangles;
    fabric.vertex_count = WISP_COUNT( points );
    fabric.triangle_count = WISP_COUNT( triangles ) / 3;
    fabric.hinges = true;
    for ( int b = 0; b < WISP_CLOTH_BENDING_COUNT; ++b )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.bending = (wisp_cloth_bending)b;
        cloth.drag_coefficient = cloth.lift_coefficient = cloth.internal_damping = 1.0f;
        int before = h->log.count;
        wisp_entity e = add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
        assert_int_equal( h->log.count, before + 1 );
        assert_one_message( h->log.last );
        run_steps( h->world, 100, 0.01f );
        assert_true( is_finite( h->world, e ) );
        assert_false( wisp_is_halted( h->world, e ) );
        const wisp_vec3 loose = point_of( h->world, e, 5 );
        assert_true( loose.x == 1.0f && loose.y == 1.0f && loose.z == 1.0f );
    }
}

WORLD_TEST( a_mesh_too_small_for_coarse_sheets_has_none )
{
    SCOPED( test_mesh_free )
    test_mesh mesh = triangle_mesh( ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 0, 0, 1 }, ( wisp_vec3 ){ 1, 0, 0 } );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.coarse_sheets = true;
    fabric.hinges = true;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.coarse_substeps = 3;
    cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
    assert_contains( h->log.last, "the fabric has no coarse sheets" );
    step( h->world );
    assert_int_equal( count_passes_named( h->world, "surface.levels" ), 0 );
    assert_int_equal( count_passes_named( h->world, "cloth.bending" ), 0 );
}

WORLD_TEST( who_asks_for_coarse_sheets_in_vain_is_told_once )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 30, 0.1f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_entity e = add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
    const int before = h->log.count;
    cloth.coarse_substeps = 1;
    for ( int i = 0; i < 2; ++i )
    {
        assert_status( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
        step( h->world );
        assert_int_equal( h->log.count, before + 1 );
        assert_contains( h->log.last, "the fabric has no coarse sheets" );
    }
}

// ---- refusals ----

static wisp_entity add_plain( hosted* h, bool cross, bool hinges, bool attached )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 4, 0.1f );
    const int32_t pin = 0;
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = cross;
    fabric.hinges = hinges;
    fabric.attachments = &pin;
    fabric.attachment_count = attached ? 1 : 0;
    return test_surface_of( h->world, &fabric, support_weightless_surface_def() );
}

static void assert_refused( hosted* h, wisp_entity e, const wisp_cloth_def* def, wisp_status expected,
                            const char* word )
{
    uint64_t before = wisp_world_hash( h->world );
    int passes = wisp_world_plan_passes( h->world );
    expect_refusal( h->world, wisp_set_cloth( h->world, e, def ), expected, word );
    assert_int_equal( wisp_world_hash( h->world ), before );
    assert_int_equal( wisp_world_plan_passes( h->world ), passes );
}

WORLD_TEST( coarse_sheets_need_xpbd )
{
    wisp_entity e = add_plain( h, true, true, false );
    wisp_cloth_def def = wisp_default_cloth_def();
    def.coarse_substeps = 1;
    def.solver = WISP_SOLVER_PBD;
    assert_refused( h, e, &def, WISP_CONFLICT, "coarse sheets need the solver xpbd" );
}

WORLD_TEST( directions_and_winds_are_finite )
{
    wisp_entity e = add_plain( h, true, true, false );
    const wisp_vec3 warps[] = { { 0 }, { NAN, 0.0f, 1.0f }, { 0.0f, INFINITY, 0.0f }, { 1e-7f, 0.0f, 0.0f } };
    for ( int i = 0; i < WISP_COUNT( warps ); ++i )
    {
        wisp_cloth_def def = wisp_default_cloth_def();
        def.warp = warps[i];
        assert_refused( h, e, &def, WISP_BAD_INPUT, "warp" );
    }
    const wisp_vec3 winds[] = { { NAN, 0.0f, 0.0f }, { 0.0f, 0.0f, -INFINITY }, { 1.1e5f, 0.0f, 0.0f } };
    wisp_cloth_def airy = wisp_default_cloth_def();
    airy.drag_coefficient = 1.0f;
    assert_status( h->world, wisp_set_cloth( h->world, e, &airy ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( winds ); ++i )
    {
        wisp_cloth_def def = airy;
        def.wind = winds[i];
        assert_refused( h, e, &def, WISP_BAD_INPUT, "wind" );
        assert_int_equal( wisp_set_cloth_wind( h->world, e, winds[i] ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( h->world ), "wind" ) );
    }
}

WORLD_TEST( a_fabric_must_have_what_the_cloth_needs )
{
    wisp_entity bare = add_plain( h, false, false, true ), loose = add_plain( h, true, true, false );
    wisp_cloth_def def = wisp_default_cloth_def();
    assert_refused( h, bare, &def, WISP_CONFLICT, "bend links" );
    def.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    assert_refused( h, bare, &def, WISP_CONFLICT, "hinges" );
    def.bending = WISP_CLOTH_BENDING_ISOMETRIC;
    assert_refused( h, bare, &def, WISP_CONFLICT, "hinges" );
    def.bending = WISP_CLOTH_BENDING_NONE;
    def.tethers = true;
    assert_refused( h, bare, &def, WISP_CONFLICT, "tethers" );
    assert_refused( h, loose, &def, WISP_CONFLICT, "attachments" );
    def.tethers = false;
    assert_status( h->world, wisp_set_cloth( h->world, bare, &def ), WISP_OK );
}
