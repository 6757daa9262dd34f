// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/implicit_cloth.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "implicit_cloth_fixture.h"
#include "determinism_fixture.h"

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
    wisp_integrator integrator;
    int repeats;
    bool crumpled, carried, dropped, pushed; // carried by its pins, on a ball and a plane, by a ball that moves
} golden_case;

static const golden_case cases[] = {
    { "hanging", SIDE, .repeats = 1 },
    { "sheet", SIDE, .weights = WISP_IMPLICIT_WEIGHTS_NONE, .stiffness = WISP_IMPLICIT_STIFFNESS_MATERIAL,
      .repeats = 1 },
    { "bdf2", SIDE, .integrator = WISP_INTEGRATOR_BDF2, .repeats = 1, .carried = true },
    { "newton-repeats", SIDE, .repeats = 3, .crumpled = true },
    { "blocks", LARGE, .repeats = 1, .carried = true },
    { "dropped-on-a-ball", SIDE, .repeats = 1, .dropped = true },
    { "blocks-pushed", LARGE, .integrator = WISP_INTEGRATOR_BDF2, .repeats = 2, .dropped = true, .pushed = true },
};

typedef struct running
{
    determinism_run base;
    const golden_case* c;
    hosted h;
    wisp_entity cloth, ball;
} running;

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
    wisp_implicit_cloth_def def = linked_def();
    def.weights = c->weights;
    def.stiffness_model = c->stiffness;
    def.integrator = c->integrator;
    def.newton_iterations = c->repeats;
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

static void run_case_steps( determinism_run* base, int steps )
{
    running* r = (running*)base;
    for ( int i = 0; i < steps; ++i )
    {
        r->base.steps += 1;
        const float t = DT * (float)r->base.steps;
        const int32_t pin = 0;
        const wisp_vec3 target = { -0.25f * t, 0.5f * t, 0.0f };
        const float half = 0.5f * 0.03125f * (float)( r->c->side - 1 );
        wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { half + 0.5f * t, -0.15f + 0.5f * t, half } };
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

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    running* r = checked_calloc( 1, sizeof( *r ) );
    r->c = cases + number;
    r->h.def = implicit_def( &r->h );
    determinism_place( &r->h.def, place, calls );
    r->h.def.substeps = 2;
    assert_int_equal( wisp_world_create( &r->h.def, &r->h.world, NULL ), WISP_OK );
    r->base = ( determinism_run ){ number, 0, r->h.world, &r->h.host };
    add_case( r );
    return &r->base;
}

static void close_case( determinism_run* base )
{
    close_world( &( (running*)base )->h );
    free( base );
}

static traces traces_of( determinism_run* base )
{
    running* r = (running*)base;
    return ( traces ){ hash_of( r->h.world, r->cloth, WISP_SURFACE_POINTS ), wisp_world_hash( r->h.world ) };
}

static void check_case( determinism_run* base )
{
    running* r = (running*)base;
    const wisp_implicit_cloth_stats f = stats_of( r->h.world, r->cloth );
    assert_true( f.iterations > 0 );
    assert_int_equal( f.sticking + f.sliding + f.landing > 0, r->c->dropped );
}

static void nudge( determinism_run* base )
{
    running* r = (running*)base;
    velocity_of( r->h.world, r->cloth, r->c->side + 1 )[2] += 1e-3f;
}

static determinism_case describe( int number )
{
    const golden_case* c = cases + number;
    return ( determinism_case ){ c->name, STEPS, .warm_workers = 2, .is_one_block = c->side < LARGE };
}

DETERMINISM( implicit_cloth, true );
