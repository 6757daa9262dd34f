// Execution of a plan: item by item, loop by loop, and only when due; fused passes together where an entity has all that
// the fusion requires and no other passes, once per substep; and modules with more components and passes than one word
// has bits, which run, wait, and are restored like the first ones, up to the limit.
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
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "a1.0 b1.0 a1.1 b1.1 a1.2 b1.2" );
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
        SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
        request( world, add_with( world, "" ), "A" );
        step( world );
        assert_string_equal( trace_text(), cuts[i].trace );
    }
}

TEST( an_entity_pass_runs_once_an_entity )
{
    static const fake_pass passes[] = { { "a", SHAPE, ENTITY, .writes = "A" } };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    for ( int i = 0; i < 3; ++i )
    {
        request( world, add_with( world, "" ), "A" );
    }
    step( world );
    assert_string_equal( trace_text(), "a1 a2 a3" );
}

TEST( an_entity_without_strands_has_no_group_to_run_over )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, ENTITY, .reads = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, test_add_strands( world, 0, 0 ), "B" );
    request( world, test_add_strands( world, 5, 0 ), "B" );
    step( world );
    assert_string_equal( trace_text(), "b1 b2" );
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
    SCOPED( destroy_local ) wisp_world* world = open_looping( LOOPS, WISP_COUNT( LOOPS ), 2, 3 );
    request( world, add_with( world, "FP" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "input1 force1 project1 project1 project1 velocity1 "
                                       "force1 project1 project1 project1 velocity1 observe1" );
}

TEST( a_loop_without_a_pass_vanishes )
{
    static const fake_pass still[] = {
        { "input", WISP_STAGE_INPUT, ENTITY, .writes = "A" },
        { "observe", WISP_STAGE_OBSERVE, ENTITY, .reads = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = open_looping( still, WISP_COUNT( still ), 50, 50 );
    request( world, add_with( world, "" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "input1 observe1" );
    assert_int_equal( world->plan.wave_count[PLAN_SUBSTEP], 0 );
    assert_int_equal( world->plan.wave_count[PLAN_ITERATION], 0 );
    assert_int_equal( world->plan.wave_count[PLAN_AFTER_ITERATION], 0 );
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
        SCOPED( destroy_local ) wisp_world* world = open_looping( passes, WISP_COUNT( passes ), 4, 5 );
        request( world, add_with( world, "" ), "A" );
        step( world );
        assert_int_equal( runs_of( "lone" ), lone[i].runs );
    }
}

// ---- on change ----

static const fake_pass WATCHING[] = {
    { "watch", SHAPE, ENTITY, .required = "N", .reads = "N", .writes = "A", .on_change = 'N' },
};

TEST( a_pass_on_change_runs_first_and_then_only_when_rows_were_written )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( WATCHING );
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
}

TEST( a_change_of_one_entity_wakes_no_other )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity first = add_with( world, "N" ), second = add_with( world, "N" );
    request( world, first, "A" );
    request( world, second, "A" );
    step( world );
    trace_text();
    wisp_world_column( world, second, letter( 'N' ), 0 );
    step( world );
    assert_string_equal( trace_text(), "watch2" );
}

TEST( a_new_entity_in_a_reused_slot_is_a_change )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( WATCHING );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    step( world );
    assert_int_equal( wisp_remove( world, e ), WISP_OK );
    e = add_with( world, "N" );
    request( world, e, "A" );
    trace_text();
    step( world );
    assert_string_equal( trace_text(), "watch1" );
}

TEST( a_pass_that_writes_what_it_watches_does_not_wake_itself )
{
    static const fake_pass passes[] = { { "self", SHAPE, ENTITY, .reads = "A", .writes = "A", .on_change = 'A' } };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
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
}

TEST( what_a_pass_writes_wakes_the_passes_behind_it_in_the_same_step )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .required = "N", .reads = "N", .writes = "A", .on_change = 'N', .grain = 9 },
        { "fused", SHAPE, GROUP, .reads = "A", .writes = "B", .on_change = 'A' },
        { "later", SHAPE, ENTITY, .reads = "B", .writes = "C", .on_change = 'B' },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
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
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( ASKING );
    request( world, add_with( world, "N" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "ask1 then1" );
    fake.due = false;
    step( world );
    assert_string_equal( trace_text(), "" );
    fake.due = true;
    step( world );
    assert_string_equal( trace_text(), "ask1 then1" );
}

TEST( a_pass_is_queried_once_a_step_and_entity )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( ASKING );
    request( world, add_with( world, "N" ), "B" );
    request( world, add_with( world, "N" ), "B" );
    step( world );
    step( world );
    assert_int_equal( fake.queried, 4 );
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
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
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
}

TEST( passes_that_were_not_due_took_no_time )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( WATCHING );
    request( world, add_with( world, "N" ), "A" );
    step( world );
    assert_int_equal( wisp_world_profile( world ).lines[0].items, 1 );
    step( world );
    wisp_profile p = wisp_world_profile( world );
    assert_int_equal( p.count, 1 );
    assert_int_equal( p.lines[0].items, 0 );
    assert_true( p.lines[0].seconds == 0.0 );
}

// ---- fused passes ----

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
    SCOPED( destroy_local ) wisp_world* world = open_joined( 1 );
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
}

TEST( substeps_of_a_block_stay_in_order )
{
    SCOPED( destroy_local ) wisp_world* world = open_joined( 1 );
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
}

TEST( one_block_in_eight_is_timed )
{
    SCOPED( destroy_local ) wisp_world* world = open_joined( 1 );
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
}

TEST( an_entity_with_a_pass_that_the_join_does_not_know_runs_apart_and_its_neighbour_does_not )
{
    SCOPED( destroy_local ) wisp_world* world = open_joined( 1 );
    const wisp_entity spoilt = add_with( world, "APK" ), sound = add_with( world, "AP" );
    request( world, spoilt, "C" );
    request( world, sound, "C" );
    step( world );
    const tally other = tally_of_entity( spoilt ), own = tally_of_entity( sound );
    assert_false( is_ever_together( &other ) );
    assert_int_equal( other.apart[0], 3 );
    assert_true( is_ever_together( &own ) );
}

TEST( without_a_pass_that_the_join_needs_and_with_more_iterations_passes_run_apart )
{
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        SCOPED( destroy_local ) wisp_world* world = open_joined( iterations );
        const wisp_entity e = add_with( world, iterations == 1 ? "A" : "AP" );
        request( world, e, "C" );
        step( world );
        const tally t = tally_of_entity( e );
        assert_false( is_ever_together( &t ) );
        assert_int_equal( t.apart[SUBSTEPS - 1], 3 );
    }
}

TEST( the_plan_tells_what_runs_together )
{
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        SCOPED( destroy_local ) wisp_world* world = open_joined( iterations );
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

// ---- more than a word of bits ----

enum
{
    MANY = 180,     // passes, and components besides the first
    BEYOND = 130,   // a pass behind the second word
    TOO_MANY = 300, // more than any world has
};

static struct
{
    wisp_component values[MANY + 1];
    int runs[MANY];
    bool watches; // pass i runs when value i was written
    char names[TOO_MANY][24];
    char pass_names[TOO_MANY][24];
} many;

static const wisp_column_def VALUE[] = { { "value", sizeof( int32_t ) } };

// Value i + 1 is one more than value i.
static void add_one( wisp_frame* frame, const wisp_span* span, void* user )
{
    const int i = (int)( (int*)user - many.runs );
    const int32_t* from = wisp_frame_column( frame, span->entity, many.values[i], 0 );
    int32_t* to = wisp_frame_column( frame, span->entity, many.values[i + 1], 0 );
    *to = wisp_frame_has( frame, span->entity, many.values[i] ) ? *from + 1 : -1;
    many.runs[i] += 1;
}

static wisp_component declare_value( wisp_registry* r, int i )
{
    snprintf( many.names[i], sizeof( many.names[i] ), "host.value%d", i );
    return wisp_declare_component( r, &( wisp_component_def ){ many.names[i], WISP_TABLE_ENTITY, VALUE, 1 } );
}

// The last pass first, so that data decides the order.
static wisp_status declare_chain( wisp_registry* r )
{
    for ( int i = 0; i <= MANY; ++i )
    {
        many.values[i] = declare_value( r, i );
    }
    wisp_status status = WISP_OK;
    for ( int i = MANY - 1; i >= 0 && status == WISP_OK; --i )
    {
        snprintf( many.pass_names[i], sizeof( many.pass_names[i] ), "host.add%d", i );
        status = wisp_declare_pass( r, &( wisp_pass ){
                                           .name = many.pass_names[i],
                                           .stage = WISP_STAGE_SHAPE,
                                           .domain = WISP_DOMAIN_ENTITY,
                                           .required = { many.values[0] },
                                           .reads = { many.values[i] },
                                           .writes = { many.values[i + 1] },
                                           .on_change = many.watches ? many.values[i] : (wisp_component)0,
                                           .run = add_one,
                                           .user = many.runs + i,
                                       } );
    }
    return status;
}

static wisp_world* open_chain( bool watches, wisp_entity* e )
{
    static const wisp_module host = { .name = "host", .declare = declare_chain };
    static const wisp_module* const modules[] = { &host };
    memset( (void*)&many, 0, sizeof( many ) );
    many.watches = watches;
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 1;
    def.modules = modules;
    def.module_count = 1;
    wisp_world* world = open_world_with( &def );
    *e = test_add_strands( world, 1, 2 );
    assert_int_equal( wisp_world_attach( world, *e, many.values[0] ), WISP_OK );
    assert_int_equal( wisp_request( world, *e, many.values[MANY] ), WISP_OK );
    return world;
}

static int32_t* value_of( wisp_world* world, wisp_entity e, int i )
{
    return wisp_world_column( world, e, many.values[i], 0 );
}

TEST( passes_and_components_beyond_two_words_run_in_the_order_of_their_data )
{
    wisp_entity e;
    SCOPED( destroy_local ) wisp_world* world = open_chain( false, &e );
    *value_of( world, e, 0 ) = 5;
    step( world );
    assert_int_equal( wisp_world_plan_passes( world ), MANY );
    assert_int_equal( *value_of( world, e, MANY ), 5 + MANY );
    assert_int_equal( wisp_world_profile( world ).count, MANY );
}

TEST( a_pass_that_nobody_requests_is_absent_beyond_two_words )
{
    wisp_entity e;
    SCOPED( destroy_local ) wisp_world* world = open_chain( false, &e );
    assert_int_equal( wisp_cancel_request( world, e, many.values[MANY] ), WISP_OK );
    assert_int_equal( wisp_request( world, e, many.values[BEYOND] ), WISP_OK );
    step( world );
    assert_int_equal( wisp_world_plan_passes( world ), BEYOND );
    assert_false( wisp_world_has( world, e, many.values[MANY] ) );
    assert_null( value_of( world, e, MANY ) );
}

TEST( a_write_beyond_two_words_wakes_the_passes_behind_it_alone )
{
    wisp_entity e;
    SCOPED( destroy_local ) wisp_world* world = open_chain( true, &e );
    step( world );
    step( world );
    assert_int_equal( many.runs[0], 1 );
    assert_int_equal( many.runs[MANY - 1], 1 );
    *value_of( world, e, BEYOND ) = 1000;
    step( world );
    assert_int_equal( many.runs[BEYOND - 1], 1 );
    assert_int_equal( many.runs[BEYOND], 2 );
    assert_int_equal( many.runs[MANY - 1], 2 );
    assert_int_equal( *value_of( world, e, MANY ), 1000 + MANY - BEYOND );
}

TEST( what_waits_beyond_two_words_is_restored )
{
    wisp_entity e;
    SCOPED( destroy_local ) wisp_world* world = open_chain( true, &e );
    step( world );
    *value_of( world, e, BEYOND ) = 1000;
    const size_t size = store_snapshot_size( &world->store );
    void* bytes = checked_malloc( size );
    store_snapshot( &world->store, bytes );
    step( world );
    assert_int_equal( many.runs[MANY - 1], 2 );
    assert_int_equal( store_restore( &world->store, bytes, size, NULL ), WISP_OK );
    free( bytes );
    step( world );
    assert_int_equal( many.runs[BEYOND - 1], 1 );
    assert_int_equal( many.runs[MANY - 1], 3 );
}

// ---- the limits ----

static wisp_status declare_too_many_components( wisp_registry* r )
{
    for ( int i = 0; i < TOO_MANY; ++i )
    {
        declare_value( r, i );
    }
    return WISP_OK;
}

static wisp_status declare_too_many_passes( wisp_registry* r )
{
    const wisp_component value = declare_value( r, 0 );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < TOO_MANY && status == WISP_OK; ++i )
    {
        snprintf( many.pass_names[i], sizeof( many.pass_names[i] ), "host.add%d", i );
        status =
            wisp_declare_pass( r, &( wisp_pass ){ .name = many.pass_names[i], .writes = { value }, .run = add_one } );
    }
    return status;
}

static void assert_refused( wisp_status ( *declare )( wisp_registry* r ), const char* sentence )
{
    const wisp_module host = { .name = "host", .declare = declare };
    const wisp_module* const modules[] = { &host };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = 1;
    wisp_world* world = NULL;
    wisp_error error = { WISP_OK, "" };
    assert_int_equal( wisp_world_create( &def, &world, &error ), WISP_BAD_INPUT );
    assert_null( world );
    assert_string_equal( error.message, sentence );
}

TEST( the_first_declaration_beyond_the_limit_is_named )
{
    char sentence[200];
    wisp_entity e;
    wisp_world* world = open_chain( false, &e );
    const int own = world->registry.pass_count - MANY; // passes of every world
    const int components = world->store.component_count - ( MANY + 1 );
    wisp_world_destroy( world );
    snprintf( sentence, sizeof( sentence ),
              "module 'host': too many components, or declared differently by another module: 'host.value%d'",
              256 - components );
    assert_refused( declare_too_many_components, sentence );
    snprintf( sentence, sizeof( sentence ),
              "module 'host': too many passes, or a pass without a function or an output: 'host.add%d'", 256 - own );
    assert_refused( declare_too_many_passes, sentence );
}
