// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/cloth.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "cloth_fixture.h"
#include "determinism_fixture.h"

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
    wisp_solve_order solve_order;
    bool blown, damped, far; // far: tethers and coarse sheets
    int iterations;
} golden_case;

static const golden_case cases[] = {
    { "hanging", WISP_CLOTH_BENDING_LINKS, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_COLOUR, false, false, false, 1 },
    { "hanging-pbd-iterated", WISP_CLOTH_BENDING_LINKS, WISP_SOLVER_PBD, WISP_SOLVE_ORDER_COLOUR, false, false, false,
      3 },
    { "flag", WISP_CLOTH_BENDING_LINKS, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_COLOUR, true, true, false, 2 },
    { "dihedral", WISP_CLOTH_BENDING_DIHEDRAL, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_COLOUR, false, true, false, 2 },
    { "isometric", WISP_CLOTH_BENDING_ISOMETRIC, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_COLOUR, false, false, false, 2 },
    { "tethers-coarse-sheets", WISP_CLOTH_BENDING_LINKS, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_COLOUR, false, false,
      true, 1 },
    { "list-sweep", WISP_CLOTH_BENDING_LINKS, WISP_SOLVER_XPBD, WISP_SOLVE_ORDER_LIST, false, false, false, 1 },
};

static void open_place( hosted* h, const golden_case* c, const place_to_run* place, int* calls )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    determinism_place( &h->def, place, calls );
    h->def.substeps = 2;
    h->def.iterations = c->iterations;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static wisp_entity add_case( wisp_world* world, const golden_case* c, int n )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( n, 0.03125f );
    const int32_t pins[2] = { 0, n - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    fabric.tethers = c->far;
    fabric.coarse_sheets = c->far;
    fabric.solve_order = c->solve_order;
    fabric.attachments = pins;
    fabric.attachment_count = 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = 2;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = c->bending;
    cloth.solver = c->solver;
    cloth.warp_compliance = 1e-4f;
    cloth.internal_damping = c->damped ? 0.5f : 0.0f;
    cloth.drag_coefficient = c->blown ? 1.0f : 0.0f;
    cloth.lift_coefficient = c->blown ? 0.5f : 0.0f;
    cloth.wind = ( wisp_vec3 ){ 3.0f, 1.0f, 2.0f };
    cloth.tethers = c->far;
    cloth.coarse_substeps = c->far ? 2 : 0;
    wisp_entity e = add_cloth( world, &fabric, surface, &cloth, EARTH );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_NORMALS ), WISP_OK );
    return e;
}

typedef struct running
{
    determinism_run base;
    hosted h;
    wisp_entity cloth;
} running;

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    running* r = checked_calloc( 1, sizeof( *r ) );
    open_place( &r->h, cases + number, place, calls );
    r->cloth = add_case( r->h.world, cases + number, SIDE );
    r->base = ( determinism_run ){ number, 0, r->h.world, &r->h.host };
    return &r->base;
}

static void close_case( determinism_run* base )
{
    close_world( &( (running*)base )->h );
    free( base );
}

static void run_case_steps( determinism_run* base, int steps )
{
    base->steps += steps;
    run_steps( base->world, steps, 1.0f / 64.0f );
}

// Points and normals.
static traces traces_of( determinism_run* base )
{
    const wisp_entity e = ( (running*)base )->cloth;
    const uint64_t points = hash_of( base->world, e, WISP_SURFACE_POINTS );
    const uint64_t normals = hash_of( base->world, e, WISP_SURFACE_NORMALS );
    return ( traces ){ points ^ ( normals << 1 | normals >> 63 ), wisp_world_hash( base->world ) };
}

static void check_case( determinism_run* base )
{
    assert_false( wisp_is_halted( base->world, ( (running*)base )->cloth ) );
}

static void nudge( determinism_run* base )
{
    velocity_of( base->world, ( (running*)base )->cloth, SIDE * SIDE - 1 )[2] = 1e-3f;
}

static determinism_case describe( int number )
{
    return ( determinism_case ){ cases[number].name, STEPS, .warm_workers = 2 };
}

// Twenty small cloths of all kinds share waves; each has the same bits as in a world of its own.
TEST( many_small_cloths_are_what_each_is_alone )
{
    enum
    {
        CLOTHS = 20,
    };
    const golden_case one_iteration = { .iterations = 2 };
    for ( int workers = 1; workers <= 3; workers += 2 )
    {
        const place_to_run place = { workers, NULL, NULL };
        SCOPED( close_world ) hosted together;
        open_place( &together, &one_iteration, &place, NULL );
        wisp_entity all[CLOTHS];
        for ( int i = 0; i < CLOTHS; ++i )
        {
            all[i] = add_case( together.world, cases + i % WISP_COUNT( cases ), 5 + i % 7 );
        }
        run_steps( together.world, STEPS, 1.0f / 64.0f );
        for ( int i = 0; i < CLOTHS; ++i )
        {
            SCOPED( close_world ) hosted alone;
            open_place( &alone, &one_iteration, &PLAIN, NULL );
            wisp_entity e = add_case( alone.world, cases + i % WISP_COUNT( cases ), 5 + i % 7 );
            run_steps( alone.world, STEPS, 1.0f / 64.0f );
            assert_int_equal( hash_of( together.world, all[i], WISP_SURFACE_POINTS ),
                              hash_of( alone.world, e, WISP_SURFACE_POINTS ) );
            assert_int_equal( hash_of( together.world, all[i], WISP_SURFACE_NORMALS ),
                              hash_of( alone.world, e, WISP_SURFACE_NORMALS ) );
        }
    }
}

DETERMINISM( cloth, true );
