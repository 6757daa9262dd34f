// Invalid implicit cloth is rejected with one message that names the error; a rejection or a lack of memory changes
// nothing; all memory is returned; several cloths in a world, and one that changes during the simulation.
#include "saved_world.h"
#include "implicit_cloth_fixture.h"

static const float DT = 1.0f / 64.0f; // s

static wisp_entity add_plain( hosted* h )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 4, 0.125f );
    const int32_t pin = 0;
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = &pin;
    surface.pin_count = 1;
    return test_surface_of( h->world, &fabric, surface );
}

static void assert_refused( hosted* h, wisp_entity e, const wisp_implicit_cloth_def* def, wisp_status expected,
                            const char* word )
{
    const uint64_t before = wisp_world_hash( h->world );
    const int passes = wisp_world_plan_passes( h->world );
    expect_refusal( h->world, wisp_set_implicit_cloth( h->world, e, def ), expected, word );
    // the first call of a world allocates its list of cloths, which stays; later calls do not
    const size_t bytes = wisp_world_memory( h->world );
    const int64_t lent = atomic_load( &h->host.bytes );
    expect_refusal( h->world, wisp_set_implicit_cloth( h->world, e, def ), expected, word );
    assert_int_equal( wisp_world_hash( h->world ), before );
    assert_int_equal( wisp_world_plan_passes( h->world ), passes );
    assert_int_equal( wisp_world_memory( h->world ), bytes );
    assert_int_equal( atomic_load( &h->host.bytes ), lent );
}

// ---- pairs ----

IMPLICIT_TEST( a_pair_is_two_vertices_of_the_surface )
{
    wisp_entity e = add_plain( h );
    const int32_t bad[][2] = { { 3, 3 }, { -1, 0 }, { 0, 16 }, { INT32_MAX, 0 }, { 0, INT32_MIN } };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        int32_t pairs[4] = { 0, 1 };
        memcpy( pairs + 2, bad[i], sizeof( bad[i] ) );
        wisp_implicit_cloth_def def = linked_def();
        def.stretch_pairs = pairs;
        def.stretch_pair_count = 2;
        assert_refused( h, e, &def, WISP_BAD_INPUT, "stretch pair 1" );
        def = linked_def();
        def.bend_pairs = pairs;
        def.bend_pair_count = 2;
        assert_refused( h, e, &def, WISP_BAD_INPUT, "bend pair 1" );
    }
}

IMPLICIT_TEST( a_count_of_pairs_needs_a_list )
{
    wisp_entity e = add_plain( h );
    wisp_implicit_cloth_def def = linked_def();
    def.stretch_pair_count = 3;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "3 stretch pairs" );
    def.stretch_pair_count = 0;
    def.bend_pair_count = -1;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "-1 bend pairs" );
}

IMPLICIT_TEST( pairs_by_hand_have_no_area )
{
    static const int32_t PAIR[2] = { 0, 1 };
    wisp_entity e = add_plain( h );
    wisp_implicit_cloth_def def = linked_def();
    def.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
    def.stretch_pairs = PAIR;
    def.stretch_pair_count = 1;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "area" );
    def.stretch_pair_count = 0;
    def.stretch_pairs = NULL;
    assert_status( h->world, wisp_set_implicit_cloth( h->world, e, &def ), WISP_OK );
}

// Two vertices of two triangles that lie on each other at rest.
IMPLICIT_TEST( a_link_without_a_length_is_named )
{
    static const int32_t PAIR[2] = { 0, 3 };
    wisp_vec3 points[6] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
    int32_t triangles[6] = { 0, 1, 2, 3, 4, 5 };
    const test_mesh mesh = { points, triangles, 6, 2 };
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_entity e = test_surface_of( h->world, &fabric, support_weightless_surface_def() );
    wisp_implicit_cloth_def def = linked_def();
    def.stretch_pairs = PAIR;
    def.stretch_pair_count = 1;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "vertices 0 and 3" );
}

// ---- ownership ----

IMPLICIT_TEST( two_solvers_do_not_move_one_surface )
{
    const wisp_implicit_cloth_def def = linked_def();
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    wisp_entity e = add_plain( h );
    assert_status( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
    assert_refused( h, e, &def, WISP_CONFLICT, "it is a cloth" );
    wisp_entity limited = add_plain( h );
    assert_status( h->world, wisp_set_strain_limit( h->world, limited, 0.9f, 1.1f ), WISP_OK );
    assert_refused( h, limited, &def, WISP_CONFLICT, "strain limits" );
    assert_status( h->world, wisp_set_strain_limit( h->world, limited, 0.0f, INFINITY ), WISP_OK );
    assert_status( h->world, wisp_set_implicit_cloth( h->world, limited, &def ), WISP_OK );
    expect_refusal( h->world, wisp_set_strain_limit( h->world, limited, 0.9f, 1.1f ), WISP_CONFLICT,
                    "strain limits" );
    wisp_entity foreign = add_plain( h );
    assert_status( h->world, wisp_world_attach( h->world, foreign, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    assert_refused( h, foreign, &def, WISP_CONFLICT, "another solver" );
}

IMPLICIT_TEST( an_implicit_cloth_becomes_no_other_cloth_and_no_balloon )
{
    test_mesh mesh = test_ball( 1 );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = true;
    wisp_entity e = test_surface_of( h->world, &fabric, support_weightless_surface_def() );
    wisp_entity blown = test_surface_of( h->world, &fabric, support_weightless_surface_def() );
    test_mesh_free( &mesh );
    const wisp_implicit_cloth_def def = linked_def();
    set_implicit( h->world, e, &def );
    run_steps( h->world, 1, DT );
    const uint64_t before = wisp_world_hash( h->world );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    expect_refusal( h->world, wisp_set_cloth( h->world, e, &cloth ), WISP_CONFLICT, "solve" );
    const wisp_balloon_def balloon = wisp_default_balloon_def();
    expect_refusal( h->world, wisp_set_balloon( h->world, e, &balloon ), WISP_CONFLICT, "solve" );
    assert_int_equal( wisp_world_hash( h->world ), before );
    run_steps( h->world, 1, DT );
    assert_status( h->world, wisp_set_balloon( h->world, blown, &balloon ), WISP_OK );
    assert_refused( h, blown, &def, WISP_CONFLICT, "balloon" );
}

IMPLICIT_TEST( stats_are_there_from_the_step_after_asking )
{
    const wisp_implicit_cloth_def def = linked_def();
    wisp_implicit_cloth_stats stats;
    wisp_entity e = add_plain( h );
    assert_status( h->world, wisp_set_implicit_cloth( h->world, e, &def ), WISP_OK );
    run_steps( h->world, 1, DT );
    expect_refusal( h->world, wisp_read_implicit_cloth_stats( h->world, e, &stats ), WISP_CONFLICT, "statistics" );
    assert_status( h->world, wisp_request_implicit_cloth_stats( h->world, e, true ), WISP_OK );
    expect_refusal( h->world, wisp_read_implicit_cloth_stats( h->world, e, &stats ), WISP_CONFLICT, "statistics" );
    run_steps( h->world, 1, DT );
    assert_int_equal( stats_of( h->world, e ).newton_iterations, 1 );
    assert_status( h->world, wisp_request_implicit_cloth_stats( h->world, e, false ), WISP_OK );
    run_steps( h->world, 1, DT );
    assert_int_equal( count_passes_named( h->world, "implicit_cloth.stats" ), 0 );
    expect_refusal( h->world, wisp_read_implicit_cloth_stats( h->world, e, &stats ), WISP_CONFLICT, "statistics" );
}

// ---- memory ----

static uint64_t alone( const wisp_implicit_cloth_def* def, int n, int steps )
{
    SCOPED( close_world ) hosted h;
    open_implicit( &h, 1 );
    wisp_entity e = add_sheet( h.world, def, n, true );
    run_steps( h.world, steps, DT );
    return hash_of( h.world, e, WISP_SURFACE_POINTS );
}

IMPLICIT_TEST( a_removed_cloth_gives_its_memory_back )
{
    const wisp_implicit_cloth_def def = linked_def();
    wisp_entity stays = add_sheet( h->world, &def, 6, true );
    wisp_entity first = add_sheet( h->world, &def, 12, true ), second = add_sheet( h->world, &def, 12, true );
    run_steps( h->world, 2, DT );
    assert_status( h->world, wisp_remove( h->world, first ), WISP_OK );
    assert_status( h->world, wisp_remove( h->world, second ), WISP_OK );
    run_steps( h->world, 2, DT );
    const int64_t lent = atomic_load( &h->host.bytes );
    for ( int i = 0; i < 20; ++i )
    {
        wisp_entity e = add_sheet( h->world, &def, 12, true );
        run_steps( h->world, 1, DT );
        assert_true( atomic_load( &h->host.bytes ) > lent );
        assert_status( h->world, wisp_remove( h->world, e ), WISP_OK );
        run_steps( h->world, 1, DT );
        assert_int_equal( atomic_load( &h->host.bytes ), lent );
    }
    assert_true( is_finite( h->world, stays ) );
}

// ---- several, and changes ----

IMPLICIT_TEST( cloths_of_one_world_do_not_know_of_each_other )
{
    wisp_implicit_cloth_def soft = linked_def(), stiff = soft;
    stiff.stretch_stiffness = 2000.0f;
    stiff.weights = WISP_IMPLICIT_WEIGHTS_NONE;
    wisp_entity a = add_sheet( h->world, &soft, 9, true ), b = add_sheet( h->world, &stiff, 7, true );
    wisp_entity c = add_sheet( h->world, &stiff, 9, true );
    run_steps( h->world, 5, DT );
    assert_status( h->world, wisp_remove( h->world, a ), WISP_OK );
    run_steps( h->world, 5, DT );
    assert_int_equal( hash_of( h->world, b, WISP_SURFACE_POINTS ), alone( &stiff, 7, 10 ) );
    assert_int_equal( hash_of( h->world, c, WISP_SURFACE_POINTS ), alone( &stiff, 9, 10 ) );
    assert_int_equal( stats_of( h->world, b ).stretch_links, 2 * 7 * 6 + 6 * 6 );
}

// An instance has the mesh of its source and parameters of its own.
IMPLICIT_TEST( an_instance_is_a_cloth_of_its_own )
{
    wisp_implicit_cloth_def def = linked_def();
    wisp_entity source = add_sheet( h->world, &def, 9, true ), twin;
    const int32_t pins[2] = { 0, 8 };
    assert_status( h->world, wisp_add_instance( h->world, source, NULL, &twin ), WISP_OK );
    assert_status( h->world, wisp_pin( h->world, twin, pins, 2 ), WISP_OK );
    assert_status( h->world, wisp_set_gravity( h->world, twin, EARTH ), WISP_OK );
    set_implicit( h->world, twin, &def );
    run_steps( h->world, 10, DT );
    assert_int_equal( hash_of( h->world, source, WISP_SURFACE_POINTS ),
                      hash_of( h->world, twin, WISP_SURFACE_POINTS ) );
    assert_status( h->world, wisp_remove( h->world, source ), WISP_OK );
    run_steps( h->world, 10, DT );
    assert_int_equal( hash_of( h->world, twin, WISP_SURFACE_POINTS ), alone( &def, 9, 20 ) );
}

IMPLICIT_TEST( a_cloth_can_be_changed_while_it_moves )
{
    wisp_implicit_cloth_def def = exact_def();
    def.link_damping = 0.2f;
    wisp_entity e = add_chain( h->world, &def, 3, 0.01f, NULL );
    assert_status( h->world, wisp_set_gravity( h->world, e, EARTH ), WISP_OK );
    const float stiffness[3] = { 200.0f, 50.0f, 200.0f };
    size_t bytes = 0;
    for ( int i = 0; i < 3; ++i )
    {
        def.stretch_stiffness = stiffness[i];
        def.integrator = i == 1 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
        assert_status( h->world, wisp_set_implicit_cloth( h->world, e, &def ), WISP_OK );
        run_steps( h->world, 600, 0.01f );
        // vertex 1 carries two and a half: the last one counts half; positions are rounded by 1.5e-8 m
        const double stretch = 2.5 * 0.01 * 9.81 / (double)stiffness[i];
        assert_near( (double)point_of( h->world, e, 1 ).y, -(double)CHAIN_LINK - stretch, 1e-7 );
        assert_int_equal( stats_of( h->world, e ).stretch_links, 3 ); // still requested
        bytes = i == 0 ? wisp_world_memory( h->world ) : bytes;
    }
    assert_int_equal( wisp_world_memory( h->world ), bytes );
}
