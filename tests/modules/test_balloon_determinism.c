// The same bits for any number of workers, any instruction set and after any restart, and the same as yesterday:
// data/golden/balloon.hash. WISP_GOLDEN=write in the environment writes that file anew. And a warm step asks for no memory.
#include "balloon_engine_fixture.h"
#include "golden_file.h"

#include <inttypes.h>
#include <stdio.h>

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/balloon.hash";

// ---- cases: meshes without the C library's mathematics but its square root ----

typedef struct golden_case
{
    const char* name;
    int level; // of the pear: 10242 vertices are enough for several workers in every pass
    bool held, blows;
    wisp_solver solver;
    wisp_balloon_spin spin;
    float fill, rate;
    int steps;
} golden_case;

static const golden_case CASES[] = {
    { "held", 3, true, false, WISP_SOLVER_XPBD, WISP_BALLOON_SPIN_KICK, 1.2f, 0.0f, 30 },
    { "inflating", 3, false, false, WISP_SOLVER_PBD, WISP_BALLOON_SPIN_KICK, 1.0f, 5e-3f, 30 },
    { "flying", 3, false, true, WISP_SOLVER_XPBD, WISP_BALLOON_SPIN_KICK, 1.2f, 0.0f, 30 },
    { "flying-printed", 2, false, true, WISP_SOLVER_XPBD, WISP_BALLOON_SPIN_PRINTED, 1.2f, 0.0f, 30 },
    { "flying-large", 5, false, true, WISP_SOLVER_XPBD, WISP_BALLOON_SPIN_KICK, 1.2f, 0.0f, 3 },
};

typedef struct golden_meshes
{
    balloon_mesh level[6];
} golden_meshes;

static int make_meshes( void** state )
{
    golden_meshes* meshes = calloc( 1, sizeof( golden_meshes ) );
    assert_non_null( meshes );
    for ( int level = 2; level < WISP_COUNT( meshes->level ); ++level )
    {
        meshes->level[level] = balloon_pear( level );
    }
    *state = meshes;
    return 0;
}

static int free_meshes( void** state )
{
    golden_meshes* meshes = *state;
    for ( int level = 2; level < WISP_COUNT( meshes->level ); ++level )
    {
        balloon_mesh_destroy( meshes->level + level );
    }
    free( meshes );
    return 0;
}

static const int32_t PINS[3] = { 5, 70, 110 };

static balloon_scene scene_of( const golden_case* c, const golden_meshes* meshes )
{
    balloon_scene scene = balloon_scene_in_air( meshes->level + c->level );
    scene.def.keep_angular_momentum = true;
    scene.damping = 0.5f;
    scene.def.solver = scene.def.volume = c->solver;
    scene.def.fill = c->fill;
    scene.def.inflation_rate = c->rate;
    scene.def.spin = c->spin;
    scene.pins = PINS;
    scene.pin_count = c->held ? WISP_COUNT( PINS ) : 0;
    if ( c->blows )
    {
        balloon_scene_give_outlet( &scene, 40, true );
    }
    return scene;
}

static uint64_t hash_case( const golden_case* c, const golden_meshes* meshes, int workers, const char* isa )
{
    balloon_scene scene = scene_of( c, meshes );
    scene.workers = workers;
    scene.isa = isa;
    balloon_flight flight;
    balloon_start( &flight, &scene );
    balloon_steps( &flight, c->steps );
    assert_true( balloon_is_finite( &flight ) );
    uint64_t hash = balloon_hash( &flight );
    balloon_end( &flight );
    return hash;
}

// Instruction sets of this processor, each once.
static int list_isas( const char* isas[3] )
{
    static const char* const NAMES[] = { "baseline", "avx2", "avx512" };
    int count = 0;
    for ( int n = 0; n < WISP_COUNT( NAMES ); ++n )
    {
        const balloon_scene host = { .isa = NAMES[n], .workers = 1, .substeps = 1, .iterations = 1 };
        wisp_world* world = balloon_world_create( &host );
        if ( strcmp( wisp_world_isa( world ), NAMES[n] ) == 0 )
        {
            isas[count++] = NAMES[n];
        }
        wisp_world_destroy( world );
    }
    return count;
}

// ---- tests ----

static void workers_and_instruction_sets_do_not_change_a_bit( void** state )
{
    const int workers[] = { 1, 2, 3, 5, 8 };
    const char* isas[3];
    const int isa_count = list_isas( isas );
    assert_in_range( isa_count, 1, 3 );
    for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
    {
        const uint64_t expected = hash_case( CASES + n, *state, 1, "baseline" );
        for ( int k = 1; k < WISP_COUNT( workers ) * isa_count; ++k )
        {
            int w = workers[k % WISP_COUNT( workers )];
            const char* isa = isas[k / WISP_COUNT( workers )];
            uint64_t hash = hash_case( CASES + n, *state, w, isa );
            if ( hash != expected )
            {
                fail_msg( "%s: %016" PRIx64 " with %d workers and %s, %016" PRIx64 " with one and baseline",
                          CASES[n].name, hash, w, isa, expected );
            }
        }
    }
    for ( int i = 0; i < isa_count; ++i )
    {
        print_message( "           compared: %s\n", isas[i] );
    }
}

static golden_hash run_numbered( int number, const void* context )
{
    return ( golden_hash ){ CASES[number].name, hash_case( CASES + number, context, 1, NULL ) };
}

static void balloons_are_those_of_the_golden_file( void** state )
{
    golden_check( golden_file, WISP_COUNT( CASES ), run_numbered, *state );
}

// A hash that forgot a vertex would let everything pass.
static void a_hash_tells_cases_and_a_single_bit_apart( void** state )
{
    uint64_t hashes[WISP_COUNT( CASES )];
    for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
    {
        hashes[n] = hash_case( CASES + n, *state, 1, NULL );
        for ( int k = 0; k < n; ++k )
        {
            assert_true( hashes[n] != hashes[k] );
        }
    }
    balloon_scene scene = scene_of( CASES, *state );
    balloon_flight flight;
    balloon_start( &flight, &scene );
    uint32_t bits;
    float* last = balloon_positions( &flight ) + 4 * ( scene.mesh->vertex_count - 1 );
    memcpy( &bits, last, sizeof( bits ) );
    bits ^= 1u;
    memcpy( last, &bits, sizeof( bits ) );
    balloon_steps( &flight, CASES[0].steps );
    assert_true( balloon_hash( &flight ) != hashes[0] );
    balloon_end( &flight );
}

static void a_restored_snapshot_flies_on_bit_by_bit( void** state )
{
    for ( int n = 0; n < 4; ++n )
    {
        balloon_scene scene = scene_of( CASES + n, *state );
        balloon_flight flight;
        balloon_start( &flight, &scene );
        balloon_steps( &flight, 7 );
        size_t size = wisp_world_snapshot_size( flight.world );
        void* kept = malloc( size );
        assert_non_null( kept );
        assert_int_equal( wisp_world_snapshot( flight.world, kept, size ), WISP_OK );
        balloon_steps( &flight, 9 );
        uint64_t points = balloon_hash( &flight ), everything = wisp_world_hash( flight.world );
        assert_int_equal( wisp_world_restore( flight.world, kept, size ), WISP_OK );
        balloon_steps( &flight, 9 );
        assert_true( balloon_hash( &flight ) == points );
        assert_true( wisp_world_hash( flight.world ) == everything );
        free( kept );
        balloon_end( &flight );
    }
}

// Figures are read, not felt.
static void asking_for_figures_does_not_change_a_bit( void** state )
{
    for ( int n = 0; n < 4; ++n )
    {
        balloon_scene scene = scene_of( CASES + n, *state );
        balloon_flight flight;
        balloon_start( &flight, &scene );
        assert_int_equal( wisp_want_balloon_figures( flight.world, flight.entity, false ), WISP_OK );
        balloon_steps( &flight, CASES[n].steps );
        assert_true( balloon_hash( &flight ) == hash_case( CASES + n, *state, 1, NULL ) );
        balloon_end( &flight );
    }
}

static void a_warm_step_asks_for_no_memory( void** state )
{
    for ( int workers = 1; workers <= 3; workers += 2 )
    {
        for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
        {
            test_host host = { 0 };
            balloon_scene scene = scene_of( CASES + n, *state );
            scene.workers = workers;
            scene.allocator = test_host_allocator( &host );
            balloon_flight flight;
            balloon_start( &flight, &scene );
            balloon_steps( &flight, 3 );
            int64_t asked = atomic_load( &host.asked );
            balloon_steps( &flight, 5 );
            assert_int_equal( atomic_load( &host.asked ), asked );
            balloon_end( &flight );
            assert_host_has_all_back( &host );
        }
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( balloons_are_those_of_the_golden_file ),
        cmocka_unit_test( a_hash_tells_cases_and_a_single_bit_apart ),
        cmocka_unit_test( workers_and_instruction_sets_do_not_change_a_bit ),
        cmocka_unit_test( a_restored_snapshot_flies_on_bit_by_bit ),
        cmocka_unit_test( asking_for_figures_does_not_change_a_bit ),
        cmocka_unit_test( a_warm_step_asks_for_no_memory ),
    };
    return cmocka_run_group_tests( tests, make_meshes, free_meshes );
}
