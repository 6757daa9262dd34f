// Motion constraints: the calls of the host. In: limits and targets in the user's order. Out: columns in the order of slots.
#include "motion_constraints_state.h"

#include <math.h>
#include <string.h>

static const wisp_field MOTION_CONSTRAINTS_FIELDS[] = {
    WISP_SWITCH( wisp_motion_constraints_def, enabled, true ),
    WISP_NUMBER( wisp_motion_constraints_def, max_distance, INFINITY, 0, INFINITY, "m" ),
    WISP_NUMBER( wisp_motion_constraints_def, backstop_distance, INFINITY, 0, INFINITY, "m" ),
    WISP_FIELD( wisp_motion_constraints_def, backstop_radius, WISP_FIELD_NUMBER, 1e-6, INFINITY, 0, "m", INFINITY ),
    WISP_CHOICE( wisp_motion_constraints_def, solver, WISP_SOLVER_XPBD, WISP_SOLVER_COUNT ),
    WISP_NUMBER( wisp_motion_constraints_def, distance_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_motion_constraints_def, backstop_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_motion_constraints_def, distance_stiffness, 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_motion_constraints_def, backstop_stiffness, 1, 0, 1, NULL ),
};
WISP_DEFINE( motion_constraints_def, "motion constraints", MOTION_CONSTRAINTS_FIELDS )

static size_t row_of( int slot )
{
    return 24 * (size_t)( slot / 8 ) + (size_t)( slot % 8 );
}

// ---- checks ----

static wisp_status check_vectors( wisp_world* world, const char* name, const wisp_vec3* vectors, int count )
{
    for ( int v = 0; vectors != NULL && v < count; ++v )
    {
        const wisp_vec3 p = vectors[v];
        if ( !( fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "motion constraints: %s of vertex %d: got (%g, %g, %g), expected finite "
                                    "coordinates within 1e6",
                                    name, v, (double)p.x, (double)p.y, (double)p.z );
        }
    }
    return WISP_OK;
}

static wisp_status check_def( wisp_world* world, const wisp_motion_constraints_def* d, int count )
{
    const wisp_fields* f = &wisp_motion_constraints_def_fields;
    WISP_TRY( wisp_world_check_values( world, f, "max_distance", d->max_distances, count, "vertex" ) );
    WISP_TRY( wisp_world_check_values( world, f, "backstop_distance", d->backstop_distances, count, "vertex" ) );
    WISP_TRY( wisp_world_check_values( world, f, "backstop_radius", d->backstop_radii, count, "vertex" ) );
    wisp_status status = check_vectors( world, "target", d->targets, count );
    return status == WISP_OK ? check_vectors( world, "normal", d->normals, count ) : status;
}

// ---- limits ----

static float value_at( const float* map, float constant, int vertex )
{
    return map != NULL ? map[vertex] : constant;
}

static bool has_backstop_at( const wisp_motion_constraints_def* d, int vertex )
{
    return value_at( d->backstop_distances, d->backstop_distance, vertex ) < INFINITY &&
           value_at( d->backstop_radii, d->backstop_radius, vertex ) > 0.0f;
}

static bool has_backstops( const wisp_motion_constraints_def* d, int count )
{
    bool any = false;
    for ( int v = 0; v < count && any == false; ++v )
    {
        any = has_backstop_at( d, v );
    }
    return any;
}

static void fill_limits( wisp_world* world, wisp_entity surface, const motion_state* state,
                         const wisp_motion_constraints_def* d )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    float* max_distance = wisp_world_column( world, surface, state->distance, 3 );
    float* distance = wisp_world_column( world, surface, state->backstop, 3 );
    float* curvature = wisp_world_column( world, surface, state->backstop, 4 );
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        const int v = fabric->slot_vertex[slot];
        max_distance[slot] = v < 0 ? INFINITY : value_at( d->max_distances, d->max_distance, v );
        if ( distance != NULL )
        {
            const bool has = v >= 0 && has_backstop_at( d, v );
            const float radius = has ? value_at( d->backstop_radii, d->backstop_radius, v ) : INFINITY;
            distance[slot] = has ? value_at( d->backstop_distances, d->backstop_distance, v ) : INFINITY;
            curvature[slot] = radius < INFINITY ? 1.0f / radius : 0.0f;
        }
    }
    motion_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    const bool xpbd = d->solver == WISP_SOLVER_XPBD;
    *settings = ( motion_settings ){
        .stiffness = { xpbd ? 1.0f : d->distance_stiffness, xpbd ? 1.0f : d->backstop_stiffness },
        .compliance = { xpbd ? d->distance_compliance : 0.0f, xpbd ? d->backstop_compliance : 0.0f },
        .moves = MOTION_NEW,
    };
}

// ---- targets ----

static void put( float* rows, int slot, wisp_vec3 v )
{
    float* row = rows + row_of( slot );
    row[0] = v.x;
    row[8] = v.y;
    row[16] = v.z;
}

static wisp_vec3 get( const float* rows, int slot )
{
    const float* row = rows + row_of( slot );
    return ( wisp_vec3 ){ row[0], row[8], row[16] };
}

static wisp_vec3 less( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

// Unit normals of the triangles around each vertex, weighted by area; 0 where they cancel.
static void fill_normals( const wisp_fabric* fabric, const float* points, float* normals )
{
    memset( normals, 0, 3 * (size_t)fabric->slot_count * sizeof( float ) );
    for ( int t = 0; t < fabric->triangle_count; ++t )
    {
        const int32_t* corner = fabric->triangles + 3 * (size_t)t;
        const wisp_vec3 origin = get( points, corner[0] ), a = less( get( points, corner[1] ), origin ),
                        b = less( get( points, corner[2] ), origin );
        const wisp_vec3 n = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 sum = get( normals, corner[k] );
            put( normals, corner[k], ( wisp_vec3 ){ sum.x + n.x, sum.y + n.y, sum.z + n.z } );
        }
    }
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        const wisp_vec3 n = get( normals, slot );
        const float length = sqrtf( n.x * n.x + n.y * n.y + n.z * n.z );
        const float scale = length > 0.0f && length < INFINITY ? 1.0f / length : 0.0f;
        put( normals, slot,
             scale > 0.0f ? ( wisp_vec3 ){ n.x * scale, n.y * scale, n.z * scale }
                          : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    }
}

static void put_targets( wisp_world* world, wisp_entity surface, const motion_state* state, const wisp_vec3* points,
                         const wisp_vec3* normals )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    float* next = wisp_world_column( world, surface, state->distance, 2 );
    float* next_normal = wisp_world_column( world, surface, state->backstop, 2 );
    const wisp_vec3 offset = wisp_world_offset( world, surface );
    for ( int v = 0; points != NULL && v < fabric->vertex_count; ++v )
    {
        put( next, fabric->vertex_slot[v], wisp_to_rows( points[v], offset ) );
    }
    for ( int v = 0; next_normal != NULL && normals != NULL && v < fabric->vertex_count; ++v )
    {
        const float x = normals[v].x, y = normals[v].y, z = normals[v].z, length = sqrtf( x * x + y * y + z * z );
        const float scale = length > 0.0f ? 1.0f / length : 0.0f;
        put( next_normal, fabric->vertex_slot[v], ( wisp_vec3 ){ x * scale, y * scale, z * scale } );
    }
    if ( next_normal != NULL && normals == NULL )
    {
        fill_normals( fabric, next, next_normal );
    }
    motion_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    settings->moves = MOTION_NEW;
}

// Targets and normals that have nowhere to come from are where they go.
static void rest_targets( wisp_world* world, wisp_entity surface, wisp_component component )
{
    const size_t bytes = 3 * sizeof( float ) * (size_t)wisp_world_fabric( world, surface )->slot_count;
    memcpy( wisp_world_column( world, surface, component, 0 ), wisp_world_column( world, surface, component, 2 ),
            bytes );
    memset( wisp_world_column( world, surface, component, 1 ), 0, bytes );
}

static void start_targets( wisp_world* world, wisp_entity surface, const motion_state* state )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    const float* position = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    float* next = wisp_world_column( world, surface, state->distance, 2 );
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        const float* p = position + 4 * (size_t)slot;
        put( next, slot, ( wisp_vec3 ){ p[0], p[1], p[2] } );
    }
}

// ---- the calls ----

wisp_status wisp_set_motion_constraints( wisp_world* world, wisp_entity surface,
                                         const wisp_motion_constraints_def* given )
{
    wisp_motion_constraints_def def;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_motion_constraints_def_fields, &def, given ) );
    WISP_FIND_STATE( const motion_state, state, world, "motion_constraints", &surface, WISP_IS_SURFACE );
    const int count = wisp_world_fabric( world, surface )->vertex_count;
    WISP_TRY( check_def( world, &def, count ) );
    const bool xpbd = def.solver == WISP_SOLVER_XPBD,
               compliant = def.distance_compliance > 0.0f || def.backstop_compliance > 0.0f;
    const bool had = wisp_world_has( world, surface, state->distance ),
               had_backstop = wisp_world_has( world, surface, state->backstop ),
               has_backstop = def.enabled && has_backstops( &def, count );
    const wisp_component_use uses[] = {
        { state->settings, def.enabled },
        { state->distance, def.enabled },
        { state->backstop, has_backstop },
        { state->lambda, def.enabled && xpbd && compliant && state->has_iterations },
    };
    const wisp_status status = wisp_world_set_components( world, surface, uses, WISP_COUNT( uses ) );
    if ( status != WISP_OK || def.enabled == false )
    {
        return status;
    }
    fill_limits( world, surface, state, &def );
    if ( had == false )
    {
        start_targets( world, surface, state );
    }
    put_targets( world, surface, state, def.targets, def.normals );
    if ( had == false )
    {
        rest_targets( world, surface, state->distance );
    }
    if ( has_backstop && had_backstop == false )
    {
        rest_targets( world, surface, state->backstop );
    }
    return WISP_OK;
}

wisp_status wisp_move_motion_targets( wisp_world* world, wisp_entity surface, const wisp_vec3* points,
                                      const wisp_vec3* normals )
{
    WISP_FIND_STATE( const motion_state, state, world, "motion_constraints", &surface, WISP_IS_SURFACE );
    WISP_TRY( wisp_world_check_pointer( world, "points", points ) );
    if ( wisp_world_has( world, surface, state->settings ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u has no motion constraints", surface.index );
    }
    const int count = wisp_world_fabric( world, surface )->vertex_count;
    WISP_TRY( check_vectors( world, "target", points, count ) );
    WISP_TRY( check_vectors( world, "normal", normals, count ) );
    put_targets( world, surface, state, points, normals );
    return WISP_OK;
}
