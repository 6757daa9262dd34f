// The same bits for any number of workers, any instruction set and any loop of the host, and the same as in
// data/golden/strands.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "strands_fixture.h"
#include "determinism_fixture.h"

#include "guide_hair.h"

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
    bool ball;                  // a sphere in their path
    bool rooted;                // in one of two small surfaces that fall
    bool bdf2;
    bool ghosts; // with ghosts, and curves through those
    bool flat;   // the flattest section that there can be
    bool closed, free;
    strand_curve* curve;
} golden_case;

// A helix that grows down. It turns by the angle whose cosine is 0.8: sums and products have the same bits
// everywhere, which the sine of a library may not.
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

// Strands side by side over the bodies at the origin: some stick out, some are curled.
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

// An octagon over the bodies at the origin, not quite regular and with four vertices on its sides. The last vertex is the first.
static wisp_vec3 polygon( int strand, int i, int count, float length )
{
    static const float X[] = { 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 6.0f, 5.0f, 4.0f, 2.0f, 1.0f, 1.0f };
    static const float Y[] = { 1.0f, 1.0f, 1.0f, 1.0f, 2.0f, 3.0f, 4.0f, 4.0f, 4.0f, 3.0f, 2.0f };
    const int at = i % ( count - 1 );
    return ( wisp_vec3 ){ 0.15f * length * ( X[at] - 3.5f ), 0.06f + 0.05f * length * ( at % 3 == 0 ? 0.2f : 0.0f ),
                          0.15f * length * ( Y[at] - 2.5f ) + 0.0005f * (float)( strand - STRANDS / 2 ) };
}

#define DIRECT .stretch = WISP_STRAND_STRETCH_DIRECT
#define ROD DIRECT, .bend = WISP_STRAND_BEND_ROD
#define BEND_LINKS .bend = WISP_STRAND_BEND_LINKS

static const golden_case cases[] = {
    { "direct-bend-links", DIRECT, BEND_LINKS, .iterations = 1, .curve = fringe },
    { "straight-rod", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .curve = straight_out },
    { "balanced-curls", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true,
      .curve = helix_down },
    { "shape-curls", ROD, .rest = WISP_STRAND_REST_SHAPE, .iterations = 1, .curve = helix_down },
    { "links-xpbd-iterated", .stretch = WISP_STRAND_STRETCH_LINKS, BEND_LINKS, .solver = WISP_SOLVER_XPBD,
      .iterations = 2, .curve = fringe },
    { "grid-air-damping", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .blown = true, .mixed = true,
      .curve = fringe },
    { "carried-over-a-ball", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true, .ball = true,
      .curve = fringe },
    { "ghosts-curves", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true, .ghosts = true,
      .curve = fringe },
    { "rooted-in-a-surface", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .rooted = true,
      .curve = fringe },
    { "bdf2-bend-links-grid-air", DIRECT, BEND_LINKS, .solver = WISP_SOLVER_XPBD, .iterations = 2, .blown = true,
      .mixed = true, .bdf2 = true, .curve = fringe },
    { "bdf2-carried-curls", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true, .bdf2 = true,
      .curve = helix_down },
    { "bdf2-carried-over-a-ball", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true,
      .ball = true, .bdf2 = true, .curve = fringe },
    { "flattest-carried-curls", ROD, .rest = WISP_STRAND_REST_SAG_FREE, .iterations = 1, .carried = true,
      .flat = true, .curve = helix_down },
    { "closed-straight-twisted", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .blown = true,
      .closed = true, .curve = polygon },
    { "closed-shape-over-a-ball", ROD, .rest = WISP_STRAND_REST_SHAPE, .iterations = 1, .closed = true, .ball = true,
      .curve = polygon },
    { "free-straight", ROD, .rest = WISP_STRAND_REST_STRAIGHT, .iterations = 1, .free = true, .ball = true,
      .curve = fringe },
};

// Without ghosts, ghosts and curves are the strands themselves.
typedef struct running
{
    determinism_run base;
    const golden_case* c;
    hosted s;
    wisp_entity strands, ghosts, curves;
} running;

static wisp_strand_dynamics_def def_of( const golden_case* c )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.stretch = c->stretch;
    def.bending = c->bend;
    def.integrator = c->bdf2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    def.rest = c->rest;
    def.edgewise_rigidity = c->flat ? 1e5f * def.bend_rigidity : 0.0f;
    def.solver = c->solver;
    def.closed = c->closed;
    def.closing_twist = c->closed ? 4.0f : 0.0f;
    def.free_roots = c->free;
    def.stretch_compliance = 1.0f;
    def.bend_compliance = 100.0f;
    def.bend_damping = c->rest == WISP_STRAND_REST_SHAPE ? 1e-3f : 0.0f;
    def.damping = c->blown ? 2.0f : 0.0f;
    def.drag_coefficient = c->blown ? 1.0f : 0.0f;
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
    assert_status( r->s.world, wisp_add_collider( r->s.world, &ball, &e ), WISP_OK );
    assert_status( r->s.world, wisp_set_collision( r->s.world, r->strands, &collision ), WISP_OK );
    assert_status( r->s.world, wisp_request_collision_stats( r->s.world, r->strands, true ), WISP_OK );
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
    assert_status( r->s.world, wisp_set_ghosts( r->s.world, r->ghosts, &def ), WISP_OK );
    wisp_curves_def curves = wisp_default_curves_def();
    curves.source = r->ghosts;
    curves.samples = 3;
    assert_status( r->s.world, wisp_add_curves( r->s.world, &curves, &r->curves ), WISP_OK );
    assert_status( r->s.world, wisp_request( r->s.world, r->ghosts, WISP_STRAND_POINTS ), WISP_OK );
    assert_status( r->s.world, wisp_request( r->s.world, r->curves, WISP_STRAND_POINTS ), WISP_OK );
}

// Each makes all its substeps before the other one where a worker has no better use for itself.
static void add_surfaces( running* r )
{
    test_mesh mesh = test_plane( 8, 0.02f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_entity e = test_surface_of( r->s.world, &fabric, support_weightless_surface_def() );
        const wisp_vec3 gravity = { 0.5f, -1.0f - (float)i, 0.0f };
        assert_status( r->s.world, wisp_set_gravity( r->s.world, e, gravity ), WISP_OK );
        assert_status( r->s.world, wisp_request( r->s.world, e, WISP_SURFACE_POINTS ), WISP_OK );
        if ( i == 0 )
        {
            assert_status( r->s.world, wisp_root_strands( r->s.world, r->strands, e ), WISP_OK );
        }
    }
    test_mesh_free( &mesh );
}

static void add_case( running* r )
{
    const wisp_strand_dynamics_def def = def_of( r->c );
    r->strands = r->ghosts = r->curves = add_moving( r->s.world, STRANDS, VERTICES, r->c->curve, 0.1f, &def );
    if ( r->c->mixed )
    {
        wisp_strand_grid_def grid = wisp_default_strand_grid_def();
        grid.repulsion = 1.0f;
        assert_status( r->s.world, wisp_set_strand_grid( r->s.world, r->strands, &grid ), WISP_OK );
    }
    if ( r->c->ball )
    {
        add_ball( r );
    }
    if ( r->c->rooted )
    {
        add_surfaces( r );
    }
    if ( r->c->ghosts )
    {
        add_ghosts( r );
    }
}

static void run_case_steps( determinism_run* base, int steps )
{
    running* r = (running*)base;
    for ( int i = 0; i < steps; ++i )
    {
        r->base.steps += 1;
        const float t = r->c->carried ? SECONDS * (float)r->base.steps : 0.0f;
        const wisp_transform pose =
            wisp_transform_make( ( wisp_quat ){ 0.0f, t, 0.0f, 1.0f }, ( wisp_vec3 ){ 0.1f * t, -0.3f * t, 0.0f } );
        if ( r->c->rooted == false )
        {
            assert_status( r->s.world, wisp_move_strand_head( r->s.world, r->strands, pose ), WISP_OK );
        }
        strand_steps( r->s.world, 1, SECONDS );
    }
}

static uint64_t turned( uint64_t hash, int bits )
{
    return hash << bits | hash >> ( 64 - bits );
}

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module,
                                                  &wisp_guide_hair_module };
    running* r = checked_calloc( 1, sizeof( *r ) );
    r->c = cases + number;
    prepare_strands( &r->s, MODULES, WISP_COUNT( MODULES ) );
    determinism_place( &r->s.def, place, calls );
    r->s.def.substeps = 4;
    r->s.def.iterations = r->c->iterations;
    open_prepared( &r->s );
    r->base = ( determinism_run ){ number, 0, r->s.world, &r->s.host };
    add_case( r );
    return &r->base;
}

static void close_case( determinism_run* base )
{
    close_world( &( (running*)base )->s );
    free( base );
}

static traces traces_of( determinism_run* base )
{
    running* r = (running*)base;
    const uint64_t points = hash_of( r->s.world, r->strands, WISP_STRAND_POINTS );
    const uint64_t ghosts = hash_of( r->s.world, r->ghosts, WISP_STRAND_POINTS );
    const uint64_t curves = hash_of( r->s.world, r->curves, WISP_STRAND_POINTS );
    return ( traces ){ points ^ turned( ghosts, 1 ) ^ turned( curves, 2 ), wisp_world_hash( r->s.world ) };
}

static void check_case( determinism_run* base )
{
    running* r = (running*)base;
    wisp_collision_stats touch = { .contacts = 1 };
    assert_true( r->c->ball == false || wisp_read_collision_stats( r->s.world, r->strands, &touch ) == WISP_OK );
    assert_true( touch.contacts > 0 );
}

static void nudge( determinism_run* base )
{
    float* velocity = wisp_world_column( base->world, ( (running*)base )->strands, WISP_STRAND_VELOCITY, 0 );
    velocity[( VERTICES - 1 ) * 3 * WISP_LANES] = 1e-3f; // the tip of the first strand, along x
}

// Each worker has a grid of its own, and the assignment of workers to passes is not determined. A grid covers the
// reach of all strands, and is warm where they have been before. Strands over a ball take turns with their lengths where they touch it.
static determinism_case describe( int number )
{
    const bool mixed = cases[number].mixed, turns = mixed || cases[number].ball;
    return ( determinism_case ){ cases[number].name, STEPS, .warm_workers = mixed ? 1 : 2,
                                 .rehearsal = turns ? STEPS : 0 };
}

DETERMINISM( strands, true );
