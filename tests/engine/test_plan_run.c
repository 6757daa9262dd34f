// Execution of a plan: item by item, loop by loop, and only when due.
#include "plan_fixture.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY
#define SHAPE WISP_STAGE_SHAPE

// ---- items ----

TEST( a_fused_node_runs_its_passes_item_by_item )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "a1.0 b1.0 a1.1 b1.1 a1.2 b1.2" );
    wisp_world_destroy( world );
}

TEST( a_lone_pass_runs_over_blocks_of_its_grain )
{
    static const struct
    {
        int grain;
        const char* trace;
    } cuts[] = { { 0, "a1.0-3" }, { 1, "a1.0 a1.1 a1.2" }, { 2, "a1.0-2 a1.2" }, { 3, "a1.0-3" }, { 9, "a1.0-3" } };
    for ( int i = 0; i < WISP_COUNT( cuts ); ++i )
    {
        const fake_pass passes[] = { { "a", SHAPE, GROUP, .writes = "A", .grain = cuts[i].grain } };
        wisp_world* world = OPEN_WORLD( passes );
        request( world, add_with( world, "" ), "A" );
        step( world );
        assert_string_equal( trace_text(), cuts[i].trace );
        wisp_world_destroy( world );
    }
}

TEST( an_entity_pass_runs_once_an_entity )
{
    static const fake_pass passes[] = { { "a", SHAPE, ENTITY, .writes = "A" } };
    wisp_world* world = OPEN_WORLD( passes );
    for ( int i = 0; i < 3; ++i )
    {
        request( world, add_with( world, "" ), "A" );
    }
    step( world );
    assert_string_equal( trace_text(), "a1 a2 a3" );
    wisp_world_destroy( world );
}

TEST( an_entity_without_strands_has_no_group_to_run_over )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, ENTITY, .reads = "A", .writes = "B" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, test_add_strands( world, 0, 0 ), "B" );
    request( world, test_add_strands( world, 5, 0 ), "B" );
    step( world );
    assert_string_equal( trace_text(), "b1 b2" );
    wisp_world_destroy( world );
}

// ---- loops ----

static const fake_pass LOOPS[] = {
    { "observe", WISP_STAGE_OBSERVE, ENTITY, .reads = "A", .writes = "B" },
    { "velocity", WISP_STAGE_VELOCITY, ENTITY, .reads = "A", .writes = "A" },
    { "project", WISP_STAGE_PROJECT, ENTITY, .required = "P", .reads = "A", .writes = "A" },
    { "force", WISP_STAGE_FORCE, ENTITY, .required = "F", .reads = "A", .writes = "A" },
    { "input", WISP_STAGE_INPUT, ENTITY, .writes = "A" },
};

static wisp_world* open_looping( const fake_pass* passes, int count, int substeps, int iterations )
{
    declare_fakes( passes, count );
    wisp_world_def def = wisp_default_world_def();
    def.workers = 1;
    def.substeps = substeps;
    def.iterations = iterations;
    return open_world_with( &def );
}

TEST( loops_run_substeps_times_iterations )
{
    wisp_world* world = open_looping( LOOPS, WISP_COUNT( LOOPS ), 2, 3 );
    request( world, add_with( world, "FP" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "input1 force1 project1 project1 project1 velocity1 "
                                       "force1 project1 project1 project1 velocity1 observe1" );
    wisp_world_destroy( world );
}

TEST( a_loop_without_a_pass_vanishes )
{
    static const fake_pass still[] = {
        { "input", WISP_STAGE_INPUT, ENTITY, .writes = "A" },
        { "observe", WISP_STAGE_OBSERVE, ENTITY, .reads = "A", .writes = "B" },
    };
    wisp_world* world = open_looping( still, WISP_COUNT( still ), 50, 50 );
    request( world, add_with( world, "" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "input1 observe1" );
    assert_int_equal( world->plan.wave_count[PLAN_SUBSTEP], 0 );
    assert_int_equal( world->plan.wave_count[PLAN_ITERATION], 0 );
    assert_int_equal( world->plan.wave_count[PLAN_AFTER_ITERATION], 0 );
    wisp_world_destroy( world );
}

TEST( each_loop_runs_also_where_the_others_are_empty )
{
    static const struct
    {
        wisp_stage stage;
        int runs;
    } lone[] = {
        { WISP_STAGE_INPUT, 1 },    { WISP_STAGE_FORCE, 4 },    { WISP_STAGE_PREDICT, 4 }, { WISP_STAGE_CONTACT, 4 },
        { WISP_STAGE_PROJECT, 20 }, { WISP_STAGE_VELOCITY, 4 }, { WISP_STAGE_CHECK, 1 },   { WISP_STAGE_DERIVE, 1 },
        { WISP_STAGE_SHAPE, 1 },    { WISP_STAGE_OBSERVE, 1 },
    };
    for ( int i = 0; i < WISP_COUNT( lone ); ++i )
    {
        const fake_pass passes[] = { { "lone", lone[i].stage, ENTITY, .writes = "A" } };
        wisp_world* world = open_looping( passes, WISP_COUNT( passes ), 4, 5 );
        request( world, add_with( world, "" ), "A" );
        step( world );
        assert_int_equal( runs_of( "lone" ), lone[i].runs );
        wisp_world_destroy( world );
    }
}

// ---- on change ----

static const fake_pass WATCHING[] = {
    { "watch", SHAPE, ENTITY, .required = "N", .reads = "N", .writes = "A", .on_change = 'N' },
};

TEST( a_pass_on_change_runs_first_and_then_only_when_rows_were_written )
{
    wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity e = add_with( world, "NM" );
    request( world, e, "A" );
    step( world );
    assert_string_equal( trace_text(), "watch1" );
    step( world );
    assert_string_equal( trace_text(), "" );

    wisp_world_column( world, e, letter( 'N' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "watch1" );
    wisp_world_column( world, e, letter( 'M' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "" );
    wisp_world_destroy( world );
}

TEST( a_change_of_one_entity_wakes_no_other )
{
    wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity first = add_with( world, "N" ), second = add_with( world, "N" );
    request( world, first, "A" );
    request( world, second, "A" );
    step( world );
    trace_text();
    wisp_world_column( world, second, letter( 'N' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "watch2" );
    wisp_world_destroy( world );
}

TEST( a_new_entity_in_a_reused_slot_is_a_change )
{
    wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    step( world );
    assert_int_equal( wisp_remove( world, e ), WISP_OK );
    e = add_with( world, "N" );
    request( world, e, "A" );
    trace_text();
    step( world );
    assert_string_equal( trace_text(), "watch1" );
    wisp_world_destroy( world );
}

TEST( a_pass_that_writes_what_it_watches_does_not_wake_itself )
{
    static const fake_pass passes[] = { { "self", SHAPE, ENTITY, .reads = "A", .writes = "A", .on_change = 'A' } };
    wisp_world* world = OPEN_WORLD( passes );
    wisp_entity e = add_with( world, "A" );
    request( world, e, "A" );
    for ( int i = 0; i < 3; ++i )
    {
        step( world );
    }
    assert_string_equal( trace_text(), "self1" );
    wisp_world_column( world, e, letter( 'A' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "self1" );
    wisp_world_destroy( world );
}

TEST( what_a_pass_writes_wakes_the_passes_behind_it_in_the_same_step )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .required = "N", .reads = "N", .writes = "A", .on_change = 'N', .grain = 9 },
        { "fused", SHAPE, GROUP, .reads = "A", .writes = "B", .on_change = 'A' },
        { "later", SHAPE, ENTITY, .reads = "B", .writes = "C", .on_change = 'B' },
    };
    wisp_world* world = OPEN_WORLD( passes );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "C" );
    for ( int i = 0; i < 2; ++i )
    {
        step( world );
        assert_string_equal( trace_text(), "make1.0 fused1.0 make1.1 fused1.1 make1.2 fused1.2 later1" );
        step( world );
        assert_string_equal( trace_text(), "" );
        wisp_world_column( world, e, letter( 'N' ), 0 );
    }
    wisp_world_destroy( world );
}

TEST( a_request_taken_back_and_made_again_is_answered_again )
{
    wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    step( world );
    assert_string_equal( trace_text(), "watch1" );
    cancel_request( world, e, "A" );
    step( world );
    request( world, e, "A" ); // its rows are new and zero
    step( world );
    wisp_world_destroy( world );
    assert_string_equal( trace_text(), "watch1" );
}

// ---- due ----

static const fake_pass ASKING[] = {
    { "ask", WISP_STAGE_INPUT, ENTITY, .required = "N", .writes = "A", .asks = true },
    { "then", SHAPE, ENTITY, .reads = "A", .writes = "B", .on_change = 'A' },
};

TEST( a_pass_that_is_not_due_neither_runs_nor_wakes_others )
{
    wisp_world* world = OPEN_WORLD( ASKING );
    request( world, add_with( world, "N" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "ask1 then1" );
    fake.due = false;
    step( world );
    assert_string_equal( trace_text(), "" );
    fake.due = true;
    step( world );
    assert_string_equal( trace_text(), "ask1 then1" );
    wisp_world_destroy( world );
}

TEST( a_pass_is_queried_once_a_step_and_entity )
{
    wisp_world* world = OPEN_WORLD( ASKING );
    request( world, add_with( world, "N" ), "B" );
    request( world, add_with( world, "N" ), "B" );
    step( world );
    step( world );
    assert_int_equal( fake.queried, 4 );
    wisp_world_destroy( world );
}

TEST( a_pass_is_queried_when_the_passes_before_it_have_run )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "ask", SHAPE, GROUP, .reads = "A", .writes = "B", .asks = true },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    step( world );
    wisp_world_destroy( world );
    assert_int_equal( fake.queried, 1 );
    assert_int_equal( fake.runs_before, runs_of( "a" ) );
}

TEST( a_change_waits_for_a_pass_that_is_not_due )
{
    static const fake_pass passes[] = {
        { "both", SHAPE, ENTITY, .required = "N", .reads = "N", .writes = "A", .on_change = 'N', .asks = true },
    };
    wisp_world* world = OPEN_WORLD( passes );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    step( world );
    assert_string_equal( trace_text(), "both1" );
    fake.due = false;
    wisp_world_column( world, e, letter( 'N' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "" );
    fake.due = true;
    step( world );
    assert_string_equal( trace_text(), "both1" );
    step( world );
    assert_string_equal( trace_text(), "" );
    wisp_world_destroy( world );
}

TEST( passes_that_were_not_due_took_no_time )
{
    wisp_world* world = OPEN_WORLD( WATCHING );
    request( world, add_with( world, "N" ), "A" );
    step( world );
    assert_int_equal( wisp_world_profile( world ).lines[0].items, 1 );
    step( world );
    wisp_profile p = wisp_world_profile( world );
    assert_int_equal( p.count, 1 );
    assert_int_equal( p.lines[0].items, 0 );
    assert_true( p.lines[0].seconds == 0.0 );
    wisp_world_destroy( world );
}
