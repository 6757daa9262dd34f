// The passes of each switch, balloons that a scene should not contain (collapsed, flat, NaN), and memory.
#include "balloon_engine_fixture.h"
#include "plan_says.h"

// ---- switches ----

// The name of a pass, and the flags of the scenes below in which it runs.
typedef struct pass_row
{
    const char* pass;
    const char* scenes; // of "bare air outlet rate pbd", one letter each: b a o r d
} pass_row;

static const pass_row PASSES[] = {
    { "balloon.volume", "baord" }, { "balloon.measure", "ao" }, { "balloon.body", "ao" },
    { "balloon.inflate", "r" },    { "balloon.pressure", "o" }, { "balloon.outlet", "o" },
    { "balloon.jet", "o" },        { "balloon.spin", "o" },     { "balloon.drag", "a" },
    { "balloon.buoyancy", "a" },   { "balloon.stats", "" },     { "balloon.angular", "baord" },
    { "links.xpbd", "baor" },      { "links.pbd", "d" },        { "particles.gravity", "a" },
};

static balloon_scene lettered_scene( const balloon_mesh* mesh, char letter )
{
    balloon_scene scene = letter == 'a' ? balloon_scene_in_air( mesh ) : balloon_scene_of( mesh );
    if ( letter == 'o' )
    {
        balloon_scene_give_outlet( &scene, 3, true );
    }
    scene.def.inflation_rate = letter == 'r' ? 1e-3f : 0.0f;
    scene.def.solver = letter == 'd' ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    return scene;
}

TEST( a_pass_exists_only_where_something_asks_for_it )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 1 );
    for ( const char* letter = "baord"; *letter != 0; ++letter )
    {
        balloon_scene scene = lettered_scene( &mesh, *letter );
        SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
        wisp_entity entity = balloon_surface_add( world, &scene );
        assert_int_equal( wisp_set_balloon( world, entity, &scene.def ), WISP_OK );
        assert_int_equal( wisp_request( world, entity, WISP_SURFACE_POINTS ), WISP_OK );
        for ( int i = 0; i < WISP_COUNT( PASSES ); ++i )
        {
            bool expected = strchr( PASSES[i].scenes, *letter ) != NULL;
            if ( plan_says( world, PASSES[i].pass, "wave" ) != expected )
            {
                fail_msg( "scene '%c': pass %s is %s", *letter, PASSES[i].pass, expected ? "missing" : "there" );
            }
        }
        assert_int_equal( wisp_world_step( world, scene.dt ), WISP_OK );
    }
}

TEST( switches_may_be_changed_in_flight_and_passes_go_with_them )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 1 );
    balloon_scene scene = balloon_scene_in_air( &mesh ), still = balloon_scene_of( &mesh );
    scene.def.gas_ratio = 1.2f;
    balloon_scene_give_outlet( &scene, 3, true );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 5 );
    wisp_balloon_stats f = balloon_read( &flight );
    assert_true( f.gas_lost > 0.0 && double3_length( balloon_from( f.drag ) ) > 0.0 );
    assert_int_equal( wisp_set_balloon( flight.world, flight.entity, &still.def ), WISP_OK );
    const char* const gone[] = { "balloon.outlet", "balloon.jet", "balloon.spin", "balloon.drag",
                                 "balloon.buoyancy" };
    for ( int i = 0; i < WISP_COUNT( gone ); ++i )
    {
        assert_false( plan_says( flight.world, gone[i], "wave" ) );
    }
    balloon_steps( &flight, 5 );
    f = balloon_read( &flight );
    // no value of the earlier jet is reported
    assert_true( f.gas_lost == 0.0 && f.mass_flow == 0.0 && f.outlet_speed == 0.0 && f.jet_starts == 0.0 );
    assert_true( double3_length( balloon_from( f.jet ) ) + double3_length( balloon_from( f.drag ) ) == 0.0 );
    assert_int_equal( wisp_set_balloon_inflation( flight.world, flight.entity, 1e-3f ), WISP_OK );
    assert_true( plan_says( flight.world, "balloon.inflate", "wave" ) );
    assert_int_equal( wisp_set_balloon_inflation( flight.world, flight.entity, 0.0f ), WISP_OK );
    assert_false( plan_says( flight.world, "balloon.inflate", "wave" ) );
    assert_int_equal( wisp_set_balloon_gas_ratio( flight.world, flight.entity, 1.5f ), WISP_OK );
    balloon_steps( &flight, 1 );
    f = balloon_read( &flight );
    balloon_assert_fraction( f.target_volume, 1.5 * f.rest_volume, 1e-12 );
}

// ---- guards ----

TEST( a_collapsed_balloon_stays_finite_and_its_outlet_silent )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 2, 0.15 );
    const int32_t pin = 7;
    for ( int n = 0; n < 2; ++n )
    {
        balloon_scene scene = balloon_scene_in_air( &mesh );
        scene.def.solver = scene.def.volume = n == 0 ? WISP_SOLVER_XPBD : WISP_SOLVER_PBD;
        scene.pins = &pin;
        scene.pin_count = 1;
        balloon_scene_give_outlet( &scene, 3, true );
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        float* x = balloon_positions( &flight );
        for ( int i = 0; i < 4 * mesh.vertex_count; ++i )
        {
            x[i] = i % 4 == 3 ? x[i] : 0.0f;
        }
        balloon_steps( &flight, 20 );
        assert_true( balloon_is_finite( &flight ) );
        wisp_balloon_stats f = balloon_read( &flight );
        // a point has no direction to grow; Eq. 9 uses the smallest allowed volume
        balloon_assert_fraction( f.volume, 1e-3 * f.rest_volume, 1e-12 );
        assert_true( f.mass_flow == 0.0 && f.outlet_speed == 0.0 && f.gas_lost == 0.0 );
        assert_true( isfinite( f.pressure ) );
    }
}

// Two vertices at one position: an edge without length, two triangles without area.
TEST( edges_without_length_and_triangles_without_area_do_no_harm )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 2, 0.15 );
    mesh.positions[mesh.triangles[1]] = mesh.positions[mesh.triangles[0]];
    balloon_scene scene = balloon_scene_in_air( &mesh );
    scene.def.gas_ratio = 1.2f;
    balloon_scene_give_outlet( &scene, mesh.triangles[1], true );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 1 );
    assert_true( balloon_read( &flight ).rest_volume > 0.01 );
    balloon_steps( &flight, 30 );
    assert_true( balloon_is_finite( &flight ) );
}

// ---- several, and one that breaks ----

TEST( balloons_in_one_world_fly_as_if_they_were_alone )
{
    balloon_mesh meshes[3] = { balloon_pear( 2 ), balloon_sphere( 1, 0.15 ), balloon_pear( 4 ) };
    balloon_scene scenes[3];
    wisp_entity together[3];
    for ( int n = 0; n < 3; ++n )
    {
        scenes[n] = n == 1 ? balloon_scene_of( meshes + n ) : balloon_scene_in_air( meshes + n );
        scenes[n].def.gas_ratio = 1.1f + 0.1f * (float)n;
        scenes[n].def.solver = n == 1 ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
        if ( n != 1 )
        {
            balloon_scene_give_outlet( scenes + n, 5, true );
        }
    }
    for ( int workers = 1; workers <= 3; workers += 2 )
    {
        scenes[0].workers = workers;
        SCOPED( destroy_local ) wisp_world* world = balloon_world_create( scenes );
        for ( int n = 0; n < 3; ++n )
        {
            together[n] = balloon_add( world, scenes + n );
        }
        for ( int n = 0; n < 10; ++n )
        {
            assert_int_equal( wisp_world_step( world, scenes[0].dt ), WISP_OK );
        }
        for ( int n = 0; n < 3; ++n )
        {
            const balloon_flight flight = { world, together[n], scenes + n };
            SCOPED( balloon_end ) balloon_flight alone = balloon_start( scenes + n );
            balloon_steps( &alone, 10 );
            assert_true( balloon_hash( &alone ) == balloon_hash( &flight ) );
            assert_true( balloon_read( &alone ).gas_lost == balloon_read( &flight ).gas_lost );
        }
    }
    for ( int n = 0; n < 3; ++n )
    {
        balloon_mesh_destroy( meshes + n );
    }
}

TEST( a_nan_halts_its_balloon_alone_and_what_is_kept_of_it_stays_a_number )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    for ( int n = 0; n < 2; ++n )
    {
        balloon_scene scene = balloon_scene_in_air( &mesh );
        scene.def.gas_ratio = 1.2f;
        balloon_scene_give_outlet( &scene, 5, true );
        balloon_flight bad, alone;
        bad = balloon_start( &scene );
        const balloon_flight good = { bad.world, balloon_add( bad.world, &scene ), &scene };
        balloon_steps( &bad, 3 );
        uint64_t before = balloon_hash( &bad );
        balloon_velocities( &bad )[4] = n == 0 ? NAN : INFINITY;
        balloon_steps( &bad, 2 );
        assert_true( wisp_is_halted( bad.world, bad.entity ) );
        assert_false( wisp_is_halted( bad.world, good.entity ) );
        assert_true( balloon_hash( &bad ) == before );

        alone = balloon_start( &scene );
        balloon_steps( &alone, 5 );
        assert_true( balloon_hash( &alone ) == balloon_hash( &good ) );
        balloon_end( &alone );

        // and once it is released, it continues
        assert_int_equal( wisp_resume( bad.world, bad.entity ), WISP_OK );
        balloon_steps( &bad, 5 );
        assert_true( balloon_is_finite( &bad ) && balloon_hash( &bad ) != before );
        wisp_balloon_stats f = balloon_read( &bad ), g = balloon_read( &good );
        // no gas has left while its state was NaN, nor while it was halted
        assert_true( f.gas_lost <= g.gas_lost );
        const double numbers[] = {
            f.target_volume,       f.volume,    f.pressure, f.gas_lost, f.orientation[0], f.orientation[3],
            f.angular_velocity[0], f.centre[0], f.jet[0]
        };
        for ( int i = 0; i < WISP_COUNT( numbers ); ++i )
        {
            assert_true( isfinite( numbers[i] ) );
        }
        balloon_end( &bad );
    }
}
