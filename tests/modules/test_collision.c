// Bodies in closed form: rejected cases, and the plan; motion is in tests/claims/collision.yaml. Particles that no body can reach in a
// step are left out of its substeps. That never changes anything: worlds with and without it have the same bits after every
// step, whatever moves and how fast.
#include "collision_fixture.h"
#include "collision_state.h"
#include "near_bodies.h"
#include "saved_world.h"

#include "engine/pass_hook.h"

#include "wisp/module/components.h"

static const float GRAVITY = 9.8f;
static const float DT = 1.0f / 60.0f;

// ---- the plan ----

COLLISION_TEST( removed_bodies_and_surfaces_are_forgotten )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    wisp_collider_def ball = body_of( WISP_COLLIDER_SPHERE );
    wisp_entity first = add_collider( h->world, &plane );
    wisp_entity e = add_cloth( h->world, 5, 0.4f, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, GRAVITY );
    wisp_entity second = add_collider( h->world, &ball );
    run_for( h->world, DT, 5 );
    assert_int_equal( wisp_remove( h->world, second ), WISP_OK );
    assert_int_equal( wisp_move_collider( h->world, second, plane.pose ), WISP_STALE_ID );
    // a cloth in the body's slot is not mistaken for the body
    wisp_entity other = add_cloth( h->world, 5, 0.4f, ( wisp_vec3 ){ 2.0f, 0.02f, 0.0f }, GRAVITY );
    assert_int_equal( other.index, second.index );
    run_for( h->world, DT, 60 );
    assert_true( motion_stats_of( h->world, e ).centre[1] > 0.0 );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_remove( h->world, first ), WISP_OK );
    run_for( h->world, DT, 60 );
    assert_true( motion_stats_of( h->world, other ).centre[1] < -1.0 );
}

// ---- determinism and memory ----

// A cloth of several blocks between a ball that moves, a box and a plane.
static wisp_entity busy_scene( wisp_world* world, wisp_entity* ball )
{
    wisp_collider_def def = body_of( WISP_COLLIDER_SPHERE );
    *ball = add_collider( world, &def );
    def = body_of( WISP_COLLIDER_BOX );
    def.pose.translation = ( wisp_vec3 ){ 0.5f, 0.0f, 0.3f };
    add_collider( world, &def );
    def = body_of( WISP_COLLIDER_PLANE );
    def.pose.translation.y = -0.3f;
    add_collider( world, &def );
    return add_cloth( world, 40, 1.4f, ( wisp_vec3 ){ 0.0f, 0.35f, 0.0f }, GRAVITY );
}

COLLISION_TEST( a_snapshot_brings_moving_bodies_back )
{
    wisp_entity ball;
    busy_scene( h->world, &ball );
    run_busy( h->world, ball, 0, 20 );
    // taken between setting a target and moving
    assert_int_equal(
        wisp_move_collider( h->world, ball, ( wisp_transform ){ about_z( 1.0 ), { 0.3f, 0.0f, 0.0f } } ), WISP_OK );
    const saved_world saved = save_world( h->world );
    run_for( h->world, DT, 5 );
    uint64_t expected = wisp_world_hash( h->world );
    assert_int_equal( wisp_world_restore( h->world, saved.bytes, saved.size ), WISP_OK );
    run_for( h->world, DT, 5 );
    assert_int_equal( wisp_world_hash( h->world ), expected );
    free( saved.bytes );
}

// ---- refusals ----

static void assert_refused( wisp_world* world, const wisp_collider_def* def, const char* word )
{
    wisp_entity e = { 7, 7 };
    uint64_t before = wisp_world_hash( world );
    assert_int_equal( wisp_add_collider( world, def, &e ), WISP_BAD_INPUT );
    assert_int_equal( e.index, 0 );
    assert_one_message( wisp_world_message( world ) );
    assert_contains( wisp_world_message( world ), word );
    assert_int_equal( wisp_world_hash( world ), before );
}

COLLISION_TEST( impossible_bodies_are_refused )
{
    wisp_collider_def def = body_of( WISP_COLLIDER_PLANE );
    def.pose.rotation = ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 0.0f };
    assert_refused( h->world, &def, "not a rotation" );
    def = body_of( WISP_COLLIDER_PLANE );
    def.kinetic_friction = 0.6f;
    assert_refused( h->world, &def, "kinetic_friction: got 0.6, expected at most static_friction" );
}

COLLISION_TEST( calls_that_do_not_fit_are_refused_with_a_message )
{
    wisp_collider_def plane = body_of( WISP_COLLIDER_PLANE );
    wisp_entity body = add_collider( h->world, &plane );
    wisp_entity e = add_cloth( h->world, 3, 0.2f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, GRAVITY );
    wisp_collision_def collision = wisp_default_collision_def();
    assert_int_equal( wisp_set_collision( h->world, body, &collision ), WISP_CONFLICT );
    assert_int_equal( wisp_move_collider( h->world, e, plane.pose ), WISP_CONFLICT );
    wisp_transform nowhere = plane.pose;
    nowhere.rotation.x = NAN;
    assert_int_equal( wisp_move_collider( h->world, body, nowhere ), WISP_BAD_INPUT );
    nowhere.rotation = ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 0.0f };
    assert_int_equal( wisp_move_collider( h->world, body, nowhere ), WISP_BAD_INPUT );
    wisp_entity copy;
    assert_int_equal( wisp_add_instance( h->world, body, NULL, &copy ), WISP_CONFLICT );
    assert_int_equal( wisp_request_collision_stats( h->world, e, false ), WISP_OK );
    wisp_collision_stats stats;
    assert_int_equal( wisp_read_collision_stats( h->world, e, &stats ), WISP_CONFLICT );
    assert_int_equal( wisp_read_collision_stats( h->world, body, &stats ), WISP_CONFLICT );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_STALE_ID );
}

enum
{
    SIDE = 24,
    SUBSTEPS = 10,
    STEPS = 40,
    BODIES = 30, // some of them far away
};

typedef struct drop
{
    const char* name;
    float gravity;         // m/s^2
    wisp_vec3 velocity;    // m/s, of the cloth at the start
    wisp_vec3 body_motion; // m per step, of all bodies
    float turn;            // rad per step
    float bodies_far;      // m, by which bodies are lower
    int iterations, workers;
    const char* isa;
    bool pulled;  // a corner of the cloth is pulled through the bodies
    bool is_fast; // bodies may reach everything in a step
} drop;

static const drop DROPS[] = {
    { .name = "falls", .gravity = 9.81f, .iterations = 1, .workers = 1 },
    { .name = "falls far", .gravity = 300.0f, .bodies_far = 6.0f, .iterations = 2, .workers = 1 },
    { .name = "is shot", .gravity = 9.81f, .velocity = { 4.0f, -60.0f, 1.0f }, .iterations = 1, .workers = 2 },
    { .name = "is shot from afar",
      .velocity = { 0.0f, -200.0f, 0.0f },
      .bodies_far = 20.0f,
      .iterations = 1,
      .workers = 1,
      .isa = "baseline" },
    { .name = "bodies push", .body_motion = { 0.02f, 0.03f, -0.01f }, .iterations = 1, .workers = 1 },
    { .name = "bodies strike",
      .gravity = 9.81f,
      .body_motion = { 0.3f, 0.4f, -0.1f },
      .iterations = 1,
      .workers = 1,
      .is_fast = true },
    { .name = "bodies fly by",
      .body_motion = { -0.1f, 1.7f, 0.0f },
      .bodies_far = 30.0f,
      .iterations = 1,
      .workers = 1,
      .isa = "avx2" },
    { .name = "bodies turn", .gravity = 9.81f, .turn = 0.02f, .iterations = 1, .workers = 1 },
    { .name = "bodies spin", .gravity = 9.81f, .turn = 0.7f, .iterations = 1, .workers = 2 },
    { .name = "bodies spin and fly",
      .gravity = 9.81f,
      .body_motion = { 0.02f, 0.05f, 0.0f },
      .turn = 2.9f,
      .iterations = 2,
      .workers = 1,
      .is_fast = true },
    { .name = "is pulled", .gravity = 9.81f, .iterations = 1, .workers = 1, .pulled = true },
};

typedef struct stage
{
    hosted* h;
    wisp_entity cloth, bodies[BODIES];
    wisp_vec3 places[BODIES];
    int body_count, settled; // particles, over all substeps
    pass_hook hook;
} stage;

// ---- settled groups ----

static void add_body( stage* s, wisp_collider_def def, wisp_vec3 place, float lower )
{
    s->places[s->body_count] = ( wisp_vec3 ){ place.x, place.y - lower, place.z };
    def.pose = ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, s->places[s->body_count] };
    s->bodies[s->body_count++] = add_collider( s->h->world, &def );
}

static void add_bodies( stage* s, float lower )
{
    add_body( s, body_of( WISP_COLLIDER_SPHERE ), ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, lower );
    add_body( s, body_of( WISP_COLLIDER_BOX ), ( wisp_vec3 ){ 0.5f, 0.1f, 0.2f }, lower );
    add_body( s, body_of( WISP_COLLIDER_CAPSULE ), ( wisp_vec3 ){ -0.4f, -0.1f, 0.3f }, lower );
    add_body( s, body_of( WISP_COLLIDER_PLANE ), ( wisp_vec3 ){ 0.0f, -0.6f, 0.0f }, lower );
    test_mesh mesh = test_ball( 1 );
    move_mesh( &mesh, 0.2f, ( wisp_vec3 ){ 0.3f, 0.1f, -0.2f } ); // away from the origin of its frame
    add_body( s, mesh_body( &mesh ), ( wisp_vec3 ){ -0.6f, 0.0f, -0.4f }, lower );
    test_mesh_free( &mesh );
    assert_true( s->body_count <= BODIES );
}

// Counts settled particles, which have a negative radius.
static void count_settled( void* user )
{
    stage* s = user;
    const float* found = wisp_world_column( s->h->world, s->cloth, WISP_PARTICLE_HALF_SPACES, 1 );
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        s->settled += found[4 * (size_t)i + 3] < 0.0f ? 1 : 0;
    }
}

// Rows of balls on both sides, so that the world has more bodies than each participant asks.
static void add_far_bodies( stage* s )
{
    for ( int i = s->body_count; i < BODIES; ++i )
    {
        const float side = i % 2 == 0 ? -1.0f : 1.0f, far = 1.0f + 0.25f * (float)i;
        add_body( s, body_of( WISP_COLLIDER_SPHERE ), ( wisp_vec3 ){ side * far, 0.1f, 0.3f * side }, 0.0f );
    }
}

static stage* new_stage( const drop* d, bool searches_all )
{
    stage* s = checked_calloc( 1, sizeof( stage ) );
    s->h = checked_calloc( 1, sizeof( hosted ) );
    s->h->def = colliding_def( s->h );
    s->h->def.substeps = SUBSTEPS;
    s->h->def.iterations = d->iterations;
    s->h->def.workers = d->workers;
    s->h->def.isa = d->isa;
    assert_int_equal( wisp_world_create( &s->h->def, &s->h->world, NULL ), WISP_OK );
    s->cloth = add_cloth( s->h->world, SIDE, 1.6f, ( wisp_vec3 ){ 0.1f, 0.5f, 0.05f }, d->gravity );
    add_bodies( s, d->bodies_far );
    collision_state* state = wisp_world_module_state( s->h->world, "collision" );
    state->searches_all = searches_all;
    if ( d->workers == 1 )
    {
        s->hook = ( pass_hook ){ .after = count_settled, .user = s };
        pass_hook_set( s->h->world, "collision.find", &s->hook );
    }
    float* velocity = wisp_world_column( s->h->world, s->cloth, WISP_PARTICLE_VELOCITY, 0 );
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        velocity[4 * (size_t)i] = d->velocity.x;
        velocity[4 * (size_t)i + 1] = d->velocity.y;
        velocity[4 * (size_t)i + 2] = d->velocity.z;
    }
    return s;
}

static void free_stage( stage* s )
{
    free_colliding( s->h );
    free( s );
}

static void step_stage( stage* s, const drop* d, int number )
{
    for ( int b = 0; b < s->body_count && ( d->turn != 0.0f || d->body_motion.y != 0.0f ); ++b )
    {
        const wisp_vec3 from = s->places[b], by = d->body_motion;
        const float n = (float)number;
        const wisp_transform pose = { about_z( (double)( d->turn * n ) ),
                                      { from.x + n * by.x, from.y + n * by.y, from.z + n * by.z } };
        assert_int_equal( wisp_move_collider( s->h->world, s->bodies[b], pose ), WISP_OK );
    }
    if ( d->pulled )
    {
        // a corner is held, and put elsewhere by the host between two steps
        float* position = wisp_world_column( s->h->world, s->cloth, WISP_PARTICLE_POSITION, 0 );
        position[3] = 0.0f;
        position[1] -= 0.1f;
        position[0] += 0.04f;
    }
    run_for( s->h->world, 1.0f / 60.0f, 1 );
}

TEST( settled_groups_change_no_bit )
{
    for ( int k = 0; k < WISP_COUNT( DROPS ); ++k )
    {
        const drop* d = DROPS + k;
        stage *some = new_stage( d, false ), *all = new_stage( d, true );
        int contacts = 0;
        for ( int n = 1; n <= STEPS; ++n )
        {
            step_stage( some, d, n );
            step_stage( all, d, n );
            if ( wisp_world_hash( some->h->world ) != wisp_world_hash( all->h->world ) )
            {
                fail_msg( "cloth that %s: step %d depends on what is left out", d->name, n );
            }
            const int32_t* count = wisp_world_column( some->h->world, some->cloth, WISP_PARTICLE_HALF_SPACES, 0 );
            for ( int i = 0; i < SIDE * SIDE; ++i )
            {
                contacts += count[i] > 0 ? 1 : 0;
            }
        }
        assert_int_equal( all->settled, 0 );
        if ( contacts < 200 || ( d->workers == 1 && d->is_fast == false && some->settled < 1000 ) )
        {
            fail_msg( "cloth that %s: %d contacts and %d settled particles show nothing", d->name, contacts,
                      some->settled );
        }
        free_stage( some );
        free_stage( all );
    }
}

static bool are_columns_equal( const stage* a, const stage* b, wisp_component component )
{
    const size_t bytes = (size_t)wisp_world_fabric( a->h->world, a->cloth )->slot_count * 4 * sizeof( float );
    return memcmp( wisp_world_column( a->h->world, a->cloth, component, 0 ),
                   wisp_world_column( b->h->world, b->cloth, component, 0 ), bytes ) == 0;
}

TEST( bodies_that_are_not_listed_move_nothing )
{
    for ( int k = 0; k < WISP_COUNT( DROPS ); ++k )
    {
        const drop* d = DROPS + k;
        stage *some = new_stage( d, false ), *all = new_stage( d, true );
        add_far_bodies( some );
        add_far_bodies( all );
        collision_state* module = wisp_world_module_state( some->h->world, "collision" );
        int listed = 0;
        for ( int n = 1; n <= STEPS; ++n )
        {
            step_stage( some, d, n );
            step_stage( all, d, n );
            listed += module->nearness.near[some->cloth.index].count;
            if ( are_columns_equal( some, all, WISP_PARTICLE_POSITION ) == false ||
                 are_columns_equal( some, all, WISP_PARTICLE_VELOCITY ) == false )
            {
                fail_msg( "cloth that %s: step %d depends on bodies that are listed", d->name, n );
            }
        }
        assert_true( listed > 0 && listed < STEPS * BODIES );
        free_stage( some );
        free_stage( all );
    }
}

TEST( features_of_a_sheet_add_their_passes_and_take_them_away )
{
    SCOPED( close_local ) hosted* h = new_colliding( 2, 1, 1 );
    const wisp_collider_def needle = body_of( WISP_COLLIDER_CAPSULE );
    add_collider( h->world, &needle );
    const wisp_entity sheet = add_cloth( h->world, 21, 0.4f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.0f );
    run_for( h->world, DT, 1 );
    const int without = wisp_world_plan_passes( h->world );
    SET( h->world, sheet, collision, d.features = WISP_COLLISION_ALL );
    assert_int_equal( wisp_world_plan_passes( h->world ), without + 3 ); // what is found is stored, to be projected
    SET_DEFAULT( h->world, sheet, collision );
    assert_int_equal( wisp_world_plan_passes( h->world ), without );
}
