// The engine's ghosts against the oracle for every switch, and properties of the method. Numbers of equations,
// figures and sections are those of Park and Kim 2024. The scene is a metre wide, so a millionth of a metre is a
// relative 1e-6; a float is exact to 6e-8 m there.
#include "guide_hair_fixture.h"

#include "guide_internal.h"

static const double tolerance = 1e-6; // m

// ---- against the oracle ----

typedef struct variant
{
    const char* name;
    wisp_ghost_elastic elastic;
    float tip, centre, time, spread;
    bool repair, turning;
    int ghosts_a_target, links, ghost_nodes;
    double allowed; // times the tolerance; 0 is once
} variant;

#define USUAL .tip = 0.5f, .centre = 0.5f, .spread = 1.0f, .ghosts_a_target = 6, .links = 1, .ghost_nodes = NODES

static const variant variants[] = {
    { "default", USUAL },
    { "no elastic", USUAL, .elastic = WISP_GHOST_ELASTIC_OFF },
    { "turning", USUAL, .turning = true },
    { "one ghost a target", .tip = 0.5f, .centre = 0.5f, .spread = 1.0f, .ghosts_a_target = 1, .links = 1,
      .ghost_nodes = NODES },
    { "a second", USUAL, .time = 1.0f },
    { "large gains", .tip = 8.0f, .centre = 5.0f, .spread = 1.0f, .ghosts_a_target = 5, .links = 1,
      .ghost_nodes = NODES },
    { "spread 2.5", .tip = 0.5f, .spread = 2.5f, .ghosts_a_target = 4, .links = 1, .ghost_nodes = NODES },
    { "spread 0.25", .tip = 0.5f, .spread = 0.25f, .ghosts_a_target = 4, .links = 1, .ghost_nodes = NODES },
    // the direction of a segment that is shortened to a few mm passes on the rounding of its ends, nine times
    { "lengths repaired", USUAL, .time = 0.3f, .repair = true, .allowed = 3.0 },
    { "two targets a ghost", .tip = 0.5f, .spread = 1.0f, .ghosts_a_target = 6, .links = 2, .ghost_nodes = NODES },
    { "four targets a ghost, turning", .tip = 0.5f, .spread = 1.0f, .turning = true, .ghosts_a_target = 6, .links = 4,
      .ghost_nodes = NODES },
    { "twice the nodes", .tip = 0.5f, .centre = 0.5f, .spread = 1.0f, .ghosts_a_target = 6, .links = 1,
      .ghost_nodes = 2 * NODES },
    { "fewer nodes, turning", .tip = 0.5f, .centre = 0.5f, .spread = 1.0f, .turning = true, .ghosts_a_target = 6,
      .links = 1, .ghost_nodes = 7 },
    { "fewer nodes of three targets", .tip = 0.5f, .spread = 1.0f, .ghosts_a_target = 5, .links = 3,
      .ghost_nodes = 7 },
};

static wisp_ghosts_def def_of_variant( const variant* c )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.target_count = c->links;
    def.resample = c->ghost_nodes != NODES;
    def.elastic = c->elastic;
    def.tip_gain = c->tip;
    def.centre_gain = c->centre;
    def.time = c->time;
    def.spread = c->spread;
    def.repair_length = c->repair;
    return def;
}

// Roots turned by the same angles on both sides.
static void turn( flock* f, int frame, guide_oracle_rotation* rotations )
{
    const double3 axis = double3_make( 0.6, 0.0, 0.8 );
    const double angle = 0.02 * frame;
    for ( int n = 0; n < f->s.target_count; ++n )
    {
        rotations[n] = guide_oracle_turn_about( axis, angle + 0.1 * n );
    }
    guide_turn_roots( f->world, f->targets, axis, angle, 0.1 );
}

static double run_variant( const variant* c )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 6, c->ghosts_a_target, c->ghost_nodes );
    guide_follow( &f, def_of_variant( c ) );
    const wisp_ghosts_def ghosts = def_of_variant( c );
    SCOPED( guide_oracle_destroy ) guide_oracle hair = guide_oracle_of( &f, &ghosts );
    guide_oracle_rotation rotations[MAX_TARGETS];
    double largest = 0.0;
    for ( int frame = 0; frame < 45; ++frame )
    {
        if ( c->turning )
        {
            turn( &f, frame, rotations );
        }
        guide_swing( &f );
        const guide_oracle_motion motion = { f.x, f.v, c->turning ? rotations : NULL };
        guide_oracle_step( &hair, &motion );
        for ( int n = 0; n < f.s.ghost_count * c->ghost_nodes; ++n )
        {
            const double3 y = guide_ghost( &f, n / c->ghost_nodes, n % c->ghost_nodes );
            largest = fmax( largest, double3_distance( y, hair.y[n] ) );
        }
    }
    return largest;
}

// Every switch of Eq. 2-5, other node counts, several targets, frames
TEST( every_switch_follows_the_oracle )
{
    for ( int n = 0; n < WISP_COUNT( variants ); ++n )
    {
        const double error = run_variant( variants + n );
        const double allowed = tolerance * ( variants[n].allowed > 0.0 ? variants[n].allowed : 1.0 );
        if ( !( error <= allowed ) )
        {
            fail_msg( "%s: %.3g m from the oracle, allowed %.3g", variants[n].name, error, allowed );
        }
    }
}

// ---- Eq. 1: correspondence ----

TEST( ghosts_follow_the_target_that_equation_1_names_and_ties_the_lowest )
{
    double3 targets[24 * 3], ghosts[60 * 5];
    for ( int n = 0; n < WISP_COUNT( targets ); ++n )
    {
        targets[n] = guide_round( random_vector( 1000 + n, 0 ) );
    }
    for ( int n = 0; n < 3; ++n )
    {
        targets[20 * 3 + n] = targets[7 * 3 + n]; // 20 is the same as 7: 7 wins the tie
    }
    for ( int n = 0; n < WISP_COUNT( ghosts ); ++n )
    {
        const double3 near = targets[n / 5 % 24 * 3 + n % 3];
        ghosts[n] = guide_round( double3_add( near, double3_scale( 0.5, random_vector( 5000 + n, 0 ) ) ) );
    }
    SCOPED( destroy_local ) wisp_world* world = guide_world( NULL );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.resample = true;
    def.targets = guide_add( world, targets, 24, 3 );
    const wisp_entity entity = guide_add( world, ghosts, 60, 5 );
    guide_ok( world, wisp_set_ghosts( world, entity, &def ) );
    const guide_follower* follower = guide_active_follower( wisp_world_module_state( world, "guide_hair" ), entity );
    int ties = 0;
    for ( int g = 0; g < 60; ++g )
    {
        int best = 0;
        for ( int a = 1; a < 24; ++a )
        {
            best = brute_distance( ghosts + g * 5, 5, targets + a * 3, 3 ) <
                           brute_distance( ghosts + g * 5, 5, targets + best * 3, 3 )
                       ? a
                       : best;
        }
        assert_int_equal( follower->target[g], best );
        ties += best == 7 ? 1 : 0;
    }
    assert_true( ties > 0 );
}

// ---- Fig. 1: the centre follows, the block keeps its shape ----

TEST( the_mean_of_a_group_is_its_target_and_without_weights_ghosts_keep_their_distance )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 5, NODES );
    guide_follow( &f, guide_without_weights() );
    double distance[15 * NODES];
    for ( int frame = 0; frame < 60; ++frame )
    {
        guide_swing( &f );
        for ( int n = 0; n < 3 * NODES; ++n )
        {
            double3 mean = zero;
            for ( int l = 0; l < 5; ++l )
            {
                const int g = n / NODES * 5 + l, at = g * NODES + n % NODES;
                const double3 y = guide_ghost( &f, g, n % NODES );
                const double apart = double3_distance( y, f.x[n] );
                mean = double3_add( mean, double3_scale( 0.2, y ) );
                distance[at] = frame == 0 ? apart : distance[at];
                assert_close( apart, distance[at], 3e-7 ); // two roundings at a metre
            }
            assert_at( mean, f.x[n], 2e-7 );
        }
    }
}

// ---- Eq. 5, Fig. 2a: at rest ----

TEST( at_rest_the_weights_change_no_bit )
{
    SCOPED( guide_end ) flock with = guide_flock( NULL, 3, 4, NODES ), without = guide_flock( NULL, 3, 4, NODES );
    guide_follow( &with, wisp_default_ghosts_def() );
    guide_follow( &without, guide_without_weights() );
    double3 still[MAX_TARGETS * NODES];
    for ( int n = 0; n < 3 * NODES; ++n )
    {
        still[n] = zero;
    }
    for ( int frame = 0; frame < 10; ++frame )
    {
        swing( &with.s, 8 );
        guide_place( &with, with.s.x, still );
        guide_place( &without, with.s.x, still );
        guide_step( with.world );
        guide_step( without.world );
        assert_memory_equal( guide_points( with.world, with.ghosts ), guide_points( without.world, without.ghosts ),
                             12 * NODES * sizeof( wisp_vec3 ) );
    }
}

// ---- Eq. 2-3: spread ----

TEST( spread_scales_the_offsets_of_a_group_about_a_centre_that_stays )
{
    const float ratios[] = { 0.25f, 1.0f, 2.5f };
    for ( int r = 0; r < 3; ++r )
    {
        SCOPED( guide_end ) flock f = guide_flock( NULL, 2, 4, NODES );
        wisp_ghosts_def def = guide_without_weights();
        def.spread = ratios[r];
        guide_follow( &f, def );
        guide_swing( &f );
        for ( int n = 0; n < 2 * NODES; ++n )
        {
            double3 rest[4], now[4];
            for ( int l = 0; l < 4; ++l )
            {
                rest[l] = f.ghost[( n / NODES * 4 + l ) * NODES + n % NODES];
                now[l] = guide_ghost( &f, n / NODES * 4 + l, n % NODES );
            }
            const double requested = ( n % NODES == 0 ? 1.0 : (double)ratios[r] ) * guide_oracle_spread( rest, 4 );
            // the relative error of V is twice that of the offsets, which are 1e-2 m long and 1e-7 m exact
            assert_close( guide_oracle_spread( now, 4 ) / requested, 1.0, 1e-4 );
            assert_at( guide_oracle_mean( now, 4 ), f.x[n], 2e-7 );
        }
    }
}

// ---- strands of several lengths ----

// One world with strands of three lengths against three worlds of one length each: the same bits.
TEST( strands_of_several_lengths_do_not_meet )
{
    enum
    {
        KINDS = 3,
        EACH = 11
    };
    const int lengths[KINDS] = { 4, 10, 7 };
    double3 targets[KINDS * 3 * NODES], ghosts[KINDS * EACH * NODES], all_targets[KINDS * 3 * NODES];
    double3 all_ghosts[KINDS * EACH * NODES];
    int target_counts[KINDS * 3], ghost_counts[KINDS * EACH], target_total = 0, ghost_total = 0;
    wisp_vec3 alone[KINDS * EACH * NODES];
    wisp_ghosts_def def = wisp_default_ghosts_def();
    for ( int k = 0; k < KINDS; ++k )
    {
        const int first_ghost = ghost_total;
        for ( int s = 0; s < 3; ++s )
        {
            target_counts[k * 3 + s] = lengths[k];
            for ( int i = 0; i < lengths[k]; ++i )
            {
                targets[s * lengths[k] + i] =
                    guide_round( double3_make( 2.0 * k + 0.2 * s, -0.02 * i, 0.01 * i * s ) );
                all_targets[target_total++] = targets[s * lengths[k] + i];
            }
        }
        for ( int s = 0; s < EACH; ++s )
        {
            ghost_counts[k * EACH + s] = lengths[k];
            for ( int i = 0; i < lengths[k]; ++i )
            {
                const double3 at = targets[s % 3 * lengths[k] + i];
                ghosts[s * lengths[k] + i] =
                    guide_round( double3_add( at, double3_scale( 0.01, random_vector( s + 20 * k, i ) ) ) );
                all_ghosts[ghost_total++] = ghosts[s * lengths[k] + i];
            }
        }
        SCOPED( destroy_local ) wisp_world* world = guide_world( NULL );
        def.targets = guide_add( world, targets, 3, lengths[k] );
        const wisp_entity e = guide_add( world, ghosts, EACH, lengths[k] );
        guide_ok( world, wisp_world_attach( world, def.targets, WISP_STRAND_VELOCITY ) );
        guide_write( world, def.targets, WISP_STRAND_VELOCITY, targets ); // any velocity
        guide_ok( world, wisp_request( world, e, WISP_STRAND_POINTS ) );
        guide_ok( world, wisp_set_ghosts( world, e, &def ) );
        guide_step( world );
        memcpy( alone + first_ghost, guide_points( world, e ), (size_t)( EACH * lengths[k] ) * sizeof( wisp_vec3 ) );
    }
    SCOPED( destroy_local ) wisp_world* world = guide_world( NULL );
    def.targets = guide_add_mixed( world, all_targets, KINDS * 3, target_counts );
    const wisp_entity e = guide_add_mixed( world, all_ghosts, KINDS * EACH, ghost_counts );
    guide_ok( world, wisp_world_attach( world, def.targets, WISP_STRAND_VELOCITY ) );
    guide_write( world, def.targets, WISP_STRAND_VELOCITY, all_targets );
    guide_ok( world, wisp_request( world, e, WISP_STRAND_POINTS ) );
    guide_ok( world, wisp_set_ghosts( world, e, &def ) );
    guide_step( world );
    assert_memory_equal( guide_points( world, e ), alone, (size_t)ghost_total * sizeof( wisp_vec3 ) );
}
