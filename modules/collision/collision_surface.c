// Surfaces as bodies. In: positions, targets of pins and velocities of a surface at the start of a step. Out: the mesh of the
// body, from its start to its end in the step (pass collision.follow).
//
// Nothing is kept from step to step: start and end follow from the columns of the surface. So a snapshot, a teleport or a
// pin that is moved by hand needs no care here. Participants take the fraction of the motion that their substeps cover,
// whatever the substeps of the surface, and strands can still run all substeps of a group in one go.
#include "collision_bodies.h"

#include "collision_state.h"
#include "collision_vectors.h"

#include <math.h>

enum
{
    GRAIN = 2048, // vertices per block
};

void collision_release_points( const wisp_allocator* allocator, collision_body* body )
{
    wisp_release( allocator, body->start, collision_points_bytes( body ) );
    wisp_release( allocator, body->finish, collision_points_bytes( body ) );
    body->start = body->finish = NULL;
}

void collision_forget_surface( collision_state* state, wisp_entity surface )
{
    for ( int i = 0; i < state->body_count; ++i )
    {
        collision_body* body = state->bodies + i;
        if ( body->follows && wisp_entity_equal( body->surface, surface ) )
        {
            body->surface = ( wisp_entity ){ 0, 0 };
        }
    }
}

// ---- construction ----

// Triangles of a fabric name slots; those of the body name vertices.
static wisp_status build_mesh( wisp_world* world, const wisp_fabric* fabric, collision_body* body )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)fabric->triangle_count * 3 * sizeof( int32_t );
    int32_t* triangles = allocator->allocate( allocator->user, bytes, sizeof( int32_t ) );
    if ( triangles == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for a collider of %d triangles",
                                fabric->triangle_count );
    }
    for ( size_t k = 0; k < 3 * (size_t)fabric->triangle_count; ++k )
    {
        triangles[k] = fabric->slot_vertex[fabric->triangles[k]];
    }
    const wisp_collision_mesh_def def = {
        .points = body->finish,
        .triangles = triangles,
        .point_count = body->point_count,
        .triangle_count = fabric->triangle_count,
        .deforms = true,
    };
    wisp_error error = { 0 };
    wisp_status status = wisp_collision_mesh_create( &def, allocator, &body->tree, &error );
    if ( status != WISP_OK )
    {
        status = wisp_world_fail( world, status, "collider: %s", error.message );
    }
    else if ( body->double_sided == false )
    {
        const int open = wisp_collision_mesh_get_stats( body->tree ).open_edge_count;
        if ( open > 0 )
        {
            status =
                wisp_world_fail( world, WISP_BAD_INPUT,
                                 "collider: the surface has %d open edges, so nothing is inside: close it or call "
                                 "it double-sided",
                                 open );
        }
        body->bluntness = collision_bluntness( body->finish, triangles, fabric->triangle_count );
        if ( status == WISP_OK && !( body->bluntness > 0.0f ) )
        {
            status = wisp_world_fail( world, WISP_BAD_INPUT, "collider: the triangles of the surface face inwards" );
        }
    }
    allocator->release( allocator->user, triangles, bytes );
    return status;
}

// Bounds of the points of a body in a step.
typedef struct point_bounds
{
    wisp_vec3 lower, upper; // m
    float shift;            // m^2
} point_bounds;

static point_bounds no_bounds( void )
{
    return ( point_bounds ){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 0.0f };
}

static void widen_bounds( point_bounds* all, const collision_body* body, int v )
{
    collision_widen( &all->lower, &all->upper, body->start[v] );
    collision_widen( &all->lower, &all->upper, body->finish[v] );
    const wisp_vec3 displacement = wisp_v3_sub( body->finish[v], body->start[v] );
    all->shift = collision_larger( all->shift, wisp_v3_dot( displacement, displacement ) );
}

static void join_bounds( point_bounds* all, const point_bounds* more )
{
    wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    collision_widen( &all->lower, &none, more->lower );
    collision_widen( &none, &all->upper, more->upper );
    all->shift = collision_larger( all->shift, more->shift );
}

static void set_bounds( collision_body* body, const point_bounds* all )
{
    const wisp_vec3 lower = all->lower, upper = all->upper;
    // slightly larger, against rounding
    const float most = 0.50001f;
    body->shift = 1.001f * sqrtf( all->shift );
    body->half =
        ( wisp_vec3 ){ most * ( upper.x - lower.x ), most * ( upper.y - lower.y ), most * ( upper.z - lower.z ) };
    body->centre =
        ( wisp_vec3 ){ 0.5f * ( lower.x + upper.x ), 0.5f * ( lower.y + upper.y ), 0.5f * ( lower.z + upper.z ) };
    body->ball_radius = body->tight_radius = wisp_v3_length( body->half );
}

wisp_status collision_make_surface( wisp_world* world, const wisp_collider_def* d, collision_body* body )
{
    WISP_TRY( wisp_world_check_entity( world, d->surface ) );
    const wisp_fabric* fabric = wisp_world_fabric( world, d->surface );
    if ( fabric == NULL || fabric->triangle_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "collider: entity %u is not a surface with triangles",
                                d->surface.index );
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    body->follows = true;
    body->surface = d->surface;
    body->point_count = fabric->vertex_count;
    body->start = allocator->allocate( allocator->user, collision_points_bytes( body ), sizeof( float ) );
    body->finish = allocator->allocate( allocator->user, collision_points_bytes( body ), sizeof( float ) );
    wisp_status status = WISP_OK;
    if ( body->start == NULL || body->finish == NULL )
    {
        status =
            wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for a collider of %d points", body->point_count );
    }
    else
    {
        const float* position = wisp_world_column( world, d->surface, WISP_PARTICLE_POSITION, 0 );
        point_bounds bounds = no_bounds();
        for ( int v = 0; v < body->point_count; ++v )
        {
            body->start[v] = body->finish[v] = wisp_v3_load( position + (size_t)fabric->vertex_slot[v] * 4 );
            widen_bounds( &bounds, body, v );
        }
        set_bounds( body, &bounds );
        status = build_mesh( world, fabric, body );
    }
    return status;
}

wisp_status collision_follow_surface( wisp_world* world, const collision_state* state, wisp_entity body,
                                      wisp_entity surface )
{
    wisp_world_let_meet( world, surface );
    WISP_TRY( wisp_world_attach( world, body, state->follower ) );
    WISP_TRY( wisp_world_request( world, body, state->follower, true ) );
    return wisp_world_request( world, surface, WISP_PARTICLE_POSITION, true );
}

// ---- the pass ----

typedef struct follow_loop
{
    collision_body* body;
    const int32_t* vertex_slot;
    wisp_surface_motion motion;
    point_bounds bounds[WISP_MAX_WORKERS];
} follow_loop;

// What is not finite stays where it was; the state check of the surface handles it.
static void follow_range( void* context, int begin, int end, int worker )
{
    follow_loop* loop = context;
    for ( int v = begin; v < end; ++v )
    {
        const int32_t slot = loop->vertex_slot[v];
        const wisp_vec3 at = wisp_v3_load( loop->motion.position + 4 * (size_t)slot ),
                        to = wisp_surface_motion_end( &loop->motion, slot );
        const bool is_valid = collision_is_in_range( at );
        loop->body->start[v] = is_valid ? at : loop->body->finish[v];
        loop->body->finish[v] = is_valid && collision_is_in_range( to ) ? to : loop->body->start[v];
        widen_bounds( loop->bounds + worker, loop->body, v );
    }
}

static collision_body* find_body( collision_state* state, wisp_entity entity )
{
    int i = 0;
    while ( wisp_entity_equal( state->bodies[i].entity, entity ) == false )
    {
        ++i;
    }
    return state->bodies + i;
}

// Count the vertices that may ask a body: those of all participants but its own.
static int64_t count_vertices( wisp_frame* frame, const collision_state* state, wisp_entity surface )
{
    int64_t count = 0;
    for ( wisp_entity e = { 0, 0 }; collision_next_participant( state, &e ); )
    {
        const wisp_fabric* fabric = wisp_frame_fabric( frame, e );
        const bool is_own = wisp_entity_equal( e, surface );
        count += is_own ? 0 : fabric != NULL ? fabric->vertex_count : wisp_frame_strands( frame, e )->vertex_count;
    }
    return count;
}

void collision_follow( wisp_frame* frame, const wisp_span* span, void* user )
{
    collision_body* body = find_body( user, span->entity );
    if ( body->surface.index == 0 )
    {
        return;
    }
    const wisp_entity surface = body->surface;
    follow_loop loop = {
        .body = body,
        .vertex_slot = wisp_frame_fabric( frame, surface )->vertex_slot,
        .motion = wisp_frame_surface_motion( frame, surface,
                                             wisp_frame_dt( frame, span->entity ) *
                                                 (float)wisp_frame_substeps( frame, span->entity ) ),
    };
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    for ( int worker = 0; worker < WISP_MAX_WORKERS; ++worker )
    {
        loop.bounds[worker] = no_bounds();
    }
    wisp_parallel_for( parallel, body->point_count, GRAIN, follow_range, &loop );
    for ( int worker = 1; worker < WISP_MAX_WORKERS; ++worker )
    {
        join_bounds( loop.bounds, loop.bounds + worker );
    }
    set_bounds( body, loop.bounds );
    const wisp_status status = wisp_collision_mesh_update( body->tree, body->start, body->finish, parallel, NULL );
    WISP_ASSERT( status == WISP_OK ); // all points are in range, and a tree needs no memory
    (void)status;
    if ( count_vertices( frame, user, surface ) >= wisp_frame_fabric( frame, surface )->triangle_count / 2 )
    {
        wisp_collision_mesh_fill_cells( body->tree, parallel );
    }
}
