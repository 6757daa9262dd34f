// The same bits for any number of workers, any instruction set and any host's loop, and the same as yesterday:
// data/golden/implicit_cloth.hash. WISP_GOLDEN=write in the environment writes that file anew.
#include "implicit_cloth_fixture.h"
#include "golden_file.h"

#include <inttypes.h>

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/implicit_cloth.hash";

enum
{
    SIDE = 20,  // vertices: one block of slices
    LARGE = 52, // more than 256 slices, which are solved for in blocks of 64
    STEPS = 10,
};

static const float DT = 1.0f / 64.0f; // s

typedef struct golden_case
{
    const char* name;
    int side;
    wisp_implicit_weights weights;
    wisp_implicit_stiffness stiffness;
    wisp_implicit_damping damping;
    wisp_implicit_jacobian jacobian;
    wisp_implicit_integrator integrator;
    int repeats;
    bool crumpled, carried, dropped, pushed; // carried by its pins, on a ball and a plane, by a ball that moves
} golden_case;

static const golden_case cases[] = {
    { "hanging", SIDE, .repeats = 1 },
    { "pair-weights-carried", SIDE, .weights = WISP_IMPLICIT_WEIGHTS_PAIR, .repeats = 1, .carried = true },
    { "sheet", SIDE, .weights = WISP_IMPLICIT_WEIGHTS_NONE, .stiffness = WISP_IMPLICIT_STIFFNESS_SHEET,
      .repeats = 1 },
    { "axial-damping", SIDE, .damping = WISP_IMPLICIT_DAMPING_AXIAL, .repeats = 1, .crumpled = true },
    { "full-jacobian", SIDE, .jacobian = WISP_IMPLICIT_JACOBIAN_FULL, .repeats = 1, .crumpled = true },
    { "bdf2", SIDE, .integrator = WISP_IMPLICIT_BDF2, .repeats = 1, .carried = true },
    { "newton-repeats", SIDE, .repeats = 3, .crumpled = true },
    { "blocks", LARGE, .repeats = 1, .carried = true },
    { "dropped-on-a-ball", SIDE, .repeats = 1, .dropped = true },
    { "blocks-pushed", LARGE, .integrator = WISP_IMPLICIT_BDF2, .repeats = 2, .dropped = true, .pushed = true },
};

typedef struct place_to_run
{
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
} place_to_run;

// A world with a case in it.
typedef struct running
{
    const golden_case* c;
    hosted h;
    wisp_entity cloth, ball;
    int steps;
} running;

static void open_place( running* r, const golden_case* c, const place_to_run* place, int* calls )
{
    *r = ( running ){ .c = c };
    r->h.def = implicit_def( &r->h );
    r->h.def.workers = place->workers;
    r->h.def.isa = place->isa;
    r->h.def.parallel_for = place->parallel_for;
    r->h.def.parallel_for_user = calls;
    r->h.def.substeps = 2;
    assert_int_equal( wisp_world_create( &r->h.def, &r->h.world, NULL ), WISP_OK );
}

// A ball under the middle of the sheet, and a plane under both.
static void add_bodies( running* r )
{
    const float half = 0.5f * 0.03125f * (float)( r->c->side - 1 );
    wisp_collider_def ball = wisp_default_collider_def(), plane = ball;
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.125f;
    ball.pose.translation = ( wisp_vec3 ){ half, -0.15f, half };
    plane.kind = WISP_COLLIDER_PLANE;
    plane.pose.translation = ( wisp_vec3 ){ 0.0f, -0.05f, 0.0f };
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = 0.01f;
    wisp_entity e;
    assert_status( r->h.world, wisp_add_collider( r->h.world, &ball, &r->ball ), WISP_OK );
    assert_status( r->h.world, wisp_add_collider( r->h.world, &plane, &e ), WISP_OK );
    assert_status( r->h.world, wisp_set_collision( r->h.world, r->cloth, &collision ), WISP_OK );
}

static void add_case( running* r )
{
    const golden_case* c = r->c;
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.weights = c->weights;
    def.stiffness = c->stiffness;
    def.damping_form = c->damping;
    def.jacobian = c->jacobian;
    def.integrator = c->integrator;
    def.newton_repeats = c->repeats;
    r->cloth = add_sheet( r->h.world, &def, c->side, c->dropped == false );
    if ( c->crumpled )
    {
        crumple_sheet( r->h.world, r->cloth, 0.004f, 0.5f );
    }
    if ( c->dropped )
    {
        add_bodies( r );
    }
}

static void run_case_steps( running* r, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        r->steps += 1;
        const float t = DT * (float)r->steps;
        const int32_t pin = 0;
        const wisp_vec3 target = { -0.25f * t, 0.5f * t, 0.0f };
        const float half = 0.5f * 0.03125f * (float)( r->c->side - 1 );
        wisp_rigid pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { half + 0.5f * t, -0.15f + 0.5f * t, half } };
        if ( r->c->carried )
        {
            assert_status( r->h.world, wisp_move_pins( r->h.world, r->cloth, &pin, &target, 1 ), WISP_OK );
        }
        if ( r->c->pushed )
        {
            assert_status( r->h.world, wisp_move_collider( r->h.world, r->ball, pose ), WISP_OK );
        }
        run_steps( r->h.world, 1, DT );
    }
}

// Points, for the golden file; and everything that a step leaves behind, whose hash also changes when a column is
// added to the engine.
typedef struct traces
{
    uint64_t motion, state;
} traces;

static traces traces_of( running* r )
{
    return ( traces ){ hash_of( r->h.world, r->cloth, WISP_SURFACE_POINTS ), wisp_world_hash( r->h.world ) };
}

static traces run_case( const golden_case* c, const place_to_run* place, int* calls )
{
    running r;
    open_place( &r, c, place, calls );
    add_case( &r );
    run_case_steps( &r, STEPS );
    const traces t = traces_of( &r );
    assert_int_equal( wisp_world_counter( r.h.world, WISP_COUNT_HALTED ), 0 );
    const wisp_implicit_cloth_figures f = figures_of( r.h.world, r.cloth );
    assert_true( f.iterations > 0 );
    assert_int_equal( f.sticking + f.sliding + f.landing > 0, c->dropped );
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
    traces t = run_case( c, place, &calls );
    if ( t.motion != expected.motion || t.state != expected.state )
    {
        fail_msg( "%s: %016" PRIx64 " with %d workers and %s%s, %016" PRIx64 " with one and baseline", c->name,
                  t.state, place->workers, place->isa, place->parallel_for != NULL ? " on a host's loop" : "",
                  expected.state );
    }
    // a small sheet is one block, which nobody else is asked to help with
    assert_true( place->parallel_for == NULL || calls > 0 || c->side < LARGE );
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
        running r;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        velocity_of( r.h.world, r.cloth, cases[n].side + 1 )[2] += 1e-3f;
        run_case_steps( &r, STEPS );
        assert_true( traces_of( &r ).motion != hashes[n] );
        close_world( &r.h );
    }
}

static void a_step_that_is_warm_asks_for_no_memory( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        running r;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        run_case_steps( &r, 3 );
        const int64_t asked = atomic_load( &r.h.host.asked );
        run_case_steps( &r, STEPS );
        if ( atomic_load( &r.h.host.asked ) != asked )
        {
            fail_msg( "%s asks for memory %d times in warm steps", cases[n].name,
                      (int)( atomic_load( &r.h.host.asked ) - asked ) );
        }
        close_world( &r.h );
    }
}

static void a_snapshot_goes_on_to_the_same_bits( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        const traces straight = run_case( cases + n, &PLAIN, NULL );
        running r;
        open_place( &r, cases + n, &PLAIN, NULL );
        add_case( &r );
        run_case_steps( &r, STEPS / 2 );
        const size_t size = wisp_world_snapshot_size( r.h.world );
        void* bytes = malloc( size );
        assert_non_null( bytes );
        assert_status( r.h.world, wisp_world_snapshot( r.h.world, bytes, size ), WISP_OK );
        run_case_steps( &r, STEPS );
        assert_true( traces_of( &r ).state != straight.state );
        assert_status( r.h.world, wisp_world_restore( r.h.world, bytes, size ), WISP_OK );
        r.steps = STEPS / 2;
        run_case_steps( &r, STEPS - STEPS / 2 );
        const traces t = traces_of( &r );
        if ( t.motion != straight.motion || t.state != straight.state )
        {
            fail_msg( "%s goes on differently behind a snapshot", cases[n].name );
        }
        free( bytes );
        close_world( &r.h );
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
