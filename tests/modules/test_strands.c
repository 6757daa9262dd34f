// Moving strands, end to end: they hang, stay in balance, follow their head or surface, reject invalid input, and
// have the same bits for every number of workers.
#include "saved_world.h"
#include "strands_fixture.h"

static const float FRAME = 1.0f / 60.0f;
static const wisp_transform NOWHERE = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };

static wisp_strand_dynamics_def default_def( void )
{
    return undamped_hair();
}

// ---- lengths and shapes ----

TEST( a_strand_hangs_and_stays_at_rest_length )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 1, 1, 1 );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 17, 20, straight_down, 0.1f, &def );
    assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
    strand_steps( s.world, 60, FRAME );
    // a hanging strand is in balance; the remainder is rounding of the positions, 1e-8 m
    assert_true( drift_from( s.world, e, 17, 20, straight_down, 0.1f ) < 1e-6 );
    assert_true( motion_stats_of( s.world, e ).strain_max < 1e-5 );
}

TEST( falling_strands_of_different_lengths_keep_them )
{
    const int counts[] = { 20, 3, 1, 0, 12, 2, 20 };
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    def.bending = WISP_STRAND_BEND_NONE;
    const wisp_entity e = add_strands( s.world, counts, WISP_COUNT( counts ), straight_out, 0.1f );
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
    for ( int i = 0; i < 60; ++i )
    {
        strand_steps( s.world, 1, FRAME );
        // the definition's tolerance; strands beyond it are reset exactly
        assert_true( motion_stats_of( s.world, e ).strain_max < 1.1e-3 );
    }
    // half a metre per second at least: they do fall
    assert_true( motion_stats_of( s.world, e ).speed_max > 0.5 );
}

TEST( curls_that_are_not_balanced_sag )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 8, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    def.rest = WISP_STRAND_REST_SHAPE;
    const wisp_entity e = add_moving( s.world, 20, 20, curl_down, 0.1f, &def );
    strand_steps( s.world, 60, FRAME );
    assert_true( drift_from( s.world, e, 20, 20, curl_down, 0.1f ) > 1e-3 );
}

TEST( every_way_to_stretch_and_bend_steps_and_hangs )
{
    for ( int k = 0; k < WISP_STRAND_STRETCH_COUNT * WISP_STRAND_BEND_COUNT * 4; ++k )
    {
        SCOPED( close_world ) hosted s;
        open_strands( &s, 4, 1 + k / 6 % 2, 1 );
        wisp_strand_dynamics_def def = default_def();
        def.stretch = (wisp_strand_stretch)( k % 2 );
        def.bending = (wisp_strand_bend)( k / 2 % 3 );
        def.solver = k / 12 == 0 ? WISP_SOLVER_XPBD : WISP_SOLVER_PBD;
        def.damping = 1.0f;
        def.drag_coefficient = 1.0f;
        def.rest = WISP_STRAND_REST_STRAIGHT;
        const wisp_entity e = add_moving( s.world, 18, 5, straight_down, 0.1f, &def );
        strand_steps( s.world, 30, FRAME );
        // one sweep of links leaves 2 % at most on four segments: g dt^2 / l per substep, not quite removed
        assert_true( drift_from( s.world, e, 18, 5, straight_down, 0.1f ) < 0.02 * 0.1 );
        assert_false( wisp_is_halted( s.world, e ) );
    }
}

TEST( tension_at_the_root_is_the_weight )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 1, 1 );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 3, 20, straight_down, 0.1f, &def );
    strand_steps( s.world, 30, FRAME );
    float tension[60];
    assert_int_equal( wisp_read_strand_tension( s.world, e, tension ), WISP_OK );
    // the root itself carries its own half of the first segment
    const double weight = 9.81 * 6.5e-6 * 0.1 * ( 1.0 - 0.5 / 19.0 );
    // positions are rounded to 4e-9 m, equivalent to a hundredth of a segment's weight at 1/240 s; a clamp that is
    // stretched in the first step of 1/60 s would carry a part of it
    assert_true( fabs( (double)tension[0] / weight - 1.0 ) < 1e-2 );
    assert_true( tension[19] == 0.0f );
}

// A falling strand has another tension in every substep: that of the last one is read, as if each were a step.
TEST( tension_is_that_of_the_last_substep )
{
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        float tension[2][18 * 8];
        for ( int k = 0; k < 2; ++k )
        {
            SCOPED( close_world ) hosted s;
            open_strands( &s, k == 0 ? 4 : 1, iterations, 1 );
            wisp_strand_dynamics_def def = default_def();
            def.bending = WISP_STRAND_BEND_LINKS;
            def.rest = WISP_STRAND_REST_STRAIGHT;
            const wisp_entity e = add_moving( s.world, 18, 8, straight_out, 0.1f, &def );
            strand_steps( s.world, k == 0 ? 5 : 20, k == 0 ? 1.0f / 64.0f : 1.0f / 256.0f );
            assert_int_equal( wisp_read_strand_tension( s.world, e, tension[k] ), WISP_OK );
        }
        assert_true( tension[0][0] > 0.0f );
        assert_memory_equal( tension[0], tension[1], sizeof( tension[0] ) );
    }
}

// Groups run all their substeps at once; in each step another one of them is timed.
TEST( every_pass_of_strands_has_its_time_in_every_step )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 3, 2, 1 );
    const wisp_strand_dynamics_def def = default_def();
    add_moving( s.world, 160, 20, straight_out, 0.1f, &def );
    for ( int step = 0; step < 4; ++step )
    {
        strand_steps( s.world, 1, FRAME );
        const wisp_profile p = wisp_world_profile( s.world );
        double sum = 0.0;
        for ( int i = 0; i < p.count; ++i )
        {
            assert_true( p.lines[i].items == 0 || p.lines[i].seconds > 0.0 );
            sum += p.lines[i].seconds;
        }
        assert_true( p.count > 4 && sum <= p.seconds * ( 1.0 + 1e-12 ) );
    }
}

static wisp_vec3 doubled_out( int strand, int i, int count, float length )
{
    // the first strand has its third vertex twice and thrice, the second has no length at all
    const int at = strand == 0 && i > 2 ? ( i < 5 ? 2 : i - 2 ) : i;
    return straight_out( strand, strand == 1 ? 0 : at, count, length );
}

TEST( vertices_on_top_of_each_other_and_strands_without_length_are_no_trouble )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 1, 1 );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 3, 12, doubled_out, 0.1f, &def );
    const wisp_transform pose = { NOWHERE.rotation, { 0.0f, 0.05f, 0.0f } };
    assert_int_equal( wisp_move_strand_head( s.world, e, pose ), WISP_OK );
    strand_steps( s.world, 60, FRAME );
    assert_false( wisp_is_halted( s.world, e ) );
    const wisp_vec3* p = strand_points( s.world, e );
    double length = 0.0;
    for ( int v = 1; v < 12; ++v )
    {
        length += vec_distance( p[v], p[v - 1] );
        // the strand without a length follows its root
        assert_true( fabsf( p[12 + v].y - 0.05f ) < 1e-7f );
    }
    // segments without a length get a thousandth of the mean one, two of them here
    assert_true( fabs( length / ( 0.1 * 9.0 / 11.0 ) - 1.0 ) < 5e-3 );
}

TEST( changing_how_strands_move_leaves_them_where_they_are )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 2, 1 );
    wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 5, 10, straight_out, 0.1f, &def );
    for ( int k = 0; k < 12; ++k )
    {
        wisp_vec3 before[50];
        strand_steps( s.world, 3, FRAME );
        memcpy( before, strand_points( s.world, e ), sizeof( before ) );
        // links for a short step only: what they stretch in a long one would be corrected at once
        def.stretch = k % 2 == 0 ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT;
        def.bending = ( k + 1 ) / 3 % 2 == 0 ? WISP_STRAND_BEND_ROD : WISP_STRAND_BEND_NONE;
        def.rest = (wisp_strand_rest)( k % 2 * 2 );
        def.damping = (float)( k % 2 );
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
        strand_steps( s.world, 1, 1e-5f );
        for ( int v = 0; v < 50; ++v )
        {
            // nothing here is faster than 10 m/s
            assert_true( vec_distance( strand_points( s.world, e )[v], before[v] ) < 1e-4 );
        }
        def.stretch = WISP_STRAND_STRETCH_DIRECT;
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    }
    assert_false( wisp_is_halted( s.world, e ) );
}

TEST( strands_of_no_and_of_one_vertex_step )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    const int ones[] = { 1, 1, 0 }, none = 0;
    const wisp_strand_dynamics_def def = default_def();
    const wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    const wisp_entity e[2] = { add_strands( s.world, ones, 3, straight_out, 0.1f ),
                               add_strands( s.world, &none, 1, straight_out, 0.1f ) };
    for ( int k = 0; k < 2; ++k )
    {
        assert_int_equal( wisp_set_strand_dynamics( s.world, e[k], &def ), WISP_OK );
        assert_int_equal( wisp_set_strand_grid( s.world, e[k], &grid ), WISP_OK );
        assert_int_equal( wisp_request( s.world, e[k], WISP_STRAND_POINTS ), WISP_OK );
        assert_int_equal( wisp_request( s.world, e[k], WISP_MOTION_STATS ), WISP_OK );
    }
    const wisp_transform pose = { NOWHERE.rotation, { 1.0f, 2.0f, 3.0f } };
    assert_int_equal( wisp_move_strand_head( s.world, e[0], pose ), WISP_OK );
    strand_steps( s.world, 2, FRAME );
    assert_true( strand_points( s.world, e[0] )[1].y == 2.0f );
    assert_true( motion_stats_of( s.world, e[1] ).mass == 0.0 );
}

// ---- heads and surfaces ----

TEST( a_head_carries_its_roots_and_pins )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    const int32_t pins[] = { 5, 26 };
    def.pins = pins;
    def.pin_count = WISP_COUNT( pins );
    const wisp_entity e = add_moving( s.world, 3, 20, straight_out, 0.1f, &def );
    const wisp_transform pose =
        head_at( 0.5f, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ 0.02f, 0.1f, 0.0f } );
    assert_int_equal( wisp_move_strand_head( s.world, e, pose ), WISP_OK );
    strand_steps( s.world, 1, FRAME );
    const wisp_vec3* p = strand_points( s.world, e );
    const int held[] = { 0, 5, 20, 26, 40 };
    for ( int k = 0; k < WISP_COUNT( held ); ++k )
    {
        const wisp_vec3 at = wisp_transform_to_world( pose, straight_out( held[k] / 20, held[k] % 20, 20, 0.1f ) );
        // a few roundings of numbers of 0.1 m
        assert_true( vec_distance( p[held[k]], at ) < 1e-7 );
    }
}

TEST( a_head_that_jumps_takes_its_strands_along_without_a_velocity )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 16, 1, 1 );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 5, 20, curl_down, 0.1f, &def );
    assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
    const wisp_transform pose = head_at( 1.0f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, ( wisp_vec3 ){ 3.0f, 0.0f, 0.0f } );
    assert_int_equal( wisp_move_strand_head( s.world, e, pose ), WISP_OK );
    strand_steps( s.world, 1, FRAME );
    const wisp_vec3* p = strand_points( s.world, e );
    for ( int v = 0; v < 100; ++v )
    {
        const wisp_vec3 at = wisp_transform_to_world( pose, curl_down( v / 20, v % 20, 20, 0.1f ) );
        // turned about gravity, the shape is in balance still; rounding at 3 m is 3e-7 m
        assert_true( vec_distance( p[v], at ) < 1e-4 );
    }
    assert_true( motion_stats_of( s.world, e ).speed_max < 0.05 );
}

TEST( roots_stay_on_the_triangles_of_a_surface_and_remain_when_it_goes )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface_def = support_weightless_surface_def();
    const wisp_entity surface = test_surface_of( s.world, &fabric, surface_def );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 3, 10, straight_down, 0.1f, &def );
    assert_int_equal( wisp_root_strands( s.world, e, surface ), WISP_OK );
    assert_int_equal( wisp_request( s.world, surface, WISP_SURFACE_POINTS ), WISP_OK );
    assert_int_equal( wisp_set_gravity( s.world, surface, ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } ), WISP_OK );
    strand_steps( s.world, 10, FRAME );
    const float height = ( (const wisp_vec3*)view_of( s.world, surface, WISP_SURFACE_POINTS ).data )[0].y;
    assert_true( height < -0.01f );
    for ( int k = 0; k < 3; ++k )
    {
        // the surface falls flat, and its weights sum to 1 up to a rounding
        assert_true( fabsf( strand_points( s.world, e )[10 * k].y - height ) < 1e-7f );
    }
    assert_true( plan_says( s.world, "strands.anchors", "item loop" ) );
    assert_int_equal( wisp_move_strand_head( s.world, e, NOWHERE ), WISP_CONFLICT );
    const wisp_vec3 root = strand_points( s.world, e )[10];
    assert_int_equal( wisp_remove( s.world, surface ), WISP_OK );
    strand_steps( s.world, 3, FRAME );
    assert_memory_equal( strand_points( s.world, e ) + 10, &root, sizeof( root ) );
}

TEST( a_finer_tolerance_has_more_passes_and_smaller_errors )
{
    double worst[2] = { 0.0, 0.0 };
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted s;
        open_strands( &s, 4, 1, 1 );
        wisp_strand_dynamics_def def = default_def();
        def.bending = WISP_STRAND_BEND_NONE;
        def.stretch_tolerance = k == 0 ? 1e-2f : 1e-6f;
        const wisp_entity e = add_moving( s.world, 20, 12, straight_out, 0.1f, &def );
        assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
        for ( int i = 0; i < 20; ++i )
        {
            strand_steps( s.world, 1, FRAME );
            worst[k] = fmax( worst[k], motion_stats_of( s.world, e ).strain_max );
        }
    }
    assert_true( worst[0] < 2e-5 && worst[1] < 2e-6 );
}

TEST( friction_on_the_grid_keeps_momentum_and_takes_relative_motion )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 1, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    def.bending = WISP_STRAND_BEND_NONE;
    const wisp_entity e = add_moving( s.world, 2, 2, straight_down, 0.1f, &def );
    wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    grid.friction = 1.0f;
    grid.cell_size = 1.0f;
    assert_int_equal( wisp_set_strand_grid( s.world, e, &grid ), WISP_OK );
    assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[3 * WISP_LANES] = 0.01f; // the tip of the first strand, along x
    strand_steps( s.world, 1, 1e-4f );
    const wisp_motion_stats q = motion_stats_of( s.world, e );
    const double mass = 0.5 * 0.1 * 6.5e-6;
    // both tips share the corners of one cell. 1 - (1 - 1)^(60 dt) is 1, so both move with the mean of the momentum
    assert_true( fabs( q.momentum[0] / ( mass * 0.01 ) - 1.0 ) < 1e-3 );
    assert_true( fabs( q.speed_max / 0.005 - 1.0 ) < 1e-2 );
    grid.enabled = false;
    assert_int_equal( wisp_set_strand_grid( s.world, e, &grid ), WISP_OK );
    assert_true( plan_says( s.world, "strands.grid", "absent" ) );
}

// ---- the plan ----

TEST( points_alone_keep_the_whole_chain_in_the_item_loop )
{
    static const char* const LOOP[] = {
        "strands.roots",   "strands.pins",       "strands.damping", "strands.air",
        "strands.predict", "strands.rod_curved", "strands.stretch", "strands.velocity"
    };
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    const int32_t pin = 3;
    def.pins = &pin;
    def.pin_count = 1;
    def.damping = 1.0f;
    def.drag_coefficient = 1.0f;
    add_moving( s.world, 2, 8, straight_out, 0.1f, &def );
    for ( int i = 0; i < WISP_COUNT( LOOP ); ++i )
    {
        if ( plan_says( s.world, LOOP[i], "item loop" ) == false )
        {
            fail_msg( "%s is not in the item loop", LOOP[i] );
        }
    }
    assert_true( plan_says( s.world, "strands.state_check", "after" ) );
    assert_true( plan_says( s.world, "strands.factor", "before" ) );
}

// ---- invalid states ----

TEST( wrong_definitions_are_refused_and_change_nothing )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 1, 1, 1 );
    const wisp_strand_dynamics_def good = default_def();
    const wisp_entity e = add_moving( s.world, 2, 5, straight_out, 0.1f, &good );
    strand_steps( s.world, 1, FRAME );
    const uint64_t hash = wisp_world_hash( s.world );
    wisp_strand_dynamics_def bad[6] = { good, good, good, good, good, good };
    const int32_t pin = 10;
    float masses[10] = { 1e-6f };
    bad[0].stretch_passes = 17;
    bad[1].bend_rigidity = NAN;
    bad[2].line_density = 0.0f;
    bad[3].pins = &pin;
    bad[3].pin_count = 1;
    bad[4].vertex_masses = masses;
    bad[5].gravity.y = INFINITY;
    static const char* const NAMED[6] = { "stretch_passes",     "bend_rigidity",    "line_density",
                                          "pin 0 is vertex 10", "mass of vertex 1", "gravity" };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, bad + i ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( s.world ), NAMED[i] ) );
    }
    wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    grid.friction = 1.5f;
    float tension[10];
    assert_int_equal( wisp_set_strand_grid( s.world, e, &grid ), WISP_BAD_INPUT );
    assert_int_equal( wisp_set_strand_wind( s.world, e, ( wisp_vec3 ){ NAN, 0.0f, 0.0f } ), WISP_BAD_INPUT );
    assert_int_equal( wisp_root_strands( s.world, e, e ), WISP_CONFLICT );
    assert_int_equal( wisp_move_strand_head( s.world, e, ( wisp_transform ){ { 0, 0, 0, 1 }, { NAN, 0, 0 } } ),
                      WISP_BAD_INPUT );
    assert_true( wisp_world_hash( s.world ) == hash );
    const int count = 3;
    const wisp_entity still = add_strands( s.world, &count, 1, straight_out, 0.1f );
    assert_int_equal( wisp_read_strand_tension( s.world, still, tension ), WISP_CONFLICT );
}

TEST( a_nan_in_one_position_halts_that_entity_alone )
{
    uint64_t hashes[2][4];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted s;
        open_strands( &s, 4, 1, 1 );
        const wisp_strand_dynamics_def def = undamped_hair();
        // more than one group each
        const wisp_entity sound = add_moving( s.world, 20, 12, straight_out, 0.1f, &def );
        const wisp_entity sick = add_moving( s.world, 20, 12, curl_down, 0.1f, &def );
        strand_steps( s.world, 3, FRAME );
        if ( k == 1 )
        {
            float* position = wisp_world_column( s.world, sick, WISP_STRAND_POSITION, 0 );
            position[5 * 3 * WISP_LANES + 2] = NAN; // x of vertex 5 of the strand in lane 2
        }
        for ( int i = 0; i < 4; ++i )
        {
            strand_steps( s.world, 5, FRAME );
            assert_int_equal( wisp_world_hash_column( s.world, sound, WISP_STRAND_POINTS, &hashes[k][i] ), WISP_OK );
        }
        assert_int_equal( wisp_is_halted( s.world, sick ), k == 1 );
        assert_false( wisp_is_halted( s.world, sound ) );
        assert_int_equal( wisp_world_counter( s.world, WISP_COUNT_HALTED ), k );
        const wisp_vec3* p = strand_points( s.world, sick );
        for ( int v = 0; v < 240; ++v )
        {
            assert_true( isfinite( p[v].x + p[v].y + p[v].z ) );
        }
    }
    assert_memory_equal( hashes[0], hashes[1], sizeof( hashes[0] ) );
}
