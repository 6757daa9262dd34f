// Strands and bodies: the plan, and what is refused. Motion is in tests/claims/hair_on_bodies.yaml and friction.yaml.
#include "collision_fixture.h"

#include "strands.h"
#include "wisp/generate.h"

static const float SEGMENT = 0.01f;

typedef struct hair_world
{
    int substeps, iterations, workers;
    const char* isa;
} hair_world;

static hosted* new_hair_world( hair_world w )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module };
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    OPEN( h, MODULES, .substeps = w.substeps, .iterations = w.iterations, .workers = w.workers, .isa = w.isa );
    return h;
}

static int open_hair( void** state )
{
    *state = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
    return 0;
}

#define HAIR_TEST( test ) TEST_WITH( test, open_hair, close_hosted )

// Soft hair that does not keep its initial shape.
static wisp_strand_dynamics_def damped_hair( void )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = 5e-10f;
    def.damping = 5.0f;
    return def;
}

static wisp_entity add_strands_of( wisp_world* world, test_strands* s, const wisp_strand_dynamics_def* dynamics )
{
    wisp_strands_def def = test_strands_def( s );
    wisp_entity e;
    assert_int_equal( wisp_add_strands( world, &def, &e ), WISP_OK );
    test_strands_free( s );
    wisp_collision_def collision = wisp_default_collision_def();
    if ( wisp_set_strand_dynamics( world, e, dynamics ) != WISP_OK ||
         wisp_set_collision( world, e, &collision ) != WISP_OK )
    {
        fail_msg( "no hair: %s", wisp_world_message( world ) );
    }
    assert_int_equal( wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    return e;
}

// Straight strands that move and collide, from `roots` along `directions`, a centimetre per segment.
static wisp_entity add_hair( wisp_world* world, const wisp_vec3* roots, const wisp_vec3* directions, int count,
                             int vertices, const wisp_strand_dynamics_def* dynamics )
{
    test_strands s = test_strands_of( count, vertices );
    for ( int i = 0; i < count * vertices; ++i )
    {
        const wisp_vec3 r = roots[i / vertices], d = directions[i / vertices];
        const float t = SEGMENT * (float)( i % vertices );
        s.points[i] = ( wisp_vec3 ){ r.x + t * d.x, r.y + t * d.y, r.z + t * d.z };
    }
    return add_strands_of( world, &s, dynamics );
}

// Twenty strands side by side, level, that fall over a body at the origin.
static wisp_entity add_fringe( wisp_world* world )
{
    wisp_vec3 roots[20], directions[20];
    for ( int i = 0; i < 20; ++i )
    {
        roots[i] = ( wisp_vec3 ){ -0.13f, 0.14f, 0.01f * (float)( i - 10 ) + 0.003f };
        directions[i] = ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f };
    }
    const wisp_strand_dynamics_def dynamics = damped_hair();
    return add_hair( world, roots, directions, 20, 31, &dynamics );
}

static wisp_collider_def small_body( wisp_collider_kind kind )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = 0.1f;
    def.half_length = 0.1f;
    def.half_extent = ( wisp_vec3 ){ 0.08f, 0.1f, 0.2f };
    def.pose.rotation =
        kind == WISP_COLLIDER_CAPSULE ? ( wisp_quat ){ sqrtf( 0.5f ), 0.0f, 0.0f, sqrtf( 0.5f ) } : def.pose.rotation;
    return def;
}

// ---- the plan, and refusals ----

typedef struct plan_lines
{
    bool in_item_loop, before_stretch, seen_stretch;
} plan_lines;

static void read_plan_line( void* user, const char* line )
{
    plan_lines* found = user;
    char pass[64] = "";
    const char* wave = strstr( line, " wave " );
    if ( wave == NULL || sscanf( wave, " wave %*d %63s", pass ) != 1 )
    {
        return;
    }
    const bool mine = strcmp( pass, "collision.strands" ) == 0;
    found->in_item_loop = found->in_item_loop || ( mine && strstr( line, "item loop" ) != NULL );
    found->before_stretch = found->before_stretch || ( mine && found->seen_stretch == false );
    found->seen_stretch = found->seen_stretch || strcmp( pass, "strands.stretch" ) == 0;
}

HAIR_TEST( contact_comes_before_lengths_in_the_item_loop )
{
    hosted* h = *state;
    wisp_entity e = add_fringe( h->world );
    int bare = wisp_world_plan_passes( h->world );
    const wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    wisp_entity body = add_collider( h->world, &ball );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 3 );
    plan_lines found = { 0 };
    assert_int_equal( wisp_world_plan( h->world, read_plan_line, &found ), WISP_OK );
    assert_true( found.in_item_loop && found.before_stretch && found.seen_stretch );
    assert_int_equal( wisp_request_collision_stats( h->world, e, false ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 2 );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
}

HAIR_TEST( strands_that_cannot_collide_are_refused_with_a_message )
{
    hosted* h = *state;
    wisp_entity still = test_add_strands( h->world, 3, 5 );
    assert_int_equal( wisp_world_attach( h->world, still, WISP_STRAND_VELOCITY ),
                      WISP_OK ); // it moves, but has no weights
    wisp_collision_def collision = wisp_default_collision_def();
    expect_refusal( h->world, wisp_set_collision( h->world, still, &collision ), WISP_CONFLICT, "dynamics" );
    wisp_collision_stats stats;
    assert_int_equal( wisp_read_collision_stats( h->world, still, &stats ), WISP_CONFLICT );
    wisp_entity e = add_fringe( h->world );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_STALE_ID );
}
