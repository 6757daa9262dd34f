// Contact input of each particle of a surface with an external solver, from the bodies around it; statistics, plans, memory,
// and the same bits for every way to run them.
#include "collision_fixture.h"
#include "plan_says.h"
#include "collision_state.h"

#include "collision_vectors.h"

static const float DT = 1.0f / 60.0f;
static const float MARGIN = 0.02f;

// ---- a solver without forces ----

static void follow( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    const float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        for ( int k = 0; k < 3 && position[4 * slot + 3] > 0.0f; ++k )
        {
            position[4 * slot + k] += wisp_frame_dt( frame, span->entity ) * velocity[4 * slot + k];
        }
    }
}

static wisp_status declare_follower( wisp_registry* r )
{
    const wisp_pass pass = {
        WISP_PASS( "follower.follow", PROJECT, PARTICLE_BLOCK, follow ),
        .required = { WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
        .reads = { WISP_PARTICLE_CONTACTS, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        .writes = { WISP_PARTICLE_POSITION },
    };
    return wisp_declare_pass( r, &pass );
}

static const wisp_module FOLLOWER = { .name = "follower", .declare = declare_follower };

// ---- worlds ----

static hosted* new_world( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_collision_module, &FOLLOWER };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, wisp_default_world_def().iterations, workers );
}

static int open_sense( void** state )
{
    *state = new_world( 1, 1 );
    return 0;
}

#define SENSE_TEST( test ) HOSTED_TEST( test, open_sense )

static wisp_entity add_surface( wisp_world* world, const test_mesh* mesh )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static void give_solver( wisp_world* world, wisp_entity e )
{
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_CONTACTS ), WISP_OK );
}

static wisp_collision_def thin( void )
{
    wisp_collision_def def = wisp_default_collision_def();
    def.thickness = MARGIN;
    def.max_push_out_speed = 1.0f;
    return def;
}

// A small triangle with vertex 0 at a given position.
static wisp_entity add_probe( wisp_world* world, wisp_vec3 at )
{
    test_mesh mesh = test_triangle( at, 1e-3f );
    wisp_entity e = add_surface( world, &mesh );
    test_mesh_free( &mesh );
    give_solver( world, e );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( world, e, &def ), WISP_OK );
    return e;
}

static void give_velocity( wisp_world* world, wisp_entity e, float x, float y, float z )
{
    assert_int_equal( wisp_set_velocity( world, e, ( wisp_vec3 ){ x, y, z }, ( wisp_vec3 ){ 0 } ), WISP_OK );
}

// ---- contacts found ----

typedef struct sensed
{
    int32_t body;
    wisp_vec3 normal, motion;
    float gap, margin, static_friction, kinetic_friction, recovery;
} sensed;

static sensed touch_of( wisp_world* world, wisp_entity e, int vertex, int k )
{
    const size_t slot = (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex],
                 row = slot * WISP_MAX_PARTICLE_CONTACTS;
    const int32_t* body = wisp_world_column( world, e, WISP_PARTICLE_CONTACTS, 0 );
    const float* plane = wisp_world_column( world, e, WISP_PARTICLE_CONTACTS, 1 );
    const float* motion = wisp_world_column( world, e, WISP_PARTICLE_CONTACTS, 2 );
    const float* friction = wisp_world_column( world, e, WISP_PARTICLE_CONTACTS, 3 );
    assert_non_null( body );
    plane += 4 * ( row + (size_t)k );
    motion += 4 * ( row + (size_t)k );
    friction += 3 * ( row + (size_t)k );
    return ( sensed ){ body[row + (size_t)k],
                       wisp_v3_load( plane ),
                       wisp_v3_load( motion ),
                       plane[3],
                       motion[3],
                       friction[0],
                       friction[1],
                       friction[2] };
}

// Only vertex 0 is checked, and only its nearest body.
static sensed sense( wisp_world* world, wisp_entity e )
{
    run_for( world, DT, 1 );
    return touch_of( world, e, 0, 0 );
}

static void assert_vector( wisp_vec3 v, double x, double y, double z, double tolerance )
{
    assert_near( v.x, x, tolerance );
    assert_near( v.y, y, tolerance );
    assert_near( v.z, z, tolerance );
}

// ---- meshes ----

// A ball of radius 0.3, or a square of side 2 in the plane y = 0.
static void add_mesh( wisp_world* world, bool double_sided, wisp_transform pose )
{
    SCOPED( test_mesh_free ) test_mesh mesh = double_sided ? test_plane( 3, 1.0f ) : test_ball( 4 );
    move_mesh( &mesh, double_sided ? 1.0f : 0.3f,
               ( wisp_vec3 ){ double_sided ? -1.0f : 0.0f, 0.0f, double_sided ? -1.0f : 0.0f } );
    wisp_collider_def def = mesh_body( &mesh );
    def.double_sided = double_sided;
    def.pose = pose;
    add_collider( world, &def );
}

static const wisp_transform AT_ORIGIN = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };

// ---- closed forms ----

// Off the surface, and well inside, where the way out is told.
TEST( each_closed_form_is_sensed_where_it_stands )
{
    // in the body's frame; kinds in their order
    const struct
    {
        wisp_vec3 at, normal;
        double gap;
    } cases[] = {
        { { 0.2f, 0.01f, 0.1f }, { 0.0f, 1.0f, 0.0f }, 0.01 },
        { { 0.6f * 0.31f, 0.8f * 0.31f, 0.0f }, { 0.6f, 0.8f, 0.0f }, 0.01 },
        { { 0.31f, 0.1f, 0.0f }, { 1.0f, 0.0f, 0.0f }, 0.01 },
        { { 0.1f, 0.05f, -0.26f }, { 0.0f, 0.0f, -1.0f }, 0.01 },
        { { 0.2f, -5.0f, 0.1f }, { 0.0f, 1.0f, 0.0f }, -5.0 },
        { { 0.05f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, -0.25 },
        { { 0.0f, 0.1f, 0.05f }, { 0.0f, 0.0f, 1.0f }, -0.25 },
        { { 0.02f, 0.1f, 0.03f }, { 0.0f, 1.0f, 0.0f }, -0.1 },
    };
    const double c = cos( 1.2 ), s = sin( 1.2 );
    for ( int k = 0; k < WISP_COUNT( cases ); ++k )
    {
        SCOPED( close_local ) hosted* h = new_world( 1, 1 );
        wisp_collider_def body = body_of( (wisp_collider_kind)( k % WISP_COLLIDER_MESH ) );
        body.pose = ( wisp_transform ){ about_z( 1.2 ), { 0.1f, 0.5f, -0.1f } };
        add_collider( h->world, &body );
        const wisp_vec3 a = cases[k].at, n = cases[k].normal;
        const wisp_entity e =
            add_probe( h->world, ( wisp_vec3 ){ (float)( c * (double)a.x - s * (double)a.y ) + 0.1f,
                                                (float)( s * (double)a.x + c * (double)a.y ) + 0.5f, a.z - 0.1f } );
        wisp_collision_def def = thin();
        def.max_push_out_speed = 0.7f;
        assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
        const sensed t = sense( h->world, e );
        assert_true( t.body != 0 && t.recovery == 0.7f );
        // coordinates near 1 m are rounded to 6e-8 m
        assert_near( t.gap, cases[k].gap, 5e-7 * ( 1.0 + fabs( cases[k].gap ) ) );
        assert_vector( t.normal, c * (double)n.x - s * (double)n.y, s * (double)n.x + c * (double)n.y, n.z, 5e-6 );
        assert_true( t.motion.x == 0.0f && t.motion.y == 0.0f && t.motion.z == 0.0f );
        assert_int_equal( touch_of( h->world, e, 0, 1 ).body, 0 );
    }
}

SENSE_TEST( margin_and_friction_are_those_of_participant_and_body )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    plane.thickness = 0.01f;
    plane.static_friction = 0.8f;
    plane.kinetic_friction = 0.4f;
    add_collider( h->world, &plane );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.025f, 0.0f } );
    wisp_collision_def def = thin();
    def.friction_scale = 0.5f;
    def.max_push_out_speed = 3.0f;
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    const sensed t = sense( h->world, e );
    assert_true( t.margin == MARGIN + 0.01f );
    assert_true( t.static_friction == 0.4f && t.kinetic_friction == 0.2f && t.recovery == 3.0f );
    assert_true( t.gap == 0.025f );
}

SENSE_TEST( what_is_beyond_margin_and_path_is_not_sensed )
{
    wisp_collider_def ball = body_of( WISP_COLLIDER_SPHERE );
    add_collider( h->world, &ball );
    wisp_entity near = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.3f + 0.99f * MARGIN, 0.0f } );
    wisp_entity far = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.3f + 1.01f * MARGIN, 0.0f } );
    wisp_entity coming = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f } );
    wisp_entity late = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f } );
    give_velocity( h->world, coming, 0.0f, -0.081f / DT, 0.0f );
    give_velocity( h->world, late, 0.0f, -0.079f / DT, 0.0f );
    run_for( h->world, DT, 1 );
    assert_true( touch_of( h->world, near, 0, 0 ).body != 0 );
    assert_int_equal( touch_of( h->world, far, 0, 0 ).body, 0 );
    assert_near( touch_of( h->world, coming, 0, 0 ).gap, 0.1, 5e-7 );
    assert_int_equal( touch_of( h->world, late, 0, 0 ).body, 0 );
    assert_true( touch_of( h->world, late, 0, 0 ).margin == 0.0f );
}

// At a corner a box reaches as far as the ball around it, so the test of blocks is tight.
SENSE_TEST( what_parts_from_a_corner_is_sensed_as_far_as_its_path )
{
    wisp_collider_def box = body_of( WISP_COLLIDER_BOX );
    wisp_entity body = add_collider( h->world, &box );
    const wisp_vec3 half = box.half_extent;
    const float reach = wisp_v3_length( half );
    const wisp_vec3 out = { -half.x / reach, -half.y / reach, -half.z / reach }, none = { 0.0f, 0.0f, 0.0f };
    wisp_entity near = add_probe( h->world, wisp_v3_mul_add( none, reach + 0.019f, out ) );
    wisp_entity leaves = add_probe( h->world, wisp_v3_mul_add( none, reach + 0.05f, out ) );
    wisp_entity stays = add_probe( h->world, wisp_v3_mul_add( none, reach + 0.05f, out ) );
    const float speed = 0.04f / DT;
    give_velocity( h->world, leaves, speed * out.x, speed * out.y, speed * out.z );
    run_for( h->world, DT, 1 );
    // sums of coordinates are rounded to 6e-8 m
    assert_near( touch_of( h->world, near, 0, 0 ).gap, 0.019, 2e-7 );
    assert_near( touch_of( h->world, leaves, 0, 0 ).gap, 0.05, 2e-7 );
    assert_int_equal( touch_of( h->world, stays, 0, 0 ).body, 0 );
    const wisp_transform away = { box.pose.rotation, wisp_v3_mul_add( none, -0.04f, out ) };
    assert_int_equal( wisp_move_collider( h->world, body, away ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_near( touch_of( h->world, stays, 0, 0 ).gap, 0.05, 2e-7 );
}

SENSE_TEST( gravity_counts_in_the_path )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    add_collider( h->world, &plane );
    wisp_entity floats = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.03f, 0.0f } );
    wisp_entity falls = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.03f, 0.0f } );
    // h h g is 0.011 m: the margin is reached
    give_gravity( h->world, falls, 39.6f );
    run_for( h->world, DT, 1 );
    assert_int_equal( touch_of( h->world, floats, 0, 0 ).body, 0 );
    assert_true( touch_of( h->world, falls, 0, 0 ).body != 0 );
}

// ---- motion of bodies ----

TEST( the_surface_of_a_body_moves_as_a_rigid_body_does )
{
    const int substeps = 4;
    const double v[3] = { 0.3, -0.2, 0.1 }, omega = 0.6; // about z
    SCOPED( close_local ) hosted* h = new_world( substeps, 1 );
    wisp_collider_def box = body_of( WISP_COLLIDER_BOX );
    wisp_entity body = add_collider( h->world, &box );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.1f, 0.215f, 0.05f } );
    const wisp_transform pose = { about_z( omega * (double)DT ),
                                  { (float)( v[0] * (double)DT ), (float)( v[1] * (double)DT ),
                                    (float)( v[2] * (double)DT ) } };
    assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
    const sensed t = sense( h->world, e );
    // the last substep begins with the body at three quarters of its path
    const double angle = 0.75 * omega * (double)DT, time = 0.75 * (double)DT;
    const double n[2] = { -sin( angle ), cos( angle ) };
    assert_vector( t.normal, n[0], n[1], 0.0, 1e-6 );
    const double to[2] = { (double)0.1f - v[0] * time, (double)0.215f - v[1] * time };
    const double gap = to[0] * n[0] + to[1] * n[1] - 0.2;
    assert_near( t.gap, gap, 2e-7 );
    // v + omega x r of the nearest point; the chord of a substep differs from its start by omega^2 r h / 2 = 2e-4
    // m/s, and a coordinate rounded to 1.5e-8 m is 7e-6 m/s in 1/240 s
    const double r[2] = { to[0] - gap * n[0], to[1] - gap * n[1] };
    assert_vector( t.motion, v[0] - omega * r[1], v[1] + omega * r[0], v[2], 4e-4 );
    // once it has come to rest its velocity is exactly zero
    const sensed rest = sense( h->world, e );
    assert_true( rest.motion.x == 0.0f && rest.motion.y == 0.0f && rest.motion.z == 0.0f );
    assert_int_equal( rest.body, t.body );
}

SENSE_TEST( a_body_at_100_m_s_is_sensed_before_it_arrives )
{
    wisp_collider_def plate = body_of( WISP_COLLIDER_BOX );
    plate.half_extent = ( wisp_vec3 ){ 1.0f, 0.002f, 1.0f };
    plate.pose.translation.y = -1.0f;
    wisp_entity body = add_collider( h->world, &plate );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const wisp_transform pose = { plate.pose.rotation, { 0.0f, -1.0f + 100.0f * DT, 0.0f } };
    assert_int_equal( wisp_move_collider( h->world, body, pose ), WISP_OK );
    const sensed t = sense( h->world, e );
    assert_near( t.gap, 0.998, 1e-6 );
    assert_vector( t.normal, 0.0, 1.0, 0.0, 1e-6 );
    // coordinates near 1 m are rounded to 6e-8 m, which is 4e-6 m/s in a step
    assert_vector( t.motion, 0.0, 100.0, 0.0, 5e-5 );
}

// ---- motion of particles ----

SENSE_TEST( a_particle_at_100_m_s_is_told_where_its_path_enters )
{
    wisp_collider_def plate = body_of( WISP_COLLIDER_BOX );
    plate.half_extent = ( wisp_vec3 ){ 1.0f, 0.001f, 1.0f };
    add_collider( h->world, &plate );
    // from beyond the edge, so that the closest point is on the edge and not where the path enters
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 1.3f, 0.401f, 0.0f } );
    give_velocity( h->world, e, -100.0f, -60.0f, 0.0f );
    const sensed t = sense( h->world, e );
    assert_near( t.gap, 0.4, 1e-6 );
    assert_vector( t.normal, 0.0, 1.0, 0.0, 1e-6 );
}

// Half a metre to the side of a plate and five millimetres above it, on the way to its top: closer to that plane than
// the margin, and not held.
SENSE_TEST( a_flat_path_is_not_held_before_it_arrives )
{
    wisp_collider_def plate = body_of( WISP_COLLIDER_BOX );
    plate.half_extent = ( wisp_vec3 ){ 1.0f, 0.1f, 1.0f };
    add_collider( h->world, &plate );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 1.5f, 0.105f, 0.0f } );
    const wisp_vec3 way = { -0.75f, -0.006f, 0.0f };
    give_velocity( h->world, e, way.x / DT, way.y / DT, way.z / DT );
    const sensed t = sense( h->world, e );
    assert_true( t.gap == MARGIN );
    // it lands where it would have entered, after five sixths of its path, so a fifth of the margin is left behind
    // the plane
    assert_near( wisp_v3_length( t.normal ), 1.0, 1e-6 );
    assert_near( t.gap + wisp_v3_dot( t.normal, way ), -0.2 * (double)MARGIN, 1e-5 );
    // the top of the plate, tilted by the ratio of the missing margin and the path to it
    assert_near( t.normal.x, 0.015 / 0.625, 1e-3 );
}

// The solver lands particles that would pass the plane; those that pass beside it must not land.
TEST( a_path_that_passes_by_is_not_stopped )
{
    // next to a ball, past its top, and across the edge of a box
    const struct
    {
        wisp_collider_kind kind;
        wisp_vec3 from, way;
    } cases[] = {
        { WISP_COLLIDER_SPHERE, { 0.33f, 0.1f, 0.0f }, { 0.0f, -0.2f, 0.0f } },
        { WISP_COLLIDER_SPHERE, { -0.4f, 0.32f, 0.0f }, { 0.8f, 0.0f, 0.0f } },
        { WISP_COLLIDER_SPHERE, { -0.4f, 0.301f, 0.0f }, { 0.7f, 0.0f, 0.0f } },
        { WISP_COLLIDER_BOX, { 0.15f, 0.45f, 0.0f }, { 0.5f, -0.5f, 0.0f } },
        { WISP_COLLIDER_CAPSULE, { 0.33f, 0.5f, 0.0f }, { 0.0f, -1.0f, 0.0f } },
    };
    for ( int k = 0; k < WISP_COUNT( cases ); ++k )
    {
        SCOPED( close_local ) hosted* h = new_world( 1, 1 );
        wisp_collider_def body = body_of( cases[k].kind );
        add_collider( h->world, &body );
        const wisp_vec3 from = cases[k].from, way = cases[k].way;
        wisp_entity e = add_probe( h->world, from );
        give_velocity( h->world, e, way.x / DT, way.y / DT, way.z / DT );
        const sensed t = sense( h->world, e );
        assert_true( t.body != 0 );
        assert_near( wisp_v3_length( t.normal ), 1.0, 1e-6 );
        // not held, because it has not arrived; both ends of the path are in front; a path of 1 m is rounded to 6e-8
        // m
        assert_true( t.gap >= MARGIN );
        assert_true( t.gap + wisp_v3_dot( t.normal, way ) >= -1e-6f );
        // and the body is behind, except for paths that come closer than the margin, which receive the margin: the
        // plane is as far from the body's middle as the body reaches in that direction
        const float slack = t.gap > MARGIN ? 1e-6f : MARGIN;
        const wisp_vec3 n = t.normal;
        const float middle = wisp_v3_dot( n, from ) - t.gap;
        const wisp_vec3 half = body.half_extent;
        const float round =
            body.radius + ( body.kind == WISP_COLLIDER_CAPSULE ? fabsf( n.y ) * body.half_length : 0.0f );
        const float flat = fabsf( n.x ) * half.x + fabsf( n.y ) * half.y + fabsf( n.z ) * half.z;
        assert_true( middle >= ( body.kind == WISP_COLLIDER_BOX ? flat : round ) - slack );
    }
}

SENSE_TEST( pinned_particles_and_those_that_are_no_numbers_sense_nothing )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    add_collider( h->world, &plane );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    const int32_t first = 0;
    assert_int_equal( wisp_pin( h->world, e, &first, 1 ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_int_equal( touch_of( h->world, e, 0, 0 ).body, 0 );
    assert_true( touch_of( h->world, e, 1, 0 ).body != 0 );
    assert_int_equal( wisp_unpin( h->world, e, &first, 1 ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_true( touch_of( h->world, e, 0, 0 ).body != 0 );
    wisp_entity bad = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    float* velocity = wisp_world_column( h->world, bad, WISP_PARTICLE_VELOCITY, 0 );
    velocity[4 * wisp_world_fabric( h->world, bad )->vertex_slot[0]] = NAN;
    run_for( h->world, DT, 1 );
    assert_int_equal( touch_of( h->world, bad, 0, 0 ).body, 0 );
    assert_true( touch_of( h->world, bad, 1, 0 ).body != 0 );
}

// ---- several bodies ----

// A half space whose surface is `gap` below the origin along an axis that is turned about z.
static wisp_entity add_wall( wisp_world* world, double angle, float gap )
{
    wisp_collider_def wall = body_of( WISP_COLLIDER_PLANE );
    wall.pose =
        ( wisp_transform ){ about_z( angle ), { gap * (float)sin( angle ), -gap * (float)cos( angle ), 0.0f } };
    return add_collider( world, &wall );
}

TEST( the_two_nearest_bodies_are_kept_in_whatever_order_they_came )
{
    const float gaps[3] = { 0.004f, 0.008f, 0.012f };
    const int orders[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
    for ( int k = 0; k < 6; ++k )
    {
        SCOPED( close_local ) hosted* h = new_world( 1, 1 );
        for ( int i = 0; i < 3; ++i )
        {
            add_wall( h->world, 2.0 * orders[k][i], gaps[orders[k][i]] );
        }
        wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        const sensed a = sense( h->world, e ), b = touch_of( h->world, e, 0, 1 );
        assert_near( a.gap, gaps[0], 1e-7 );
        assert_near( b.gap, gaps[1], 1e-7 );
        assert_vector( b.normal, -sin( 2.0 ), cos( 2.0 ), 0.0, 1e-6 );
        assert_true( a.body != b.body );
    }
}

SENSE_TEST( of_bodies_that_are_equally_near_the_first_count )
{
    const float side[3] = { 1.0f, -1.0f, 1.0f };
    for ( int i = 0; i < 3; ++i )
    {
        wisp_collider_def ball = body_of( WISP_COLLIDER_SPHERE );
        ball.pose.translation =
            i < 2 ? ( wisp_vec3 ){ side[i] * 0.3125f, 0.0f, 0.0f } : ( wisp_vec3 ){ 0.0f, 0.3125f, 0.0f };
        add_collider( h->world, &ball );
    }
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const sensed a = sense( h->world, e ), b = touch_of( h->world, e, 0, 1 );
    assert_true( a.gap == b.gap );
    assert_true( a.normal.x == -1.0f && b.normal.x == 1.0f );
}

// Two walls are left behind; the particle would hit the third.
SENSE_TEST( what_the_path_enters_counts_before_what_it_leaves )
{
    add_wall( h->world, 0.0, 0.001f );
    add_wall( h->world, 0.5, 0.002f );
    add_wall( h->world, 3.0, 0.1f );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    give_velocity( h->world, e, 0.0f, 0.3f / DT, 0.0f );
    const sensed a = sense( h->world, e ), b = touch_of( h->world, e, 0, 1 );
    assert_near( a.gap, 0.1, 1e-6 );
    assert_near( b.gap, 0.001, 1e-6 );
}

SENSE_TEST( a_thick_body_that_touches_counts_before_a_thin_one_that_is_nearer )
{
    add_wall( h->world, 0.0, 0.010f );
    add_wall( h->world, 1.0, 0.012f );
    wisp_collider_def thick = body_of( WISP_COLLIDER_PLANE );
    thick.thickness = 0.05f;
    thick.pose = ( wisp_transform ){ about_z( 3.0 ), { 0.0f, 0.015f, 0.0f } };
    add_collider( h->world, &thick );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    assert_true( sense( h->world, e ).margin == MARGIN + 0.05f );
    assert_near( touch_of( h->world, e, 0, 1 ).gap, 0.01, 1e-6 );
}

SENSE_TEST( layers_say_who_senses_whom )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    plane.layers = 4;
    add_collider( h->world, &plane );
    wisp_entity blind = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    wisp_entity seeing = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    wisp_collision_def def = thin();
    def.mask = 3;
    assert_int_equal( wisp_set_collision( h->world, blind, &def ), WISP_OK );
    def.mask = 5;
    assert_int_equal( wisp_set_collision( h->world, seeing, &def ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_int_equal( touch_of( h->world, blind, 0, 0 ).body, 0 );
    assert_true( touch_of( h->world, seeing, 0, 0 ).body != 0 );
}

SENSE_TEST( a_body_in_the_place_of_a_removed_one_has_another_name )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    wisp_entity first = add_collider( h->world, &plane );
    const int32_t name = sense( h->world, e ).body;
    assert_int_equal( sense( h->world, e ).body, name );
    assert_int_equal( wisp_remove( h->world, first ), WISP_OK );
    wisp_entity second = add_collider( h->world, &plane );
    assert_int_equal( second.index, first.index );
    assert_true( sense( h->world, e ).body != name );
}

// ---- meshes ----

SENSE_TEST( a_mesh_is_sensed_as_the_ball_it_stands_for )
{
    add_mesh( h->world, false, ( wisp_transform ){ about_z( 1.2 ), { 0.5f, 0.0f, 0.0f } } );
    wisp_entity outside = add_probe( h->world, ( wisp_vec3 ){ 0.5f, 0.31f, 0.0f } );
    wisp_entity deep = add_probe( h->world, ( wisp_vec3 ){ 0.55f, 0.0f, 0.0f } );
    wisp_entity fast = add_probe( h->world, ( wisp_vec3 ){ -0.5f, 0.0f, 0.0f } );
    give_velocity( h->world, fast, 100.0f, 0.0f, 0.0f );
    run_for( h->world, DT, 1 );
    // faces of 512 triangles per side lie up to a hundredth of the radius inside the ball, and are tilted by as much
    // as 0.1
    const sensed o = touch_of( h->world, outside, 0, 0 ), d = touch_of( h->world, deep, 0, 0 );
    assert_near( o.gap, 0.01, 0.003 );
    assert_vector( o.normal, 0.0, 1.0, 0.0, 0.1 );
    assert_near( d.gap, -0.25, 0.003 );
    const sensed f = touch_of( h->world, fast, 0, 0 );
    assert_near( f.gap, 0.7, 0.01 );
    assert_vector( f.normal, -1.0, 0.0, 0.0, 0.1 );
}

SENSE_TEST( a_sheet_turns_its_normal_to_where_the_particle_comes_from )
{
    add_mesh( h->world, true, AT_ORIGIN );
    const float heights[4] = { 0.01f, -0.01f, 0.8f, -0.8f };
    for ( int k = 0; k < 4; ++k )
    {
        wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.3f, heights[k], 0.2f } );
        give_velocity( h->world, e, 0.0f, k < 2 ? 0.0f : copysignf( 100.0f, -heights[k] ), 0.0f );
        const sensed t = sense( h->world, e );
        assert_true( t.body != 0 );
        assert_near( t.gap, fabsf( heights[k] ), 1e-6 );
        assert_vector( t.normal, 0.0, copysign( 1.0, (double)heights[k] ), 0.0, 1e-6 );
        assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    }
}

// ---- figures ----

SENSE_TEST( stats_tell_depth_behind_the_surface_and_count_within_the_margin )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    plane.thickness = 0.01f;
    add_collider( h->world, &plane );
    // rows of nine vertices a centimetre apart, from 3.5 cm below the plane to 4.5 cm above it
    test_mesh mesh = test_plane( 9, 0.01f );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].y = 0.01f * (float)( v / 9 ) - 0.035f;
    }
    wisp_entity e = add_surface( h->world, &mesh );
    test_mesh_free( &mesh );
    give_solver( h->world, e );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    run_for( h->world, DT, 1 );
    wisp_collision_stats f = collision_of( h->world, e );
    assert_near( f.penetration, 0.035, 1e-8 );
    assert_true( f.thickness == MARGIN + 0.01f );
    assert_int_equal( f.vertex, 0 );
    assert_int_equal( f.contacts, 7 * 9 ); // up to 2.5 cm, within 3 cm
    assert_int_equal( f.dropped, 0 );
    give_velocity( h->world, e, 0.0f, 0.036f / DT, 0.0f );
    run_for( h->world, DT, 1 );
    f = collision_of( h->world, e );
    assert_true( f.penetration == 0.0f );
    assert_int_equal( f.vertex, -1 );
    assert_int_equal( f.contacts, 3 * 9 );
    assert_int_equal( wisp_request_collision_stats( h->world, e, false ), WISP_OK );
    assert_false( plan_says( h->world, "collision.stats", "wave" ) );
}

// ---- plans ----

SENSE_TEST( calls_in_either_order_give_the_same_plan )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    add_collider( h->world, &plane );
    test_mesh mesh = test_triangle( ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f }, 0.01f );
    wisp_entity e = add_surface( h->world, &mesh );
    test_mesh_free( &mesh );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    assert_true( plan_says( h->world, "collision.keep_outside", "wave" ) );
    assert_false( plan_says( h->world, "collision.contact_input", "wave" ) );
    run_for( h->world, DT, 1 ); // which pushes it out of the margin
    give_solver( h->world, e );
    give_velocity( h->world, e, 0.0f, -0.003f / DT, 0.0f );
    for ( int again = 0; again < 2; ++again )
    {
        assert_false( wisp_world_has( h->world, e, WISP_PARTICLE_HALF_SPACES ) );
        assert_true( plan_says( h->world, "collision.contact_input", "wave" ) );
        assert_false( plan_says( h->world, "collision.keep_outside", "wave" ) );
        assert_true( plan_says( h->world, "collision.stats", "wave" ) );
        assert_true( sense( h->world, e ).body != 0 );
        assert_int_equal( collision_of( h->world, e ).contacts, 3 );
        assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    }
}

SENSE_TEST( nothing_to_touch_leaves_no_pass_and_no_memory_of_bodies )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    wisp_entity e = add_probe( h->world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } );
    assert_int_equal( wisp_request_collision_stats( h->world, e, true ), WISP_OK );
    const int bare = wisp_world_plan_passes( h->world );
    assert_false( plan_says( h->world, "collision.contact_input", "wave" ) );
    wisp_entity body = add_collider( h->world, &plane );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 2 );
    assert_true( sense( h->world, e ).body != 0 );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
    assert_int_equal( touch_of( h->world, e, 0, 0 ).body, 0 );
    assert_int_equal( sense( h->world, e ).body, 0 );
    add_collider( h->world, &plane );
    assert_true( sense( h->world, e ).body != 0 );
    wisp_collision_def def = thin();
    def.enabled = false;
    assert_int_equal( wisp_set_collision( h->world, e, &def ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
    assert_int_equal( sense( h->world, e ).body, 0 );
    assert_int_equal( collision_of( h->world, e ).contacts, 0 );
}

// ---- many particles ----

static wisp_entity busy_scene( wisp_world* world, wisp_entity* ball )
{
    wisp_collider_def def = body_of( WISP_COLLIDER_SPHERE );
    *ball = add_collider( world, &def );
    def = body_of( WISP_COLLIDER_BOX );
    def.pose.translation = ( wisp_vec3 ){ 0.5f, 0.0f, 0.3f };
    add_collider( world, &def );
    def = body_of( WISP_COLLIDER_CAPSULE );
    def.pose.translation = ( wisp_vec3 ){ -0.4f, 0.0f, 0.2f };
    add_collider( world, &def );
    def = body_of( WISP_COLLIDER_PLANE );
    def.pose.translation.y = -0.1f;
    add_collider( world, &def );
    add_mesh( world, false, ( wisp_transform ){ about_z( 0.3 ), { 0.0f, 0.0f, -0.6f } } );
    test_mesh mesh = test_plane( 40, 0.035f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.7f, 0.35f, -0.7f } );
    wisp_entity e = add_surface( world, &mesh );
    test_mesh_free( &mesh );
    give_solver( world, e );
    const wisp_collision_def collision = thin();
    assert_int_equal( wisp_set_collision( world, e, &collision ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    give_velocity( world, e, 0.1f, -2.0f, 0.05f );
    give_gravity( world, e, 9.8f );
    return e;
}

// The same surface, moved as a whole: particles share blocks differently, and the result must not show it.
SENSE_TEST( a_particle_senses_the_same_alone_and_among_others )
{
    wisp_entity ball;
    wisp_entity many = busy_scene( h->world, &ball );
    test_mesh mesh = test_plane( 40, 0.035f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.7f, 0.35f, -0.7f } );
    wisp_entity alone[10];
    for ( int k = 0; k < 10; ++k )
    {
        alone[k] = add_probe( h->world, mesh.points[160 * k + 7] );
        give_velocity( h->world, alone[k], 0.1f, -2.0f, 0.05f );
        give_gravity( h->world, alone[k], 9.8f );
    }
    test_mesh_free( &mesh );
    int touched = 0;
    for ( int n = 0; n < 20; ++n )
    {
        run_busy( h->world, ball, n, n + 1 );
        for ( int k = 0; k < 10; ++k )
        {
            for ( int t = 0; t < WISP_MAX_PARTICLE_CONTACTS; ++t )
            {
                const sensed a = touch_of( h->world, alone[k], 0, t ), b = touch_of( h->world, many, 160 * k + 7, t );
                assert_memory_equal( &a, &b, sizeof( a ) );
                touched += a.body != 0 ? 1 : 0;
            }
        }
    }
    assert_true( touched > 50 );
}
