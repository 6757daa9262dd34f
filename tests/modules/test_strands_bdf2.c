// Strands that integrate with BDF2: order, energy, and where a strand goes back to implicit Euler. The equations are
// compared with the oracle in test_strands_against_oracle.c.
#include "strands_fixture.h"

#define FRAME ( 1.0f / 60.0f )

static const double GRAVITY = 9.81;

enum
{
    STRANDS = 3,
    VERTICES = 20,
    POINTS = STRANDS * VERTICES,
};

static wisp_strand_dynamics_def chain_def( void )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.bending = WISP_STRAND_BEND_NONE;
    def.integrator = WISP_INTEGRATOR_BDF2;
    return def;
}

static wisp_entity add_chains( hosted* s, int substeps, float length, const wisp_strand_dynamics_def* def )
{
    open_strands( s, substeps, 1, 1 );
    return add_moving( s->world, STRANDS, VERTICES, straight_out, length, def );
}

static int euler_count( const hosted* s )
{
    return (int)wisp_world_counter( s->world, WISP_COUNT_FIRST_ORDER );
}

// ---- order ----

static void fall( wisp_integrator integrator, int substeps, wisp_vec3 points[POINTS] )
{
    hosted s;
    wisp_strand_dynamics_def def = chain_def();
    def.integrator = integrator;
    const wisp_entity e = add_chains( &s, substeps, 0.95f, &def );
    strand_steps( s.world, 15, FRAME );
    memcpy( points, strand_points( s.world, e ), POINTS * sizeof( wisp_vec3 ) );
    assert_int_equal( euler_count( &s ), 0 );
    close_world( &s );
}

static double distance_between( const wisp_vec3* a, const wisp_vec3* b )
{
    double sum = 0.0;
    for ( int v = 0; v < POINTS; ++v )
    {
        sum += vec_distance( a[v], b[v] ) * vec_distance( a[v], b[v] );
    }
    return sqrt( sum / POINTS );
}

TEST( a_chain_that_falls_has_order_two )
{
    static wisp_vec3 reference[POINTS], points[POINTS];
    double error[2][3];
    fall( WISP_INTEGRATOR_BDF2, 256, reference );
    for ( int k = 0; k < 6; ++k )
    {
        fall( k < 3 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2, 1 << k % 3, points );
        error[k / 3][k % 3] = distance_between( points, reference );
    }
    for ( int k = 0; k < 2; ++k )
    {
        // halving the substep divides the error by 2 and by 4, up to the next order
        assert_true( error[0][k] / error[0][k + 1] > 1.8 && error[0][k] / error[0][k + 1] < 2.4 );
        assert_true( error[1][k] / error[1][k + 1] > 3.4 && error[1][k] / error[1][k + 1] < 5.0 );
    }
    assert_true( error[1][2] < 0.1 * error[0][2] );
}

// ---- energy ----

static double energy_of( hosted* s, wisp_entity e )
{
    const wisp_motion_stats q = motion_stats_of( s->world, e );
    return q.kinetic_energy + q.potential_energy;
}

// Bending only stores energy that is not counted, so a rod that starts straight may have less, never more.
TEST( strands_that_swing_gain_no_energy_in_15_seconds )
{
    static const wisp_strand_bend BENDS[] = { WISP_STRAND_BEND_NONE, WISP_STRAND_BEND_LINKS, WISP_STRAND_BEND_ROD };
    static const int SUBSTEPS[] = { 1, 2, 4, 10 };
    for ( int k = 0; k < WISP_COUNT( BENDS ) * WISP_COUNT( SUBSTEPS ); ++k )
    {
        hosted s;
        wisp_strand_dynamics_def def = chain_def();
        def.bending = BENDS[k / WISP_COUNT( SUBSTEPS )];
        def.rest = WISP_STRAND_REST_STRAIGHT;
        const int substeps = SUBSTEPS[k % WISP_COUNT( SUBSTEPS )];
        const wisp_entity e = add_chains( &s, substeps, 0.3f, &def );
        assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
        strand_steps( s.world, 1, FRAME );
        const double start = energy_of( &s, e ), weight = 0.3 * STRANDS * 6.5e-6 * GRAVITY;
        double highest = start;
        for ( int i = 0; i < 900; ++i )
        {
            strand_steps( s.world, 1, FRAME );
            highest = fmax( highest, energy_of( &s, e ) );
        }
        // energies of a step are those of a height that is off by the second order of a substep
        const double dt = (double)FRAME / substeps;
        if ( !( highest - start < weight * ( 1e-3 * 0.3 + GRAVITY * dt * dt ) ) )
        {
            fail_msg( "bending %d, %d substeps: energy rises by %.3g of weight times length", (int)def.bending,
                      substeps, ( highest - start ) / ( 0.3 * weight ) );
        }
        assert_true( energy_of( &s, e ) < start );
        close_world( &s );
    }
}

// ---- back to Euler ----

TEST( only_what_breaks_the_history_is_made_by_euler )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    open_strands( &s, 1, 1, 1 );
    const wisp_entity e = add_moving( s.world, STRANDS, VERTICES, straight_down, 0.3f, &def );
    strand_steps( s.world, 5, FRAME );
    assert_int_equal( euler_count( &s ), 0 ); // nor is the first substep counted

    // a step of so many usual ones makes longer substeps
    strand_steps( s.world, 1, 10.0f * FRAME );
    assert_int_equal( euler_count( &s ), STRANDS );

    // a jump of the head, beyond the teleport distance
    assert_int_equal(
        wisp_move_strand_head( s.world, e, head_at( 0.3f, ( wisp_vec3 ){ 0, 0, 1 }, ( wisp_vec3 ){ 3.0f, 0, 0 } ) ),
        WISP_OK );
    strand_steps( s.world, 4, FRAME );
    assert_int_equal( euler_count( &s ), 2 * STRANDS );

    // another definition begins anew
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    strand_steps( s.world, 4, FRAME );
    assert_int_equal( euler_count( &s ), 2 * STRANDS );
    close_world( &s );
}

TEST( a_teleport_takes_the_history_along )
{
    static wisp_vec3 points[2][POINTS];
    const wisp_transform motion = head_at( 0.0f, ( wisp_vec3 ){ 0, 1, 0 }, ( wisp_vec3 ){ 0.5f, 0.25f, 0 } );
    for ( int k = 0; k < 2; ++k )
    {
        hosted s;
        const wisp_strand_dynamics_def def = chain_def();
        const wisp_entity e = add_chains( &s, 2, 0.3f, &def );
        strand_steps( s.world, 6, FRAME );
        assert_int_equal( k == 1 ? wisp_teleport( s.world, e, motion, true ) : WISP_OK, WISP_OK );
        strand_steps( s.world, 6, FRAME );
        assert_int_equal( euler_count( &s ), 0 );
        memcpy( points[k], strand_points( s.world, e ), sizeof( points[k] ) );
        close_world( &s );
    }
    for ( int v = 0; v < POINTS; ++v )
    {
        const wisp_vec3 p = points[0][v];
        // rounding of positions below 1 m, twelve substeps
        assert_true( vec_distance( points[1][v], ( wisp_vec3 ){ p.x + 0.5f, p.y + 0.25f, p.z } ) < 2e-6 );
    }
}

TEST( a_strand_that_is_put_to_rest_elsewhere_falls_from_rest )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    strand_steps( s.world, 8, FRAME );
    const wisp_vec3 before = strand_points( s.world, e )[VERTICES - 1];
    assert_int_equal(
        wisp_teleport( s.world, e, head_at( 0.0f, ( wisp_vec3 ){ 0, 1, 0 }, ( wisp_vec3 ){ 1, 0, 0 } ), false ),
        WISP_OK );
    strand_steps( s.world, 1, FRAME );
    const wisp_vec3 p = strand_points( s.world, e )[VERTICES - 1];
    // no farther than a fall of a step
    assert_true( vec_distance( p, ( wisp_vec3 ){ before.x + 1.0f, before.y, before.z } ) <
                 GRAVITY * (double)( FRAME * FRAME ) );
    close_world( &s );
}

static void add_floor( hosted* s, wisp_entity strands, float height )
{
    wisp_collider_def floor = wisp_default_collider_def();
    floor.kind = WISP_COLLIDER_PLANE;
    floor.pose.translation.y = height;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.friction_scale = 0.0f;
    wisp_entity e;
    assert_int_equal( wisp_add_collider( s->world, &floor, &e ), WISP_OK );
    assert_int_equal( wisp_set_collision( s->world, strands, &collision ), WISP_OK );
}

// A vertex at a time comes down flat on a floor. The chain lifts one by 5 mm again; BDF2 would throw it up with half of
// its speed, by 16 mm.
TEST( what_lands_on_a_floor_does_not_bounce )
{
    for ( int substeps = 1; substeps <= 4; substeps *= 2 )
    {
        hosted s;
        const wisp_strand_dynamics_def def = chain_def();
        const wisp_entity e = add_chains( &s, substeps, 0.3f, &def );
        add_floor( &s, e, -0.12f );
        bool has_landed[POINTS] = { false };
        for ( int i = 0; i < 60; ++i )
        {
            strand_steps( s.world, 1, FRAME );
            const wisp_vec3* points = strand_points( s.world, e );
            for ( int v = 0; v < POINTS && i < 16; ++v )
            {
                const bool is_down = (double)points[v].y < -0.12 + 0.002;
                assert_true( has_landed[v] == false || (double)points[v].y < -0.12 + 0.008 );
                has_landed[v] = has_landed[v] || is_down;
            }
        }
        assert_true( euler_count( &s ) > STRANDS );
        close_world( &s );
    }
}

TEST( strands_that_are_reset_go_on_by_euler )
{
    hosted s;
    wisp_strand_dynamics_def def = chain_def();
    def.stretch_passes = 1;
    def.stretch_tolerance = 1e-6f;
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    strand_steps( s.world, 2, FRAME );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[( VERTICES - 1 ) * 3 * WISP_LANES] = 40.0f; // the tip of one strand
    const int before = (int)wisp_world_counter( s.world, WISP_COUNT_STRAND_RESET );
    strand_steps( s.world, 1, FRAME );
    assert_true( (int)wisp_world_counter( s.world, WISP_COUNT_STRAND_RESET ) > before );
    assert_true( euler_count( &s ) > 0 );
    close_world( &s );
}

TEST( halted_strands_go_on_without_their_history )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    open_strands( &s, 1, 1, 1 );
    const wisp_entity e = add_moving( s.world, STRANDS, VERTICES, straight_down, 0.3f, &def );
    strand_steps( s.world, 5, FRAME );
    static wisp_vec3 before[POINTS];
    memcpy( before, strand_points( s.world, e ), sizeof( before ) );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[4 * 3 * WISP_LANES + 1] = NAN;
    strand_steps( s.world, 1, FRAME );
    assert_true( wisp_is_halted( s.world, e ) );
    assert_memory_equal( strand_points( s.world, e ), before, sizeof( before ) );
    const int count = euler_count( &s );
    assert_int_equal( wisp_resume( s.world, e ), WISP_OK );
    strand_steps( s.world, 1, FRAME );
    assert_int_equal( euler_count( &s ), count + STRANDS );
    strand_steps( s.world, 10, FRAME );
    assert_int_equal( euler_count( &s ), count + STRANDS );
    assert_false( wisp_is_halted( s.world, e ) );
    close_world( &s );
}

// ---- roots that move ----

// A head that shakes at 4 Hz by 5 cm, and then rests.
TEST( hair_on_a_head_that_shakes_comes_to_rest )
{
    for ( int k = 0; k < 6; ++k )
    {
        hosted s;
        wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
        def.integrator = WISP_INTEGRATOR_BDF2;
        def.damping = 4.0f;
        def.bending = k < 3 ? WISP_STRAND_BEND_ROD : WISP_STRAND_BEND_LINKS;
        open_strands( &s, 1 << k % 3, 1, 1 );
        const wisp_entity e = add_moving( s.world, STRANDS, VERTICES, straight_down, 0.2f, &def );
        assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
        double speed = 0.0;
        for ( int i = 0; i < 60; ++i )
        {
            const float x = 0.05f * sinf( 6.2831853f * 4.0f * FRAME * (float)( i + 1 ) );
            const wisp_vec3 place = { x, 0.0f, 0.0f };
            assert_int_equal( wisp_move_strand_head( s.world, e, head_at( 0.0f, ( wisp_vec3 ){ 0, 1, 0 }, place ) ),
                              WISP_OK );
            strand_steps( s.world, 1, FRAME );
            speed = fmax( speed, motion_stats_of( s.world, e ).speed_max );
        }
        // the head has 1.26 m/s, a fall by the length of the hair ends with 2 m/s
        assert_true( speed < 2.0 * 1.26 + 2.0 * 1.98 );
        strand_steps( s.world, 300, FRAME );
        assert_true( motion_stats_of( s.world, e ).speed_max < 0.05 );
        assert_int_equal( wisp_world_counter( s.world, WISP_COUNT_HALTED ), 0 );
        close_world( &s );
    }
}

// ---- refusals ----

TEST( bdf2_is_refused_without_direct_lengths )
{
    hosted s;
    wisp_strand_dynamics_def def = chain_def();
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    def.stretch = WISP_STRAND_STRETCH_LINKS;
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_BAD_INPUT );
    assert_string_equal( wisp_world_message( s.world ),
                         "strands: got integrator bdf2 with stretch links, expected direct" );
    def.stretch = WISP_STRAND_STRETCH_DIRECT;
    def.integrator = WISP_INTEGRATOR_COUNT;
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( s.world ), "integrator" ) );
    close_world( &s );
}
