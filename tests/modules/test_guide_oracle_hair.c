// Figures, switches, refusals and degenerate cases of guide hair on its double-precision oracle. Numbers of
// equations, figures and sections are those of Park and Kim 2024.
#include "guide_oracle_fixture.h"

// Fig. 2a: 1:1
static void difference_lines_grow_with_the_change_of_velocity_and_vanish_without_weights( void** state )
{
    (void)state;
    for ( int on = 0; on <= 1; ++on )
    {
        scene s = make_scene( 1, 1 );
        guide_oracle_options options = options_without_weights();
        options.elastic_gain = on;
        options.cap_offset = false;
        guide_oracle hair = make_hair( &s, &options );
        double turn[240], line[240], longest = 0.0;
        double3 v0 = zero;
        step( &hair, s.x, s.v );
        assert_memory_equal( hair.y, hair.b, NODES * sizeof( double3 ) );
        for ( int frame = 0; frame < 240; ++frame )
        {
            swing( &s, 20 );
            step( &hair, s.x, s.v );
            double3 v = s.v[NODES - 1], difference = double3_sub( hair.y[NODES - 1], hair.b[NODES - 1] );
            assert_true( double3_distance( hair.y[0], hair.b[0] ) == 0.0 );
            turn[frame] = double3_angle( v, v0 );
            line[frame] = double3_length( difference ) / ( options.tau * double3_length( v ) );
            longest = fmax( longest, line[frame] );
            v0 = v;
        }
        assert_true( on ? longest > 0.3 : longest == 0.0 );
        for ( int n = 1; on && n < 240 * 240; ++n )
        {
            int a = n / 240, b = n % 240;
            // y - b loses the digits of y, which is a metre from the origin, over a distance of tau |v| from 1e-5 m
            // up
            assert_true( turn[a] >= turn[b] || line[a] <= line[b] + 1e-9 );
        }
        guide_oracle_destroy( &hair );
    }
}

// Fig. 2b and 2c: 1:4
static void only_the_centre_weight_lets_four_ghosts_sway_apart( void** state )
{
    (void)state;
    double spread[3] = { 0.0, 0.0, 0.0 };
    for ( int n = 0; n < 3; ++n )
    {
        scene s = make_scene( 1, 4 );
        guide_oracle_options options = options_without_weights();
        options.elastic_gain = 1.0;
        options.centre_gain = 0.5 * n;
        options.cap_offset = false;
        guide_oracle hair = make_hair( &s, &options );
        for ( int frame = 0; frame < 180; ++frame )
        {
            swing( &s, 20 );
            step( &hair, s.x, s.v );
            spread[n] += present_spread( &hair, NODES - 1 ) / 180.0;
            for ( int k = 0; k < 16; ++k )
            {
                int p = k / 4 * NODES + NODES - 1, q = k % 4 * NODES + NODES - 1;
                double move_p = double3_distance( hair.y[p], hair.b[p] ),
                       move_q = double3_distance( hair.y[q], hair.b[q] );
                double apart =
                    double3_distance( hair.b[p], s.x[NODES - 1] ) - double3_distance( hair.b[q], s.x[NODES - 1] );
                double expected =
                    options.tau * double3_length( s.v[NODES - 1] ) * options.centre_gain * apart / hair.largest[0];
                // the block problem for n = 0; beyond it near ghosts sway less than far ones
                assert_close( move_p - move_q, expected, 1e-14 );
            }
        }
        guide_oracle_destroy( &hair );
    }
    // over the whole swing: at one instant a far ghost on the lee side may approach the others
    assert_true( spread[1] > 1.001 * spread[0] && spread[2] > spread[1] );
}

// A4, section 4.5
static void feedback_undoes_what_is_common_and_keeps_what_differs( void** state )
{
    (void)state;
    for ( int differs = 0; differs <= 1; ++differs )
    {
        scene s = make_scene( 1, 4 );
        guide_oracle_options options = options_without_weights();
        options.feedback = true;
        options.elastic_gain = options.tip_gain = 1.0;
        options.centre_gain = differs;
        guide_oracle hair = make_hair( &s, &options );
        double3 rest[4 * NODES];
        memcpy( rest, hair.offset, sizeof( rest ) );
        for ( int frame = 0; frame < 60; ++frame )
        {
            swing( &s, 5 );
            step( &hair, s.x, s.v );
            for ( int i = 0; i < NODES; ++i )
            {
                assert_at( ghost_mean( &hair, hair.y, 0, i ), s.x[i], 1e-12 );
            }
        }
        memset( s.v, 0, sizeof( s.v ) );
        step( &hair, s.x, s.v );
        double lost = 0.0;
        for ( int n = 0; n < 4 * NODES; ++n )
        {
            double3 offset = double3_sub( hair.y[n], s.x[n % NODES] );
            lost = fmax( lost, double3_distance( offset, rest[n] ) );
            assert_true( n % NODES > 0 || double3_distance( offset, rest[n] ) < 1e-15 );
        }
        assert_true( differs ? lost > 1e-4 : lost < 1e-12 );
        guide_oracle_destroy( &hair );
    }
}

// Several targets
static void several_targets_a_ghost_are_weighted_by_inverse_squared_distance( void** state )
{
    (void)state;
    scene s = make_scene( 3, 1 );
    // ghost 0 in the middle of targets 0 and 1, ghost 1 on target 1, ghost 2 anywhere
    for ( int i = 0; i < NODES; ++i )
    {
        s.ghost[i] = double3_scale( 0.5, double3_add( s.target[i], s.target[NODES + i] ) );
        s.ghost[NODES + i] = s.target[NODES + i];
        s.ghost[2 * NODES + i] = double3_add( s.target[NODES + i], double3_make( 0.031, 0.004, 0.002 ) );
    }
    guide_oracle_options options = options_without_weights();
    options.link_count = 3;
    guide_oracle hair = make_hair( &s, &options );
    for ( int g = 0; g < 3; ++g )
    {
        const double3* ghost = s.ghost + g * NODES;
        double inverse[3], sum = 0.0, total = 0.0;
        for ( int a = 0; a < 3; ++a )
        {
            inverse[a] = 1.0 / fmax( 1e-30, brute_distance( ghost, NODES, s.target + a * NODES, NODES ) );
            sum += inverse[a];
        }
        for ( int k = 0; k < 3; ++k )
        {
            assert_close( hair.link_weight[3 * g + k], inverse[hair.link[3 * g + k]] / sum, 1e-12 );
            assert_true( k == 0 || hair.link_weight[3 * g + k] <= hair.link_weight[3 * g + k - 1] );
            total += hair.link_weight[3 * g + k];
        }
        assert_close( total, 1.0, 1e-15 );
    }
    assert_int_equal( hair.link[0], 0 );
    assert_close( hair.link_weight[0], hair.link_weight[1], 1e-12 );
    assert_true( hair.link_weight[3] == 1.0 && hair.link[3] == 1 );
    // groups of one, whose anchor is the target: at rest every ghost is at its initial position
    for ( int n = 0; n < 3 * NODES; ++n )
    {
        assert_at( hair.y[n], s.ghost[n], 1e-15 );
    }

    // each target moves independently, and a ghost follows the weighted mean
    double3 move[3] = { { 0.1, 0.0, 0.0 }, { 0.0, 0.2, 0.0 }, { 0.0, 0.0, -0.4 } };
    for ( int n = 0; n < 3 * NODES; ++n )
    {
        s.x[n] = double3_add( s.target[n], move[n / NODES] );
    }
    step( &hair, s.x, s.v );
    for ( int n = 0; n < 3 * NODES; ++n )
    {
        double3 expected = s.ghost[n];
        for ( int k = 0; k < 3; ++k )
        {
            int row = 3 * ( n / NODES ) + k;
            expected = double3_add( expected, double3_scale( hair.link_weight[row], move[hair.link[row]] ) );
        }
        assert_at( hair.y[n], expected, 1e-15 );
    }
    guide_oracle_destroy( &hair );
}

// Section 4.6
static void length_repair_restores_every_segment_from_the_root_on( void** state )
{
    (void)state;
    scene s = make_scene( 1, 4 );
    guide_oracle_options options = guide_oracle_default_options();
    options.repair_lengths = true;
    options.tau = 0.1;
    guide_oracle hair = make_hair( &s, &options );
    for ( int frame = 0; frame < 30; ++frame )
    {
        swing( &s, 5 );
        step( &hair, s.x, s.v );
        for ( int n = 0; n < 4 * NODES; ++n )
        {
            double length = n % NODES > 0 ? double3_distance( hair.y[n], hair.y[n - 1] ) : 0.0;
            double rest = n % NODES > 0 ? double3_distance( s.ghost[n], s.ghost[n - 1] ) : 0.0;
            assert_close( length, rest, 1e-15 );
            assert_true( n % NODES > 0 || double3_distance( hair.y[n], hair.b[n] ) == 0.0 );
        }
    }
    assert_int_equal( hair.counters.zero_segments, 0 );
    guide_oracle_destroy( &hair );

    // Coincident nodes have no direction
    double3 strand[3] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 3, 0 } };
    const double lengths[3] = { 0.0, 1.0, 1.0 };
    assert_int_equal( guide_oracle_repair_lengths( strand, 3, lengths ), 1 );
    assert_at( strand[1], zero, 0.0 );
    assert_at( strand[2], double3_make( 0.0, 1.0, 0.0 ), 1e-15 );
}

// Cost in counts of operations; the benchmark measures the time
static void ghosts_cost_one_update_a_node_however_hard_their_targets_iterate( void** state )
{
    (void)state;
    const int size[3] = { 1, 4, 16 };
    double ratio[3];
    for ( int n = 0; n < 3; ++n )
    {
        for ( int iterations = 5; iterations <= 20; iterations += 15 )
        {
            // cost is linear in targets, so two targets give the ratio of any number of strands
            scene s = make_scene( 2, size[n] );
            guide_oracle_options options = guide_oracle_default_options();
            guide_oracle hair = make_hair( &s, &options );
            swing( &s, iterations );
            step( &hair, s.x, s.v );
            assert_int_equal( hair.counters.node_updates, s.ghost_count * NODES );
            assert_int_equal( s.projections, 2 * 4 * iterations * ( NODES - 1 + NODES - 2 ) );
            // against projecting every strand
            double all = (double)s.projections / 2.0 * ( 2.0 + s.ghost_count );
            ratio[n] = (double)( s.projections + hair.counters.node_updates ) / all;
            guide_oracle_destroy( &hair );
        }
        assert_true( ratio[n] < ( n == 0 ? 0.51 : 0.8 * ratio[n - 1] ) );
    }
}

static void assert_refused( const guide_oracle_def* def, const guide_oracle_options* options, const char* words )
{
    wisp_error error = { 0 };
    guide_oracle hair;
    assert_int_equal( guide_oracle_create( def, options, &hair, &error ), WISP_BAD_INPUT );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_contains( error.message, words );
}

// Unequal node counts (conclusion)
static void unequal_node_counts_are_refused_unless_resampled( void** state )
{
    (void)state;
    scene s = make_scene( 1, 2 );
    guide_oracle_def def = def_of( &s );
    guide_oracle_options options = guide_oracle_default_options();
    def.ghost_nodes = 2 * NODES;
    def.ghost_count = 1;
    assert_refused( &def, &options, "ghosts have 20 nodes and targets 10" );
    options.pairing = GUIDE_ORACLE_PAIRING_SPLINE;
    guide_oracle hair;
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    assert_int_equal( hair.node_count, 2 * NODES );
    guide_oracle_destroy( &hair );
}

static void wrong_shapes_and_parameters_are_refused_by_name( void** state )
{
    (void)state;
    scene s = make_scene( 2, 2 );
    guide_oracle_def def = def_of( &s );
    const struct
    {
        const char* words;
        double dt, tau, elastic, tip, centre, spread;
        int links;
        bool feedback;
        guide_oracle_frame frame;
    } bad[] = {
        { "dt is 0", 0.0, 0.01, 1.0, 0.5, 0.5, 1.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "tau is nan", 0.01, (double)NAN, 1.0, 0.5, 0.5, 1.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "elastic_gain is -1", 0.01, 0.01, -1.0, 0.5, 0.5, 1.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "tip_gain is -0.5", 0.01, 0.01, 1.0, -0.5, 0.5, 1.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "centre_gain is inf", 0.01, 0.01, 1.0, 0.5, (double)INFINITY, 1.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "spread is 0", 0.01, 0.01, 1.0, 0.5, 0.5, 0.0, 1, false, GUIDE_ORACLE_FRAME_OFF },
        { "link_count is 3", 0.01, 0.01, 1.0, 0.5, 0.5, 1.0, 3, false, GUIDE_ORACLE_FRAME_OFF },
        { "feedback", 0.01, 0.01, 1.0, 0.5, 0.5, 1.0, 2, true, GUIDE_ORACLE_FRAME_OFF },
        { "feedback", 0.01, 0.01, 1.0, 0.5, 0.5, 1.0, 1, true, GUIDE_ORACLE_FRAME_PARALLEL },
    };
    for ( size_t n = 0; n < sizeof( bad ) / sizeof( bad[0] ); ++n )
    {
        guide_oracle_options options = guide_oracle_default_options();
        options.dt = bad[n].dt;
        options.tau = bad[n].tau;
        options.elastic_gain = bad[n].elastic;
        options.tip_gain = bad[n].tip;
        options.centre_gain = bad[n].centre;
        options.spread = bad[n].spread;
        options.link_count = bad[n].links;
        options.feedback = bad[n].feedback;
        options.frame = bad[n].frame;
        assert_refused( &def, &options, bad[n].words );
    }
    guide_oracle_options options = guide_oracle_default_options();
    const int assignment[4] = { 0, 1, 2, 0 };
    def.assignment = assignment;
    assert_refused( &def, &options, "ghost 2 is assigned to target 2" );
    def.assignment = NULL;
    def.ghost_nodes = 0;
    assert_refused( &def, &options, "there are 0 nodes a ghost" );
    def.ghost_nodes = NODES;
    s.ghost[3 * NODES + 4].y = (double)NAN;
    assert_refused( &def, &options, "node 4 of ghost 3" );
}

static void a_step_with_a_target_that_is_not_finite_changes_nothing( void** state )
{
    (void)state;
    scene s = make_scene( 2, 2 );
    guide_oracle_options options = guide_oracle_default_options();
    guide_oracle hair = make_hair( &s, &options );
    swing( &s, 5 );
    step( &hair, s.x, s.v );
    double3 kept[4 * NODES];
    memcpy( kept, hair.y, sizeof( kept ) );
    guide_oracle_counters counters = hair.counters;
    s.v[NODES + 3].z = (double)INFINITY;
    wisp_error error = { 0 };
    guide_oracle_motion motion = { s.x, s.v, NULL };
    assert_int_equal( guide_oracle_step( &hair, &motion, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "node 3 of velocities of target 1" ) );
    assert_memory_equal( hair.y, kept, sizeof( kept ) );
    assert_memory_equal( &hair.counters, &counters, sizeof( counters ) );
    guide_oracle_destroy( &hair );
}

// Group of one
static void a_ghost_alone_keeps_its_offset_or_stands_on_its_target( void** state )
{
    (void)state;
    for ( int keep = 0; keep <= 1; ++keep )
    {
        scene s = make_scene( 2, 1 );
        guide_oracle_options options = guide_oracle_default_options();
        options.keep_offset = keep == 1;
        options.use_spread = true;
        options.spread = 2.5;
        guide_oracle hair = make_hair( &s, &options );
        swing( &s, 5 );
        step( &hair, s.x, s.v );
        for ( int n = 0; n < 2 * NODES; ++n )
        {
            double3 rest = keep ? double3_sub( s.ghost[n], s.target[n] ) : zero;
            assert_at( double3_sub( hair.b[n], s.x[n] ), rest, 1e-15 );
            assert_true( hair.centre_weight[n] == 0.0 && hair.rest_spread[n] == 0.0 );
        }
        assert_int_equal( hair.counters.coincident_spreads, 0 );
        guide_oracle_destroy( &hair );
    }
    double3 alone[1] = { { 1.0, 2.0, 3.0 } };
    assert_int_equal( guide_oracle_spread_project( alone, 1, 1.0, true ), GUIDE_ORACLE_SPREAD_SINGLE );
}

// V = 0, Vbar <= 0
static void coincident_ghosts_cannot_spread_and_are_counted( void** state )
{
    (void)state;
    double3 points[3] = { { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 } };
    assert_int_equal( guide_oracle_spread_project( points, 3, 1.0, true ), GUIDE_ORACLE_SPREAD_COINCIDENT );
    assert_int_equal( guide_oracle_spread_project( points, 3, 1.0, false ), GUIDE_ORACLE_SPREAD_COINCIDENT );
    assert_true( points[2].x == 1.0 );
    points[2].x = 2.0;
    assert_int_equal( guide_oracle_spread_project( points, 3, 0.0, true ), GUIDE_ORACLE_SPREAD_BAD_TARGET );
    assert_int_equal( guide_oracle_spread_project( points, 3, -1.0, false ), GUIDE_ORACLE_SPREAD_BAD_TARGET );
    assert_true( points[2].x == 2.0 );

    scene s = make_scene( 1, 3 );
    for ( int n = 0; n < 3 * NODES; ++n )
    {
        s.ghost[n] = s.target[n % NODES];
    }
    guide_oracle_options options = guide_oracle_default_options();
    options.use_spread = true;
    guide_oracle hair = make_hair( &s, &options );
    swing( &s, 5 );
    step( &hair, s.x, s.v );
    assert_int_equal( hair.counters.coincident_spreads, NODES - 1 );
    for ( int n = 0; n < NODES; ++n )
    {
        assert_true( hair.centre_weight[n] == 0.0 );
        assert_at( hair.y[n], hair.y[2 * NODES + n], 0.0 );
    }
    guide_oracle_destroy( &hair );
}

// Empty group, no target
static void a_target_without_ghosts_is_reported_and_no_target_leaves_ghosts_alone( void** state )
{
    (void)state;
    scene s = make_scene( 3, 2 );
    const int assignment[6] = { 0, 0, 2, 2, 2, 0 };
    guide_oracle_def def = def_of( &s );
    guide_oracle_options options = guide_oracle_default_options();
    guide_oracle hair;
    def.assignment = assignment;
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    assert_int_equal( hair.counters.empty_groups, 1 );
    assert_int_equal( hair.group_size[1], 0 );
    swing( &s, 5 );
    step( &hair, s.x, s.v );
    assert_int_equal( hair.counters.node_updates, 6 * NODES );
    guide_oracle_destroy( &hair );

    def.assignment = NULL;
    def.target_count = 0;
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    step( &hair, NULL, NULL );
    assert_memory_equal( hair.y, s.ghost, 6 * NODES * sizeof( double3 ) );
    guide_oracle_destroy( &hair );
    options.strict = true;
    assert_refused( &def, &options, "no target" );
}

// The first step has v0 = v; a strand of one node has no tip
static void the_first_step_sees_no_change_and_a_single_node_only_follows( void** state )
{
    (void)state;
    scene s = make_scene( 1, 2 );
    guide_oracle_options options = guide_oracle_default_options();
    guide_oracle hair = make_hair( &s, &options );
    for ( int n = 0; n < NODES; ++n )
    {
        s.v[n] = random_vector( 3, n );
    }
    step( &hair, s.x, s.v );
    for ( int n = 0; n < 2 * NODES; ++n )
    {
        assert_close( hair.elastic_weight[n], 0.0, 1e-15 );
    }
    guide_oracle_destroy( &hair );
    // a velocity of zero before would give half of it
    options.elastic = GUIDE_ORACLE_ELASTIC_PRINTED_COS;
    hair = make_hair( &s, &options );
    step( &hair, s.x, s.v );
    for ( int n = 0; n < 2 * NODES; ++n )
    {
        assert_close( hair.elastic_weight[n], 1.0, 1e-15 );
    }
    guide_oracle_destroy( &hair );

    guide_oracle_def def = { 1, 1, 2, 1, s.target, s.ghost, NULL };
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    step( &hair, s.x, s.v );
    assert_memory_equal( hair.y, hair.b, 2 * sizeof( double3 ) );
    guide_oracle_destroy( &hair );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( difference_lines_grow_with_the_change_of_velocity_and_vanish_without_weights ),
        cmocka_unit_test( only_the_centre_weight_lets_four_ghosts_sway_apart ),
        cmocka_unit_test( feedback_undoes_what_is_common_and_keeps_what_differs ),
        cmocka_unit_test( several_targets_a_ghost_are_weighted_by_inverse_squared_distance ),
        cmocka_unit_test( length_repair_restores_every_segment_from_the_root_on ),
        cmocka_unit_test( ghosts_cost_one_update_a_node_however_hard_their_targets_iterate ),
        cmocka_unit_test( unequal_node_counts_are_refused_unless_resampled ),
        cmocka_unit_test( wrong_shapes_and_parameters_are_refused_by_name ),
        cmocka_unit_test( a_step_with_a_target_that_is_not_finite_changes_nothing ),
        cmocka_unit_test( a_ghost_alone_keeps_its_offset_or_stands_on_its_target ),
        cmocka_unit_test( coincident_ghosts_cannot_spread_and_are_counted ),
        cmocka_unit_test( a_target_without_ghosts_is_reported_and_no_target_leaves_ghosts_alone ),
        cmocka_unit_test( the_first_step_sees_no_change_and_a_single_node_only_follows ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
