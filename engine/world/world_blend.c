#include "world_blend.h"

#include "alloc.h"

#include <string.h>

static const wisp_component BLENDED[] = { WISP_STRAND_POINTS, WISP_SURFACE_POINTS };

static size_t column_bytes( const wisp_world* world )
{
    return (size_t)world->store.row_count[WISP_TABLE_POINT] * sizeof( wisp_vec3 );
}

bool world_keep_points( wisp_world* world )
{
    world_blend* blend = &world->blend;
    const size_t bytes = column_bytes( world );
    if ( base_buffer_reserve( &world->allocator, &blend->previous, WISP_COUNT( BLENDED ) * bytes ) == false ||
         base_buffer_reserve( &world->allocator, &blend->points, WISP_COUNT( BLENDED ) * bytes ) == false )
    {
        return false;
    }
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        const void* column = world->store.components[BLENDED[k]].columns[0];
        if ( column != NULL && bytes > 0 )
        {
            memcpy( (char*)blend->previous.data + (size_t)k * bytes, column, bytes );
        }
    }
    blend->structure = world->store.structure;
    return true;
}

static bool is_kept( const wisp_world* world )
{
    return world->blend.points.data != NULL && world->blend.structure == world->store.structure;
}

void world_blend_points( wisp_world* world, float weight )
{
    if ( is_kept( world ) == false )
    {
        return;
    }
    world_blend* blend = &world->blend;
    const size_t floats = column_bytes( world ) / sizeof( float );
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        const float* column = world->store.components[BLENDED[k]].columns[0];
        const float* previous = (const float*)blend->previous.data + (size_t)k * floats;
        float* points = (float*)blend->points.data + (size_t)k * floats;
        for ( size_t i = 0; i < floats && column != NULL; ++i )
        {
            points[i] = previous[i] + weight * ( column[i] - previous[i] );
        }
    }
    blend->is_shown = true;
}

void* world_kept_rows( wisp_world* world, const store_entity* e, wisp_component component )
{
    for ( int k = 0; k < WISP_COUNT( BLENDED ) && is_kept( world ); ++k )
    {
        if ( BLENDED[k] == component )
        {
            return (char*)world->blend.previous.data + (size_t)k * column_bytes( world ) +
                   (size_t)e->rows[WISP_TABLE_POINT].begin * sizeof( wisp_vec3 );
        }
    }
    return NULL;
}

const void* world_blended_rows( const wisp_world* world, const store_entity* e, wisp_component component )
{
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        if ( BLENDED[k] == component && world->blend.is_shown && is_kept( world ) )
        {
            return (const char*)world->blend.points.data + (size_t)k * column_bytes( world ) +
                   (size_t)e->rows[WISP_TABLE_POINT].begin * sizeof( wisp_vec3 );
        }
    }
    return NULL;
}
