// The plan as data: the report on selected and absent passes, on modules, and on cost.
#include "plan_fixture.h"

static void plan_info_local( wisp_plan_info** local )
{
    wisp_plan_info_release( *local );
}

#define SHAPE WISP_STAGE_SHAPE
#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY

enum
{
    ROWS = 3,      // add_with() makes three groups of strands
    ROW_BYTES = 4, // of a letter's one column
};

static const fake_pass CHAIN[] = {
    { "make", WISP_STAGE_INPUT, GROUP, .required = "N", .writes = "A" },
    { "bend", WISP_STAGE_PROJECT, ENTITY, .reads = "A", .writes = "A" },
    { "show", WISP_STAGE_OBSERVE, GROUP, .reads = "A", .writes = "B" },
    { "needy", SHAPE, GROUP, .required = "NM", .writes = "C" },
    { "idle", SHAPE, GROUP, .required = "N", .excluded = "P", .writes = "D" },
    { "torn", SHAPE, GROUP, .required = "KL", .writes = "E" },
    { "shy", SHAPE, GROUP, .required = "K", .excluded = "O", .writes = "F" },
};

static wisp_plan_info* explain( wisp_world* world )
{
    wisp_plan_info* report = NULL;
    if ( wisp_world_explain( world, &report ) != WISP_OK )
    {
        fail_msg( "no report: %s", wisp_world_message( world ) );
    }
    return report;
}

static const wisp_plan_module* module_of( const wisp_plan_info* report, const char* name )
{
    for ( int i = 0; i < report->module_count; ++i )
    {
        if ( strcmp( report->modules[i].name, name ) == 0 )
        {
            return report->modules + i;
        }
    }
    fail_msg( "no module is called %s", name );
    return NULL;
}

static wisp_world* open_chain( void )
{
    wisp_world* world = OPEN_WORLD( CHAIN );
    request( world, add_with( world, "N" ), "B" );
    add_with( world, "KO" );
    add_with( world, "L" );
    return world;
}

static void assert_list( const char* const* names, const char* letters )
{
    char name[8];
    int i = 0;
    for ( ; letters[i] != 0; ++i )
    {
        snprintf( name, sizeof( name ), "fake.%c", letters[i] );
        assert_non_null( names[i] );
        assert_string_equal( names[i], name );
    }
    assert_null( names[i] );
}

TEST( a_kept_pass_tells_where_it_runs_and_on_what )
{
    SCOPED( destroy_local ) wisp_world* world = open_chain();
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    assert_int_equal( report->active_count, 3 );
    const char* const in_order[] = { "make", "bend", "show" };
    const char* const loops[] = { "before", "iteration", "after" };
    const char* const stages[] = { "input", "project", "observe" };
    for ( int i = 0; i < 3; ++i )
    {
        const wisp_plan_pass* p = report->passes + i;
        assert_string_equal( p->name, in_order[i] );
        assert_string_equal( p->module, "fake" );
        assert_string_equal( p->loop, loops[i] );
        assert_string_equal( p->stage, stages[i] );
        assert_int_equal( p->state, WISP_PLAN_ACTIVE );
        assert_int_equal( p->wave, 0 );
        assert_int_equal( p->entities, 1 );
        assert_int_equal( p->items, i == 1 ? 1 : ROWS );
        assert_int_equal( p->blocks, 1 );
        assert_null( p->missing[0] );
    }
    assert_string_equal( report->passes[0].domain, "strand group" );
    assert_string_equal( report->passes[1].domain, "entity" );
}

TEST( a_kept_pass_tells_what_it_uses_and_all_who_request_it )
{
    SCOPED( destroy_local ) wisp_world* world = open_chain();
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    const wisp_plan_pass *make = pass_of( report, "make" ), *show = pass_of( report, "show" );
    assert_list( make->required, "N" );
    assert_list( make->reads, "" );
    assert_list( make->writes, "A" );
    assert_list( show->reads, "A" );
    assert_list( pass_of( report, "idle" )->excluded, "P" );
    assert_int_equal( make->reason_count, 2 );
    assert_string_equal( make->reasons[0].component, "fake.A" );
    assert_string_equal( make->reasons[0].reader, "bend" );
    assert_string_equal( make->reasons[1].reader, "show" );
    assert_int_equal( show->reason_count, 1 );
    assert_string_equal( show->reasons[0].component, "fake.B" );
    assert_null( show->reasons[0].reader );
    assert_string_equal( make->because, "fake.A read by bend and show" );
}

TEST( of_many_readers_words_name_three_and_the_list_has_all )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .writes = "A" },
        { "r1", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "r2", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "r3", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "r4", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "r5", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "AB" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    const wisp_plan_pass* make = pass_of( report, "make" );
    assert_int_equal( make->reason_count, 6 );
    assert_null( make->reasons[0].reader );
    assert_string_equal( make->reasons[5].reader, "r5" );
    assert_string_equal( make->because, "fake.A requested by the scene and read by r3, r4, r5 and 2 others" );
}

TEST( an_absent_pass_tells_which_of_four_things_keeps_it_away )
{
    const struct
    {
        const char* pass;
        wisp_plan_state state;
        const char *missing, *because;
    } expected[] = {
        { "needy", WISP_PLAN_MISSING, "M", "needs component fake.M, which no entity has" },
        { "torn", WISP_PLAN_SPLIT, "", "needs components fake.K and fake.L, which no single entity has together" },
        { "shy", WISP_PLAN_EXCLUDED, "", "excluded by component fake.O" },
        { "idle", WISP_PLAN_UNREQUESTED, "", "neither requested nor read: component fake.D" },
    };
    SCOPED( destroy_local ) wisp_world* world = open_chain();
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    for ( int i = 0; i < WISP_COUNT( expected ); ++i )
    {
        const wisp_plan_pass* p = pass_of( report, expected[i].pass );
        assert_int_equal( p->state, expected[i].state );
        assert_string_equal( p->because, expected[i].because );
        assert_list( p->missing, expected[i].missing );
        assert_null( p->loop );
        assert_int_equal( p->wave, -1 );
        assert_int_equal( p->reason_count, 0 );
        assert_true( isnan( p->fraction ) );
    }
}

// Rows that a plan creates between two passes are no component of the entity.
TEST( rows_between_passes_are_not_what_a_pass_could_need )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .writes = "A" },
        { "show", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "needy", SHAPE, GROUP, .required = "A", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    assert_int_equal( pass_of( report, "needy" )->state, WISP_PLAN_MISSING );
}

TEST( predicted_shares_follow_bytes_and_loops_and_sum_to_one )
{
    declare_fakes( CHAIN, WISP_COUNT( CHAIN ) );
    wisp_world_def def = wisp_default_world_def();
    def.workers = 1;
    def.substeps = 3;
    def.iterations = 2;
    SCOPED( destroy_local ) wisp_world* world = open_world_with( &def );
    request( world, add_with( world, "N" ), "B" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    const wisp_plan_pass *make = pass_of( report, "make" ), *bend = pass_of( report, "bend" ),
                         *show = pass_of( report, "show" );
    assert_int_equal( make->runs, 1 );
    assert_int_equal( bend->runs, 6 );
    assert_int_equal( make->bytes, ROWS * ROW_BYTES );     // writes A
    assert_int_equal( bend->bytes, 2 * ROWS * ROW_BYTES ); // reads A, writes A
    assert_int_equal( show->bytes, 2 * ROWS * ROW_BYTES ); // reads A, writes B
    // 1 : 12 : 2; each quotient is rounded once
    assert_true( fabs( make->fraction - 1.0 / 15.0 ) <= DBL_EPSILON );
    assert_true( fabs( bend->fraction - 12.0 / 15.0 ) <= DBL_EPSILON );
    assert_true( fabs( make->fraction + bend->fraction + show->fraction - 1.0 ) <= 3.0 * DBL_EPSILON );
}

TEST( what_a_pass_touches_of_others_is_predicted_too )
{
    static const fake_pass passes[] = {
        { "meet", SHAPE, ENTITY, .required = "N", .writes = "B", .foreign = "A" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "N" ), "B" );
    add_with( world, "A" );
    add_with( world, "A" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    // B of its own entity is written; A of two others is read and written
    assert_int_equal( pass_of( report, "meet" )->bytes, ( 1 + 2 * 2 ) * ROWS * ROW_BYTES );
    assert_list( pass_of( report, "meet" )->foreign, "A" );
}

TEST( passes_of_one_node_are_told_as_fused )
{
    static const fake_pass passes[] = {
        { "first", SHAPE, GROUP, .writes = "A" },
        { "second", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "third", SHAPE, ENTITY, .reads = "B", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "C" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    assert_int_equal( report->node_count, 2 );
    assert_int_equal( report->wave_count, 2 );
    assert_false( report->passes[0].is_fused );
    assert_true( report->passes[1].is_fused );
    assert_int_equal( report->passes[0].node, report->passes[1].node );
    assert_false( report->passes[2].is_fused );
    assert_int_equal( report->passes[2].wave, 1 );
}

static wisp_status declare_other( wisp_registry* r )
{
    static const wisp_column_def columns[] = { { "value", sizeof( int32_t ) } };
    const wisp_component lacked = wisp_declare_component(
        r, &( wisp_component_def ){ "other.settings", WISP_TABLE_ENTITY, columns, WISP_COUNT( columns ) } );
    const wisp_pass pass = { .name = "other.run",
                             .stage = WISP_STAGE_SHAPE,
                             .required = { lacked },
                             .writes = { lacked },
                             .run = fake_trace };
    return wisp_declare_pass( r, &pass );
}

TEST( an_absent_module_tells_the_component_that_it_lacks )
{
    static const wisp_module other = { .name = "other", .declare = declare_other };
    static const wisp_module* const modules[] = { &fake_module, &other };
    declare_fakes( CHAIN, WISP_COUNT( CHAIN ) );
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 1;
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    SCOPED( destroy_local ) wisp_world* world = open_world_with( &def );
    request( world, add_with( world, "N" ), "B" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    assert_int_equal( report->module_count, 3 ); // the engine's own passes, too
    assert_string_equal( report->modules[0].name, "wisp" );
    const wisp_plan_module *mine = module_of( report, "fake" ), *absent = module_of( report, "other" );
    assert_int_equal( mine->active_count, 3 );
    assert_int_equal( mine->pass_count, WISP_COUNT( CHAIN ) );
    assert_string_equal( mine->because, "" );
    assert_int_equal( absent->active_count, 0 );
    assert_string_equal( absent->missing, "other.settings" );
    assert_string_equal( absent->because, "needs component other.settings, which no entity has" );
}

TEST( a_module_that_nobody_requests_says_so_of_its_nearest_pass )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    add_with( world, "N" );
    SCOPED( plan_info_local ) wisp_plan_info* report = explain( world );
    const wisp_plan_module* m = module_of( report, "fake" );
    assert_int_equal( m->active_count, 0 );
    assert_null( m->missing );
    assert_string_equal( m->because, "make: neither requested nor read: component fake.A" );
}

typedef struct line_check
{
    const wisp_plan_info* report;
    int count;
} line_check;

static void compare_line( void* user, const char* line )
{
    line_check* check = user;
    char expected[512];
    if ( check->count == 0 )
    {
        wisp_plan_info_text( check->report, expected, sizeof( expected ) );
    }
    else
    {
        wisp_plan_pass_text( check->report->passes + check->count - 1, expected, sizeof( expected ) );
    }
    assert_string_equal( line, expected );
    check->count += 1;
}

TEST( the_printed_plan_is_the_report_in_lines )
{
    SCOPED( destroy_local ) wisp_world* world = open_chain();
    line_check check = { .report = explain( world ) };
    assert_int_equal( wisp_world_plan( world, compare_line, &check ), WISP_OK );
    assert_int_equal( check.count, 1 + check.report->pass_count );
    char cut[12];
    wisp_plan_info_text( check.report, cut, sizeof( cut ) );
    assert_int_equal( strlen( cut ), sizeof( cut ) - 1 );
    wisp_plan_info_release( (wisp_plan_info*)(uintptr_t)check.report );
}

TEST( a_report_stays_as_it_is_and_gives_its_memory_back )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "B" );
    assert_int_equal( wisp_world_plan_passes( world ), 3 );
    const size_t memory = wisp_world_memory( world );
    wisp_plan_info* report = explain( world );
    assert_int_equal( report->hash, world->plan.hash );
    cancel_request( world, e, "B" );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    assert_int_equal( report->active_count, 3 );
    assert_string_equal( report->passes[2].reasons[0].component, "fake.B" );
    wisp_plan_info_release( report );
    wisp_plan_info_release( NULL );
    request( world, e, "B" );
    assert_int_equal( wisp_world_plan_passes( world ), 3 );
    assert_int_equal( wisp_world_memory( world ), memory );
}

TEST( a_refused_plan_gives_no_report )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    request( world, add_with( world, "" ), "C" );
    wisp_plan_info* report = (wisp_plan_info*)(uintptr_t)1;
    assert_int_equal( wisp_world_explain( world, &report ), WISP_CONFLICT );
    assert_null( report );
    assert_non_null( strstr( wisp_world_message( world ), "fake.C" ) );
}

TEST( without_memory_there_is_a_message_and_no_report )
{
    test_host host = { 0 };
    declare_fakes( CHAIN, WISP_COUNT( CHAIN ) );
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 1;
    def.allocator = test_host_allocator( &host );
    wisp_world* world = open_world_with( &def );
    request( world, add_with( world, "N" ), "B" );
    assert_int_equal( wisp_world_plan_passes( world ), 3 );
    test_host_refuse( &host, 1, false );
    wisp_plan_info* report = NULL;
    assert_int_equal( wisp_world_explain( world, &report ), WISP_NO_MEMORY );
    assert_null( report );
    assert_one_message( wisp_world_message( world ) );
    test_host_refuse( &host, 0, false );
    wisp_plan_info_release( explain( world ) );
    wisp_world_destroy( world );
    assert_host_memory_is_released( &host );
}
