// Ghosts drawn between steps (section II.2.2), against the oracle and their specified properties.
#include "guide_hair_fixture.h"

// The scene is a metre wide, so a millionth of a metre is a relative 1e-6.
static const double tolerance = 1e-6; // m

TEST( places_that_are_no_longer_kept_leave_nothing_behind )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES ), plain = guide_flock( NULL, 3, 4, NODES );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.between = true;
    guide_follow( &f, def );
    guide_follow( &plain, wisp_default_ghosts_def() );
    for ( int frame = 0; frame < 5; ++frame )
    {
        guide_swing( &f );
        guide_swing( &plain );
    }
    guide_follow( &f, wisp_default_ghosts_def() );
    guide_swing( &f );
    guide_swing( &plain );
    assert_memory_equal( guide_points( f.world, f.ghosts ), guide_points( plain.world, plain.ghosts ),
                         12 * NODES * sizeof( wisp_vec3 ) );
    assert_int_equal( wisp_world_plan_passes( f.world ), wisp_world_plan_passes( plain.world ) );
}

// ---- between steps ----

static double3 velocity_of( const guide_oracle* hair, const double3* v, int ghost, int node )
{
    return v[hair->link[ghost] * hair->node_count + node];
}

TEST( places_between_steps_follow_the_oracle_and_meet_both_steps )
{
    for ( int nodes = 7; nodes <= NODES; nodes += NODES - 7 )
    {
        SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, nodes );
        wisp_ghosts_def def = wisp_default_ghosts_def();
        def.between = true;
        def.resample = nodes != NODES;
        guide_follow( &f, def );
        SCOPED( guide_oracle_destroy ) guide_oracle hair = guide_oracle_of( &f, &def );
        wisp_vec3 before[12 * NODES], points[12 * NODES];
        double3 y[12 * NODES], v[3 * NODES];
        const size_t bytes = (size_t)( 12 * nodes ) * sizeof( wisp_vec3 );
        for ( int frame = 0; frame < 20; ++frame )
        {
            memcpy( before, guide_points( f.world, f.ghosts ), bytes );
            memcpy( y, hair.y, (size_t)( 12 * nodes ) * sizeof( double3 ) );
            memcpy( v, hair.v, (size_t)( 3 * nodes ) * sizeof( double3 ) );
            guide_swing( &f );
            step( &hair, f.x, f.v );
            guide_ok( f.world, wisp_ghosts_between( f.world, f.ghosts, 1.0f, points ) );
            assert_memory_equal( points, guide_points( f.world, f.ghosts ), bytes );
            if ( frame > 0 )
            {
                guide_ok( f.world, wisp_ghosts_between( f.world, f.ghosts, 0.0f, points ) );
                assert_memory_equal( points, before, bytes );
            }
            for ( int part = 1; part < 4 && frame > 0; ++part )
            {
                guide_ok( f.world, wisp_ghosts_between( f.world, f.ghosts, 0.25f * (float)part, points ) );
                for ( int n = 0; n < 12 * nodes; ++n )
                {
                    const double3 expected = guide_oracle_between_frames(
                        y[n], velocity_of( &hair, v, n / nodes, n % nodes ), hair.y[n],
                        velocity_of( &hair, hair.v, n / nodes, n % nodes ), (double)FRAME, 0.25 * part );
                    const double3 p = double3_make( (double)points[n].x, (double)points[n].y, (double)points[n].z );
                    assert_at( p, expected, tolerance );
                }
            }
        }
    }
}

// Difference quotient of second order at an end of the step, 0 or 1, looking into the step, m/s.
static double3 velocity_at( const flock* f, int end, int vertex )
{
    enum
    {
        PARTS = 32
    };
    wisp_vec3 points[12 * NODES];
    double3 p[3];
    for ( int k = 0; k < 3; ++k )
    {
        const float inside = (float)k / PARTS;
        guide_ok( f->world, wisp_ghosts_between( f->world, f->ghosts, end == 0 ? inside : 1.0f - inside, points ) );
        p[k] = double3_widen( points[vertex] );
    }
    const double3 slope = double3_sub( double3_scale( 4.0, double3_sub( p[1], p[0] ) ), double3_sub( p[2], p[0] ) );
    return double3_scale( ( end == 0 ? 0.5 : -0.5 ) * PARTS / (double)FRAME, slope );
}

// Section II.2.2: once continuously differentiable. Both sides of a step have the velocity of the target's node.
TEST( the_velocity_between_steps_is_that_of_the_target_at_both_sides_of_a_step )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.between = true;
    guide_follow( &f, def );
    double fastest = 0.0;
    for ( int frame = 0; frame < 20; ++frame )
    {
        double3 before[12], node[12];
        for ( int n = 0; n < 12; ++n )
        {
            before[n] = frame > 0 ? velocity_at( &f, 1, n * NODES + NODES - 1 ) : zero;
            node[n] = f.v[n / 4 * NODES + NODES - 1];
        }
        guide_swing( &f );
        for ( int n = 0; n < 12 && frame > 0; ++n )
        {
            // floats at a metre, 6e-8 m, over 1/32 of a step of 1/60 s, and the third derivative over its square
            assert_at( before[n], node[n], 3e-3 );
            assert_at( velocity_at( &f, 0, n * NODES + NODES - 1 ), node[n], 3e-3 );
            fastest = fmax( fastest, double3_length( node[n] ) );
        }
    }
    assert_true( fastest > 0.1 );
}

TEST( places_between_steps_are_refused_by_name_and_nothing_is_written )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES );
    wisp_vec3 points[12 * NODES] = { { 0.0f, 0.0f, 0.0f } }, untouched[12 * NODES] = { { 0.0f, 0.0f, 0.0f } };
    assert_int_equal( wisp_ghosts_between( f.world, f.ghosts, 0.5f, points ), WISP_CONFLICT );
    guide_follow( &f, wisp_default_ghosts_def() );
    assert_int_equal( wisp_ghosts_between( f.world, f.ghosts, 0.5f, points ), WISP_CONFLICT );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.between = true;
    guide_follow( &f, def );
    const float wrong[] = { -0.1f, 1.1f, NAN };
    for ( int n = 0; n < WISP_COUNT( wrong ); ++n )
    {
        assert_int_equal( wisp_ghosts_between( f.world, f.ghosts, wrong[n], points ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( f.world ), "fraction" ) );
    }
    assert_memory_equal( points, untouched, sizeof( points ) );
}
