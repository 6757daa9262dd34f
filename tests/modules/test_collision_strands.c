// Strands and bodies: rest, friction, moving heads, starts inside a body, and the same bits for every number of
// workers.
#include "collision_fixture.h"

#include "strands.h"

static const float DT = 1.0f / 60.0f;
static const float SEGMENT = 0.01f;
static const double DEGREE = 3.14159265358979323846 / 180.0;

typedef struct hair_world
{
    int substeps, iterations, workers;
    const char* isa;
} hair_world;

static hosted* new_hair_world( hair_world w )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module };
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    h->def = hosted_def( h );
    h->def.modules = MODULES;
    h->def.module_count = WISP_COUNT( MODULES );
    h->def.substeps = w.substeps;
    h->def.iterations = w.iterations;
    h->def.workers = w.workers;
    h->def.isa = w.isa;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
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
    wisp_strands_def def = test_strands_def( &s );
    wisp_entity e;
    assert_int_equal( wisp_add_strands( world, &def, &e ), WISP_OK );
    test_strands_free( &s );
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

// Hair all over the upper half of a head of 0.1 m.
static wisp_entity add_head_of_hair( wisp_world* world, int count )
{
    wisp_vec3* roots = calloc( (size_t)count, sizeof( wisp_vec3 ) );
    wisp_vec3* directions = calloc( (size_t)count, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < count; ++i )
    {
        const double y = 0.1 + 0.85 * ( i + 0.5 ) / count, turn = 2.399963 * i, r = sqrt( 1.0 - y * y );
        directions[i] = ( wisp_vec3 ){ (float)( r * cos( turn ) ), (float)y, (float)( r * sin( turn ) ) };
        roots[i] = ( wisp_vec3 ){ 0.1f * directions[i].x, 0.1f * directions[i].y, 0.1f * directions[i].z };
    }
    const wisp_strand_dynamics_def dynamics = damped_hair();
    wisp_entity e = add_hair( world, roots, directions, count, 21, &dynamics );
    free( roots );
    free( directions );
    return e;
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

static wisp_entity add_mesh_ball( wisp_world* world, float radius )
{
    test_mesh mesh = test_ball( 4 );
    move_mesh( &mesh, radius, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_MESH;
    def.points = mesh.points;
    def.triangles = mesh.triangles;
    def.point_count = mesh.vertex_count;
    def.triangle_count = mesh.triangle_count;
    const wisp_entity e = add_collider( world, &def );
    test_mesh_free( &mesh );
    return e;
}

static const wisp_vec3* points_of( wisp_world* world, wisp_entity e, int* count )
{
    const wisp_view view = view_of( world, e, WISP_STRAND_POINTS );
    *count = view.count;
    return view.data;
}

static double mean_height( wisp_world* world, wisp_entity e )
{
    int count;
    const wisp_vec3* points = points_of( world, e, &count );
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += (double)points[i].y;
    }
    return sum / count;
}

static double fastest( wisp_world* world, wisp_entity e )
{
    const wisp_strand_topology* t = wisp_world_strands( world, e );
    const float* v = wisp_world_column( world, e, WISP_STRAND_VELOCITY, 0 );
    double most = 0.0;
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        const float* x = v + i / WISP_LANES * 48 + i % WISP_LANES;
        most = fmax( most, sqrt( (double)( x[0] * x[0] + x[16] * x[16] + x[32] * x[32] ) ) );
    }
    return most;
}

// ---- rest ----

TEST( strands_that_fall_on_a_body_rest_outside )
{
    for ( int kind = 0; kind < WISP_COLLIDER_MESH; ++kind )
    {
        hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
        wisp_collider_def body = small_body( (wisp_collider_kind)kind );
        body.pose.translation.y = kind == WISP_COLLIDER_PLANE ? -0.05f : 0.0f;
        add_collider( h->world, &body );
        wisp_entity e = add_fringe( h->world );
        run_for( h->world, DT, 180 );
        const wisp_collision_stats f = collision_of( h->world, e );
        print_message( "kind %d: %d contacts, %.3f of a segment deep, %.2g m/s\n", kind, f.contacts,
                       (double)( f.penetration / SEGMENT ), fastest( h->world, e ) );
        assert_true( f.contacts >= 40 );
        // lengths are restored after contact; at rest that undoes next to nothing
        assert_true( f.penetration < 0.02f * SEGMENT );
        // vertices near the sharp edge of a box creep by a few hundredths of the thickness per substep
        assert_true( fastest( h->world, e ) < ( kind == WISP_COLLIDER_BOX ? 0.1 : 0.005 ) );
        free_colliding( h );
    }
}

TEST( strands_lie_on_a_mesh_as_on_the_closed_form )
{
    double height[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
        const wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
        if ( k == 0 )
        {
            add_collider( h->world, &ball );
        }
        else
        {
            add_mesh_ball( h->world, 0.1f );
        }
        wisp_entity e = add_fringe( h->world );
        run_for( h->world, DT, 120 );
        height[k] = mean_height( h->world, e );
        assert_true( collision_of( h->world, e ).penetration < 0.05f * SEGMENT );
        assert_true( collision_of( h->world, e ).contacts >= 40 );
        free_colliding( h );
    }
    // faces lie up to 0.1 (1 - cos( 90 / 32 degrees )), 1.2e-4 m, inside the ball, and strands roll off along their
    // edges
    assert_near( height[1], height[0], 2e-3 );
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

HAIR_TEST( layers_and_pins_are_kept )
{
    hosted* h = *state;
    wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    ball.layers = 4;
    ball.pose.translation = ( wisp_vec3 ){ -0.13f, 0.14f, 0.0f }; // over the roots
    add_collider( h->world, &ball );
    wisp_entity e = add_fringe( h->world );
    run_for( h->world, DT, 10 );
    int count;
    const wisp_vec3 root = points_of( h->world, e, &count )[0];
    assert_near( (double)root.x, -0.13, 1e-6 );
    assert_near( (double)root.y, 0.14, 1e-6 );
    assert_true( collision_of( h->world, e ).contacts > 0 );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.mask = 3;
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_OK );
    run_for( h->world, DT, 10 );
    assert_int_equal( collision_of( h->world, e ).contacts, 0 );
    assert_int_equal( collision_of( h->world, e ).vertex, -1 );
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
    uint64_t before = wisp_world_hash( h->world );
    collision.thickness = -1.0f;
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( h->world ), "thickness" ) );
    collision = wisp_default_collision_def();
    collision.max_push_out_speed = NAN;
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_BAD_INPUT );
    assert_int_equal( wisp_world_hash( h->world ), before );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_STALE_ID );
}
