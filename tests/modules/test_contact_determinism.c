// The same bits for any number of workers, any instruction set and any host's loop, behind a snapshot and in another world, and
// the same as yesterday: data/golden/contact.hash. WISP_GOLDEN=write in the environment writes that file anew.
#include "contact_fixture.h"
#include "golden_file.h"

#include <inttypes.h>

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/contact.hash";

enum
{
    MOST_GUESTS = 3,
    STEPS = 24,
};

typedef enum case_kind
{
    FOLD,     // two cloths on a ball that moves
    BALLOONS, // three in a heap on a floor
    TANGLED,  // two cloths that start crossed
    THREADS,  // strands on cloth
} case_kind;

typedef struct golden_case
{
    const char* name;
    case_kind kind;
    wisp_contact_features features;
    int iterations;
} golden_case;

static const golden_case cases[] = {
    { "fold", FOLD, WISP_CONTACT_EXACT, 1 },          { "balloons", BALLOONS, WISP_CONTACT_EXACT, 2 },
    { "tangled", TANGLED, WISP_CONTACT_EXACT, 1 },    { "strands", THREADS, WISP_CONTACT_EXACT, 1 },
    { "samples", BALLOONS, WISP_CONTACT_SAMPLES, 1 },
};

typedef struct place_to_run
{
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
} place_to_run;

typedef struct running
{
    const golden_case* c;
    hosted h;
    wisp_entity guests[MOST_GUESTS], ball;
    int guest_count, steps;
} running;

static void open_place( running* r, const golden_case* c, const place_to_run* place, int* calls )
{
    *r = ( running ){ .c = c };
    r->h.def = contact_world_def( &r->h );
    r->h.def.workers = place->workers;
    r->h.def.isa = place->isa;
    r->h.def.parallel_for = place->parallel_for;
    r->h.def.parallel_for_user = calls;
    r->h.def.substeps = 6;
    r->h.def.iterations = c->iterations;
    assert_int_equal( wisp_world_create( &r->h.def, &r->h.world, NULL ), WISP_OK );
}

static void add_fold( running* r )
{
    test_mesh mesh = level_sheet( 17, 0.6f, ( wisp_vec3 ){ 0.02f, 0.2f, 0.01f } );
    test_mesh upper = level_sheet( 11, 0.5f, ( wisp_vec3 ){ 0.0f, 0.22f, 0.03f } );
    r->guests[r->guest_count++] = add_draping( r->h.world, &mesh, NULL, 0, EARTH );
    r->guests[r->guest_count++] = add_draping( r->h.world, &upper, NULL, 0, EARTH );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.08f;
    ball.pose.translation = ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f };
    assert_status( r->h.world, wisp_add_collider( r->h.world, &ball, &r->ball ), WISP_OK );
    add_floor( r->h.world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( r->h.world, r->guests[0] );
}

static void add_heap( running* r )
{
    add_floor( r->h.world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    for ( int k = 0; k < MOST_GUESTS; ++k )
    {
        test_mesh mesh =
            ball_of( 2, 0.1f, ( wisp_vec3 ){ 0.09f * (float)k, 0.11f + 0.15f * (float)( k % 2 ), 0.0f } );
        r->guests[r->guest_count++] = add_balloon( r->h.world, &mesh, EARTH );
        set_collision( r->h.world, r->guests[k] );
    }
}

static void add_tangle( running* r )
{
    for ( int k = 0; k < 2; ++k )
    {
        test_mesh mesh = level_sheet( 9, 0.5f, ( wisp_vec3 ){ 0 } );
        for ( int v = 0; v < mesh.vertex_count && k == 1; ++v )
        {
            const wisp_vec3 p = mesh.points[v];
            mesh.points[v] = ( wisp_vec3 ){ 0.9f * p.x + 0.013f, p.z + 0.2f, 0.017f };
        }
        const int32_t corners[4] = { 80, 72, 0, 8 };
        r->guests[r->guest_count++] = add_draping( r->h.world, &mesh, corners, k == 0 ? 4 : 2, EARTH );
    }
}

static void add_threads( running* r )
{
    test_mesh mesh = level_sheet( 9, 0.4f, ( wisp_vec3 ){ 0 } );
    const int32_t corners[4] = { 0, 8, 72, 80 };
    r->guests[r->guest_count++] = add_draping( r->h.world, &mesh, corners, 4, EARTH );
    const wisp_entity e = test_add_strands( r->h.world, 10, 12 ); // upwards from 0.1 m, so they fall over
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    assert_status( r->h.world, wisp_set_strand_dynamics( r->h.world, e, &def ), WISP_OK );
    assert_status( r->h.world, wisp_want( r->h.world, e, WISP_STRAND_POINTS ), WISP_OK );
    const wisp_rigid down = { { 0.0f, 0.0f, 1.0f, 0.0f }, { 0.0f, 0.2f, 0.0f } };
    assert_status( r->h.world, wisp_move_strand_head( r->h.world, e, down ), WISP_OK );
    r->guests[r->guest_count++] = e;
}

static void add_case( running* r )
{
    switch ( r->c->kind )
    {
        case FOLD:
            add_fold( r );
            break;
        case BALLOONS:
            add_heap( r );
            break;
        case TANGLED:
            add_tangle( r );
            break;
        default:
            add_threads( r );
            break;
    }
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.features = r->c->features;
    settings.sample_spacing = 0.02f;
    assert_status( r->h.world, wisp_set_contact_settings( r->h.world, &settings ), WISP_OK );
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int k = 0; k < r->guest_count; ++k )
    {
        set_contact( r->h.world, r->guests[k], &def );
    }
    want_figures( r->h.world );
}

static void run_case_steps( running* r, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        r->steps += 1;
        const float t = FRAME * (float)r->steps;
        const wisp_rigid pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.4f * t, 0.1f, -0.2f * t } };
        if ( r->c->kind == FOLD )
        {
            assert_status( r->h.world, wisp_move_collider( r->h.world, r->ball, pose ), WISP_OK );
        }
        run_steps( r->h.world, 1, FRAME );
    }
}

// Points of all guests, for the golden file; and everything that a step leaves behind, whose hash also changes when a
// column is added to the engine.
typedef struct traces
{
    uint64_t motion, state;
} traces;

static traces traces_of( running* r )
{
    traces t = { 0, wisp_world_hash( r->h.world ) };
    for ( int k = 0; k < r->guest_count; ++k )
    {
        const bool strands = r->c->kind == THREADS && k == 1;
        t.motion =
            31 * t.motion + hash_of( r->h.world, r->guests[k], strands ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS );
    }
    return t;
}

static traces run_case( const golden_case* c, const place_to_run* place, int* calls )
{
    running r;
    open_place( &r, c, place, calls );
    add_case( &r );
    double impulse = 0.0;
    for ( int i = 0; i < STEPS; ++i )
    {
        run_case_steps( &r, 1 );
        impulse += contact_figures( r.h.world ).impulse;
    }
    const traces t = traces_of( &r );
    assert_int_equal( wisp_world_counter( r.h.world, WISP_COUNT_HALTED ), 0 );
    if ( !( impulse > 0.0 ) )
    {
        fail_msg( "nothing pressed in %s", c->name );
    }
    close_world( &r.h );
    return t;
}

static void last_block_first( void* user, int block_count, wisp_block_fn* run, void* context )
{
    int* calls = user;
    *calls += 1;
    for ( int block = block_count - 1; block >= 0; --block )
    {
        run( context, block, 0 );
    }
}

static const place_to_run PLAIN = { 1, "baseline", NULL };

static void assert_traces( const golden_case* c, const place_to_run* place, traces expected )
{
    int calls = 0;
    const traces t = run_case( c, place, &calls );
    if ( t.motion != expected.motion || t.state != expected.state )
    {
        fail_msg( "%s: %016" PRIx64 " with %d workers and %s%s, %016" PRIx64 " with one and baseline", c->name,
                  t.state, place->workers, place->isa, place->parallel_for != NULL ? " on a host's loop" : "",
                  expected.state );
    }
    assert_true( place->parallel_for == NULL || calls > 0 );
}

// An instruction set that this processor lacks falls back to the next, which compares equal trivially.
static void workers_instruction_sets_and_hosts_do_not_change_a_bit( void** state )
{
    (void)state;
    const int workers[] = { 1, 2, 3, 5, 8 };
    const char* const isas[] = { "baseline", "avx2", "avx512" };
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        const traces expected = run_case( cases + n, &PLAIN, NULL );
        for ( int w = 1; w < WISP_COUNT( workers ); ++w )
        {
            assert_traces( cases + n, &( place_to_run ){ workers[w], isas[w % 3], NULL }, expected );
        }
        for ( int i = 1; i < WISP_COUNT( isas ); ++i )
        {
            assert_traces( cases + n, &( place_to_run ){ 1, isas[i], NULL }, expected );
        }
        assert_traces( cases + n, &( place_to_run ){ 1, "baseline", last_block_first }, expected );
    }
}

static golden_hash run_numbered( int number, const void* context )
{
    (void)context;
    return ( golden_hash ){ cases[number].name, run_case( cases + number, &PLAIN, NULL ).motion };
}

static void motion_is_that_of_the_golden_file( void** state )
{
    (void)state;
    golden_check( golden_file, WISP_COUNT( cases ), run_numbered, NULL );
}

// A hash that forgot something would let everything pass.
static void cases_and_a_nudge_have_other_hashes( void** state )
{
    (void)state;
    uint64_t hashes[WISP_COUNT( cases )];
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        hashes[n] = run_case( cases + n, &PLAIN, NULL ).motion;
        for ( int k = 0; k < n; ++k )
        {
            assert_true( hashes[n] != hashes[k] );
        }
        running r;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        velocity_of( r.h.world, r.guests[0], 20 )[2] += 1e-3f;
        run_case_steps( &r, STEPS );
        assert_true( traces_of( &r ).motion != hashes[n] );
        close_world( &r.h );
    }
}

// Lists of pairs grow with what is found, so the same motion is run twice: what was enough for it once is enough again.
static void a_step_that_is_warm_asks_for_no_memory( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        running r;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        run_case_steps( &r, 1 );
        const size_t size = wisp_world_snapshot_size( r.h.world );
        void* bytes = malloc( size );
        assert_non_null( bytes );
        assert_status( r.h.world, wisp_world_snapshot( r.h.world, bytes, size ), WISP_OK );
        run_case_steps( &r, STEPS );
        assert_status( r.h.world, wisp_world_restore( r.h.world, bytes, size ), WISP_OK );
        r.steps = 1;
        const int64_t asked = atomic_load( &r.h.host.asked );
        run_case_steps( &r, STEPS );
        if ( atomic_load( &r.h.host.asked ) != asked )
        {
            fail_msg( "%s asks for memory %d times in warm steps", cases[n].name,
                      (int)( atomic_load( &r.h.host.asked ) - asked ) );
        }
        free( bytes );
        close_world( &r.h );
    }
}

// Into the world that it came from, and into one that was just made.
static void a_snapshot_goes_on_to_the_same_bits( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        const traces straight = run_case( cases + n, &PLAIN, NULL );
        running r, fresh;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        run_case_steps( &r, STEPS / 2 + 1 );
        const size_t size = wisp_world_snapshot_size( r.h.world );
        void* bytes = malloc( size );
        assert_non_null( bytes );
        assert_status( r.h.world, wisp_world_snapshot( r.h.world, bytes, size ), WISP_OK );
        run_case_steps( &r, STEPS );
        assert_true( traces_of( &r ).state != straight.state );
        open_place( &fresh, cases + n, &PLAIN, NULL );
        add_case( &fresh );
        run_case_steps( &fresh, 1 ); // what is asked for has its columns with the plan
        running* both[2] = { &r, &fresh };
        for ( int k = 0; k < 2; ++k )
        {
            assert_status( both[k]->h.world, wisp_world_restore( both[k]->h.world, bytes, size ), WISP_OK );
            both[k]->steps = STEPS / 2 + 1;
            run_case_steps( both[k], STEPS - STEPS / 2 - 1 );
            const traces t = traces_of( both[k] );
            if ( t.motion != straight.motion || t.state != straight.state )
            {
                fail_msg( "%s goes on differently behind a snapshot in %s world (motion %s)", cases[n].name,
                          k == 0 ? "the same" : "a fresh", t.motion == straight.motion ? "same" : "other" );
            }
            close_world( &both[k]->h );
        }
        free( bytes );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( motion_is_that_of_the_golden_file ),
        cmocka_unit_test( cases_and_a_nudge_have_other_hashes ),
        cmocka_unit_test( workers_instruction_sets_and_hosts_do_not_change_a_bit ),
        cmocka_unit_test( a_step_that_is_warm_asks_for_no_memory ),
        cmocka_unit_test( a_snapshot_goes_on_to_the_same_bits ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
