// Cloth in C: air and gusts that change, coarse sheets, and what is refused with one message that names the error and changes
// nothing. What theory says of cloth is in tests/claims.
#include "boundary_fixture.h"
#include "boundary_oracle_fixture.h"
#include "cloth_fixture.h"

#include "implicit_cloth.h"
#include "membrane.h"
#include "tearing.h"

// ---- coarse sheets ----

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

// ---- bending ----

WORLD_TEST( bending_that_is_chosen_brings_its_pass_and_no_other )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    wisp_entity e = add_cloth( h->world, &fabric, support_weightless_surface_def(), &cloth, EARTH );
    static const wisp_cloth_bending KINDS[] = { WISP_CLOTH_BENDING_DIHEDRAL, WISP_CLOTH_BENDING_ISOMETRIC };
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

// Bends two cloths, of one fabric or of two, and lets one of them go. @return bytes of the world before that, and its hash at the end
static size_t bend_two( int fabric_count, uint64_t* hash )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 4, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 30, 0.1f );
    const int32_t pins[] = { 0, 29 };
    wisp_fabric_def fabric_def = test_fabric_def( &mesh );
    fabric_def.hinges = true;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    wisp_fabric* fabric = NULL;
    wisp_entity e[2];
    for ( int i = 0; i < 2; ++i )
    {
        wisp_error error = { 0 };
        if ( i < fabric_count )
        {
            wisp_fabric_release( fabric );
            assert_int_equal( wisp_fabric_cook( &fabric_def, NULL, &fabric, &error ), WISP_OK );
        }
        wisp_surface_def surface = support_weightless_surface_def();
        surface.fabric = fabric;
        surface.pins = pins;
        surface.pin_count = WISP_COUNT( pins );
        assert_status( h.world, wisp_add_surface( h.world, &surface, e + i ), WISP_OK );
        assert_status( h.world, wisp_set_cloth( h.world, e[i], &cloth ), WISP_OK );
        assert_status( h.world, wisp_set_gravity( h.world, e[i], EARTH ), WISP_OK );
    }
    wisp_fabric_release( fabric );
    run_steps( h.world, 3, 0.01f );
    const size_t bytes = wisp_world_memory( h.world );
    assert_status( h.world, wisp_unpin( h.world, e[1], pins, 1 ), WISP_OK );
    run_steps( h.world, 10, 0.01f );
    *hash = wisp_world_hash( h.world );
    return bytes;
}

TEST( cloths_of_a_fabric_share_what_bends_them_until_their_pins_differ )
{
    uint64_t together, apart;
    const size_t shared = bend_two( 1, &together ), single = bend_two( 2, &apart );
    assert_true( shared + 900 * 200 < single );
    assert_true( together == apart );
}

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

WORLD_TEST( a_wind_is_finite )
{
    wisp_entity e = add_plain( h, true, true, false );
    wisp_cloth_def airy = wisp_default_cloth_def();
    airy.drag_coefficient = 1.0f;
    assert_status( h->world, wisp_set_cloth( h->world, e, &airy ), WISP_OK );
    const wisp_vec3 winds[] = { { NAN, 0.0f, 0.0f }, { 0.0f, 0.0f, -INFINITY }, { 1.1e5f, 0.0f, 0.0f } };
    for ( int i = 0; i < WISP_COUNT( winds ); ++i )
    {
        expect_refusal( h->world, wisp_set_cloth_wind( h->world, e, winds[i] ), WISP_BAD_INPUT, "cloth: wind" );
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

TEST( membranes_that_cannot_be_are_refused )
{
    static const wisp_module* const MODULES[] = { &wisp_membrane_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_tearing_module };
    SCOPED( close_local ) hosted* h = new_hosted( MODULES, WISP_COUNT( MODULES ), 2, 1, 1 );
    wisp_world* w = h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = test_ball( 1 );
    const wisp_surface_def surface = support_weightless_surface_def();
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity e = test_surface_of( w, &fabric, surface );
    wisp_membrane_def def = wisp_default_membrane_def();
    assert_status( w, wisp_set_membrane( w, e, &def ), WISP_OK );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    expect_refusal( w, wisp_set_cloth( w, e, &cloth ), WISP_CONFLICT, "bending by links" );
    const wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
    expect_refusal( w, wisp_set_implicit_cloth( w, e, &implicit ), WISP_CONFLICT, "membrane" );
    wisp_tearing_def tearing = wisp_default_tearing_def();
    tearing.strength = 1.0f;
    expect_refusal( w, wisp_set_tearing( w, e, &tearing ), WISP_CONFLICT, "is no cloth" );
    const wisp_entity linked = test_surface_of( w, &fabric, surface );
    assert_status( w, wisp_set_cloth( w, linked, &cloth ), WISP_OK );
    expect_refusal( w, wisp_set_membrane( w, linked, &def ), WISP_CONFLICT, "before cloth or balloon" );
    assert_status( w, wisp_set_membrane( w, e, NULL ), WISP_OK );
    assert_status( w, wisp_set_cloth( w, e, &cloth ), WISP_OK );
    run_steps( w, 1, 1.0f / 60.0f );
}
