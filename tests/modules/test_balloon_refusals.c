// Invalid balloons are rejected with one message that names the error, and the rejected call changes nothing.
#include "balloon_engine_fixture.h"

// X( what the message must name, the statement that breaks a definition )
#define BROKEN_DEFS( X )                                                                                             \
    X( "solver: got 2,", d->solver = WISP_SOLVER_COUNT )                                                             \
    X( "edge_stiffness: got 0,", d->edge_stiffness = 0.0f )                                                          \
    X( "edge_stiffness: got -7,", d->edge_stiffness = -7.0f )                                                        \
    X( "edge_stiffness: got 2e+12,", d->edge_stiffness = 2e12f )                                                     \
    X( "edge_stiffness: got", d->edge_stiffness = NAN )                                                              \
    X( "bend_link_stiffness: got 0,", d->bend_link_stiffness = 0.0f )                                                \
    X( "bend_link_stiffness: got inf,", d->bend_link_stiffness = INFINITY )                                          \
    X( "stretch_stiffness: got 1.1,", d->stretch_stiffness = 1.1f )                                                  \
    X( "bend_stiffness: got -0.1,", d->bend_stiffness = -0.1f )                                                      \
    X( "volume: got 2,", d->volume = WISP_SOLVER_COUNT )                                                             \
    X( "volume_stiffness: got 0,", d->volume_stiffness = 0.0f )                                                      \
    X( "volume_stiffness: got 1.5,", d->volume_stiffness = 1.5f )                                                    \
    X( "gas_ratio: got 0,", d->gas_ratio = 0.0f )                                                                    \
    X( "gas_ratio: got 0.99,", d->gas_ratio = 0.99f )                                                                \
    X( "gas_ratio: got 0.4,", ( d->gas_ratio = 0.4f, d->min_gas_ratio = 0.5f ) )                                     \
    X( "gas_ratio: got", d->gas_ratio = NAN )                                                                        \
    X( "inflation_rate: got inf,", d->inflation_rate = INFINITY )                                                    \
    X( "min_gas_ratio: got 0,", d->min_gas_ratio = 0.0f )                                                            \
    X( "min_gas_ratio: got 1.5,", ( d->min_gas_ratio = 1.5f, d->gas_ratio = 2.0f ) )                                 \
    X( "atmospheric_pressure: got 0,", d->atmospheric_pressure = 0.0f )                                              \
    X( "temperature: got -1,", d->temperature = -1.0f )                                                              \
    X( "gas_molar_mass: got 0,", d->gas_molar_mass = 0.0f )                                                          \
    X( "air_molar_mass: got 11,", d->air_molar_mass = 11.0f )                                                        \
    X( "drag_coefficient: got -0.5,", d->drag_coefficient = -0.5f )                                                  \
    X( "drag_coefficient: got", d->drag_coefficient = NAN )                                                          \
    X( "outlet_count: got -1,", d->outlet_count = -1 )                                                               \
    X( "outlet_count: got 65,", d->outlet_count = WISP_BALLOON_MAX_OUTLET + 1 )                                      \
    X( "outlet_area: got 0,", d->outlet_area = 0.0f )                                                                \
    X( "outlet 0: got vertex 42,", ( d->outlet_count = 1, d->outlet[0] = 42 ) )                                      \
    X( "outlet 1: got vertex -1,", ( d->outlet_count = 2, d->outlet[1] = -1 ) )

#define BROKEN_TYPE wisp_balloon_def
#include "broken_defs.h"

TEST( a_value_out_of_range_is_named_and_changes_nothing )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    assert_int_equal( mesh.vertex_count, 42 );
    // a surface that is no balloon yet, and one that is
    for ( int balloon = 0; balloon <= 1; ++balloon )
    {
        balloon_scene scene = balloon_scene_in_air( &mesh );
        SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
        wisp_entity entity = balloon == 1 ? balloon_add( world, &scene ) : balloon_surface_add( world, &scene );
        assert_int_equal( wisp_world_step( world, scene.dt ), WISP_OK );
        uint64_t hash = wisp_world_hash( world );
        int passes = wisp_world_plan_passes( world );
        for ( int n = 0; n < BROKEN_COUNT; ++n )
        {
            wisp_balloon_def bad = scene.def;
            const char* expected = break_def( n, &bad );
            expect_refusal( world, wisp_set_balloon( world, entity, &bad ), WISP_BAD_INPUT, expected );
            assert_true( wisp_world_hash( world ) == hash );
            assert_int_equal( wisp_world_plan_passes( world ), passes );
        }
    }
}

TEST( the_ends_of_every_range_are_accepted_and_give_numbers )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    for ( int upper = 0; upper <= 1; ++upper )
    {
        balloon_scene scene = balloon_scene_in_air( &mesh );
        wisp_balloon_def* d = &scene.def;
        d->edge_stiffness = d->bend_link_stiffness = upper ? 1e12f : 1e-6f;
        d->stretch_stiffness = d->bend_stiffness = upper ? 1.0f : 0.0f;
        d->volume_stiffness = upper ? 1.0f : 1e-6f;
        d->min_gas_ratio = upper ? 1.0f : 1e-3f;
        d->gas_ratio = upper ? 1.0f : 1e-3f;
        d->atmospheric_pressure = upper ? 1e7f : 1e-3f;
        d->drag_coefficient = upper ? 1e6f : 0.0f;
        d->outlet_count = upper ? WISP_BALLOON_MAX_OUTLET : 0;
        for ( int i = 0; i < d->outlet_count; ++i )
        {
            d->outlet[i] = i % mesh.vertex_count;
        }
        d->outlet_open = true;
        for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
        {
            d->solver = d->volume = (wisp_solver)solver;
            SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
            balloon_steps( &flight, 5 );
            assert_true( balloon_is_finite( &flight ) );
        }
    }
}

// ---- meshes ----

static void refuse_mesh( const balloon_mesh* mesh, const char* named )
{
    balloon_scene scene = balloon_scene_of( mesh );
    SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
    wisp_entity entity = balloon_surface_add( world, &scene );
    uint64_t hash = wisp_world_hash( world );
    expect_refusal( world, wisp_set_balloon( world, entity, &scene.def ), WISP_BAD_INPUT, named );
    assert_true( wisp_world_hash( world ) == hash );
    expect_refusal( world, wisp_request_balloon_stats( world, entity, true ), WISP_CONFLICT, "is not a balloon" );
    assert_int_equal( wisp_world_step( world, scene.dt ), WISP_OK );
}

// A strip of three triangles turned once: one-sided, with a border; and a closed one-sided shell, in which two
// triangles must run along some edge in the same direction.
TEST( a_one_sided_mesh_encloses_nothing )
{
    double3 strip[5] = {
        { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.2 }, { 0.5, 1.0, 0.0 }, { 1.5, 1.0, 0.5 }, { 1.0, 0.5, 1.0 }
    };
    int moebius[15] = { 0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 0, 4, 4, 0, 1 };
    balloon_mesh mesh = { 5, 5, strip, moebius };
    refuse_mesh( &mesh, "got 5 open edges" );

    // the projective plane of six vertices
    double3 six[6];
    for ( int i = 0; i < 6; ++i )
    {
        six[i] = double3_make( i == 0, 0.3 * i, 0.1 * i * i );
    }
    int plane[30] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1, 1, 2, 4, 2, 3, 5, 3, 4, 1, 4, 5, 2, 5, 1, 3 };
    balloon_mesh projective = { 6, 10, six, plane };
    refuse_mesh( &projective, "in at most two triangles of equal winding" );
}

TEST( an_edge_of_four_triangles_is_no_skin )
{
    // two tetrahedra that have only an edge in common
    double3 points[6] = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 1.0 },  { 1.0, 0.0, 0.5 },
                          { 1.0, 1.0, 0.5 }, { -1.0, 0.0, 0.5 }, { -1.0, -1.0, 0.5 } };
    int triangles[24] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 4, 1, 0, 1, 5, 0, 5, 4, 1, 4, 5 };
    balloon_mesh mesh = { 6, 8, points, triangles };
    refuse_mesh( &mesh, "got 1 nonmanifold edges" );
}

TEST( two_shells_are_two_balloons )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh one = balloon_sphere( 1, 0.15 ), both;
    assert_true( balloon_mesh_join( &both, &one, &one, double3_make( 1.0, 0.0, 0.0 ) ) );
    refuse_mesh( &both, "got 2 components" );
}

TEST( an_inside_out_mesh_is_told_which_way_to_run )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        int kept = mesh.triangles[3 * t + 1];
        mesh.triangles[3 * t + 1] = mesh.triangles[3 * t + 2];
        mesh.triangles[3 * t + 2] = kept;
    }
    refuse_mesh( &mesh, "counter-clockwise" );
}

TEST( a_flattened_mesh_encloses_nothing )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.positions[v].z = 0.0;
    }
    refuse_mesh( &mesh, "enclosed volume of 0 m^3" );
}

// ---- calls ----

TEST( calls_that_a_balloon_is_not_ready_for_are_refused )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    balloon_scene scene = balloon_scene_of( &mesh );
    SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
    wisp_entity surface = balloon_surface_add( world, &scene );
    wisp_balloon_stats stats;
    assert_int_equal( wisp_set_balloon( world, surface, &scene.def ), WISP_OK );
    expect_refusal( world, wisp_open_balloon( world, surface, true ), WISP_CONFLICT, "has no outlet" );
    expect_refusal( world, wisp_read_balloon_stats( world, surface, &stats ), WISP_CONFLICT, "has no statistics" );
    assert_int_equal( wisp_request_balloon_stats( world, surface, true ), WISP_OK );
    expect_refusal( world, wisp_read_balloon_stats( world, surface, &stats ), WISP_CONFLICT, ", then step" );
    expect_refusal( world, wisp_set_balloon_gas_ratio( world, surface, 0.5f ), WISP_BAD_INPUT,
                    "gas_ratio: got 0.5," );
    expect_refusal( world, wisp_set_balloon_gas_ratio( world, surface, NAN ), WISP_BAD_INPUT, "gas_ratio: got" );
    expect_refusal( world, wisp_set_balloon_inflation( world, surface, NAN ), WISP_BAD_INPUT, "inflation_rate: got" );
}
