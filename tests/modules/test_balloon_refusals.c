// Invalid balloons are rejected with one message that names the error, and the rejected call changes nothing.
#include "balloon_engine_fixture.h"

// Values that are wrong beside others; those that are wrong alone are in test_calls.c.
TEST( values_that_do_not_go_together_are_named_and_change_nothing )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    assert_int_equal( mesh.vertex_count, 42 );
    balloon_scene scene = balloon_scene_in_air( &mesh );
    SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
    const wisp_entity entities[] = { balloon_surface_add( world, &scene ), balloon_add( world, &scene ) };
    assert_int_equal( wisp_world_step( world, scene.dt ), WISP_OK );
    const uint64_t hash = wisp_world_hash( world );
    const int passes = wisp_world_plan_passes( world );
    const struct
    {
        const char* message;
        float gas_ratio, min_gas_ratio;
        int outlet_count;
        int32_t outlet[2];
    } bad[] = { { "gas_ratio: got 0.4,", 0.4f, 0.5f, 0, { 0 } },
                { "min_gas_ratio: got 1.5,", 2.0f, 1.5f, 0, { 0 } },
                { "outlet 0: got vertex 42,", 1.0f, 1.0f, 1, { 42 } },
                { "outlet 1: got vertex -1,", 1.0f, 1.0f, 2, { 0, -1 } } };
    for ( int n = 0; n < 2 * WISP_COUNT( bad ); ++n )
    {
        wisp_balloon_def d = scene.def;
        d.gas_ratio = bad[n / 2].gas_ratio, d.min_gas_ratio = bad[n / 2].min_gas_ratio;
        d.outlet_count = bad[n / 2].outlet_count;
        memcpy( d.outlet, bad[n / 2].outlet, sizeof bad[n / 2].outlet );
        expect_refusal( world, wisp_set_balloon( world, entities[n % 2], &d ), WISP_BAD_INPUT, bad[n / 2].message );
        assert_true( wisp_world_hash( world ) == hash );
        assert_int_equal( wisp_world_plan_passes( world ), passes );
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
