// Surfaces of the world as bodies, held to motions that no rigid body makes. Rigid ones, and those of cloth, are in
// tests/claims/skins.yaml.
#include "collision_fixture.h"

#include "strands.h"

static const float DT = 1.0f / 60.0f;

// ---- a surface whose vertices are all pinned ----

typedef struct skin
{
    wisp_entity surface, collider;
    test_mesh mesh; // at rest
    int32_t* all;   // every vertex
    wisp_vec3* targets;
} skin;

static skin add_skin_that( wisp_world* world, test_mesh mesh, bool double_sided, bool tracks )
{
    skin s = { .mesh = mesh };
    s.all = checked_calloc( (size_t)mesh.vertex_count, sizeof( int32_t ) );
    s.targets = checked_calloc( (size_t)mesh.vertex_count, sizeof( wisp_vec3 ) );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        s.all[v] = v;
    }
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = s.all;
    surface.pin_count = mesh.vertex_count;
    s.surface = test_surface_of( world, &fabric, surface );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SURFACE;
    def.surface = s.surface;
    def.double_sided = double_sided;
    def.tracks = tracks;
    s.collider = add_collider( world, &def );
    return s;
}

static skin add_skin( wisp_world* world, test_mesh mesh, bool double_sided )
{
    return add_skin_that( world, mesh, double_sided, true );
}

static void free_skin( skin* s )
{
    test_mesh_free( &s->mesh );
    free( s->all );
    free( s->targets );
}

typedef wisp_vec3 place_fn( wisp_vec3 rest, float time );

static void move_skin( wisp_world* world, skin* s, place_fn* place, float time )
{
    for ( int v = 0; v < s->mesh.vertex_count; ++v )
    {
        s->targets[v] = place( s->mesh.points[v], time );
    }
    assert_int_equal( wisp_move_pins( world, s->surface, s->all, s->targets, s->mesh.vertex_count ), WISP_OK );
}

static test_mesh ball_mesh( int level )
{
    test_mesh mesh = test_ball( level );
    move_mesh( &mesh, 0.3f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    return mesh;
}

// ---- motions that no rigid body makes ----

static wisp_vec3 breathing( wisp_vec3 p, float time )
{
    const float size = 1.0f + 0.4f * time;
    return ( wisp_vec3 ){ size * p.x, size * p.y, size * p.z };
}

// A ball that grows from 0.3 to 0.42 m lifts the cloth on its top by 0.12 m.
TEST( a_ball_that_grows_lifts_cloth )
{
    SCOPED( close_local ) hosted* h = new_colliding( 8, 2, 1 );
    SCOPED( free_skin ) skin s = add_skin( h->world, ball_mesh( 3 ), false );
    wisp_entity e = add_cloth( h->world, 9, 0.2f, ( wisp_vec3 ){ 0.0f, 0.31f, 0.0f }, 9.8f );
    run_for( h->world, DT, 20 );
    const double before = motion_stats_of( h->world, e ).centre[1];
    for ( int n = 1; n <= 60; ++n )
    {
        move_skin( h->world, &s, breathing, (float)n * DT );
        run_for( h->world, DT, 1 );
        assert_true( collision_of( h->world, e ).penetration <= 0.1f * 0.00625f );
    }
    // a cap of a larger ball is flatter, so its middle rises by a little more than the top
    assert_near( motion_stats_of( h->world, e ).centre[1] - before, 0.12, 0.01 );
}

// A belt: the upper side runs along x, and takes what lies on it along by friction.
static wisp_vec3 sheared( wisp_vec3 p, float time )
{
    return ( wisp_vec3 ){ p.x + ( p.y > 0.0f ? 0.5f * time : 0.0f ), p.y, p.z };
}

TEST( the_velocity_of_the_surface_drags_by_friction )
{
    SCOPED( close_local ) hosted* h = new_colliding( 8, 2, 1 );
    SCOPED( free_skin ) skin s = add_skin( h->world, ball_mesh( 3 ), false );
    wisp_entity e = add_cloth( h->world, 5, 0.06f, ( wisp_vec3 ){ 0.0f, 0.302f, 0.0f }, 9.8f );
    for ( int n = 1; n <= 30; ++n )
    {
        move_skin( h->world, &s, sheared, (float)n * DT );
        run_for( h->world, DT, 1 );
    }
    const wisp_motion_stats stats = motion_stats_of( h->world, e );
    assert_near( stats.momentum[0] / stats.mass, 0.5, 0.05 );
    // sliding for the first 0.5 m/s / (0.5 * 9.8 m/s^2)
    assert_near( stats.centre[0], 0.25 - 0.5 * 0.5 * 0.102, 0.01 );
}

// ---- what is kept within a step ----

enum
{
    STRANDS = 60,
    VERTICES = 21,
};

// Soft hair of 0.3 m all over the upper half of the ball. Every fourth strand starts inside.
static wisp_entity add_hair( wisp_world* world )
{
    test_strands s = test_strands_of( STRANDS, VERTICES );
    for ( int i = 0; i < STRANDS * VERTICES; ++i )
    {
        const double up = 0.1 + 0.85 * ( i / VERTICES + 0.5 ) / STRANDS, turn = 2.399963 * ( i / VERTICES );
        const double radius = 0.3 + ( i / VERTICES % 4 == 1 ? -0.006 : 0.015 ) * ( i % VERTICES ),
                     flat = radius * sqrt( 1.0 - up * up );
        s.points[i] =
            ( wisp_vec3 ){ (float)( flat * cos( turn ) ), (float)( radius * up ), (float)( flat * sin( turn ) ) };
    }
    const wisp_strands_def def = test_strands_def( &s );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    dynamics.bend_rigidity = 5e-10f;
    dynamics.damping = 5.0f;
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity e;
    assert_int_equal( wisp_add_strands( world, &def, &e ), WISP_OK );
    test_strands_free( &s );
    assert_int_equal( wisp_set_strand_dynamics( world, e, &dynamics ), WISP_OK );
    assert_int_equal( wisp_set_collision( world, e, &collision ), WISP_OK );
    assert_int_equal( wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    return e;
}

// The roots rest. The ball shrinks on one side and comes back, and swings a little.
static wisp_vec3 sighing( wisp_vec3 p, float time )
{
    const double x = (double)p.x, sigh = sin( 9.0 * (double)time ), swing = 0.01 * sin( 5.0 * (double)time );
    return ( wisp_vec3 ){ (float)( x > 0.0 ? x * ( 1.0 - x * sigh * sigh ) : x ), p.y,
                          (float)( (double)p.z - swing * swing ) };
}

// What is left out because it is far could not have touched. From inside there are several closest points, so that
// strands which start there leave a little elsewhere.
TEST( hair_that_is_tracked_lies_where_hair_that_is_searched_in_each_substep_does )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module };
    wisp_vec3 points[2][STRANDS * VERTICES];
    wisp_collision_stats stats[2];
    for ( int tracks = 0; tracks < 2; ++tracks )
    {
        SCOPED( close_local ) hosted* h = checked_calloc( 1, sizeof( hosted ) );
        OPEN( h, MODULES, .substeps = 6 );
        SCOPED( free_skin ) skin s = add_skin_that( h->world, ball_mesh( 4 ), false, tracks == 1 );
        const wisp_entity e = add_hair( h->world );
        float deepest = 0.0f;
        for ( int n = 1; n <= 60; ++n )
        {
            move_skin( h->world, &s, sighing, (float)n * DT );
            run_for( h->world, DT, 1 );
            deepest = fmaxf( deepest, collision_of( h->world, e ).penetration );
        }
        stats[tracks] = collision_of( h->world, e );
        stats[tracks].penetration = deepest;
        const wisp_view view = view_of( h->world, e, WISP_STRAND_POINTS );
        memcpy( points[tracks], view.data, sizeof( points[tracks] ) );
    }
    double most = 0.0;
    int apart = 0;
    for ( int i = 0; i < STRANDS * VERTICES; ++i )
    {
        const wisp_vec3 a = points[0][i], b = points[1][i];
        const double way = fmax( fabs( (double)a.x - (double)b.x ), fabs( (double)a.y - (double)b.y ) );
        apart += way > 0.001 ? 1 : 0;
        most = fmax( most, way );
    }
    print_message( "%d and %d contacts, %g and %g m deep, at most %g m apart\n", stats[0].contacts, stats[1].contacts,
                   (double)stats[0].penetration, (double)stats[1].penetration, most );
    assert_true( stats[1].contacts > 100 && most < 0.01 && apart < STRANDS * VERTICES / 20 );
    assert_near( stats[0].penetration, stats[1].penetration, 1e-4 );
}

// ---- work ----

static void count_eight( void* user, int block_count, wisp_block_fn* run, void* context )
{
    int* loops = user;
    *loops += block_count == 8 ? 1 : 0;
    for ( int block = 0; block < block_count; ++block )
    {
        run( context, block, block % 2 );
    }
}

// Loops of eight blocks in a step with a ball of 8192 triangles, whose cells are cooked 1024 triangles a block where
// half as many vertices are there to use them.
static int loops_beside( int side )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module };
    int loops = 0;
    SCOPED( close_local ) hosted* h = checked_calloc( 1, sizeof( hosted ) );
    OPEN( h, MODULES, .substeps = 3, .workers = 2, .parallel_for = count_eight, .parallel_for_user = &loops );
    SCOPED( free_skin ) skin s = add_skin( h->world, ball_mesh( 5 ), false );
    add_cloth( h->world, side, 0.6f, ( wisp_vec3 ){ 0.0f, 0.301f, 0.0f }, 9.8f );
    move_skin( h->world, &s, breathing, DT );
    run_for( h->world, DT, 1 );
    loops = 0;
    move_skin( h->world, &s, breathing, 2.0f * DT );
    run_for( h->world, DT, 1 );
    return loops;
}

TEST( cells_of_a_body_are_filled_by_all_workers )
{
    assert_int_equal( loops_beside( 65 ) - loops_beside( 63 ), 1 );
}

// ---- life ----

TEST( nothing_collides_with_a_surface_that_was_removed )
{
    SCOPED( close_local ) hosted* h = new_colliding( 4, 1, 1 );
    SCOPED( free_skin ) skin s = add_skin( h->world, ball_mesh( 2 ), false );
    wisp_entity e = add_cloth( h->world, 5, 0.2f, ( wisp_vec3 ){ 0.0f, 0.35f, 0.0f }, 9.8f );
    run_for( h->world, DT, 30 );
    assert_true( motion_stats_of( h->world, e ).centre[1] > 0.25 );
    assert_int_equal( wisp_remove( h->world, s.surface ), WISP_OK );
    run_for( h->world, DT, 30 );
    assert_true( motion_stats_of( h->world, e ).centre[1] < -0.5 );
    assert_int_equal( wisp_remove( h->world, s.collider ), WISP_OK );
    run_for( h->world, DT, 1 );
}

COLLISION_TEST( wrong_surfaces_are_refused )
{
    SCOPED( free_skin ) skin s = add_skin( h->world, test_plane( 3, 0.5f ), true );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SURFACE;
    wisp_entity e;
    assert_int_equal( wisp_add_collider( h->world, &def, &e ), WISP_STALE_ID );
    def.surface = s.surface;
    assert_int_equal( wisp_add_collider( h->world, &def, &e ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( h->world ), "open edges" ) );
    def.surface = s.collider;
    assert_int_equal( wisp_add_collider( h->world, &def, &e ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( h->world ), "is not a surface" ) );
    const wisp_transform pose = { { 0, 0, 0, 1 }, { 0, 1, 0 } };
    assert_int_equal( wisp_move_collider( h->world, s.collider, pose ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( h->world ), "moves with its surface" ) );
    assert_int_equal( wisp_teleport( h->world, s.collider, pose, false ), WISP_CONFLICT );
    run_for( h->world, DT, 1 );
}
