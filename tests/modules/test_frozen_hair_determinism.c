// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/frozen_hair.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "frozen_hair_engine_fixture.h"
#include "golden_file.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/frozen_hair.hash";

// ---- cases: grooms that need nothing of the C library's mathematics, several blocks long ----

typedef struct golden_case
{
    const char* name;
    hair_shape shape;
    int dimension, strands;
    bool mixed;
    void ( *change )( wisp_frozen_hair_def* def ); // differences from the defaults
} golden_case;

static void keep( wisp_frozen_hair_def* def )
{
    (void)def;
}

static void freeze_only( wisp_frozen_hair_def* def )
{
    def->align = def->clump = false;
}

static void clump_by( wisp_frozen_hair_def* def, wisp_gap gap )
{
    def->freeze = def->align = false;
    def->gap = gap;
    def->clump_iterations = 6;
    def->clump_step_length = 0.0025f; // so large that lists are rebuilt
}

static void clump_prose( wisp_frozen_hair_def* def )
{
    clump_by( def, WISP_GAP_ABSOLUTE );
}

static void clump_wet( wisp_frozen_hair_def* def )
{
    clump_by( def, WISP_GAP_NONE );
}

static void capped( wisp_frozen_hair_def* def )
{
    def->max_neighbours = 6;
}

static void stroke( wisp_frozen_hair_def* def )
{
    def->base = WISP_FROZEN_BASE_STROKE;
    def->reach = 0.1f;
}

static void layers( wisp_frozen_hair_def* def )
{
    stroke( def );
    def->max_depth_change = 0.002f;
}

static const golden_case cases[] = {
    { "plane-wavy-all", HAIR_WAVY, 2, 220, false, keep },
    { "space-curly-all", HAIR_CURLY, 3, 220, false, keep },
    { "space-straight-freeze", HAIR_STRAIGHT, 3, 150, false, freeze_only },
    { "space-wavy-clump-prose", HAIR_WAVY, 3, 60, false, clump_prose },
    { "space-wavy-clump-wet", HAIR_WAVY, 3, 60, false, clump_wet },
    { "space-curly-mixed-lengths", HAIR_CURLY, 3, 120, true, keep },
    { "space-wavy-capped", HAIR_WAVY, 3, 60, false, capped },
    { "plane-wavy-stroke", HAIR_WAVY, 2, 220, false, stroke },
    { "space-curly-stroke-mixed-lengths", HAIR_CURLY, 3, 120, true, stroke },
    { "space-curly-layers-mixed-lengths", HAIR_CURLY, 3, 120, true, layers },
};

static hair_groom make_groom( const golden_case* c )
{
    const int lengths[] = { 17, 3, 40, 0, 2, 20, 1 };
    int counts[512];
    assert_in_range( c->strands, 1, 512 );
    for ( int s = 0; s < c->strands; ++s )
    {
        counts[s] = c->mixed ? lengths[s * 3 % WISP_COUNT( lengths )] : 20;
    }
    return hair_groom_create_mixed( c->shape, c->dimension, c->strands, counts, 0.004f );
}

// Two commands, the second from the first one's numbers and a different cursor; a stroke goes on from there.
static uint64_t hash_case( const golden_case* c, const hair_host* host )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = make_groom( c );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.cursor = ( wisp_vec3 ){ 0.05f, -0.1f, 0.0f };
    c->change( &def );
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( host );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    uint64_t first, second;
    assert_int_equal( wisp_world_hash_column( world, entity, WISP_STRAND_POINTS, &first ), WISP_OK );
    hair_command( world, entity, ( wisp_vec3 ){ 0.12f, -0.06f, 0.0f } );
    hair_step( world );
    for ( int n = 0; n < 6 && def.base == WISP_FROZEN_BASE_STROKE; ++n )
    {
        hair_command( world, entity, ( wisp_vec3 ){ 0.1f * (float)n, -0.06f, 0.02f * (float)n } );
        hair_step( world );
    }
    assert_int_equal( wisp_world_hash_column( world, entity, WISP_STRAND_POINTS, &second ), WISP_OK );
    return first ^ ( second << 1 | second >> 63 );
}

// ---- hosts ----

// Instruction sets of this processor, each once.
static int list_isas( const char* isas[3] )
{
    static const char* const names[] = { "baseline", "avx2", "avx512" };
    int count = 0;
    for ( int n = 0; n < WISP_COUNT( names ); ++n )
    {
        const hair_host host = { .isa = names[n] };
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( &host );
        if ( strcmp( wisp_world_isa( world ), names[n] ) == 0 )
        {
            isas[count++] = names[n];
        }
    }
    return count;
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

// A host that starts its threads for each wave and lets them compete for blocks.
typedef struct thread_wave
{
    wisp_block_fn* run;
    void* context;
    int block_count;
    atomic_int next;
} thread_wave;

typedef struct thread_worker
{
    thread_wave* wave;
    int number;
} thread_worker;

enum
{
    host_threads = 4
};

static void* comparison( void* argument )
{
    const thread_worker* worker = argument;
    thread_wave* wave = worker->wave;
    for ( int block = atomic_fetch_add( &wave->next, 1 ); block < wave->block_count;
          block = atomic_fetch_add( &wave->next, 1 ) )
    {
        wave->run( wave->context, block, worker->number );
    }
    return NULL;
}

static void with_threads( void* user, int block_count, wisp_block_fn* run, void* context )
{
    int* calls = user;
    *calls += 1;
    thread_wave wave = { .run = run, .context = context, .block_count = block_count };
    atomic_init( &wave.next, 0 );
    thread_worker workers[host_threads];
    pthread_t threads[host_threads];
    for ( int n = 0; n < host_threads; ++n )
    {
        workers[n] = ( thread_worker ){ &wave, n };
        assert_int_equal( pthread_create( threads + n, NULL, comparison, workers + n ), 0 );
    }
    for ( int n = 0; n < host_threads; ++n )
    {
        assert_int_equal( pthread_join( threads[n], NULL ), 0 );
    }
}

static void* do_nothing( void* argument )
{
    return argument;
}

// WebAssembly without shared memory starts none.
static bool has_threads( void )
{
    pthread_t thread;
    return pthread_create( &thread, NULL, do_nothing, NULL ) == 0 && pthread_join( thread, NULL ) == 0;
}

static void assert_hash( const golden_case* c, const hair_host* host, uint64_t expected )
{
    uint64_t hash = hash_case( c, host );
    if ( hash != expected )
    {
        fail_msg( "%s: %016" PRIx64 " with %d workers and %s%s, %016" PRIx64 " with one and baseline", c->name, hash,
                  host->workers, host->isa, host->parallel_for != NULL ? " on a host's loop" : "", expected );
    }
}

// ---- tests ----

TEST( workers_and_instruction_sets_do_not_change_a_bit )
{
    const int workers[] = { 1, 2, 3, 5, 8, 64 };
    const char* isas[3];
    const int isa_count = list_isas( isas );
    assert_in_range( isa_count, 1, 3 );
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        const hair_host one = { .workers = 1, .isa = "baseline" };
        const uint64_t expected = hash_case( cases + n, &one );
        for ( int k = 0; k < WISP_COUNT( workers ) * isa_count; ++k )
        {
            const hair_host host = { .workers = workers[k / isa_count], .isa = isas[k % isa_count] };
            assert_hash( cases + n, &host, expected );
        }
    }
    for ( int i = 0; i < isa_count; ++i )
    {
        print_message( "           compared: %s\n", isas[i] );
    }
}

TEST( a_hosts_own_loop_does_not_change_a_bit )
{
    if ( !has_threads() )
    {
        SKIP( "no second thread can be made here" );
    }
    const char* isas[3];
    const int isa_count = list_isas( isas );
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        const hair_host one = { .workers = 1, .isa = "baseline" };
        const uint64_t expected = hash_case( cases + n, &one );
        for ( int i = 0; i < isa_count; ++i )
        {
            int calls = 0;
            assert_hash( cases + n, &( hair_host ){ 1, isas[i], last_block_first, &calls, { 0 } }, expected );
            assert_true( calls > 0 );
            calls = 0;
            assert_hash( cases + n, &( hair_host ){ host_threads, isas[i], with_threads, &calls, { 0 } }, expected );
            assert_true( calls > 0 );
        }
    }
}

static golden_hash run_numbered( int number, const void* context )
{
    (void)context;
    return ( golden_hash ){ cases[number].name, hash_case( cases + number, NULL ) };
}

TEST( looks_are_those_of_the_golden_file )
{
    golden_check( golden_file, WISP_COUNT( cases ), run_numbered, NULL );
}

// A hash that left out a vertex would let everything pass.
TEST( a_hash_tells_cases_and_single_bits_apart )
{
    uint64_t hashes[WISP_COUNT( cases )];
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        hashes[n] = hash_case( cases + n, NULL );
        for ( int k = 0; k < n; ++k )
        {
            assert_true( hashes[n] != hashes[k] );
        }
    }
    SCOPED( hair_groom_destroy ) hair_groom groom = make_groom( cases + 2 );
    uint64_t before, after;
    for ( int n = 0; n < 2; ++n )
    {
        wisp_frozen_hair_def def = hair_no_stages();
        wisp_world* world = hair_world_create( NULL );
        wisp_entity entity = hair_add_frozen( world, &groom, &def );
        hair_step( world );
        assert_int_equal( wisp_world_hash_column( world, entity, WISP_STRAND_POINTS, n == 0 ? &before : &after ),
                          WISP_OK );
        wisp_world_destroy( world );
        uint32_t bits;
        memcpy( &bits, &groom.points[groom.vertex_count - 1].z, sizeof( bits ) );
        bits ^= 1u;
        memcpy( &groom.points[groom.vertex_count - 1].z, &bits, sizeof( bits ) );
    }
    assert_true( before != after );
}
