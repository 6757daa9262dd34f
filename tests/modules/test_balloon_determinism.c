// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/balloon.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "balloon_engine_fixture.h"
#include "determinism_fixture.h"

// ---- cases: meshes that need nothing of the C library's mathematics except its square root ----

typedef struct golden_case
{
    const char* name;
    int level; // of the pear: 10242 vertices are enough for several workers in every pass
    bool held, blows;
    wisp_solver solver;
    float gas_ratio, rate;
    int steps;
} golden_case;

static const golden_case cases[] = {
    { "held", 3, true, false, WISP_SOLVER_XPBD, 1.2f, 0.0f, 30 },
    { "inflating", 3, false, false, WISP_SOLVER_PBD, 1.0f, 5e-3f, 30 },
    { "flying", 3, false, true, WISP_SOLVER_XPBD, 1.2f, 0.0f, 30 },
    { "flying-large", 5, false, true, WISP_SOLVER_XPBD, 1.2f, 0.0f, 3 },
};

// One per level, made once.
static balloon_mesh meshes[6];

static const int32_t PINS[3] = { 5, 70, 110 };

static balloon_scene scene_of( const golden_case* c )
{
    balloon_scene scene = balloon_scene_in_air( meshes + c->level );
    scene.damping = 0.5f;
    scene.def.solver = scene.def.volume = c->solver;
    scene.def.gas_ratio = c->gas_ratio;
    scene.def.inflation_rate = c->rate;
    scene.pins = PINS;
    scene.pin_count = c->held ? WISP_COUNT( PINS ) : 0;
    if ( c->blows )
    {
        balloon_scene_give_outlet( &scene, 40, true );
    }
    return scene;
}

typedef struct running
{
    determinism_run base;
    test_host host;
    balloon_scene scene;
    balloon_flight flight;
} running;

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    running* r = checked_calloc( 1, sizeof( *r ) );
    r->scene = scene_of( cases + number );
    r->scene.workers = place->workers;
    r->scene.isa = place->isa;
    r->scene.parallel_for = place->parallel_for;
    r->scene.parallel_for_user = calls;
    r->scene.allocator = test_host_allocator( &r->host );
    r->flight = balloon_start( &r->scene );
    r->base = ( determinism_run ){ number, 0, r->flight.world, &r->host };
    return &r->base;
}

static void close_case( determinism_run* base )
{
    SCOPED( free_local ) running* r = (running*)base;
    balloon_end( &r->flight );
    assert_host_memory_is_released( &r->host );
}

static void run_case_steps( determinism_run* base, int steps )
{
    base->steps += steps;
    balloon_steps( &( (running*)base )->flight, steps );
}

static traces traces_of( determinism_run* base )
{
    return ( traces ){ balloon_hash( &( (running*)base )->flight ), wisp_world_hash( base->world ) };
}

static void check_case( determinism_run* base )
{
    assert_true( balloon_is_finite( &( (running*)base )->flight ) );
}

// A single bit.
static void nudge( determinism_run* base )
{
    running* r = (running*)base;
    uint32_t bits;
    float* last = balloon_positions( &r->flight ) + 4 * ( r->scene.mesh->vertex_count - 1 );
    memcpy( &bits, last, sizeof( bits ) );
    bits ^= 1u;
    memcpy( last, &bits, sizeof( bits ) );
}

static determinism_case describe( int number )
{
    const golden_case* c = cases + number;
    return ( determinism_case ){ c->name, c->steps, .warm_workers = 3, .is_one_block = c->level < 5 };
}

// Statistics are read only and have no effect.
TEST( asking_for_stats_does_not_change_a_bit )
{
    for ( int n = 0; n < 3; ++n )
    {
        uint64_t hashes[2];
        for ( int queried = 0; queried < 2; ++queried )
        {
            determinism_run* r = open_case( n, &PLAIN, NULL );
            const wisp_entity e = ( (running*)r )->flight.entity;
            assert_status( r->world, wisp_request_balloon_stats( r->world, e, queried == 1 ), WISP_OK );
            run_case_steps( r, cases[n].steps );
            hashes[queried] = traces_of( r ).motion;
            close_case( r );
        }
        assert_true( hashes[0] == hashes[1] );
    }
}

DETERMINISM( balloon, true );

static int make_meshes( void** state )
{
    (void)state;
    for ( int level = 2; level < WISP_COUNT( meshes ); ++level )
    {
        meshes[level] = balloon_pear( level );
    }
    return 0;
}

static int free_meshes( void** state )
{
    (void)state;
    for ( int level = 2; level < WISP_COUNT( meshes ); ++level )
    {
        balloon_mesh_destroy( meshes + level );
    }
    return 0;
}

TEST_GROUP( make_meshes, free_meshes )
