// Requests of a scene, and the passes selected for them: their existence and order, passes that exclude components,
// rejected plans, the time of compilation, and the printed plan.
#include "plan_fixture.h"

#include "wisp/fabric.h"
#include "wisp/module/components.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY
#define SHAPE WISP_STAGE_SHAPE

// ---- which passes exist ----

static const fake_pass LONE[] = { { "a", SHAPE, GROUP, .required = "N", .writes = "A" } };

TEST( an_empty_world_has_no_pass )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    step( world );
    assert_string_equal( trace_text(), "" );
    assert_int_equal( wisp_world_profile( world ).count, 0 );
}

TEST( a_pass_that_has_what_it_needs_and_is_requested_exists )
{
    ASSERT_PLAN( LONE, "N", "A", "[after] a" );
}

TEST( a_pass_whose_writes_nobody_requests_is_absent )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    add_with( world, "NA" );
    assert_string_equal( plan_text( world ), "" );
}

TEST( a_pass_without_what_it_needs_is_absent )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    request( world, add_with( world, "A" ), "A" ); // the user's own rows satisfy the request
    assert_string_equal( plan_text( world ), "" );
}

TEST( a_request_is_no_component_that_a_pass_could_need )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, GROUP, .required = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    wisp_entity e = add_with( world, "B" );
    request( world, e, "AB" );
    assert_string_equal( plan_text( world ), "[after] a" );
}

static const fake_pass CHAIN[] = {
    { "d", SHAPE, GROUP, .reads = "C", .writes = "D" },
    { "c", SHAPE, GROUP, .reads = "B", .writes = "C" },
    { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
    { "a", SHAPE, GROUP, .writes = "A" },
};

TEST( demand_reaches_back_through_a_chain )
{
    ASSERT_PLAN( CHAIN, "", "D", "[after] a+b+c+d" );
}

TEST( demand_ends_where_nobody_requests_more )
{
    ASSERT_PLAN( CHAIN, "", "B", "[after] a+b" );
}

TEST( demand_grows_to_a_fixed_point_in_any_order_of_declaration )
{
    for ( int first = 0; first < WISP_COUNT( CHAIN ); ++first )
    {
        fake_pass turned[WISP_COUNT( CHAIN )];
        for ( int i = 0; i < WISP_COUNT( CHAIN ); ++i )
        {
            turned[i] = CHAIN[( first + i ) % WISP_COUNT( CHAIN )];
        }
        ASSERT_PLAN( turned, "", "D", "[after] a+b+c+d" );
    }
}

TEST( each_entity_gets_only_what_it_requests )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    add_with( world, "" );
    request( world, add_with( world, "" ), "A" );
    request( world, add_with( world, "" ), "B" );
    step( world );
    assert_string_equal( trace_text(), "a2.0 a2.1 a2.2 a3.0 b3.0 a3.1 b3.1 a3.2 b3.2" );
}

TEST( a_removed_entity_takes_its_requests_along )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    assert_string_equal( plan_text( world ), "[after] a" );
    assert_int_equal( wisp_remove( world, e ), WISP_OK );
    assert_string_equal( plan_text( world ), "" );
    add_with( world, "N" ); // in the same slot
    assert_string_equal( plan_text( world ), "" );
}

// ---- rejected plans ----

// The plan is rejected by a message that contains all of these words.
static void assert_refused( wisp_world* world, const char* const* words, int count )
{
    assert_string_equal( plan_text( world ), "refused" );
    assert_int_equal( wisp_world_step( world, 0.01f ), WISP_CONFLICT );
    assert_one_message( wisp_world_message( world ) );
    assert_string_equal( fake.log.last, wisp_world_message( world ) );
    for ( int i = 0; i < count; ++i )
    {
        assert_non_null( strstr( wisp_world_message( world ), words[i] ) );
    }
    assert_string_equal( trace_text(), "" );
}

TEST( a_read_that_nobody_supplies_names_pass_component_and_entity )
{
    static const fake_pass passes[] = { { "reader", SHAPE, GROUP, .reads = "M", .writes = "B" } };
    static const char* const words[] = { "'reader'", "'fake.M'", "entity 2" };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "M" ), "B" );
    request( world, add_with( world, "" ), "B" );
    assert_refused( world, words, WISP_COUNT( words ) );
}

TEST( a_pass_that_another_entity_keeps_alive_supplies_nothing_here )
{
    static const fake_pass passes[] = {
        { "maker", SHAPE, GROUP, .required = "N", .writes = "M" },
        { "reader", SHAPE, GROUP, .reads = "M", .writes = "B" },
    };
    static const char* const words[] = { "'reader'", "'fake.M'", "entity 1" };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    request( world, add_with( world, "N" ), "B" );
    assert_refused( world, words, WISP_COUNT( words ) );
}

TEST( a_requested_component_that_no_pass_writes_is_refused )
{
    static const char* const words[] = { "'fake.C'", "entity 1" };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    request( world, add_with( world, "N" ), "C" );
    assert_refused( world, words, WISP_COUNT( words ) );
}

TEST( a_requested_component_whose_writer_lacks_its_needs_is_refused )
{
    static const char* const words[] = { "'fake.A'", "entity 1" };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    request( world, add_with( world, "" ), "A" );
    assert_refused( world, words, WISP_COUNT( words ) );
}

TEST( passes_of_a_stage_that_wait_for_each_other_are_refused )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .reads = "C", .writes = "A" },
        { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
        { "c", SHAPE, GROUP, .reads = "B", .writes = "C" },
    };
    static const char* const words[] = { "cycle", "'a'" };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "A" );
    assert_refused( world, words, WISP_COUNT( words ) );
}

TEST( a_circle_through_two_stages_is_last_steps_data )
{
    static const fake_pass passes[] = {
        { "b", WISP_STAGE_OBSERVE, GROUP, .reads = "A", .writes = "B" },
        { "a", WISP_STAGE_INPUT, GROUP, .reads = "B", .writes = "A" },
    };
    ASSERT_PLAN( passes, "", "A", "[before] a [after] b" );
}

TEST( a_refused_world_steps_again_once_the_request_is_gone )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "AC" );
    assert_string_equal( plan_text( world ), "refused" );
    cancel_request( world, e, "C" );
    step( world );
    assert_string_equal( plan_text( world ), "[after] a" );
}

// ---- order ----

TEST( stages_come_in_their_order_whatever_the_order_of_declaration )
{
    static const fake_pass passes[] = {
        { "observe", WISP_STAGE_OBSERVE, GROUP, .writes = "A" },
        { "shape", WISP_STAGE_SHAPE, GROUP, .writes = "B" },
        { "derive", WISP_STAGE_DERIVE, GROUP, .writes = "C" },
        { "velocity", WISP_STAGE_VELOCITY, ENTITY, .writes = "D" },
        { "project", WISP_STAGE_PROJECT, ENTITY, .writes = "E" },
        { "contact", WISP_STAGE_CONTACT, ENTITY, .writes = "F" },
        { "predict", WISP_STAGE_PREDICT, ENTITY, .writes = "G" },
        { "force", WISP_STAGE_FORCE, ENTITY, .writes = "H" },
        { "input", WISP_STAGE_INPUT, GROUP, .writes = "I" },
    };
    ASSERT_PLAN( passes, "", "ABCDEFGHI",
                 "[before] input [substep] force,predict,contact [iteration] project "
                 "[substep end] velocity [after] derive,shape,observe" );
}

TEST( what_writes_goes_before_what_reads )
{
    static const fake_pass passes[] = {
        { "reader", SHAPE, ENTITY, .reads = "A", .writes = "B" },
        { "writer", SHAPE, ENTITY, .writes = "A" },
    };
    ASSERT_PLAN( passes, "", "B", "[after] writer reader" );
}

TEST( what_makes_goes_before_what_changes_in_place_and_that_before_what_reads )
{
    static const fake_pass passes[] = {
        { "first", SHAPE, ENTITY, .reads = "A", .writes = "A" },
        { "second", SHAPE, ENTITY, .reads = "A", .writes = "A" },
        { "maker", SHAPE, ENTITY, .writes = "A" },
        { "reader", WISP_STAGE_OBSERVE, ENTITY, .reads = "A", .writes = "B" },
    };
    ASSERT_PLAN( passes, "", "B", "[after] maker first second reader" );
}

TEST( equals_keep_the_order_of_declaration )
{
    static const fake_pass passes[] = {
        { "z", SHAPE, ENTITY, .reads = "A", .writes = "A" },
        { "m", SHAPE, ENTITY, .reads = "A", .writes = "A" },
        { "a", SHAPE, ENTITY, .reads = "A", .writes = "A" },
    };
    ASSERT_PLAN( passes, "A", "A", "[after] z m a" );
}

// ---- when it is compiled ----

static uint64_t plans_of_a_step( wisp_world* world )
{
    uint64_t before = wisp_world_counter( world, WISP_COUNT_PLANS );
    wisp_world_step( world, 0.01f );
    return wisp_world_counter( world, WISP_COUNT_PLANS ) - before;
}

TEST( a_plan_is_compiled_again_when_the_structure_changed_and_only_then )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    assert_int_equal( plans_of_a_step( world ), 1 );
    assert_int_equal( plans_of_a_step( world ), 0 );

    // without effect on the structure
    request( world, e, "A" );
    assert_int_equal( wisp_world_attach( world, e, letter( 'N' ) ), WISP_OK );
    assert_int_equal( wisp_world_detach( world, e, letter( 'P' ) ), WISP_OK );
    assert_non_null( wisp_world_column( world, e, letter( 'N' ), 0 ) );
    assert_string_equal( plan_text( world ), "[after] a" );
    assert_int_equal( plans_of_a_step( world ), 0 );

    // with effect on it
    wisp_entity other = add_with( world, "" );
    assert_int_equal( plans_of_a_step( world ), 1 );
    assert_int_equal( wisp_world_attach( world, other, letter( 'N' ) ), WISP_OK );
    assert_int_equal( plans_of_a_step( world ), 1 );
    assert_int_equal( wisp_remove( world, other ), WISP_OK );
    assert_int_equal( plans_of_a_step( world ), 1 );
    cancel_request( world, e, "A" );
    assert_int_equal( plans_of_a_step( world ), 1 );
}

TEST( taking_back_a_request_that_nobody_had_compiles_nothing )
{
    wisp_world* world = OPEN_WORLD( LONE );
    wisp_entity e = add_with( world, "N" );
    request( world, e, "A" );
    step( world );
    cancel_request( world, e, "B" );
    uint64_t plans = plans_of_a_step( world );
    wisp_world_destroy( world );
    assert_int_equal( plans, 0 );
}

TEST( giving_a_component_that_was_only_requested_wakes_who_needs_it )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, GROUP, .required = "A", .reads = "A", .writes = "B" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    wisp_entity e = add_with( world, "B" );
    request( world, e, "AB" );
    assert_string_equal( plan_text( world ), "[after] a" );
    assert_int_equal( wisp_world_attach( world, e, letter( 'A' ) ), WISP_OK );
    const char* text = plan_text( world );
    wisp_world_destroy( world );
    assert_string_equal( text, "[after] a+b" );
}

// ---- its hash and its print ----

static uint64_t hash_of_plan( wisp_world* world, int entities, const char* requests )
{
    for ( int i = 0; i < entities; ++i )
    {
        request( world, add_with( world, "" ), requests );
    }
    assert_true( wisp_world_plan_passes( world ) > 0 );
    uint64_t hash = world->plan.hash;
    wisp_world_destroy( world );
    return hash;
}

TEST( equal_plans_hash_equal_and_others_differ )
{
    uint64_t two = hash_of_plan( OPEN_WORLD( CHAIN ), 2, "D" );
    assert_int_equal( hash_of_plan( OPEN_WORLD( CHAIN ), 2, "D" ), two );
    assert_int_not_equal( hash_of_plan( OPEN_WORLD( CHAIN ), 2, "C" ), two );
    assert_int_not_equal( hash_of_plan( OPEN_WORLD( CHAIN ), 1, "D" ), two );
}

TEST( a_plan_hashes_as_before_when_a_request_came_and_went )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    wisp_entity e = add_with( world, "" );
    request( world, e, "B" );
    assert_int_equal( wisp_world_plan_passes( world ), 2 );
    uint64_t hash = world->plan.hash;
    request( world, e, "D" );
    assert_int_equal( wisp_world_plan_passes( world ), 4 );
    cancel_request( world, e, "D" );
    assert_int_equal( wisp_world_plan_passes( world ), 2 );
    assert_int_equal( world->plan.hash, hash );
}

typedef struct printed
{
    int count;
    char lines[256][512];
} printed;

static void keep_line( void* user, const char* line )
{
    printed* p = user;
    assert_true( p->count < WISP_COUNT( p->lines ) );
    assert_null( strchr( line, '\n' ) );
    snprintf( p->lines[p->count++], sizeof( p->lines[0] ), "%s", line );
}

// The line that begins with this word and names this pass contains the reason.
static void assert_printed( const printed* p, const char* word, const char* pass, const char* reason )
{
    char name[40];
    snprintf( name, sizeof( name ), " %s ", pass );
    for ( int i = 0; i < p->count; ++i )
    {
        if ( strstr( p->lines[i], word ) != NULL && strstr( p->lines[i], name ) != NULL )
        {
            assert_non_null( strstr( p->lines[i], reason ) );
            return;
        }
    }
    fail_msg( "no line says '%s' of pass %s", word, pass );
}

TEST( a_printed_plan_says_why_a_pass_is_there_and_what_another_lacks )
{
    static const fake_pass passes[] = {
        { "make", WISP_STAGE_INPUT, GROUP, .required = "N", .writes = "A" },
        { "bend", WISP_STAGE_PROJECT, ENTITY, .reads = "A", .writes = "A" },
        { "show", WISP_STAGE_OBSERVE, GROUP, .reads = "A", .writes = "B" },
        { "needy", SHAPE, GROUP, .required = "NM", .writes = "C" },
        { "idle", SHAPE, GROUP, .required = "N", .writes = "D" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "N" ), "B" );
    printed p = { 0 };
    assert_int_equal( wisp_world_plan( world, keep_line, &p ), WISP_OK );
    wisp_world* bare = OPEN_WORLD( LONE );
    printed own = { 0 };
    assert_int_equal( wisp_world_plan( bare, keep_line, &own ), WISP_OK );
    wisp_world_destroy( bare );
    assert_int_equal( p.count,
                      own.count - WISP_COUNT( LONE ) + WISP_COUNT( passes ) ); // the engine's own passes, too
    assert_non_null( strstr( p.lines[0], "3 passes" ) );
    assert_non_null( strstr( p.lines[0], "with a substep loop" ) );
    assert_printed( &p, "before", "make", "fake.A read by bend and show" );
    assert_printed( &p, "iteration", "bend", "fake.A read by show" );
    assert_printed( &p, "after", "show", "fake.B requested by the scene" );
    assert_printed( &p, "absent", "needy", "needs component fake.M, which no entity has" );
    assert_printed( &p, "absent", "idle", "neither requested nor read: component fake.D" );
}

TEST( a_plan_without_a_loop_says_so )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    printed p = { 0 };
    assert_int_equal( wisp_world_plan( world, keep_line, &p ), WISP_OK );
    assert_non_null( strstr( p.lines[0], "0 passes" ) );
    assert_non_null( strstr( p.lines[0], "no substep loop" ) );
}

TEST( a_refused_plan_prints_nothing )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( LONE );
    request( world, add_with( world, "" ), "A" );
    printed p = { 0 };
    assert_int_equal( wisp_world_plan( world, keep_line, &p ), WISP_CONFLICT );
    assert_int_equal( p.count, 0 );
}

// ---- passes that exclude components ----

// ---- which passes exist ----

static const fake_pass SHY[] = { { "shy", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" } };

TEST( a_pass_exists_for_what_lacks_the_component )
{
    ASSERT_PLAN( SHY, "N", "A", "[after] shy" );
}

TEST( a_pass_is_absent_for_what_has_the_component )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_with( world, "NLA" );
    request( world, e, "A" );
    assert_string_equal( plan_text( world ), "" );
    step( world );
    assert_string_equal( trace_text(), "" );
}

TEST( each_entity_of_a_mixed_world_is_queried_for_itself )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" },
        { "b", SHAPE, GROUP, .required = "NL", .writes = "A" },
        { "c", SHAPE, GROUP, .required = "N", .excluded = "LM", .writes = "A" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    static const char* const KINDS[] = { "N", "NL", "NM", "NLM", "N" };
    for ( int i = 0; i < WISP_COUNT( KINDS ); ++i )
    {
        request( world, add_with( world, KINDS[i] ), "A" );
    }
    step( world );
    assert_string_equal( trace_text(), "a1.0 c1.0 a1.1 c1.1 a1.2 c1.2 b2.0 b2.1 b2.2 a3.0 a3.1 a3.2 b4.0 b4.1 b4.2 "
                                       "a5.0 c5.0 a5.1 c5.1 a5.2 c5.2" );
}

TEST( a_pass_comes_and_goes_with_the_component )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_with( world, "NA" );
    request( world, e, "A" );
    assert_int_equal( wisp_world_plan_passes( world ), 1 );
    assert_int_equal( wisp_world_attach( world, e, letter( 'L' ) ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    assert_int_equal( wisp_world_detach( world, e, letter( 'L' ) ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 1 );
}

TEST( a_request_for_the_component_keeps_nobody_out )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .required = "N", .writes = "L" },
        { "shy", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" },
    };
    ASSERT_PLAN( passes, "N", "LA", "[after] make,shy" );
}

TEST( what_a_pass_kept_out_would_have_written_is_missed_by_its_reader )
{
    static const fake_pass passes[] = {
        { "shy", SHAPE, GROUP, .excluded = "L", .writes = "A" },
        { "reader", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    assert_string_equal( plan_text( world ), "[after] shy+reader" );
    request( world, add_with( world, "L" ), "B" );
    assert_string_equal( plan_text( world ), "refused" );
    assert_non_null( strstr( wisp_world_message( world ), "fake.A" ) );
}

// ---- print ----

typedef struct line_of_pass
{
    char pass[40]; // whose line
    char line[512];
} line_of_pass;

static void keep_line_of_pass( void* user, const char* line )
{
    line_of_pass* p = user;
    char name[48];
    snprintf( name, sizeof( name ), " %s ", p->pass );
    if ( strstr( line, name ) != NULL )
    {
        snprintf( p->line, sizeof( p->line ), "%s", line );
    }
}

static void assert_line( wisp_world* world, const char* pass, const char* word, const char* reason )
{
    line_of_pass p = { .line = "" };
    snprintf( p.pass, sizeof( p.pass ), "%s", pass );
    assert_int_equal( wisp_world_plan( world, keep_line_of_pass, &p ), WISP_OK );
    if ( strstr( p.line, word ) == NULL || strstr( p.line, reason ) == NULL )
    {
        fail_msg( "'%s' does not say '%s' and '%s'", p.line, word, reason );
    }
}

TEST( a_printed_plan_says_what_keeps_a_pass_away )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    assert_line( world, "shy", "absent", "needs component fake.N, which no entity has" );
    wisp_entity kept_out = add_with( world, "NL" );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
    request( world, kept_out, "A" );
    assert_int_equal( wisp_world_attach( world, kept_out, letter( 'A' ) ), WISP_OK );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
    // the entity that is not excluded does not request it
    wisp_entity free = add_with( world, "N" );
    assert_line( world, "shy", "absent", "neither requested nor read: component fake.A" );
    request( world, free, "A" );
    assert_line( world, "shy", "wave", "fake.A requested by the scene" );
    assert_int_equal( wisp_remove( world, free ), WISP_OK );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
}

// ---- surfaces with an external solver ----

// A triangle with everything that makes the engine's own passes run: gravity, a moving pin, damping.
static wisp_entity add_surface( wisp_world* world )
{
    static const wisp_vec3 POINTS[3] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 1.0f } };
    static const int32_t CORNERS[3] = { 0, 1, 2 };
    static const int32_t PIN = 0;
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = POINTS;
    fabric.triangles = CORNERS;
    fabric.vertex_count = 3;
    fabric.triangle_count = 1;
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = &PIN;
    def.pin_count = 1;
    wisp_error error = { WISP_OK, "" };
    assert_int_equal( wisp_fabric_cook( &fabric, NULL, &def.fabric, &error ), WISP_OK );
    wisp_entity e;
    assert_int_equal( wisp_add_surface( world, &def, &e ), WISP_OK );
    wisp_fabric_release( def.fabric );
    assert_int_equal( wisp_set_gravity( world, e, ( wisp_vec3 ){ 0.0f, -10.0f, 0.0f } ), WISP_OK );
    assert_int_equal( wisp_set_damping( world, e, 1.0f ), WISP_OK );
    assert_int_equal( wisp_move_pins( world, e, &PIN, &( wisp_vec3 ){ 0.5f, 0.0f, 0.0f }, 1 ), WISP_OK );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static const char* const MOVERS[] = { "particles.gravity", "particles.targets", "particles.predict",
                                      "particles.velocity", "particles.damping" };

TEST( a_solved_surface_is_moved_by_no_pass_of_the_engine )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_surface( world );
    for ( int i = 0; i < WISP_COUNT( MOVERS ); ++i )
    {
        assert_line( world, MOVERS[i], "wave", "" );
    }
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( MOVERS ); ++i )
    {
        assert_line( world, MOVERS[i], "absent", "excluded by component particle.external_solver" );
    }
    step( world );
    wisp_view view;
    assert_int_equal( wisp_world_view( world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
    const wisp_vec3* points = view.data;
    assert_true( points[0].x == 0.0f && points[1].y == 0.0f && points[2].y == 0.0f );
}

TEST( a_surface_beside_a_solved_one_goes_on_falling )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity solved = add_surface( world ), other = add_surface( world );
    assert_int_equal( wisp_world_attach( world, solved, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    step( world );
    wisp_view view;
    assert_int_equal( wisp_world_view( world, solved, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[1].y == 0.0f );
    assert_int_equal( wisp_world_view( world, other, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[1].y < -1e-4f );
    assert_true( ( (const wisp_vec3*)view.data )[0].x == 0.5f );
}

TEST( strain_limits_of_a_solved_surface_are_refused )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_surface( world );
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    uint64_t before = wisp_world_hash( world );
    expect_refusal( world, wisp_set_strain_limit( world, e, 0.9f, 1.1f ), WISP_CONFLICT, "strain limits" );
    assert_int_equal( wisp_world_hash( world ), before );
    assert_false( wisp_world_has( world, e, WISP_LINK_LIMIT ) );
    assert_int_equal( wisp_set_strain_limit( world, e, 0.0f, INFINITY ), WISP_OK ); // there is none to remove
    assert_int_equal( wisp_world_detach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    assert_int_equal( wisp_set_strain_limit( world, e, 0.9f, 1.1f ), WISP_OK );
}
