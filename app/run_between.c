#include "run_between.h"

#include <stdlib.h>
#include <string.h>

struct run_between
{
    const run_bodies* bodies;
    scene_world* world;
    wisp_vec3** before; // of the step before the last one: ghosts as their distance to the curve, others as they are
    wisp_vec3** now;    // of the last step, the same way
    wisp_vec3** points; // of the result
};

run_between* run_between_open( const run_bodies* bodies, scene_world* world )
{
    run_between* b = calloc( 1, sizeof *b );
    if ( b )
    {
        *b = ( run_between ){ bodies, world, run_bodies_make_points( bodies ), run_bodies_make_points( bodies ),
                              run_bodies_make_points( bodies ) };
    }
    if ( b && !( b->before && b->now && b->points ) )
    {
        run_between_close( b );
        b = NULL;
    }
    return b;
}

void run_between_close( run_between* b )
{
    if ( b )
    {
        run_bodies_free_points( b->bodies, b->before );
        run_bodies_free_points( b->bodies, b->now );
        run_bodies_free_points( b->bodies, b->points );
        free( b );
    }
}

static bool is_ghosts( const run_between* b, int body )
{
    const int strands = b->bodies->numbers[body];
    return strands < b->world->scene->strands_count && b->world->scene->strands[strands].has_ghosts;
}

// Place on the curve in time that motion alone gives.
static wisp_status read_curve( const run_between* b, int body, float fraction, wisp_vec3* out, wisp_error* error )
{
    const wisp_entity entity = b->world->entities[b->bodies->numbers[body]];
    const wisp_status status = wisp_ghosts_between( b->world->world, entity, fraction, out );
    return status == WISP_OK ? WISP_OK
                             : wisp_fail( error, status, "%s: '%s': %s", b->world->scene->name,
                                          b->bodies->list[body].name, wisp_world_message( b->world->world ) );
}

// Replace points by their distance to the curve at one of its ends.
static wisp_status take_curve_off( run_between* b, int body, float fraction, wisp_vec3* points, wisp_error* error )
{
    wisp_vec3* curve = b->points[body];
    const wisp_status status = read_curve( b, body, fraction, curve, error );
    for ( int v = 0; v < b->bodies->list[body].vertex_count && status == WISP_OK; ++v )
    {
        points[v] = ( wisp_vec3 ){ points[v].x - curve[v].x, points[v].y - curve[v].y, points[v].z - curve[v].z };
    }
    return status;
}

wisp_status run_between_note( run_between* b, wisp_error* error )
{
    wisp_vec3** last = b->before;
    b->before = b->now;
    b->now = last;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->bodies->count && status == WISP_OK; ++i )
    {
        const size_t bytes = (size_t)b->bodies->list[i].vertex_count * sizeof( wisp_vec3 );
        memcpy( b->now[i], b->bodies->points[i], bytes );
        status = is_ghosts( b, i ) ? take_curve_off( b, i, 1.0f, b->now[i], error ) : WISP_OK;
    }
    return status;
}

wisp_status run_between_at( run_between* b, float fraction, const wisp_vec3* const** points, wisp_error* error )
{
    wisp_status status = WISP_OK;
    const float rest = 1.0f - fraction;
    for ( int i = 0; i < b->bodies->count && status == WISP_OK; ++i )
    {
        const wisp_vec3 *from = b->before[i], *to = b->now[i];
        wisp_vec3* out = b->points[i];
        const int count = b->bodies->list[i].vertex_count;
        if ( is_ghosts( b, i ) )
        {
            status = read_curve( b, i, fraction, out, error );
        }
        else
        {
            memset( out, 0, (size_t)count * sizeof *out );
        }
        for ( int v = 0; v < count && status == WISP_OK; ++v )
        {
            out[v].x += rest * from[v].x + fraction * to[v].x;
            out[v].y += rest * from[v].y + fraction * to[v].y;
            out[v].z += rest * from[v].z + fraction * to[v].z;
        }
    }
    *points = (const wisp_vec3* const*)b->points;
    return status;
}
