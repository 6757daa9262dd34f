/// Surfaces of an external solver, and their contacts with bodies: a module in this file moves their particles by
/// their velocities and does nothing else.
#pragma once

#include "collision_fixture.h"

#include "collision_state.h"
#include "collision_vectors.h"

static const float DT = 1.0f / 60.0f;
static const float MARGIN = 0.02f;

// ---- a solver without forces ----

static inline void follow( wisp_frame* frame, const wisp_span* span, void* user )
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

static inline wisp_status declare_follower( wisp_registry* r )
{
    const wisp_pass pass = {
        .name = "follower.follow",
        .stage = WISP_STAGE_PROJECT,
        .domain = WISP_DOMAIN_PARTICLE_BLOCK,
        .required = { WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
        .reads = { WISP_PARTICLE_CONTACTS, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        .writes = { WISP_PARTICLE_POSITION },
        .run = follow,
    };
    return wisp_declare_pass( r, &pass );
}

static const wisp_module FOLLOWER = { .name = "follower", .declare = declare_follower };

// ---- worlds ----

static inline hosted* new_world( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_collision_module, &FOLLOWER };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, wisp_default_world_def().iterations, workers );
}

static inline int open_sense( void** state )
{
    *state = new_world( 1, 1 );
    return 0;
}

#define SENSE_TEST( test ) TEST_WITH( test, open_sense, close_hosted )

static inline wisp_entity add_surface( wisp_world* world, const test_mesh* mesh )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static inline void give_solver( wisp_world* world, wisp_entity e )
{
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_CONTACTS ), WISP_OK );
}

static inline wisp_collision_def thin( void )
{
    wisp_collision_def def = wisp_default_collision_def();
    def.thickness = MARGIN;
    def.max_push_out_speed = 1.0f;
    return def;
}

// A small triangle with vertex 0 at a given position.
static inline wisp_entity add_probe( wisp_world* world, wisp_vec3 at )
{
    test_mesh mesh = test_triangle( at, 1e-3f );
    wisp_entity e = add_surface( world, &mesh );
    test_mesh_free( &mesh );
    give_solver( world, e );
    const wisp_collision_def def = thin();
    assert_int_equal( wisp_set_collision( world, e, &def ), WISP_OK );
    return e;
}

static inline void give_velocity( wisp_world* world, wisp_entity e, float x, float y, float z )
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

static inline sensed touch_of( wisp_world* world, wisp_entity e, int vertex, int k )
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
                       collision_load( plane ),
                       collision_load( motion ),
                       plane[3],
                       motion[3],
                       friction[0],
                       friction[1],
                       friction[2] };
}

// Only vertex 0 is checked, and only its nearest body.
static inline sensed sense( wisp_world* world, wisp_entity e )
{
    run_for( world, DT, 1 );
    return touch_of( world, e, 0, 0 );
}

static inline void assert_vector( wisp_vec3 v, double x, double y, double z, double tolerance )
{
    assert_near( v.x, x, tolerance );
    assert_near( v.y, y, tolerance );
    assert_near( v.z, z, tolerance );
}

typedef struct plan_search
{
    const char* name;
    bool found;
} plan_search;

static inline void look_for( void* user, const char* line )
{
    plan_search* search = user;
    const char* wave = strstr( line, "wave " );
    char name[64];
    search->found = search->found || ( wave != NULL && sscanf( wave, "wave %*d %63s", name ) == 1 &&
                                       strcmp( name, search->name ) == 0 );
}

static inline bool is_planned( wisp_world* world, const char* pass )
{
    plan_search search = { pass, false };
    assert_int_equal( wisp_world_plan( world, look_for, &search ), WISP_OK );
    return search.found;
}

// ---- meshes ----

// A ball of radius 0.3, or a square of side 2 in the plane y = 0.
static inline void add_mesh( wisp_world* world, bool double_sided, wisp_transform pose )
{
    test_mesh mesh = double_sided ? test_plane( 3, 1.0f ) : test_ball( 4 );
    move_mesh( &mesh, double_sided ? 1.0f : 0.3f,
               ( wisp_vec3 ){ double_sided ? -1.0f : 0.0f, 0.0f, double_sided ? -1.0f : 0.0f } );
    wisp_collider_def def = mesh_body( &mesh );
    def.double_sided = double_sided;
    def.pose = pose;
    add_collider( world, &def );
    test_mesh_free( &mesh );
}

static const wisp_transform AT_ORIGIN = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
