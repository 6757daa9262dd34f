// Convex bodies and height fields. In: wisp_collider_def. Out: bodies that own a hull or a copy of the heights. Both are queried through
// wisp/module/shapes.h, particle by particle.
#include "collision_bodies.h"
#include "collision_vectors.h"

#include <math.h>
#include <string.h>

wisp_status collision_make_convex( wisp_world* world, const wisp_collider_def* d, collision_body* body )
{
    WISP_TRY( wisp_world_check_list( world, "points", d->points, d->point_count ) );
    WISP_TRY( collision_check_points( world, d ) );
    wisp_error error = { 0 };
    wisp_status status =
        wisp_convex_create( d->points, d->point_count, wisp_world_allocator( world ), &body->convex, &error );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "collider: %s", error.message );
    }
    collision_measure_points( d, body );
    body->shape = ( wisp_shape ){ .kind = WISP_SHAPE_CONVEX, .convex = body->convex };
    return WISP_OK;
}

static size_t height_bytes( const wisp_height_field* f )
{
    return (size_t)f->count_x * (size_t)f->count_z * sizeof( float );
}

wisp_status collision_make_height_field( wisp_world* world, const wisp_collider_def* d, collision_body* body )
{
    const int count = d->height_count_x * d->height_count_z;
    WISP_TRY( wisp_world_check_pointer( world, "heights", d->heights ) );
    if ( count == 0 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "collider: height_count_x, height_count_z: got %d and %d, expected 2 to 8192 of both",
                                d->height_count_x, d->height_count_z );
    }
    float top = -INFINITY;
    for ( int i = 0; i < count; ++i )
    {
        if ( !( fabsf( d->heights[i] ) <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "collider: height %d of row %d is %g, it must be within 1e6 m of 0",
                                    i % d->height_count_x, i / d->height_count_x, (double)d->heights[i] );
        }
        top = fmaxf( top, d->heights[i] );
    }
    const wisp_height_field field = { NULL, d->height_count_x, d->height_count_z, d->spacing };
    const wisp_allocator* allocator = wisp_world_allocator( world );
    body->heights = allocator->allocate( allocator->user, height_bytes( &field ), 64 );
    if ( body->heights == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d heights of a collider", count );
    }
    memcpy( body->heights, d->heights, height_bytes( &field ) );
    body->shape = ( wisp_shape ){ .kind = WISP_SHAPE_HEIGHT_FIELD, .height_field = field };
    body->shape.height_field.heights = body->heights;
    body->centre = ( wisp_vec3 ){ 0.0f, top, 0.0f };
    body->half = ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY };
    body->ball_radius = INFINITY;
    body->bluntness = 1e6f; // most terrain is wide
    return WISP_OK;
}

void collision_release_body( const wisp_allocator* allocator, collision_body* body )
{
    wisp_collision_mesh_release( body->tree );
    wisp_convex_release( body->convex );
    wisp_release( allocator, body->heights, height_bytes( &body->shape.height_field ) );
    collision_release_points( allocator, body );
}

size_t collision_body_bytes( const collision_body* body )
{
    return wisp_convex_bytes( body->convex ) +
           ( body->heights != NULL ? height_bytes( &body->shape.height_field ) : 0 ) +
           ( body->start != NULL ? 2 * collision_points_bytes( body ) : 0 );
}
