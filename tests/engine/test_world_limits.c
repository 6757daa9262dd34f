// Limits of worlds: invalid definitions of worlds, of modules and of strands, each rejected by its own message; the size of
// a world, its release, and lack of memory at any moment.
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

static bool join_nothing( wisp_frame* frame, wisp_entity first, wisp_entity entity, void* user )
{
    (void)frame, (void)first, (void)entity, (void)user;
    return false;
}

static uint32_t run_no_batch( wisp_frame* frame, const wisp_entity* entities, int count, int worker, double* seconds,
                              void* user )
{
    (void)frame, (void)entities, (void)count, (void)worker, (void)seconds, (void)user;
    return 0;
}

static uint32_t run_no_pass( wisp_frame* frame, const wisp_entity* entities, int count, const wisp_span* span,
                             void* user )
{
    (void)frame, (void)entities, (void)count, (void)span, (void)user;
    return 0;
}

static wisp_status declare_batch_of_a_pass_that_is_not_there( wisp_registry* r )
{
    return wisp_declare_batch( r, &( wisp_batch ){ .name = "test.batch",
                                                   .required = { "test.pass" },
                                                   .pass = "test.other",
                                                   .lanes = 2,
                                                   .can_join = join_nothing,
                                                   .run = run_no_batch,
                                                   .run_pass = run_no_pass } );
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
        { { "lost", declare_batch_of_a_pass_that_is_not_there }, "without declared passes: 'test.batch'" },
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
    wisp_vec3 points[WISP_COUNT( POINTS )];
    memcpy( points, POINTS, sizeof( points ) );
    points[2].z = 0.5f;
    wisp_strands_def def = two_strands();
    def.points = points;
    def.dimension = 2;
    assert_no_strands( h, &def, "strand 1, vertex 0: got z = 0.5" );
}

// ---- size of a world ----

WORLD_TEST( a_world_knows_every_byte_it_was_lent )
{
    assert_int_equal( wisp_world_memory( h->world ), atomic_load( &h->host.bytes ) );
    wisp_entity e = add_frozen( h->world, 50, 7 );
    assert_int_equal( wisp_world_memory( h->world ), atomic_load( &h->host.bytes ) );
    step( h->world );
    assert_int_equal( wisp_world_memory( h->world ), atomic_load( &h->host.bytes ) );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_world_memory( h->world ), atomic_load( &h->host.bytes ) );
}

static void add_and_remove_everything( wisp_world* world )
{
    wisp_entity entities[6];
    for ( int i = 0; i < 5; ++i )
    {
        entities[i] = add_frozen( world, 10 + 20 * i, 4 + i );
    }
    assert_int_equal( wisp_add_instance( world, entities[2], NULL, entities + 5 ), WISP_OK );
    step( world );
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        assert_int_equal( wisp_remove( world, entities[i] ), WISP_OK );
    }
    step( world );
}

WORLD_TEST( removing_everything_frees_all_columns_and_topologies )
{
    int64_t blocks = atomic_load( &h->host.blocks );
    for ( int i = 0; i < 5; ++i )
    {
        assert_int_equal( wisp_world_attach( h->world, test_add_strands( h->world, 100, 9 ), WISP_POINT_COLOUR ),
                          WISP_OK );
    }
    assert_true( atomic_load( &h->host.blocks ) >= blocks + 5 + 3 + 1 ); // topologies, columns, slots
    for ( int i = 0; i < 5; ++i )
    {
        assert_int_equal( wisp_remove( h->world, store_handle( &h->world->store, i ) ), WISP_OK );
    }
    assert_int_equal( atomic_load( &h->host.blocks ), blocks + 1 ); // the slots stay
}

WORLD_TEST( coming_and_going_again_and_again_holds_no_more_memory )
{
    add_and_remove_everything( h->world );
    size_t memory = wisp_world_memory( h->world );
    for ( int i = 0; i < 10; ++i )
    {
        add_and_remove_everything( h->world );
        assert_int_equal( wisp_world_memory( h->world ), memory );
    }
}

TEST( a_world_with_many_workers_gives_everything_back )
{
    for ( int workers = 1; workers <= 8; ++workers )
    {
        hosted h;
        open_modules( &h, NULL, 0, ( wisp_world_def ){ .workers = workers } );
        for ( int i = 0; i < 6; ++i )
        {
            add_frozen( h.world, 60, 6 );
        }
        step( h.world );
        close_world( &h );
    }
}

// ---- warm steps ----

// The same command repeatedly. @return requests for memory in ten warm steps
static int64_t requests_of_warm_steps( int workers )
{
    hosted h;
    open_modules( &h, NULL, 0, ( wisp_world_def ){ .workers = workers } );
    wisp_entity e = add_frozen( h.world, 400, 8 );
    int64_t warm = 0;
    for ( int i = 0; i < 12; ++i )
    {
        assert_int_equal( wisp_replay_frozen_hair( h.world, e, ( wisp_vec3 ){ 0.1f, 0.0f, 0.1f }, 0 ), WISP_OK );
        step( h.world );
        warm = i == 1 ? atomic_load( &h.host.queried ) : warm;
    }
    int64_t requests = atomic_load( &h.host.queried ) - warm;
    wisp_world_destroy( h.world );
    assert_host_memory_is_released( &h.host );
    return requests;
}

TEST( a_warm_step_asks_for_no_memory )
{
    assert_int_equal( requests_of_warm_steps( 1 ), 0 );
    assert_int_equal( requests_of_warm_steps( 2 ), 0 );
    assert_int_equal( requests_of_warm_steps( 5 ), 0 );
}

// ---- no memory ----

enum
{
    SCENE_STRANDS = 30,
    SCENE_LENGTH = 6,
};

// A scene grows by calls; each is repeated when the host had no memory for it.
typedef struct scene
{
    hosted h;
    test_strands strands;
    wisp_entity first, second;
    bool step_failed;
} scene;

static wisp_status create_world( scene* s )
{
    wisp_error error = { WISP_OK, "" };
    wisp_status status = wisp_world_create( &s->h.def, &s->h.world, &error );
    if ( status != WISP_OK )
    {
        assert_int_equal( error.status, status );
        assert_one_message( error.message );
        assert_null( s->h.world );
        assert_host_memory_is_released( &s->h.host );
    }
    return status;
}

static wisp_status add_first( scene* s )
{
    wisp_strands_def def = test_strands_def( &s->strands );
    return wisp_add_strands( s->h.world, &def, &s->first );
}

static wisp_status add_second( scene* s )
{
    return wisp_add_instance( s->h.world, s->first, NULL, &s->second );
}

static wisp_status freeze_first( scene* s )
{
    wisp_frozen_hair_def def = clumping_def();
    return wisp_set_frozen_hair( s->h.world, s->first, &def );
}

static wisp_status freeze_second( scene* s )
{
    wisp_frozen_hair_def def = clumping_def();
    def.seed = 2;
    return wisp_set_frozen_hair( s->h.world, s->second, &def );
}

static wisp_status paint_first( scene* s )
{
    wisp_strand_appearance_def def = wisp_default_strand_appearance_def();
    return wisp_set_strand_appearance( s->h.world, s->first, &def );
}

static wisp_status chill_second( scene* s )
{
    wisp_environment_def def = wisp_default_environment_def();
    return wisp_set_environment( s->h.world, s->second, &def );
}

static wisp_status request_points( scene* s )
{
    return wisp_request( s->h.world, s->first, WISP_STRAND_POINTS );
}

static wisp_status request_second_points( scene* s )
{
    return wisp_request( s->h.world, s->second, WISP_STRAND_POINTS );
}

static wisp_status request_width( scene* s )
{
    return wisp_request( s->h.world, s->first, WISP_POINT_WIDTH );
}

// A step that failed half way has consumed its command; the same event from rest gives the same bits.
static wisp_status step_first( scene* s )
{
    if ( s->step_failed )
    {
        const wisp_vec3 cursor = clumping_def().cursor;
        assert_int_equal( wisp_replay_frozen_hair( s->h.world, s->first, cursor, 0 ), WISP_OK );
        assert_int_equal( wisp_replay_frozen_hair( s->h.world, s->second, cursor, 0 ), WISP_OK );
    }
    wisp_status status = wisp_world_step( s->h.world, 0.01f );
    s->step_failed = status != WISP_OK;
    return status;
}

static const struct
{
    wisp_status ( *call )( scene* s );
    bool changes_nothing; // when it fails
} CALLS[] = {
    { create_world, false },  { add_first, true },     { freeze_first, true },
    { request_points, true }, { add_second, true },    { paint_first, true },
    { request_width, true },  { freeze_second, true }, { request_second_points, true },
    { chill_second, true },   { step_first, false },
};

// @return whether the call failed and was repeated
static bool call_until_it_works( scene* s, int number )
{
    uint64_t hash = s->h.world != NULL ? wisp_world_hash( s->h.world ) : 0;
    wisp_status status = CALLS[number].call( s );
    if ( status == WISP_OK )
    {
        return false;
    }
    assert_int_equal( status, WISP_NO_MEMORY );
    assert_true( test_host_has_refused( &s->h.host ) );
    test_host_refuse( &s->h.host, 0, false );
    if ( s->h.world != NULL )
    {
        assert_one_message( wisp_world_message( s->h.world ) );
        assert_string_equal( s->h.log.last, wisp_world_message( s->h.world ) );
    }
    if ( CALLS[number].changes_nothing )
    {
        assert_int_equal( wisp_world_hash( s->h.world ), hash );
    }
    assert_int_equal( CALLS[number].call( s ), WISP_OK );
    return true;
}

// Visible state of the scene. A repeated call may have left another generation in a handle, so handles are left out.
static uint64_t shown_by( scene* s )
{
    return hash_of( s->h.world, s->first, WISP_STRAND_POINTS ) ^
           3 * hash_of( s->h.world, s->second, WISP_STRAND_POINTS ) ^
           5 * hash_of( s->h.world, s->first, WISP_POINT_WIDTH );
}

// Build the scene with the n-th request refused, and with `rest` all later ones until the first call fails.
// @return its visible state; *refused says whether there were n requests, *failures counts calls that failed
static uint64_t build_scene( int workers, int n, bool rest, bool* refused, int* failures )
{
    scene s = { .strands = test_strands_of( SCENE_STRANDS, SCENE_LENGTH ) };
    s.h.def = hosted_def( &s.h );
    s.h.def.workers = workers;
    test_host_refuse( &s.h.host, n, rest );
    *failures = 0;
    for ( int i = 0; i < WISP_COUNT( CALLS ); ++i )
    {
        *failures += call_until_it_works( &s, i ) ? 1 : 0;
    }
    *refused = atomic_load( &s.h.host.queried ) >= n;
    uint64_t shown = shown_by( &s );
    wisp_world_destroy( s.h.world );
    test_strands_free( &s.strands );
    assert_host_memory_is_released( &s.h.host );
    return shown;
}

static void refuse_every_request( int workers, bool rest )
{
    bool refused = false;
    int failures = 0, scenes_that_failed = 0;
    uint64_t shown = build_scene( workers, 0, false, &refused, &failures );
    assert_int_equal( failures, 0 );
    refused = true;
    for ( int n = 1; refused; ++n )
    {
        assert_int_equal( build_scene( workers, n, rest, &refused, &failures ), shown );
        scenes_that_failed += failures > 0 ? 1 : 0;
    }
    // each call makes at least one request, and the world alone several
    assert_true( scenes_that_failed > WISP_COUNT( CALLS ) );
}

TEST( any_one_request_may_be_refused )
{
    refuse_every_request( 1, false );
}

TEST( any_one_request_may_be_refused_where_workers_ask )
{
    refuse_every_request( 3, false );
}

TEST( memory_may_end_at_any_request )
{
    refuse_every_request( 1, true );
    refuse_every_request( 3, true );
}
