// Ghosts in a world: order within a step, memory, removal, rejected input, and an appearance effect on
// them.
#include "guide_hair_fixture.h"

#include "strands.h"

static double3 group_mean( const flock* f, int target, int ghosts, int node )
{
    double3 nodes[MAX_GHOSTS];
    for ( int l = 0; l < ghosts; ++l )
    {
        nodes[l] = guide_ghost( f, target * ghosts + l, node );
    }
    return guide_oracle_mean( nodes, ghosts );
}

// ---- order ----

TEST( ghosts_stand_where_this_step_has_taken_their_targets )
{
    for ( int workers = 1; workers <= 2; ++workers )
    {
        const guide_host host = { .workers = workers };
        SCOPED( guide_end ) flock f = guide_flock( &host, 6, 6, NODES );
        guide_ok( f.world, wisp_world_attach( f.world, f.targets, guide_mover_speed ) );
        *(float*)wisp_world_column( f.world, f.targets, guide_mover_speed, 0 ) = 6.0f;
        guide_follow( &f, guide_without_weights() );
        for ( int frame = 1; frame <= 30; ++frame )
        {
            guide_step( f.world );
            for ( int n = 0; n < 6 * NODES; ++n )
            {
                // 0.1 m per step; a delay of one step would show at once. Sums of floats up to 3 m
                const double3 there = double3_add( f.s.target[n], double3_make( 0.1 * frame, 0.0, 0.0 ) );
                assert_at( group_mean( &f, n / NODES, 6, n % NODES ), there, 5e-6 );
            }
        }
    }
}

// ---- removal ----

TEST( when_targets_go_their_ghosts_stay_and_when_ghosts_go_nothing_runs_for_them )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES );
    guide_follow( &f, wisp_default_ghosts_def() );
    guide_swing( &f );
    wisp_vec3 last[12 * NODES];
    memcpy( last, guide_points( f.world, f.ghosts ), sizeof( last ) );
    guide_ok( f.world, wisp_remove( f.world, f.targets ) );
    guide_step( f.world );
    guide_step( f.world );
    assert_memory_equal( guide_points( f.world, f.ghosts ), last, sizeof( last ) );

    // others to follow
    f.targets = guide_add( f.world, f.s.target, 3, NODES );
    guide_follow( &f, guide_without_weights() );
    guide_step( f.world );
    assert_at( group_mean( &f, 1, 4, 3 ), f.s.target[NODES + 3], 2e-7 );
    guide_ok( f.world, wisp_remove( f.world, f.ghosts ) );
    assert_int_equal( wisp_world_plan_passes( f.world ), 0 );
    guide_step( f.world );
}

TEST( two_herds_may_follow_the_same_targets_each_in_its_way )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES ), alone = guide_flock( NULL, 3, 4, NODES );
    const wisp_entity other = guide_add( f.world, f.ghost, 12, NODES );
    guide_ok( f.world, wisp_request( f.world, other, WISP_STRAND_POINTS ) );
    guide_follow( &f, wisp_default_ghosts_def() );
    guide_follow( &alone, wisp_default_ghosts_def() );
    wisp_ghosts_def def = guide_without_weights();
    def.targets = f.targets;
    guide_ok( f.world, wisp_set_ghosts( f.world, other, &def ) );
    for ( int frame = 0; frame < 5; ++frame )
    {
        guide_swing( &f );
        guide_swing( &alone );
    }
    const wisp_vec3 *a = guide_points( f.world, f.ghosts ), *b = guide_points( alone.world, alone.ghosts );
    assert_memory_equal( a, b, 12 * NODES * sizeof( wisp_vec3 ) );
    assert_memory_not_equal( guide_points( f.world, other ), b, 12 * NODES * sizeof( wisp_vec3 ) );
}

// ---- refusals ----

static void refuse( flock* f, wisp_ghosts_def def, wisp_status status, const char* word )
{
    const uint64_t before = wisp_world_hash( f->world );
    assert_int_equal( wisp_set_ghosts( f->world, f->ghosts, &def ), status );
    assert_contains( wisp_world_message( f->world ), word );
    assert_int_equal( wisp_world_hash( f->world ), before );
}

// Unequal node counts (conclusion)
TEST( unequal_node_counts_are_refused_by_name_unless_resampled )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, 7 );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.targets = f.targets;
    refuse( &f, def, WISP_BAD_INPUT, "ghost 0: got 7 vertices, but its target 0 has 10" );
    def.resample = true;
    guide_ok( f.world, wisp_set_ghosts( f.world, f.ghosts, &def ) );
}

TEST( who_cannot_follow_or_be_followed_is_refused )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 3, 4, NODES );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    refuse( &f, def, WISP_CONFLICT, "does not exist" );
    def.targets = f.ghosts;
    refuse( &f, def, WISP_CONFLICT, "itself" );
    def.targets = guide_add( f.world, f.s.target, 0, NODES );
    refuse( &f, def, WISP_CONFLICT, "has no vertices" );
    guide_ok( f.world, wisp_world_add_pairs( f.world, 0, &def.targets ) );
    refuse( &f, def, WISP_CONFLICT, "no strands" );
    def.targets = guide_add( f.world, f.s.target, 3, NODES );
    const wisp_entity gone = def.targets;
    guide_ok( f.world, wisp_remove( f.world, gone ) );
    refuse( &f, def, WISP_STALE_ID, "does not exist" );

    // targets move by themselves, so they cannot be ghosts; ghosts cannot be targets
    def.targets = f.ghosts;
    assert_int_equal( wisp_set_ghosts( f.world, f.targets, &def ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( f.world ), "has a solver of its own" ) );
    guide_follow( &f, wisp_default_ghosts_def() );
    const wisp_entity more = guide_add( f.world, f.ghost, 12, NODES );
    assert_int_equal( wisp_set_ghosts( f.world, more, &def ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( f.world ), "are ghosts themselves" ) );
}

// ---- an appearance effect on ghosts ----

static wisp_frozen_hair_def align_each_frame( void )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.freeze = def.clump = false;
    def.update_on = WISP_FROZEN_UPDATE_FRAME;
    def.cursor = ( wisp_vec3 ){ 0.3f, 0.5f, 0.2f };
    def.reach = 100.0f;
    return def;
}

// Ghosts that turn to a cursor each frame, against static hair at the ghosts' positions that turns once.
TEST( frozen_hair_starts_from_where_the_ghosts_are_carried )
{
    for ( int order = 0; order < 3; ++order )
    {
        const guide_host host = { .workers = order + 1 };
        flock f = guide_flock( &host, 6, 6, NODES ), plain = guide_flock( NULL, 6, 6, NODES );
        const wisp_frozen_hair_def look = align_each_frame();
        // for any order of the calls
        for ( int call = 0; call < 3; ++call )
        {
            switch ( ( call + order ) % 3 )
            {
                case 0:
                    guide_follow( &f, wisp_default_ghosts_def() );
                    break;
                case 1:
                    guide_ok( f.world, wisp_set_frozen_hair( f.world, f.ghosts, &look ) );
                    break;
                default:
                    guide_ok( f.world, wisp_request( f.world, f.ghosts, WISP_STRAND_POSED ) );
                    break;
            }
        }
        guide_follow( &plain, wisp_default_ghosts_def() );
        for ( int frame = 0; frame < 6; ++frame )
        {
            guide_swing( &f );
            guide_swing( &plain );
            double3 posed[36 * NODES];
            for ( int n = 0; n < 36 * NODES; ++n )
            {
                posed[n] = guide_ghost( &plain, n / NODES, n % NODES );
            }
            SCOPED( destroy_local ) wisp_world* still = guide_world( NULL );
            const wisp_entity hair = guide_add( still, posed, 36, NODES );
            guide_ok( still, wisp_request( still, hair, WISP_STRAND_POINTS ) );
            guide_ok( still, wisp_set_frozen_hair( still, hair, &look ) );
            guide_step( still );
            assert_memory_equal( guide_points( f.world, f.ghosts ), guide_points( still, hair ),
                                 36 * NODES * sizeof( wisp_vec3 ) );
        }
        guide_end( &plain );
        guide_end( &f );
    }
}

TEST( frozen_lengths_stay_those_at_rest )
{
    SCOPED( guide_end ) flock f = guide_flock( NULL, 6, 6, NODES );
    wisp_frozen_hair_def look = wisp_default_frozen_hair_def();
    look.align = look.clump = false;
    look.update_on = WISP_FROZEN_UPDATE_FRAME;
    look.stretch_stiffness = 1e6f;
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.time = 0.1f; // stretches the ghosts
    guide_follow( &f, def );
    guide_ok( f.world, wisp_set_frozen_hair( f.world, f.ghosts, &look ) );
    guide_ok( f.world, wisp_request( f.world, f.ghosts, WISP_STRAND_POSED ) );
    for ( int frame = 0; frame < 20; ++frame )
    {
        guide_swing( &f );
    }
    for ( int n = 0; n < 36 * NODES; ++n )
    {
        if ( n % NODES > 0 )
        {
            const double now = double3_distance( guide_ghost( &f, n / NODES, n % NODES ),
                                                 guide_ghost( &f, n / NODES, n % NODES - 1 ) );
            // 1/k of the length is random, and a float at a metre is 6e-8 of 2e-2
            assert_close( now / double3_distance( f.ghost[n], f.ghost[n - 1] ), 1.0, 2e-5 );
        }
    }
}

// ---- targets that leave their bounds ----

static void assert_finite( wisp_world* world, wisp_entity strands, int count )
{
    wisp_view view;
    guide_ok( world, wisp_world_view( world, strands, WISP_STRAND_POINTS, &view ) );
    const wisp_vec3* points = view.data;
    for ( int i = 0; i < count; ++i )
    {
        assert_true( isfinite( points[i].x ) && isfinite( points[i].y ) && isfinite( points[i].z ) );
    }
}

// The module of the ghosts is declared first, so the order of modules does not help.
TEST( ghosts_are_finite_whatever_their_targets_do )
{
    static const wisp_module* const modules[] = { &wisp_guide_hair_module, &wisp_strands_module };
    const float speeds[] = { NAN, INFINITY, -INFINITY, 9e5f, 3e38f };
    for ( int k = 0; k < 2 * WISP_COUNT( speeds ); ++k )
    {
        wisp_world_def world_def = wisp_default_world_def();
        world_def.modules = modules;
        world_def.module_count = WISP_COUNT( modules );
        world_def.log = guide_forget;
        SCOPED( destroy_local ) wisp_world* world;
        guide_ok( NULL, wisp_world_create( &world_def, &world, NULL ) );
        const double3 nodes[] = { { 0.0, 0.0, 0.0 }, { 0.1, 0.0, 0.0 }, { 0.2, 0.0, 0.0 } };
        const wisp_entity targets = guide_add( world, nodes, 1, 3 ), ghosts = guide_add( world, nodes, 1, 3 );
        wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
        dynamics.stretch = WISP_STRAND_STRETCH_LINKS; // a direct solve resets a strand that is not finite
        guide_ok( world, wisp_set_strand_dynamics( world, targets, &dynamics ) );
        wisp_ghosts_def def = wisp_default_ghosts_def();
        def.targets = targets;
        def.elastic = k % 2 == 0 ? WISP_GHOST_ELASTIC_CHANGE : WISP_GHOST_ELASTIC_OFF;
        guide_ok( world, wisp_set_ghosts( world, ghosts, &def ) );
        guide_ok( world, wisp_request( world, ghosts, WISP_STRAND_POINTS ) );
        for ( int frame = 0; frame < 4; ++frame )
        {
            float* velocity = wisp_world_column( world, targets, WISP_STRAND_VELOCITY, 0 );
            velocity[2 * 3 * WISP_LANES] = frame == 1 ? speeds[k / 2] : velocity[2 * 3 * WISP_LANES];
            guide_step( world );
            assert_finite( world, ghosts, 3 );
        }
    }
}
