// Memory: the size of a world, its release, and lack of memory at any moment.
#include "world_fixture.h"

// ---- size of a world ----

WORLD_TEST( a_world_knows_every_byte_it_was_lent )
{
    hosted* h = *state;
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
    hosted* h = *state;
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
    hosted* h = *state;
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
        hosted h = { 0 };
        h.def = hosted_def( &h );
        h.def.workers = workers;
        assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
        for ( int i = 0; i < 6; ++i )
        {
            add_frozen( h.world, 60, 6 );
        }
        step( h.world );
        wisp_world_destroy( h.world );
        assert_host_memory_is_released( &h.host );
    }
}

// ---- warm steps ----

// The same command repeatedly. @return requests for memory in ten warm steps
static int64_t requests_of_warm_steps( int workers )
{
    hosted h = { 0 };
    h.def = hosted_def( &h );
    h.def.workers = workers;
    assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
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
