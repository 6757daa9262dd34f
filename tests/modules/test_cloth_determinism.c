// The same bits for any number of workers, any instruction set and any host's loop, and the same as yesterday:
// data/golden/cloth.hash. WISP_GOLDEN=write in the environment writes that file anew.
#include "cloth_fixture.h"
#include "golden_file.h"

#include <inttypes.h>

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/cloth.hash";

enum
{
    SIDE = 40, // vertices: several tiles of 256, several blocks of 512
    STEPS = 12,
};

typedef struct golden_case
{
    const char* name;
    wisp_cloth_bending bending;
    wisp_solver solver;
    wisp_sweep sweep;
    bool blown, damped, far; // far: tethers and levels
    int iterations;
} golden_case;

static const golden_case cases[] = {
    { "hanging", WISP_CLOTH_BENDING_CROSS, WISP_SOLVER_XPBD, WISP_SWEEP_COLOUR, false, false, false, 1 },
    { "hanging-pbd-iterated", WISP_CLOTH_BENDING_CROSS, WISP_SOLVER_PBD, WISP_SWEEP_COLOUR, false, false, false, 3 },
    { "flag", WISP_CLOTH_BENDING_CROSS, WISP_SOLVER_XPBD, WISP_SWEEP_COLOUR, true, true, false, 2 },
    { "dihedral", WISP_CLOTH_BENDING_DIHEDRAL, WISP_SOLVER_XPBD, WISP_SWEEP_COLOUR, false, true, false, 2 },
    { "isometric", WISP_CLOTH_BENDING_ISOMETRIC, WISP_SOLVER_XPBD, WISP_SWEEP_COLOUR, false, false, false, 2 },
    { "tethers-levels", WISP_CLOTH_BENDING_CROSS, WISP_SOLVER_PBD, WISP_SWEEP_COLOUR, false, false, true, 1 },
    { "list-sweep", WISP_CLOTH_BENDING_CROSS, WISP_SOLVER_XPBD, WISP_SWEEP_LIST, false, false, false, 1 },
};

typedef struct place_to_run
{
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
} place_to_run;

static void open_place( hosted* h, const golden_case* c, const place_to_run* place, int* calls )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.workers = place->workers;
    h->def.isa = place->isa;
    h->def.parallel_for = place->parallel_for;
    h->def.parallel_for_user = calls;
    h->def.substeps = 2;
    h->def.iterations = c->iterations;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static wisp_entity add_case( wisp_world* world, const golden_case* c, int n )
{
    test_mesh mesh = test_plane( n, 0.03125f );
    const int32_t pins[2] = { 0, n - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    fabric.tethers = c->far;
    fabric.levels = c->far ? 4 : 0;
    fabric.sweep = c->sweep;
    fabric.attachments = pins;
    fabric.attachment_count = 2;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = c->bending;
    cloth.solver = c->solver;
    cloth.warp_compliance = 1e-4f;
    cloth.damping = c->damped ? 0.5f : 0.0f;
    cloth.drag = c->blown ? 1.0f : 0.0f;
    cloth.lift = c->blown ? 0.5f : 0.0f;
    cloth.wind = ( wisp_vec3 ){ 3.0f, 1.0f, 2.0f };
    cloth.tethers = c->far;
    cloth.level_passes = c->far ? 2 : 0;
    wisp_entity e = add_cloth( world, &fabric, surface, &cloth, EARTH );
    assert_status( world, wisp_want( world, e, WISP_SURFACE_NORMALS ), WISP_OK );
    test_mesh_free( &mesh );
    return e;
}

// Points and normals, for the golden file; and everything that a step leaves behind, whose hash also changes when a
// column is added to the engine.
typedef struct traces
{
    uint64_t motion, state;
} traces;

static traces run_case( const golden_case* c, const place_to_run* place, int* calls )
{
    hosted h;
    open_place( &h, c, place, calls );
    wisp_entity e = add_case( h.world, c, SIDE );
    run_steps( h.world, STEPS, 1.0f / 64.0f );
    uint64_t points = hash_of( h.world, e, WISP_SURFACE_POINTS ),
             normals = hash_of( h.world, e, WISP_SURFACE_NORMALS );
    traces t = { points ^ ( normals << 1 | normals >> 63 ), wisp_world_hash( h.world ) };
    assert_int_equal( wisp_world_counter( h.world, WISP_COUNT_HALTED ), 0 );
    close_world( &h );
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
    traces t = run_case( c, place, &calls );
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
        for ( int i = 0; i < WISP_COUNT( isas ); ++i )
        {
            for ( int w = 0; w < WISP_COUNT( workers ); ++w )
            {
                assert_traces( cases + n, &( place_to_run ){ workers[w], isas[i], NULL }, expected );
            }
            assert_traces( cases + n, &( place_to_run ){ 1, isas[i], last_block_first }, expected );
        }
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
    }
    hosted h;
    open_place( &h, cases, &PLAIN, NULL );
    wisp_entity e = add_case( h.world, cases, SIDE );
    velocity_of( h.world, e, SIDE * SIDE - 1 )[2] = 1e-3f;
    run_steps( h.world, STEPS, 1.0f / 64.0f );
    assert_true( wisp_world_hash( h.world ) != run_case( cases, &PLAIN, NULL ).state );
    close_world( &h );
}

static void a_step_that_is_warm_asks_for_no_memory( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        for ( int workers = 1; workers <= 2; ++workers )
        {
            hosted h;
            open_place( &h, cases + n, &( place_to_run ){ workers, NULL, NULL }, NULL );
            add_case( h.world, cases + n, SIDE );
            run_steps( h.world, 3, 1.0f / 64.0f );
            int64_t asked = atomic_load( &h.host.asked );
            run_steps( h.world, 10, 1.0f / 64.0f );
            assert_int_equal( atomic_load( &h.host.asked ), asked );
            close_world( &h );
        }
    }
}

static void a_snapshot_goes_on_to_the_same_bits( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        hosted h;
        open_place( &h, cases + n, &PLAIN, NULL );
        add_case( h.world, cases + n, SIDE );
        run_steps( h.world, STEPS / 2, 1.0f / 64.0f );
        size_t size = wisp_world_snapshot_size( h.world );
        void* bytes = malloc( size );
        assert_non_null( bytes );
        assert_status( h.world, wisp_world_snapshot( h.world, bytes, size ), WISP_OK );
        run_steps( h.world, STEPS / 2, 1.0f / 64.0f );
        uint64_t hash = wisp_world_hash( h.world );
        run_steps( h.world, 5, 1.0f / 64.0f );
        assert_true( wisp_world_hash( h.world ) != hash );
        assert_status( h.world, wisp_world_restore( h.world, bytes, size ), WISP_OK );
        run_steps( h.world, STEPS / 2, 1.0f / 64.0f );
        assert_int_equal( wisp_world_hash( h.world ), hash );
        free( bytes );
        close_world( &h );
    }
}

// Twenty small cloths of all kinds share waves; each is what it is in a world of its own.
static void many_small_cloths_are_what_each_is_alone( void** state )
{
    (void)state;
    enum
    {
        CLOTHS = 20,
    };
    const golden_case one_iteration = { .iterations = 2 };
    for ( int workers = 1; workers <= 3; workers += 2 )
    {
        const place_to_run place = { workers, NULL, NULL };
        hosted together;
        open_place( &together, &one_iteration, &place, NULL );
        wisp_entity all[CLOTHS];
        for ( int i = 0; i < CLOTHS; ++i )
        {
            all[i] = add_case( together.world, cases + i % WISP_COUNT( cases ), 5 + i % 7 );
        }
        run_steps( together.world, STEPS, 1.0f / 64.0f );
        for ( int i = 0; i < CLOTHS; ++i )
        {
            hosted alone;
            open_place( &alone, &one_iteration, &PLAIN, NULL );
            wisp_entity e = add_case( alone.world, cases + i % WISP_COUNT( cases ), 5 + i % 7 );
            run_steps( alone.world, STEPS, 1.0f / 64.0f );
            assert_int_equal( hash_of( together.world, all[i], WISP_SURFACE_POINTS ),
                              hash_of( alone.world, e, WISP_SURFACE_POINTS ) );
            assert_int_equal( hash_of( together.world, all[i], WISP_SURFACE_NORMALS ),
                              hash_of( alone.world, e, WISP_SURFACE_NORMALS ) );
            close_world( &alone );
        }
        close_world( &together );
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
        cmocka_unit_test( many_small_cloths_are_what_each_is_alone ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
