// Pins on another surface. In: positions, velocities and targets of that surface at the start of a step. Out: targets of the
// pins (pass attachments.follow).
//
// With the corners a, b and c of the triangle at the end of the step, w the barycentric coordinates and R the rotation whose first
// axis is along b - a and whose third is the normal, a pin goes to w a + w b + w c + R offset. Both w and offset are those
// of the pin when it was attached. A triangle without area has no rotation: its pins keep their targets.
#include "attachments_state.h"

#include "wisp/module/collision_mesh.h"
#include "wisp/module/vec.h"

#include <math.h>
#include <string.h>

typedef struct corners
{
    wisp_vec3 at[3];
} corners;

typedef struct axes
{
    wisp_vec3 x, y, z;
} axes;

static bool is_in_range( wisp_vec3 p )
{
    return fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f; // false for NaN
}

// @return false for a triangle without area
static bool find_axes( const corners* t, axes* out )
{
    const wisp_vec3 edge = wisp_v3_mul_add( t->at[1], -1.0f, t->at[0] );
    const wisp_vec3 normal = wisp_v3_cross( edge, wisp_v3_mul_add( t->at[2], -1.0f, t->at[0] ) );
    const float length = sqrtf( wisp_v3_dot( edge, edge ) ), area = sqrtf( wisp_v3_dot( normal, normal ) );
    if ( !( length > 0.0f && area > 0.0f ) )
    {
        return false;
    }
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    out->x = wisp_v3_mul_add( none, 1.0f / length, edge );
    out->z = wisp_v3_mul_add( none, 1.0f / area, normal );
    out->y = wisp_v3_cross( out->z, out->x );
    return true;
}

static wisp_vec3 point_of( const corners* t, const float weights[3] )
{
    wisp_vec3 p = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < 3; ++k )
    {
        p = wisp_v3_mul_add( p, weights[k], t->at[k] );
    }
    return p;
}

// ---- the pass ----

static void follow( const wisp_surface_motion* m, const attachments_place* place, float* target )
{
    corners t;
    axes r;
    for ( int k = 0; k < 3; ++k )
    {
        t.at[k] = wisp_surface_motion_end( m, place->corner[k] );
    }
    if ( find_axes( &t, &r ) == false )
    {
        return;
    }
    wisp_vec3 p = point_of( &t, place->weights );
    p = wisp_v3_mul_add( p, place->offset.x, r.x );
    p = wisp_v3_mul_add( p, place->offset.y, r.y );
    p = wisp_v3_mul_add( p, place->offset.z, r.z );
    if ( is_in_range( p ) )
    {
        target[0] = p.x;
        target[1] = p.y;
        target[2] = p.z;
        target[3] = 1.0f;
    }
}

void attachments_follow( wisp_frame* frame, const wisp_span* span, void* user )
{
    const attachments_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    attachments_place* place = wisp_frame_column( frame, span->entity, state->place, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 );
    const float seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    wisp_entity of = { 0, 0 };
    wisp_surface_motion m = { 0 };
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        if ( place[slot].to.index == 0 )
        {
            continue;
        }
        if ( position[(size_t)slot * 4 + 3] != 0.0f )
        {
            place[slot] = ( attachments_place ){ .to = { 0, 0 } }; // it was unpinned
            continue;
        }
        if ( wisp_entity_equal( of, place[slot].to ) == false )
        {
            of = place[slot].to;
            m = wisp_frame_surface_motion( frame, of, seconds );
        }
        follow( &m, place + slot, target + (size_t)slot * 4 );
    }
}

// ---- attaching ----

static bool has_attached_pins( const attachments_state* state, wisp_world* world, wisp_entity surface )
{
    const attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    for ( int slot = 0; place != NULL && slot < fabric->slot_count; ++slot )
    {
        if ( place[slot].to.index != 0 )
        {
            return true;
        }
    }
    return false;
}

static bool is_attached_to( const attachments_state* state, wisp_world* world, wisp_entity to )
{
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->place, &e ); )
    {
        const attachments_place* place = wisp_world_column( world, e, state->place, 0 );
        const int slots = wisp_world_fabric( world, e )->slot_count;
        for ( int slot = 0; slot < slots; ++slot )
        {
            if ( wisp_entity_equal( place[slot].to, to ) )
            {
                return true;
            }
        }
    }
    return false;
}

static wisp_status check_vertices( wisp_world* world, const wisp_fabric* fabric, const int32_t* vertices, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( vertices[i] < 0 || vertices[i] >= fabric->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "vertex %d: the surface has %d vertices", vertices[i],
                                    fabric->vertex_count );
        }
    }
    return WISP_OK;
}

static wisp_status check_pair( wisp_world* world, const attachments_state* state, wisp_entity surface,
                               wisp_entity to )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, to );
    if ( wisp_entity_equal( surface, to ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: entity %u cannot be attached to itself",
                                to.index );
    }
    if ( fabric == NULL || fabric->triangle_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: entity %u is not a surface with triangles",
                                to.index );
    }
    if ( has_attached_pins( state, world, to ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: entity %u has attached pins itself", to.index );
    }
    if ( is_attached_to( state, world, surface ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: other pins are attached to entity %u",
                                surface.index );
    }
    return WISP_OK;
}

// Find the place of a pin against the triangle that is closest to it.
static void set_place( const wisp_fabric* fabric, const float* particles, const wisp_mesh_nearest* nearest,
                       wisp_vec3 pin, attachments_place* place )
{
    corners t;
    axes r;
    for ( int k = 0; k < 3; ++k )
    {
        place->corner[k] = fabric->triangles[3 * (size_t)nearest->triangle + (size_t)k];
        place->weights[k] = nearest->weights[k];
        t.at[k] = wisp_v3_load( particles + (size_t)place->corner[k] * 4 );
    }
    const wisp_vec3 away = wisp_v3_mul_add( pin, -1.0f, point_of( &t, place->weights ) );
    place->offset = find_axes( &t, &r ) ? ( wisp_vec3 ){ wisp_v3_dot( away, r.x ), wisp_v3_dot( away, r.y ),
                                                         wisp_v3_dot( away, r.z ) }
                                        : away;
}

// Build the mesh of a surface as it is, for queries.
static wisp_status build_mesh( wisp_world* world, const wisp_fabric* fabric, const float* particles,
                               wisp_collision_mesh** mesh )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)fabric->slot_count * sizeof( wisp_vec3 );
    wisp_vec3* points = allocator->allocate( allocator->user, bytes, sizeof( float ) );
    if ( points == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to attach pins" );
    }
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        points[slot] = wisp_v3_load( particles + (size_t)slot * 4 );
    }
    // a mesh that deforms needs no Embree
    const wisp_collision_mesh_def def = { .points = points,
                                          .triangles = fabric->triangles,
                                          .point_count = fabric->slot_count,
                                          .triangle_count = fabric->triangle_count,
                                          .deforms = true };
    wisp_error error = { 0 };
    const wisp_status status = wisp_collision_mesh_create( &def, allocator, mesh, &error );
    allocator->release( allocator->user, points, bytes );
    return status == WISP_OK ? WISP_OK : wisp_world_fail( world, status, "attachments: %s", error.message );
}

static void attach_all( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count, wisp_entity to,
                        wisp_collision_mesh* mesh, attachments_place* place )
{
    const wisp_fabric *mine = wisp_world_fabric( world, surface ), *theirs = wisp_world_fabric( world, to );
    const float* position = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    const float* particles = wisp_world_column( world, to, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < count; ++i )
    {
        const int slot = mine->vertex_slot[vertices[i]];
        const wisp_mesh_query query = { .point = wisp_v3_load( position + (size_t)slot * 4 ), .radius = INFINITY };
        wisp_mesh_nearest nearest;
        wisp_collision_mesh_closest( mesh, &query, 1, &nearest, NULL );
        if ( nearest.triangle >= 0 )
        {
            place[slot].to = to;
            set_place( theirs, particles, &nearest, query.point, place + slot );
        }
    }
}

static wisp_status begin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                          attachments_state** state )
{
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    WISP_TRY( wisp_world_check_list( world, "vertices", vertices, count ) );
    void* found;
    WISP_TRY( wisp_world_surface_state( world, "attachments", surface, &found ) );
    *state = found;
    return check_vertices( world, wisp_world_fabric( world, surface ), vertices, count );
}

wisp_status wisp_attach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                              wisp_entity to )
{
    attachments_state* state;
    WISP_TRY( begin( world, surface, vertices, count, &state ) );
    WISP_TRY( wisp_world_check_entity( world, to ) );
    WISP_TRY( check_pair( world, state, surface, to ) );
    wisp_world_tie( world, to, surface );
    wisp_collision_mesh* mesh;
    WISP_TRY( build_mesh( world, wisp_world_fabric( world, to ),
                          wisp_world_column( world, to, WISP_PARTICLE_POSITION, 0 ), &mesh ) );
    const wisp_component_use uses[] = { { WISP_PARTICLE_TARGET, true }, { state->place, true } };
    wisp_status status = wisp_world_set_components( world, surface, uses, WISP_COUNT( uses ) );
    status = status == WISP_OK ? wisp_pin( world, surface, vertices, count ) : status;
    status = status == WISP_OK ? wisp_world_request( world, to, WISP_PARTICLE_POSITION, true ) : status; // has it
    if ( status == WISP_OK )
    {
        attach_all( world, surface, vertices, count, to, mesh, wisp_world_column( world, surface, state->place, 0 ) );
    }
    wisp_collision_mesh_release( mesh );
    return status;
}

wisp_status wisp_detach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count )
{
    attachments_state* state;
    WISP_TRY( begin( world, surface, vertices, count, &state ) );
    attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    for ( int i = 0; place != NULL && i < count; ++i )
    {
        place[fabric->vertex_slot[vertices[i]]] = ( attachments_place ){ .to = { 0, 0 } };
    }
    return WISP_OK;
}

void attachments_forget( attachments_state* state, wisp_world* world, wisp_entity to )
{
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->place, &e ); )
    {
        attachments_place* place = wisp_world_column( world, e, state->place, 0 );
        const int slots = wisp_world_fabric( world, e )->slot_count;
        for ( int slot = 0; slot < slots; ++slot )
        {
            if ( wisp_entity_equal( place[slot].to, to ) )
            {
                place[slot] = ( attachments_place ){ .to = { 0, 0 } };
            }
        }
    }
}

static void follow_triangle( attachments_place* place, int slot_count, wisp_entity to, const int32_t* before,
                             const int32_t* now )
{
    for ( int slot = 0; slot < slot_count; ++slot )
    {
        if ( wisp_entity_equal( place[slot].to, to ) &&
             memcmp( place[slot].corner, before, sizeof( place[slot].corner ) ) == 0 )
        {
            memcpy( place[slot].corner, now, sizeof( place[slot].corner ) );
        }
    }
}

// A new vertex is in no triangle of before, so no place is taken twice.
void attachments_follow_triangles( const attachments_state* state, wisp_world* world, wisp_entity to,
                                   const wisp_fabric* before )
{
    const int32_t *now = wisp_world_fabric( world, to )->triangles, *then = before->triangles;
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->place, &e ); )
    {
        attachments_place* place = wisp_world_column( world, e, state->place, 0 );
        const int slots = wisp_world_fabric( world, e )->slot_count;
        for ( int t = 0; t < before->triangle_count; ++t )
        {
            const size_t first = 3 * (size_t)t;
            if ( memcmp( now + first, then + first, 3 * sizeof( int32_t ) ) != 0 )
            {
                follow_triangle( place, slots, to, then + first, now + first );
            }
        }
    }
}
