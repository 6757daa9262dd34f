// Fixed steps from any frame time, and points between two steps.
#include "alloc.h"
#include "world.h"

#include <math.h>
#include <string.h>

enum
{
    MAX_STEPS = 8, // of one call; a host that needs more would fall ever further behind
};

static const wisp_component BLENDED[] = { WISP_STRAND_POINTS, WISP_SURFACE_POINTS };

static size_t column_bytes( const wisp_world* world )
{
    return (size_t)world->store.row_count[WISP_TABLE_POINT] * sizeof( wisp_vec3 );
}

// Keep the points of the last step. @return false without memory
static bool keep_points( wisp_world* world )
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

static void blend_points( wisp_world* world, float weight )
{
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
}

static bool is_kept( const wisp_world* world )
{
    return world->blend.points.data != NULL && world->blend.structure == world->store.structure;
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

wisp_status wisp_world_advance( wisp_world* world, float seconds, float dt, wisp_before_step_fn* before_step,
                                void* user )
{
    if ( !( seconds >= 0.0f && seconds < 1e6f ) || !( dt > 0.0f && dt < 1e6f ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "advance: got %g s in steps of %g s, expected a time of at least 0 and a step above 0", (double)seconds,
            (double)dt );
    }
    const double ROUNDING = 1e-6; // of a step
    double pending = world->clock.pending + (double)seconds;
    const double due = floor( pending / (double)dt + ROUNDING );
    const int steps = due < MAX_STEPS ? (int)due : MAX_STEPS;
    pending = fmax( pending - due * (double)dt, 0.0 );
    world->clock.pending = pending;
    for ( int i = 0; i < steps; ++i )
    {
        if ( before_step != NULL )
        {
            before_step( user, world );
        }
        // Compiling first keeps the layout of the kept points.
        if ( i + 1 == steps && wisp_world_plan_passes( world ) >= 0 && keep_points( world ) == false )
        {
            return wisp_world_fail( world, WISP_NO_MEMORY, "advance: out of memory for the points of a step" );
        }
        const wisp_status status = wisp_world_step( world, dt );
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    if ( is_kept( world ) )
    {
        blend_points( world, (float)( pending / (double)dt ) );
        world->blend.is_shown = true;
    }
    return WISP_OK;
}
