#include "figures_hang.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_held( hang_form form, wisp_vec3 p )
{
    const float edge = 0.5f * TRIANGLE_WIDTH - 1e-4f;
    const bool is_side = p.z<-edge, is_end = fabsf( p.x )> edge;
    switch ( form )
    {
        case HANG_SIDE:
            return is_side;
        case HANG_CORNERS:
            return is_side && is_end;
        case HANG_ROUND:
            break;
    }
    return is_end || fabsf( p.z ) > edge;
}

// @param pins [vertex_count] @return how many
static int find_pins( const wisp_mesh* mesh, hang_form form, int32_t* pins )
{
    int count = 0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        if ( is_held( form, mesh->points[i] ) )
        {
            pins[count++] = i;
        }
    }
    return count;
}

// Turned about the side that is held.
static void put_upright( const wisp_mesh* mesh, wisp_vec3* points )
{
    const float half = 0.5f * TRIANGLE_WIDTH;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        points[i] = ( wisp_vec3 ){ p.x, p.y - ( p.z + half ), -half };
    }
}

static wisp_status advance( surface_implementation* implementation, int steps, hang_result* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        wisp_implicit_cloth_stats seen = { 0 };
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( implementation, error );
        out->ms += 1e3 * ( wisp_clock_seconds() - begin );
        if ( status == WISP_OK &&
             wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen ) != WISP_OK )
        {
            status = bench_world_fail( implementation->world, WISP_CONFLICT, error );
        }
        out->iterations += seen.iterations;
    }
    return status;
}

static wisp_status run( const triangle_scene* scene, const triangle_setting* setting, int steps, hang_result* out,
                        wisp_error* error )
{
    surface_implementation implementation;
    wisp_status status = triangle_enter( scene, setting, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_vec3* points;
    status = advance( &implementation, steps, out, error );
    status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( out->points, points, (size_t)scene->mesh.vertex_count * sizeof( wisp_vec3 ) );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

wisp_status hang_run( const triangle_scene* scene, const hang_plan* plan, hang_result* out, wisp_error* error )
{
    const size_t count = (size_t)scene->mesh.vertex_count;
    int32_t* pins = malloc( count * sizeof( int32_t ) );
    wisp_vec3* start = malloc( count * sizeof( wisp_vec3 ) );
    *out = ( hang_result ){ .points = malloc( count * sizeof( wisp_vec3 ) ) };
    wisp_status status = WISP_OK;
    if ( pins == NULL || start == NULL || out->points == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that hangs" );
    }
    else
    {
        triangle_setting setting = triangle_default_setting();
        put_upright( &scene->mesh, start );
        setting.cloth = plan->cloth;
        setting.seconds = plan->seconds;
        setting.requests_stats = true;
        setting.has_ball = false;
        setting.points = plan->is_upright ? start : NULL;
        setting.pins = pins;
        setting.pin_count = find_pins( &scene->mesh, plan->form, pins );
        status = run( scene, &setting, plan->steps, out, error );
    }
    free( pins );
    free( start );
    if ( status != WISP_OK )
    {
        free( out->points );
        out->points = NULL;
    }
    return status;
}
