/// Tests of determinism for any table of cases: the same bits for any number of workers, any instruction set and any
/// loop of the host, after a snapshot and in another world, without allocation once warm, and the same as the golden
/// file.
///
/// A test file describes its cases by `subject`.
#pragma once

#include "golden_file.h"
#include "saved_world.h"
#include "world_fixture.h"

#include "kernel_tables.h"

typedef struct place_to_run
{
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
} place_to_run;

static const place_to_run PLAIN = { 1, "baseline", NULL };

/// Hashes of the points, for the golden file, and of all state after a step, which also changes when a column is
/// added to the engine.
typedef struct traces
{
    uint64_t motion, state;
} traces;

/// A world with a case in it: the first member of what `open` returns.
typedef struct determinism_run
{
    int number; // of the case
    int steps;  // steps so far
    wisp_world* world;
    test_host* host;
} determinism_run;

typedef struct determinism_case
{
    const char* name;
    int steps;
    int warm_workers;  // warm steps are counted with 1 worker to this many
    int rehearsal;     // steps of the same motion that run once before warm steps are counted
    bool is_one_block; // so small that no second worker takes part
    int most_workers;  // default 0: 8
} determinism_case;

typedef struct determinism
{
    const char* golden_file;
    int case_count;
    bool every_pair; // every instruction set with every number of workers; otherwise each alone
    determinism_case ( *describe )( int number );
    determinism_run* ( *open )( int number, const place_to_run* place, int* calls );
    void ( *run )( determinism_run* r, int steps );
    traces ( *traces_of )( determinism_run* r );
    void ( *check )( determinism_run* r ); // whether the event that the case tests has happened during its steps
    void ( *nudge )( determinism_run* r ); // smallest change of the initial state of a case
    void ( *close )( determinism_run* r );
} determinism;

/// Define the subject by the file's table and functions of these names.
#define DETERMINISM( golden, every_pair )                                                                            \
    static const determinism subject = {                                                                             \
        WISP_SOURCE_ROOT "/data/golden/" #golden ".hash",                                                            \
        WISP_COUNT( cases ),                                                                                         \
        every_pair,                                                                                                  \
        describe,                                                                                                    \
        open_case,                                                                                                   \
        run_case_steps,                                                                                              \
        traces_of,                                                                                                   \
        check_case,                                                                                                  \
        nudge,                                                                                                       \
        close_case,                                                                                                  \
    }

/// Defined by the file that includes this one.
static const determinism subject;

static inline void determinism_place( wisp_world_def* def, const place_to_run* place, int* calls )
{
    def->workers = place->workers;
    def->isa = place->isa;
    def->parallel_for = place->parallel_for;
    def->parallel_for_user = calls;
}

static traces run_case( const determinism* d, int number, const place_to_run* place, int* calls )
{
    determinism_run* r = d->open( number, place, calls );
    d->run( r, d->describe( number ).steps );
    const traces t = d->traces_of( r );
    assert_int_equal( wisp_world_counter( r->world, WISP_COUNT_HALTED ), 0 );
    d->check( r );
    d->close( r );
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

static void assert_traces( const determinism* d, int number, const place_to_run* place, traces expected )
{
    int calls = 0;
    const determinism_case c = d->describe( number );
    const traces t = run_case( d, number, place, &calls );
    if ( t.motion != expected.motion || t.state != expected.state )
    {
        fail_msg( "%s: %016" PRIx64 " with %d workers and %s%s, %016" PRIx64 " with one and baseline", c.name,
                  t.state, place->workers, place->isa, place->parallel_for != NULL ? " on a host's loop" : "",
                  expected.state );
    }
    assert_true( place->parallel_for == NULL || calls > 0 || c.is_one_block );
}

TEST( workers_instruction_sets_and_hosts_do_not_change_a_bit )
{
    const determinism* d = &subject;
    static const char* const known[] = { "baseline", "avx2", "avx512" };
    const char* isas[WISP_COUNT( known )];
    int isa_count = 0;
    for ( int i = 0; i < WISP_COUNT( known ); ++i )
    {
        isas[isa_count] = known[i];
        // one that the processor lacks would be the one before again
        const bool is_here = strcmp( kernels_select( known[i], NULL )->isa, known[i] ) == 0;
        isa_count += is_here ? 1 : 0;
        if ( is_here == false )
        {
            print_message( "skipped: %s: no kernels of it here\n", known[i] );
        }
    }
    for ( int n = 0; n < d->case_count; ++n )
    {
        const int most = d->describe( n ).most_workers, workers[] = { 1, 2, 3, 5, most > 0 ? most : 8 };
        const traces expected = run_case( d, n, &PLAIN, NULL );
        for ( int i = 0; i < isa_count; ++i )
        {
            for ( int w = 0; w < WISP_COUNT( workers ); ++w )
            {
                if ( d->every_pair || w == 0 || w % WISP_COUNT( known ) == i )
                {
                    assert_traces( d, n, &( place_to_run ){ workers[w], isas[i], NULL }, expected );
                }
            }
            if ( d->every_pair || i == 0 )
            {
                assert_traces( d, n, &( place_to_run ){ 1, isas[i], last_block_first }, expected );
            }
        }
    }
}

static golden_hash run_numbered( int number, const void* context )
{
    const determinism* d = context;
    return ( golden_hash ){ d->describe( number ).name, run_case( d, number, &PLAIN, NULL ).motion };
}

TEST( motion_is_that_of_the_golden_file )
{
    const determinism* d = &subject;
    golden_check( d->golden_file, d->case_count, true, run_numbered, d );
}

TEST( a_nudge_has_another_hash )
{
    const determinism* d = &subject;
    for ( int n = 0; n < d->case_count; ++n )
    {
        const uint64_t hash = run_case( d, n, &PLAIN, NULL ).motion;
        determinism_run* r = d->open( n, &PLAIN, NULL );
        d->nudge( r );
        d->run( r, d->describe( n ).steps );
        assert_true( d->traces_of( r ).motion != hash );
        d->close( r );
    }
}

// Run some steps and restore the start.
static void run_there_and_back( const determinism* d, determinism_run* r, int steps )
{
    const int before = r->steps;
    const saved_world saved = save_world( r->world );
    d->run( r, steps );
    assert_status( r->world, wisp_world_restore( r->world, saved.bytes, saved.size ), WISP_OK );
    r->steps = before;
    free( saved.bytes );
}

TEST( a_step_that_is_warm_asks_for_no_memory )
{
    const determinism* d = &subject;
    for ( int n = 0; n < d->case_count; ++n )
    {
        const determinism_case c = d->describe( n );
        for ( int workers = 1; workers <= c.warm_workers; ++workers )
        {
            determinism_run* r = d->open( n, &( place_to_run ){ workers, NULL, NULL }, NULL );
            d->run( r, 3 );
            run_there_and_back( d, r, c.rehearsal );
            const int64_t queried = atomic_load( &r->host->queried );
            d->run( r, c.steps );
            if ( atomic_load( &r->host->queried ) != queried )
            {
                fail_msg( "%s requests memory %d times in warm steps with %d workers", c.name,
                          (int)( atomic_load( &r->host->queried ) - queried ), workers );
            }
            d->close( r );
        }
    }
}

// Restore into the original world, and into a new one.
TEST( a_snapshot_goes_on_to_the_same_bits )
{
    const determinism* d = &subject;
    for ( int n = 0; n < d->case_count; ++n )
    {
        const int steps = d->describe( n ).steps, half = steps / 2 + 1;
        const traces straight = run_case( d, n, &PLAIN, NULL );
        determinism_run* both[2] = { d->open( n, &PLAIN, NULL ), d->open( n, &PLAIN, NULL ) };
        d->run( both[0], half );
        const saved_world saved = save_world( both[0]->world );
        d->run( both[0], steps );
        assert_true( d->traces_of( both[0] ).state != straight.state );
        d->run( both[1], 1 ); // columns of requested outputs exist once the plan does
        for ( int k = 0; k < 2; ++k )
        {
            assert_status( both[k]->world, wisp_world_restore( both[k]->world, saved.bytes, saved.size ), WISP_OK );
            both[k]->steps = half;
            d->run( both[k], steps - half );
            const traces t = d->traces_of( both[k] );
            if ( t.motion != straight.motion || t.state != straight.state )
            {
                fail_msg( "%s goes on differently behind a snapshot in %s world (motion %s)", d->describe( n ).name,
                          k == 0 ? "the same" : "a fresh", t.motion == straight.motion ? "same" : "other" );
            }
            d->close( both[k] );
        }
        free( saved.bytes );
    }
}
