// Velocities that the host gives a surface: those of a rigid motion, and gusts.
#include "world.h"

#include "wisp/module/vec.h"
#include "wisp/module/components.h"

#include <string.h>

// ---- a rigid motion ----

static wisp_vec3 centre_of( const wisp_fabric* fabric, const float* position )
{
    double mass = 0.0, sum[3] = { 0 };
    for ( int slot = 0; slot < fabric->vertex_count; ++slot )
    {
        const float* p = position + (size_t)slot * 4;
        double m = p[3] > 0.0f ? 1.0 / (double)p[3] : 0.0;
        mass += m;
        for ( int k = 0; k < 3; ++k )
        {
            sum[k] += m * (double)p[k];
        }
    }
    double inverse = mass > 0.0 ? 1.0 / mass : 0.0;
    return ( wisp_vec3 ){ (float)( sum[0] * inverse ), (float)( sum[1] * inverse ), (float)( sum[2] * inverse ) };
}

wisp_status wisp_set_velocity( wisp_world* world, wisp_entity surface, wisp_vec3 linear, wisp_vec3 angular )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    if ( !( wisp_v3_length( linear ) <= 1e6f && wisp_v3_length( angular ) <= 1e6f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "velocity: expected finite numbers of at most 1e6 m/s and 1e6 rad/s" );
    }
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_world_column( world, surface, WISP_PARTICLE_VELOCITY, 0 );
    const wisp_vec3 centre = centre_of( e->fabric, position );
    for ( int slot = 0; slot < e->fabric->vertex_count; ++slot )
    {
        const float* p = position + (size_t)slot * 4;
        wisp_vec3 r = wisp_v3_sub( ( wisp_vec3 ){ p[0], p[1], p[2] }, centre );
        wisp_vec3 v =
            p[3] > 0.0f ? wisp_v3_add( linear, wisp_v3_cross( angular, r ) ) : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        memcpy( velocity + (size_t)slot * 4, &v, sizeof( v ) );
    }
    wisp_world_restart_levels( world, surface );
    return WISP_OK;
}

// ---- chosen vertices ----

static wisp_status check_velocities( wisp_world* world, const wisp_fabric* fabric, const int32_t* vertices,
                                     const wisp_vec3* velocities, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( vertices[i] < 0 || vertices[i] >= fabric->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "vertices: got %d, expected 0 .. %d", vertices[i],
                                    fabric->vertex_count - 1 );
        }
        if ( !( wisp_v3_length( velocities[i] ) <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "velocities: got (%g, %g, %g) m/s for vertex %d, expected finite numbers of at "
                                    "most 1e6 m/s",
                                    (double)velocities[i].x, (double)velocities[i].y, (double)velocities[i].z,
                                    vertices[i] );
        }
    }
    return WISP_OK;
}

wisp_status wisp_set_vertex_velocities( wisp_world* world, wisp_entity surface, const int32_t* vertices,
                                        const wisp_vec3* velocities, int count )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    WISP_TRY( wisp_world_check_list( world, "vertices", vertices, count ) );
    WISP_TRY( wisp_world_check_list( world, "velocities", velocities, count ) );
    WISP_TRY( check_velocities( world, e->fabric, vertices, velocities, count ) );
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_world_column( world, surface, WISP_PARTICLE_VELOCITY, 0 );
    for ( int i = 0; i < count; ++i )
    {
        const size_t row = (size_t)e->fabric->vertex_slot[vertices[i]] * 4;
        if ( position[row + 3] > 0.0f )
        {
            memcpy( velocity + row, &velocities[i], sizeof velocities[i] );
        }
    }
    wisp_world_restart_levels( world, surface );
    return WISP_OK;
}

// ---- a gust ----

// The triangles at each vertex that the gust meets: their normal is against it. In double precision, in which the sign is that of
// the positions.
static void count_hits( const wisp_fabric* fabric, const float* position, wisp_vec3 gust, int32_t* hits )
{
    for ( int t = 0; t < fabric->triangle_count; ++t )
    {
        const int32_t* slots = fabric->triangles + 3 * (size_t)t;
        double side[2][3];
        for ( int k = 0; k < 6; ++k )
        {
            side[k / 3][k % 3] = (double)position[4 * (size_t)slots[1 + k / 3] + (size_t)( k % 3 )] -
                                 (double)position[4 * (size_t)slots[0] + (size_t)( k % 3 )];
        }
        const double along = (double)gust.x * ( side[0][1] * side[1][2] - side[0][2] * side[1][1] ) +
                             (double)gust.y * ( side[0][2] * side[1][0] - side[0][0] * side[1][2] ) +
                             (double)gust.z * ( side[0][0] * side[1][1] - side[0][1] * side[1][0] );
        for ( int k = 0; k < 3 && along < 0.0; ++k )
        {
            hits[slots[k]] += 1;
        }
    }
}

// Pinned vertices are not hit. @return the first vertex that would be faster than the limit of velocities, -1 none
static int find_too_fast( const wisp_fabric* fabric, const float* position, wisp_vec3 gust, bool per_triangle,
                          const float* velocity, int32_t* hits )
{
    for ( int slot = 0; slot < fabric->vertex_count; ++slot )
    {
        const float* v = velocity + (size_t)slot * 4;
        const bool is_free = position[(size_t)slot * 4 + 3] > 0.0f;
        hits[slot] = !is_free ? 0 : per_triangle ? hits[slot] : hits[slot] > 0;
        const float times = (float)hits[slot];
        const wisp_vec3 sum = { v[0] + times * gust.x, v[1] + times * gust.y, v[2] + times * gust.z };
        if ( times > 0.0f && !( wisp_v3_length( sum ) <= 1e6f ) )
        {
            return fabric->slot_vertex[slot];
        }
    }
    return -1;
}

static void add_gust( const wisp_fabric* fabric, wisp_vec3 gust, const int32_t* hits, float* velocity )
{
    for ( int slot = 0; slot < fabric->vertex_count; ++slot )
    {
        const float times = (float)hits[slot];
        float* v = velocity + (size_t)slot * 4;
        if ( hits[slot] > 0 )
        {
            v[0] += times * gust.x;
            v[1] += times * gust.y;
            v[2] += times * gust.z;
        }
    }
}

wisp_status wisp_apply_gust( wisp_world* world, wisp_entity surface, wisp_vec3 gust, bool per_triangle )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    if ( !( wisp_v3_length( gust ) <= 1e6f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "gust: got (%g, %g, %g) m/s, expected finite numbers of at most 1e6 m/s",
                                (double)gust.x, (double)gust.y, (double)gust.z );
    }
    if ( wisp_v3_dot( gust, gust ) == 0.0f )
    {
        return WISP_OK;
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)e->fabric->slot_count * sizeof( int32_t );
    int32_t* hits = allocator->allocate( allocator->user, bytes, 64 );
    if ( hits == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "gust: out of memory for the vertices of entity %u",
                                surface.index );
    }
    memset( hits, 0, bytes );
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    count_hits( e->fabric, position, gust, hits );
    float* velocity = wisp_world_column( world, surface, WISP_PARTICLE_VELOCITY, 0 );
    const int too_fast = find_too_fast( e->fabric, position, gust, per_triangle, velocity, hits );
    if ( too_fast < 0 )
    {
        add_gust( e->fabric, gust, hits, velocity );
        wisp_world_restart_levels( world, surface );
    }
    allocator->release( allocator->user, hits, bytes );
    return too_fast < 0 ? WISP_OK
                        : wisp_world_fail( world, WISP_BAD_INPUT,
                                           "gust: vertex %d would be faster than 1e6 m/s with (%g, %g, %g) m/s",
                                           too_fast, (double)gust.x, (double)gust.y, (double)gust.z );
}
