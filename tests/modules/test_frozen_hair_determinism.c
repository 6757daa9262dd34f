// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/frozen_hair.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "frozen_hair_engine_fixture.h"
#include "determinism_fixture.h"

#include <pthread.h>

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

typedef struct running
{
    determinism_run base;
    test_host host;
    hair_groom groom;
    wisp_frozen_hair_def def;
    wisp_entity entity;
    uint64_t first; // points after the first command
} running;

static determinism_run* open_on( int number, const hair_host* host )
{
    running* r = checked_calloc( 1, sizeof( *r ) );
    r->groom = make_groom( cases + number );
    r->def = wisp_default_frozen_hair_def();
    r->def.cursor = ( wisp_vec3 ){ 0.05f, -0.1f, 0.0f };
    cases[number].change( &r->def );
    hair_host counted = *host;
    counted.allocator = test_host_allocator( &r->host );
    r->base = ( determinism_run ){ number, 0, hair_world_create( &counted ), &r->host };
    r->entity = hair_add_frozen( r->base.world, &r->groom, &r->def );
    return &r->base;
}

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    return open_on( number, &( hair_host ){ place->workers, place->isa, place->parallel_for, calls, { 0 } } );
}

static void close_case( determinism_run* base )
{
    running* r = (running*)base;
    hair_groom_destroy( &r->groom );
    wisp_world_destroy( base->world );
    assert_host_memory_is_released( &r->host );
    free( r );
}

static uint64_t hash_of_points( running* r )
{
    uint64_t hash;
    assert_int_equal( wisp_world_hash_column( r->base.world, r->entity, WISP_STRAND_POINTS, &hash ), WISP_OK );
    return hash;
}

// Two commands, the second from the first one's numbers and a different cursor; a stroke goes on from there.
static void run_case_steps( determinism_run* base, int steps )
{
    running* r = (running*)base;
    for ( int i = 0; i < steps; ++i )
    {
        const float n = (float)( base->steps - 2 );
        if ( base->steps > 0 )
        {
            hair_command( base->world, r->entity,
                          base->steps == 1 ? ( wisp_vec3 ){ 0.12f, -0.06f, 0.0f }
                                           : ( wisp_vec3 ){ 0.1f * n, -0.06f, 0.02f * n } );
        }
        hair_step( base->world );
        base->steps += 1;
        r->first = base->steps == 1 ? hash_of_points( r ) : r->first;
    }
}

static traces traces_of( determinism_run* base )
{
    const uint64_t now = hash_of_points( (running*)base );
    return ( traces ){ ( (running*)base )->first ^ ( now << 1 | now >> 63 ), wisp_world_hash( base->world ) };
}

static void check_case( determinism_run* base )
{
    running* r = (running*)base;
    hair_assert_finite( hair_view( base->world, r->entity, r->groom.vertex_count ), r->groom.vertex_count );
}

// A single bit.
static void nudge( determinism_run* base )
{
    running* r = (running*)base;
    uint32_t bits;
    float* last = &r->groom.points[r->groom.vertex_count - 1].x;
    memcpy( &bits, last, sizeof( bits ) );
    bits ^= 1u;
    memcpy( last, &bits, sizeof( bits ) );
    assert_int_equal( wisp_remove( base->world, r->entity ), WISP_OK );
    r->entity = hair_add_frozen( base->world, &r->groom, &r->def );
}

static determinism_case describe( int number )
{
    const int steps = strstr( cases[number].name, "stroke" ) || strstr( cases[number].name, "layers" ) ? 8 : 2;
    return ( determinism_case ){ cases[number].name, steps, .warm_workers = 1, .rehearsal = steps,
                                 .most_workers = 64 };
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

static void* run_blocks( void* argument )
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
        assert_int_equal( pthread_create( threads + n, NULL, run_blocks, workers + n ), 0 );
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

TEST( threads_of_a_host_do_not_change_a_bit )
{
    if ( !has_threads() )
    {
        SKIP( "no second thread can be made here" );
    }
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        int calls = 0;
        determinism_run* r = open_on( n, &( hair_host ){ host_threads, NULL, with_threads, &calls, { 0 } } );
        run_case_steps( r, describe( n ).steps );
        assert_true( traces_of( r ).state == run_case( &subject, n, &PLAIN, NULL ).state && calls > 0 );
        close_case( r );
    }
}

DETERMINISM( frozen_hair, true );
