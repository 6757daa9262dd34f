// Invalid definitions of worlds, of modules and of strands, each rejected by its own message.
#include "world_fixture.h"

// ---- definitions of worlds ----

// Rejected with one message that contains these words, and without a world.
static void assert_no_world( const wisp_world_def* def, const char* words )
{
    wisp_world* world = (wisp_world*)(uintptr_t)1;
    wisp_error error = { WISP_OK, "" };
    assert_int_equal( wisp_world_create( def, &world, &error ), WISP_BAD_INPUT );
    assert_null( world );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_one_message( error.message );
    assert_contains( error.message, words );
    assert_int_equal( wisp_world_create( def, &world, NULL ), WISP_BAD_INPUT );
}

TEST( a_world_of_impossible_workers_is_refused )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = -1;
    assert_no_world( &def, "workers: got -1" );
    def.workers = WISP_MAX_WORKERS + 1;
    assert_no_world( &def, "workers: got 65" );
}

TEST( a_world_of_no_loops_is_refused )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 0;
    assert_no_world( &def, "substeps, iterations: got 0 and" );
    def.substeps = 1;
    def.iterations = -5;
    assert_no_world( &def, "and -5, expected 1 to 1000000" );
}

TEST( half_an_allocator_is_refused )
{
    test_host host = { 0 };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.allocator = test_host_allocator( &host );
    def.allocator.release = NULL;
    assert_no_world( &def, "allocator" );
    def.allocator = test_host_allocator( &host );
    def.allocator.allocate = NULL;
    assert_no_world( &def, "allocator" );
}

TEST( modules_that_are_not_there_are_refused )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.module_count = -1;
    assert_no_world( &def, "module_count: got -1" );
    def.module_count = 2;
    assert_no_world( &def, "module_count: got 2" );
}

TEST( an_unknown_instruction_set_is_refused )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.isa = "sse9";
    assert_no_world( &def, "'sse9'" );
}

TEST( a_known_instruction_set_is_a_cap )
{
    static const char* const isas[] = { "baseline", "avx2", "avx512" };
    for ( int i = 0; i < WISP_COUNT( isas ); ++i )
    {
        wisp_world_def def = wisp_default_world_def();
        def.substeps = 1;
        def.isa = isas[i];
        wisp_world* world = NULL;
        assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
        int place = 0;
        while ( place < WISP_COUNT( isas ) && strcmp( isas[place], wisp_world_isa( world ) ) != 0 )
        {
            ++place;
        }
        wisp_world_destroy( world );
        assert_true( place <= i );
    }
}

TEST( a_default_world_has_a_worker_and_an_instruction_set )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    wisp_world* world = NULL;
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    assert_in_range( wisp_world_workers( world ), 1, WISP_MAX_WORKERS );
    assert_true( strlen( wisp_world_isa( world ) ) > 0 );
    assert_string_equal( wisp_world_message( world ), "" );
    assert_true( wisp_world_memory( world ) > 0 );
    wisp_world_destroy( world );
    wisp_world_destroy( NULL );
}

TEST( a_definition_that_no_function_has_filled_is_refused )
{
    const wisp_world_def zero = { 0 };
    assert_no_world( &zero, "expected one that wisp_default_world_def() has filled" );
    assert_no_world( NULL, "got null" );
    wisp_world_def newer = wisp_default_world_def();
    newer.size += 8;
    assert_no_world( &newer, "compiled with a newer version" );
}

TEST( a_definition_of_an_older_version_has_defaults_where_it_ends )
{
    wisp_world_def older, whole = wisp_default_world_def();
    memset( &older, 0x5a, sizeof( older ) );
    wisp_init_world_def( &older, offsetof( wisp_world_def, substeps ) );
    assert_int_equal( older.size, offsetof( wisp_world_def, substeps ) );
    assert_int_equal( older.substeps, 0x5a5a5a5a );
    wisp_world* world = NULL;
    wisp_error error = { WISP_OK, "" };
    // with what is behind its end this definition would be refused
    assert_int_equal( wisp_world_create( &older, &world, &error ), WISP_OK );
    wisp_world_destroy( world );
    assert_int_equal( whole.size, sizeof( whole ) );
}

TEST( a_host_that_is_newer_finds_zeros_in_what_the_library_does_not_know )
{
    struct
    {
        wisp_world_def def;
        int more[2];
    } newer;
    memset( &newer, 0x5a, sizeof( newer ) );
    wisp_init_world_def( &newer.def, sizeof( newer ) );
    assert_int_equal( newer.def.size, sizeof( newer ) );
    assert_int_equal( newer.def.substeps, 10 );
    assert_int_equal( newer.more[1], 0 );
    wisp_init_world_def( NULL, 10 );
    wisp_init_world_def( &newer.def, 2 );
    assert_int_equal( newer.def.size, sizeof( newer ) );
}

TEST( counts_beyond_sense_are_refused )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 2000000000;
    assert_no_world( &def, "got 2000000000 and 1, expected 1 to 1000000" );
}

// ---- invalid declarations of modules ----

static const wisp_column_def VALUE[] = { { "value", 4 } }, WIDE[] = { { "value", 8 } };

static void run_nothing( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)frame, (void)span, (void)user;
}

static wisp_status declare_value( wisp_registry* r )
{
    wisp_component c =
        wisp_declare_component( r, &( wisp_component_def ){ "test.value", WISP_TABLE_ENTITY, VALUE, 1 } );
    return wisp_declare_pass( r, &( wisp_pass ){ .name = "test.pass", .writes = { c }, .run = run_nothing } );
}

static wisp_status declare_wide( wisp_registry* r )
{
    wisp_declare_component( r, &( wisp_component_def ){ "test.value", WISP_TABLE_ENTITY, WIDE, 1 } );
    return WISP_OK;
}

static wisp_status declare_same_pass( wisp_registry* r )
{
    return wisp_declare_pass( r, &( wisp_pass ){ .name = "test.pass", .writes = { 1 }, .run = run_nothing } );
}

static wisp_status declare_pass_that_runs_nothing( wisp_registry* r )
{
    return wisp_declare_pass( r, &( wisp_pass ){ .name = "test.still", .writes = { 1 } } );
}

static wisp_status declare_pass_that_writes_nothing( wisp_registry* r )
{
    return wisp_declare_pass( r, &( wisp_pass ){ .name = "test.vain", .run = run_nothing } );
}

static wisp_status declare_too_many_passes( wisp_registry* r )
{
    static char names[PLAN_MAX_PASSES + 1][24];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( names ) && status == WISP_OK; ++i )
    {
        snprintf( names[i], sizeof( names[i] ), "test.pass%d", i );
        status = wisp_declare_pass( r, &( wisp_pass ){ .name = names[i], .writes = { 1 }, .run = run_nothing } );
    }
    return status;
}

static wisp_status declare_too_many_components( wisp_registry* r )
{
    static char names[STORE_MAX_COMPONENTS + 1][24];
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        snprintf( names[i], sizeof( names[i] ), "test.value%d", i );
        wisp_declare_component( r, &( wisp_component_def ){ names[i], WISP_TABLE_ENTITY, VALUE, 1 } );
    }
    return WISP_OK;
}

static wisp_status declare_nothing_and_fail( wisp_registry* r )
{
    (void)r;
    return WISP_BAD_INPUT;
}

TEST( a_module_that_declares_wrongly_is_refused_by_name )
{
    static const struct
    {
        wisp_module module;
        const char* words;
    } wrong[] = {
        { { "wide", declare_wide },
          "module 'wide': too many components, or declared differently by another module: "
          "'test.value'" },
        { { "twin", declare_same_pass }, "module 'twin': got a second pass 'test.pass'" },
        { { "still", declare_pass_that_runs_nothing }, "'test.still'" },
        { { "vain", declare_pass_that_writes_nothing }, "'test.vain'" },
        { { "busy", declare_too_many_passes }, "module 'busy': too many passes" },
        { { "rich", declare_too_many_components }, "module 'rich': too many components" },
        { { "mute", declare_nothing_and_fail }, "module 'mute': declaration failed" },
    };
    static const wisp_module value = { "value", declare_value };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        const wisp_module* modules[] = { &value, &wrong[i].module };
        test_host host = { 0 };
        wisp_world_def def = wisp_default_world_def();
        def.substeps = 1;
        def.allocator = test_host_allocator( &host );
        def.modules = modules;
        def.module_count = 2;
        assert_no_world( &def, wrong[i].words );
        assert_host_memory_is_released( &host );
    }
}

// ---- definitions of strands ----

static const wisp_vec3 POINTS[] = {
    { 0.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 1.0f, 1.0f, 0.0f }
};
static const int32_t OFFSETS[] = { 0, 2, 4 };

static wisp_strands_def two_strands( void )
{
    wisp_strands_def def = wisp_default_strands_def();
    def.points = POINTS;
    def.offsets = OFFSETS;
    def.strand_count = 2;
    return def;
}

static void assert_no_strands( hosted* h, const wisp_strands_def* def, const char* words )
{
    wisp_entity e = { 7, 7 };
    uint64_t hash = wisp_world_hash( h->world );
    size_t memory = wisp_world_memory( h->world );
    int heard = h->log.count;
    assert_int_equal( wisp_add_strands( h->world, def, &e ), WISP_BAD_INPUT );
    assert_int_equal( e.index, 0 );
    assert_one_message( wisp_world_message( h->world ) );
    assert_string_equal( h->log.last, wisp_world_message( h->world ) );
    assert_int_equal( h->log.count, heard + 1 );
    assert_int_equal( wisp_world_hash( h->world ), hash );
    assert_int_equal( wisp_world_memory( h->world ), memory );
    assert_contains( wisp_world_message( h->world ), words );
}

WORLD_TEST( strands_with_wrong_counts_are_refused )
{
    hosted* h = *state;
    wisp_strands_def def = two_strands();
    def.strand_count = -1;
    assert_no_strands( h, &def, "strand_count: got -1" );
    def = two_strands();
    def.strand_count = INT32_MAX;
    assert_no_strands( h, &def, "strand_count: got 2147483647" );
    def = two_strands();
    def.offsets = NULL;
    assert_no_strands( h, &def, "offsets" );
    def = two_strands();
    def.points = NULL;
    assert_no_strands( h, &def, "points: got null, expected 4 points" );
    def = two_strands();
    def.dimension = 4;
    assert_no_strands( h, &def, "dimension: got 4" );
}

WORLD_TEST( strands_with_wrong_offsets_are_refused_by_number )
{
    hosted* h = *state;
    wisp_strands_def def = two_strands();
    def.offsets = ( const int32_t[] ){ 1, 2, 4 };
    assert_no_strands( h, &def, "offsets: got 1 as the first" );
    def.offsets = ( const int32_t[] ){ 0, 4, 3 };
    assert_no_strands( h, &def, "strand 1: got vertices 4 to 3" );
    def.offsets = ( const int32_t[] ){ 0, -2, 4 };
    assert_no_strands( h, &def, "strand 0: got vertices 0 to -2" );
    def.offsets = ( const int32_t[] ){ 0, 2, INT32_MAX };
    assert_no_strands( h, &def, "strand 1: got vertices 2 to 2147483647" );
}

WORLD_TEST( points_that_are_no_places_are_refused_by_strand_and_vertex )
{
    hosted* h = *state;
    const float wrong[] = { NAN, INFINITY, -INFINITY, 1.1e6f, -1.1e6f };
    for ( int i = 0; i < WISP_COUNT( wrong ) * 3; ++i )
    {
        wisp_vec3 points[WISP_COUNT( POINTS )];
        memcpy( points, POINTS, sizeof( points ) );
        ( &points[3].x )[i % 3] = wrong[i / 3];
        wisp_strands_def def = two_strands();
        def.points = points;
        assert_no_strands( h, &def, "strand 1, vertex 1" );
    }
}

WORLD_TEST( flat_strands_with_depth_are_refused )
{
    hosted* h = *state;
    wisp_vec3 points[WISP_COUNT( POINTS )];
    memcpy( points, POINTS, sizeof( points ) );
    points[2].z = 0.5f;
    wisp_strands_def def = two_strands();
    def.points = points;
    def.dimension = 2;
    assert_no_strands( h, &def, "strand 1, vertex 0: got z = 0.5" );
}

WORLD_TEST( a_step_of_no_possible_length_is_refused )
{
    hosted* h = *state;
    const float wrong[] = { 0.0f, -0.01f, NAN, INFINITY };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        assert_int_equal( wisp_world_step( h->world, wrong[i] ), WISP_BAD_INPUT );
        assert_one_message( wisp_world_message( h->world ) );
    }
    assert_int_equal( wisp_world_counter( h->world, WISP_COUNT_STEPS ), 0 );
}
