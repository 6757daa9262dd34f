// Fused passes run together where an entity has all that the fusion requires and no other passes, once per substep.
#include "plan_fixture.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP

enum
{
    SUBSTEPS = 5,
    STEPS = 60, // within these, every substep of every block is timed once
};

// A substep is move, then project, then read. Hold and blow are allowed, spoil is not.
static const fake_pass PASSES[] = {
    { .name = "hold", .stage = WISP_STAGE_FORCE, .domain = GROUP, .required = "H", .reads = "A", .writes = "A" },
    { .name = "spoil", .stage = WISP_STAGE_FORCE, .domain = GROUP, .required = "K", .reads = "A", .writes = "A" },
    { .name = "move", .stage = WISP_STAGE_PREDICT, .domain = GROUP, .required = "A", .writes = "AB" },
    { .name = "project", .stage = WISP_STAGE_PROJECT, .domain = GROUP, .required = "P", .reads = "B", .writes = "A" },
    { .name = "read", .stage = WISP_STAGE_VELOCITY, .domain = GROUP, .required = "A", .reads = "AB", .writes = "C" },
};

static const wisp_fusion JOIN = {
    .name = "fake.together",
    .required = { "move", "project", "read" },
    .allowed = { "hold" },
    .run = fake_trace_joined,
};

static wisp_world* open_joined( int iterations )
{
    declare_fakes( PASSES, WISP_COUNT( PASSES ) );
    fake.join = &JOIN;
    wisp_world_def def = wisp_default_world_def();
    def.workers = 1;
    def.substeps = SUBSTEPS;
    def.iterations = iterations;
    return open_world_with( &def );
}

// Number of substeps of groups that ran fused, and pass by pass.
typedef struct tally
{
    int together[SUBSTEPS], apart[SUBSTEPS];
} tally;

static tally tally_of_entity( wisp_entity e )
{
    tally t = { { 0 }, { 0 } };
    for ( int i = 0; i < atomic_load( &fake.run_count ); ++i )
    {
        const fake_run* run = fake.runs + i;
        const int groups = run->span.end - run->span.begin;
        const bool is_here = run->span.entity.index == e.index;
        for ( int s = run->span.substep; s < run->substep_end && is_here && run->pass == NULL; ++s )
        {
            t.together[s] += groups;
        }
        if ( is_here && run->pass != NULL && strcmp( run->pass->name, "move" ) == 0 )
        {
            t.apart[run->span.substep] += groups;
        }
    }
    return t;
}

static bool is_ever_together( const tally* t )
{
    int sum = 0;
    for ( int s = 0; s < SUBSTEPS; ++s )
    {
        sum += t->together[s];
    }
    return sum > 0;
}

TEST( every_substep_of_every_group_runs_once_and_most_of_them_together )
{
    wisp_world* world = open_joined( 1 );
    const wisp_entity e = add_with( world, "APH" );
    request( world, e, "C" );
    int together = 0, timed[SUBSTEPS] = { 0 };
    for ( int i = 0; i < STEPS; ++i )
    {
        atomic_store( &fake.run_count, 0 );
        step( world );
        const tally t = tally_of_entity( e );
        for ( int s = 0; s < SUBSTEPS; ++s )
        {
            assert_int_equal( t.together[s] + t.apart[s], 3 );
            together += t.together[s];
            timed[s] += t.apart[s];
        }
    }
    for ( int s = 0; s < SUBSTEPS; ++s )
    {
        assert_int_equal( timed[s], 3 * STEPS / SUBSTEPS );
    }
    // its one block is timed in every step, in one substep
    assert_int_equal( together, 3 * STEPS * ( SUBSTEPS - 1 ) );
    wisp_world_destroy( world );
}

TEST( substeps_of_a_block_stay_in_order )
{
    wisp_world* world = open_joined( 1 );
    const wisp_entity e = add_with( world, "AP" );
    request( world, e, "C" );
    for ( int i = 0; i < SUBSTEPS; ++i )
    {
        atomic_store( &fake.run_count, 0 );
        step( world );
        int next = 0, passes = 0;
        for ( int k = 0; k < atomic_load( &fake.run_count ); ++k )
        {
            const fake_run* run = fake.runs + k;
            assert_int_equal( run->span.substep, next );
            passes += run->pass != NULL ? 1 : 0;
            next = run->pass == NULL ? run->substep_end : next + ( passes % 3 == 0 ? 1 : 0 );
        }
        assert_int_equal( next, SUBSTEPS );
        assert_int_equal( passes, 3 );
    }
    wisp_world_destroy( world );
}

TEST( one_block_in_eight_is_timed )
{
    wisp_world* world = open_joined( 1 );
    const wisp_entity e = test_add_strands( world, 16 * 4 * 32, 2 ); // 32 blocks
    assert_int_equal( wisp_world_attach( world, e, letter( 'A' ) ), WISP_OK );
    assert_int_equal( wisp_world_attach( world, e, letter( 'P' ) ), WISP_OK );
    request( world, e, "C" );
    for ( int i = 0; i < 10; ++i )
    {
        atomic_store( &fake.run_count, 0 );
        step( world );
        const tally t = tally_of_entity( e );
        int apart = 0;
        for ( int s = 0; s < SUBSTEPS; ++s )
        {
            assert_int_equal( t.together[s] + t.apart[s], 4 * 32 );
            apart += t.apart[s];
        }
        assert_int_equal( apart, 4 * 4 );
        const wisp_profile profile = wisp_world_profile( world );
        assert_int_equal( profile.count, 3 );
        for ( int line = 0; line < profile.count; ++line )
        {
            assert_true( profile.lines[line].seconds > 0.0 );
            assert_int_equal( profile.lines[line].items, 4 * 32 * SUBSTEPS );
        }
    }
    wisp_world_destroy( world );
}

TEST( an_entity_with_a_pass_that_the_join_does_not_know_runs_apart_and_its_neighbour_does_not )
{
    wisp_world* world = open_joined( 1 );
    const wisp_entity spoilt = add_with( world, "APK" ), sound = add_with( world, "AP" );
    request( world, spoilt, "C" );
    request( world, sound, "C" );
    step( world );
    const tally other = tally_of_entity( spoilt ), own = tally_of_entity( sound );
    assert_false( is_ever_together( &other ) );
    assert_int_equal( other.apart[0], 3 );
    assert_true( is_ever_together( &own ) );
    wisp_world_destroy( world );
}

TEST( without_a_pass_that_the_join_needs_and_with_more_iterations_passes_run_apart )
{
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        wisp_world* world = open_joined( iterations );
        const wisp_entity e = add_with( world, iterations == 1 ? "A" : "AP" );
        request( world, e, "C" );
        step( world );
        const tally t = tally_of_entity( e );
        assert_false( is_ever_together( &t ) );
        assert_int_equal( t.apart[SUBSTEPS - 1], 3 );
        wisp_world_destroy( world );
    }
}

TEST( the_plan_tells_what_runs_together )
{
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        wisp_world* world = open_joined( iterations );
        const wisp_entity e = add_with( world, "AP" );
        request( world, e, "C" );
        wisp_plan_info* report = NULL;
        assert_int_equal( wisp_world_explain( world, &report ), WISP_OK );
        const wisp_plan_pass* pass = pass_of( report, "project" );
        char line[512];
        wisp_plan_pass_text( pass, line, sizeof( line ) );
        if ( iterations == 1 )
        {
            assert_string_equal( pass->fusion, "fake.together" );
            assert_non_null( strstr( line, "(in fake.together)" ) );
        }
        else
        {
            assert_null( pass->fusion );
            assert_null( strstr( line, "together" ) );
        }
        assert_null( pass_of( report, "spoil" )->fusion );
        wisp_plan_info_release( report );
        wisp_world_destroy( world );
    }
}

TEST( a_join_of_nothing_or_of_unknown_passes_is_refused )
{
    static const wisp_fusion BAD[] = {
        { .name = "fake.nothing", .run = fake_trace_joined },
        { .name = "fake.unknown", .required = { "move", "nowhere" }, .run = fake_trace_joined },
        { .name = "fake.stranger", .required = { "move" }, .allowed = { "nowhere" }, .run = fake_trace_joined },
        { .name = "fake.idle", .required = { "move" } },
    };
    static const wisp_module* const MODULES[] = { &fake_module };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        declare_fakes( PASSES, WISP_COUNT( PASSES ) );
        fake.join = BAD + i;
        wisp_world_def def = wisp_default_world_def();
        def.substeps = 1;
        def.modules = MODULES;
        def.module_count = WISP_COUNT( MODULES );
        wisp_world* world = NULL;
        wisp_error error = { WISP_OK, "" };
        assert_int_equal( wisp_world_create( &def, &world, &error ), WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, BAD[i].name ) );
    }
}
