// A host's module with more components and passes than one word has bits: they run, wait, and are restored like the
// first ones, up to the limit.
#include "plan_fixture.h"

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
    wisp_world* world = open_chain( false, &e );
    *value_of( world, e, 0 ) = 5;
    step( world );
    assert_int_equal( wisp_world_plan_passes( world ), MANY );
    assert_int_equal( *value_of( world, e, MANY ), 5 + MANY );
    assert_int_equal( wisp_world_profile( world ).count, MANY );
    wisp_world_destroy( world );
}

TEST( a_pass_that_nobody_requests_is_absent_beyond_two_words )
{
    wisp_entity e;
    wisp_world* world = open_chain( false, &e );
    assert_int_equal( wisp_cancel_request( world, e, many.values[MANY] ), WISP_OK );
    assert_int_equal( wisp_request( world, e, many.values[BEYOND] ), WISP_OK );
    step( world );
    assert_int_equal( wisp_world_plan_passes( world ), BEYOND );
    assert_false( wisp_world_has( world, e, many.values[MANY] ) );
    assert_null( value_of( world, e, MANY ) );
    wisp_world_destroy( world );
}

TEST( a_write_beyond_two_words_wakes_the_passes_behind_it_alone )
{
    wisp_entity e;
    wisp_world* world = open_chain( true, &e );
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
    wisp_world_destroy( world );
}

TEST( what_waits_beyond_two_words_is_restored )
{
    wisp_entity e;
    wisp_world* world = open_chain( true, &e );
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
    wisp_world_destroy( world );
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
