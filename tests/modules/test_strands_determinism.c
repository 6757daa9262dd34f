// The same bits for any number of workers, any instruction set and any host's loop, and the same as yesterday:
// data/golden/strands.hash. WISP_GOLDEN=write in the environment writes that file anew.
#include "strands_fixture.h"
#include "golden_file.h"

#include "guide_hair.h"

#include <inttypes.h>

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/strands.hash";

enum
{
    STRANDS = 70, // five groups, the last of them not full
    VERTICES = 12,
    STEPS = 12,
};

static const float SECONDS = 1.0f / 64.0f;

typedef struct golden_case
{
    const char* name;
    wisp_strand_stretch stretch;
    wisp_strand_bend bend;
    wisp_strand_rest rest;
    wisp_solver solver;
    int iterations;
    bool carried, blown, mixed; // by a head, by the wind and damped, on a grid
    bool ball;                  // a sphere in the way
    bool ghosts;                // others follow, and curves run through those
    strand_curve* curve;
} golden_case;

// A helix that grows down. It turns by the angle whose cosine is 0.8: sums and products have the same bits everywhere, a library's
// sine need not.
static wisp_vec3 helix_down( int strand, int i, int count, float length )
{
    const float radius = 0.12f * length, drop = 0.6f * length / (float)( count - 1 );
    float x = strand % 3 == 0 ? radius : 0.6f * radius, z = strand % 3 == 0 ? 0.0f : 0.8f * radius;
    const float x0 = x, z0 = z;
    for ( int k = 0; k < i; ++k )
    {
        const float turned = 0.8f * x - 0.6f * z;
        z = 0.6f * x + 0.8f * z;
        x = turned;
    }
    return ( wisp_vec3 ){ 0.01f * (float)strand + x - x0, -drop * (float)i, z - z0 };
}

// Strands side by side over what is at the origin: some stick out, some are curled.
static wisp_vec3 fringe( int strand, int i, int count, float length )
{
    const wisp_vec3 p = strand % 2 == 0 ? straight_out( 0, i, count, length ) : helix_down( 0, i, count, length );
    const float x = strand % 2 == 0 ? -0.06f : 0.0f;
    return ( wisp_vec3 ){ p.x + x, p.y + ( strand % 2 == 0 ? 0.045f : 0.1f ),
                          p.z + 0.001f * (float)( strand - STRANDS / 2 ) };
}

static wisp_vec3 beside_the_fringe( int strand, int i, int count, float length )
{
    const wisp_vec3 p = fringe( strand % STRANDS, i, count, length );
    return ( wisp_vec3 ){ p.x + 0.001f, p.y, p.z + 0.0003f * (float)( 1 + strand / STRANDS ) };
}

#define DIRECT .stretch = WISP_STRAND_STRETCH_DIRECT
#define ROD DIRECT, .bend = WISP_STRAND_BEND_ROD
#define BEND_LINKS .bend = WISP_STRAND_BEND_LINKS

static const golden_case cases[] = {
    { "direct-bend-links", DIRECT, BEND_LINKS, .iterations = 1, .curve = fringe },
    { "straight-rod", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .curve = straight_out },
    { "balanced-curls", ROD, .rest = WISP_STRAND_REST_BALANCED, .iterations = 1, .carried = true,
      .curve = helix_down },
    { "shape-curls", ROD, .rest = WISP_STRAND_REST_SHAPE, .iterations = 1, .curve = helix_down },
    { "links-xpbd-iterated", .stretch = WISP_STRAND_STRETCH_LINKS, BEND_LINKS, .solver = WISP_SOLVER_XPBD,
      .iterations = 2, .curve = fringe },
    { "follow", .stretch = WISP_STRAND_STRETCH_FOLLOW, .bend = WISP_STRAND_BEND_NONE, .iterations = 1,
      .carried = true, .curve = fringe },
    { "grid-air-damping", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .blown = true, .mixed = true,
      .curve = fringe },
    { "carried-over-a-ball", ROD, .rest = WISP_STRAND_REST_BALANCED, .iterations = 1, .carried = true, .ball = true,
      .curve = fringe },
    { "ghosts-curves", ROD, .rest = WISP_STRAND_REST_BALANCED, .iterations = 1, .carried = true, .ghosts = true,
      .curve = fringe },
};

typedef struct place_to_run
{
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
} place_to_run;

static const place_to_run PLAIN = { 1, "baseline", NULL };

// A world with a case in it. Where no ghosts follow, ghosts and curves are the strands themselves.
typedef struct running
{
    const golden_case* c;
    strand_world s;
    wisp_entity strands, ghosts, curves;
    int steps;
} running;

static void open_place( running* r, const golden_case* c, const place_to_run* place, int* calls )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module,
                                                  &wisp_guide_hair_module };
    *r = ( running ){ .c = c };
    prepare_strands( &r->s, MODULES, WISP_COUNT( MODULES ) );
    r->s.def.workers = place->workers;
    r->s.def.isa = place->isa;
    r->s.def.parallel_for = place->parallel_for;
    r->s.def.parallel_for_user = calls;
    r->s.def.substeps = 4;
    r->s.def.iterations = c->iterations;
    open_prepared( &r->s );
}

static void assert_ok( wisp_world* world, wisp_status status )
{
    if ( status != WISP_OK )
    {
        fail_msg( "%s: %s", wisp_status_name( status ), wisp_world_message( world ) );
    }
}

static wisp_strand_dynamics_def def_of( const golden_case* c )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.stretch = c->stretch;
    def.bend = c->bend;
    def.rest = c->rest;
    def.solver = c->solver;
    def.stretch_compliance = 1.0f;
    def.bend_compliance = 100.0f;
    def.bend_damping = c->rest == WISP_STRAND_REST_SHAPE ? 1e-3f : 0.0f;
    def.damping = c->blown ? 2.0f : 0.0f;
    def.drag = c->blown ? 1.0f : 0.0f;
    def.wind = ( wisp_vec3 ){ 1.0f, 0.5f, 2.0f };
    return def;
}

static void add_ball( running* r )
{
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.04f;
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity e;
    assert_ok( r->s.world, wisp_add_collider( r->s.world, &ball, &e ) );
    assert_ok( r->s.world, wisp_set_collision( r->s.world, r->strands, &collision ) );
    assert_ok( r->s.world, wisp_want_collision_figures( r->s.world, r->strands, true ) );
}

static void add_ghosts( running* r )
{
    int counts[3 * STRANDS];
    for ( int n = 0; n < WISP_COUNT( counts ); ++n )
    {
        counts[n] = VERTICES;
    }
    r->ghosts = add_strands( r->s.world, counts, WISP_COUNT( counts ), beside_the_fringe, 0.1f );
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.targets = r->strands;
    def.target_count = 3;
    assert_ok( r->s.world, wisp_set_ghosts( r->s.world, r->ghosts, &def ) );
    wisp_curves_def curves = wisp_default_curves_def();
    curves.source = r->ghosts;
    curves.samples = 3;
    assert_ok( r->s.world, wisp_add_curves( r->s.world, &curves, &r->curves ) );
    assert_ok( r->s.world, wisp_want( r->s.world, r->ghosts, WISP_STRAND_POINTS ) );
    assert_ok( r->s.world, wisp_want( r->s.world, r->curves, WISP_STRAND_POINTS ) );
}

static void add_case( running* r )
{
    const wisp_strand_dynamics_def def = def_of( r->c );
    r->strands = r->ghosts = r->curves = add_moving( r->s.world, STRANDS, VERTICES, r->c->curve, 0.1f, &def );
    if ( r->c->mixed )
    {
        wisp_strand_grid_def grid = wisp_default_strand_grid_def();
        grid.repulsion = 1.0f;
        assert_ok( r->s.world, wisp_set_strand_grid( r->s.world, r->strands, &grid ) );
    }
    if ( r->c->ball )
    {
        add_ball( r );
    }
    if ( r->c->ghosts )
    {
        add_ghosts( r );
    }
}

static void run_steps( running* r, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        r->steps += 1;
        const float t = r->c->carried ? SECONDS * (float)r->steps : 0.0f;
        const wisp_rigid pose =
            wisp_rigid_make( ( wisp_quat ){ 0.0f, t, 0.0f, 1.0f }, ( wisp_vec3 ){ 0.1f * t, -0.3f * t, 0.0f } );
        assert_ok( r->s.world, wisp_move_strand_head( r->s.world, r->strands, pose ) );
        strand_steps( r->s.world, 1, SECONDS );
    }
}

// Points, for the golden file; and everything that a step leaves behind, whose hash also changes when a column is added to the
// engine.
typedef struct traces
{
    uint64_t motion, state;
} traces;

static uint64_t turned( uint64_t hash, int bits )
{
    return hash << bits | hash >> ( 64 - bits );
}

static traces traces_of( running* r )
{
    const uint64_t points = hash_of( r->s.world, r->strands, WISP_STRAND_POINTS );
    const uint64_t ghosts = hash_of( r->s.world, r->ghosts, WISP_STRAND_POINTS );
    const uint64_t curves = hash_of( r->s.world, r->curves, WISP_STRAND_POINTS );
    return ( traces ){ points ^ turned( ghosts, 1 ) ^ turned( curves, 2 ), wisp_world_hash( r->s.world ) };
}

static traces run_case( const golden_case* c, const place_to_run* place, int* calls )
{
    running r;
    open_place( &r, c, place, calls );
    add_case( &r );
    run_steps( &r, STEPS );
    const traces t = traces_of( &r );
    assert_int_equal( wisp_world_counter( r.s.world, WISP_COUNT_HALTED ), 0 );
    wisp_collision_figures touch = { .contacts = 1 };
    assert_true( c->ball == false || wisp_read_collision_figures( r.s.world, r.strands, &touch ) == WISP_OK );
    assert_true( touch.contacts > 0 );
    close_strands( &r.s );
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
        float* velocity = wisp_world_column( r.s.world, r.strands, WISP_STRAND_VELOCITY, 0 );
        velocity[( VERTICES - 1 ) * 3 * WISP_LANES] = 1e-3f; // the tip of the first strand, along x
        run_steps( &r, STEPS );
        assert_true( traces_of( &r ).motion != hashes[n] );
        close_strands( &r.s );
    }
}

// Run so many steps and come back.
static void run_there_and_back( running* r, int steps )
{
    const int before = r->steps;
    const size_t size = wisp_world_snapshot_size( r->s.world );
    void* bytes = malloc( size );
    assert_non_null( bytes );
    assert_ok( r->s.world, wisp_world_snapshot( r->s.world, bytes, size ) );
    run_steps( r, steps );
    assert_ok( r->s.world, wisp_world_restore( r->s.world, bytes, size ) );
    r->steps = before;
    free( bytes );
}

static void a_step_that_is_warm_asks_for_no_memory( void** state )
{
    (void)state;
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        // each worker has a grid of its own, and which one of several takes a pass is nobody's promise
        for ( int workers = 1; workers <= ( cases[n].mixed ? 1 : 2 ); ++workers )
        {
            running r;
            open_place( &r, cases + n, &( place_to_run ){ workers, NULL, NULL }, NULL );
            add_case( &r );
            run_steps( &r, 3 );
            // a grid covers all that strands reach, and is warm where they have reached it before
            run_there_and_back( &r, cases[n].mixed ? 10 : 0 );
            const int64_t asked = atomic_load( &r.s.host.asked );
            run_steps( &r, 10 );
            if ( atomic_load( &r.s.host.asked ) != asked )
            {
                fail_msg( "%s asks for memory %d times in ten warm steps with %d workers", cases[n].name,
                          (int)( atomic_load( &r.s.host.asked ) - asked ), workers );
            }
            close_strands( &r.s );
        }
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
        run_steps( &r, STEPS / 2 );
        const size_t size = wisp_world_snapshot_size( r.s.world );
        void* bytes = malloc( size );
        assert_non_null( bytes );
        assert_ok( r.s.world, wisp_world_snapshot( r.s.world, bytes, size ) );
        run_steps( &r, STEPS );
        assert_true( traces_of( &r ).state != straight.state );
        assert_ok( r.s.world, wisp_world_restore( r.s.world, bytes, size ) );
        r.steps = STEPS / 2;
        run_steps( &r, STEPS - STEPS / 2 );
        const traces t = traces_of( &r );
        if ( t.motion != straight.motion || t.state != straight.state )
        {
            fail_msg( "%s goes on differently behind a snapshot", cases[n].name );
        }
        free( bytes );
        close_strands( &r.s );
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
