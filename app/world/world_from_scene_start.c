// Surfaces that start away from their rest shape.
#include "world_from_scene_parts.h"

#include "wisp/module/random.h"

#include <math.h>

// Bounds of points, with the middle in double.
typedef struct start_box
{
    double lower[3], upper[3], middle[3];
    double size; // m, the longest edge
} start_box;

static start_box box_of( const wisp_vec3* points, int count )
{
    start_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, { 0 }, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        const double p[3] = { (double)points[i].x, (double)points[i].y, (double)points[i].z };
        for ( int k = 0; k < 3; ++k )
        {
            box.lower[k] = fmin( box.lower[k], p[k] );
            box.upper[k] = fmax( box.upper[k], p[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        box.middle[k] = 0.5 * ( box.lower[k] + box.upper[k] );
        box.size = fmax( box.size, box.upper[k] - box.lower[k] );
    }
    return box;
}

// Turned about the vertical through the middle, in proportion to the depth.
static void twist( const start_box* box, double turns, double p[3] )
{
    const double height = box->upper[1] - box->lower[1];
    const double angle = height > 0.0 ? 6.283185307179586 * turns * ( box->upper[1] - p[1] ) / height : 0.0;
    const double x = p[0] - box->middle[0], z = p[2] - box->middle[2];
    p[0] = box->middle[0] + cos( angle ) * x + sin( angle ) * z;
    p[2] = box->middle[2] - sin( angle ) * x + cos( angle ) * z;
}

// Pinned vertices are only scaled.
static wisp_vec3 start_of( const wisp_scene_start* start, const start_box* box, double mirror, wisp_vec3 rest,
                           int vertex, bool is_pinned )
{
    const wisp_scene_start_shape shape = is_pinned ? WISP_SCENE_START_REST : start->shape;
    const double scale[3] = { (double)start->scale.x, (double)start->scale.y, (double)start->scale.z };
    double p[3] = { (double)rest.x, (double)rest.y, (double)rest.z };
    const wisp_random_key key = wisp_random_make_key( start->seed, 0, 0 );
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = box->middle[k] + scale[k] * ( p[k] - box->middle[k] );
        switch ( shape )
        {
            case WISP_SCENE_START_RANDOM:
                p[k] =
                    box->middle[k] + box->size * ( wisp_random_unit( key, (uint32_t)vertex, (uint32_t)k, 0 ) - 0.5 );
                break;
            case WISP_SCENE_START_PLANE:
                p[k] = k == 1 ? box->middle[k] : p[k];
                break;
            case WISP_SCENE_START_POINT:
                p[k] = box->middle[k];
                break;
            case WISP_SCENE_START_INSIDE_OUT:
                p[k] = 2.0 * ( k == 1 ? mirror : box->middle[k] ) - p[k];
                break;
            case WISP_SCENE_START_REST:
            case WISP_SCENE_START_TWISTED:
                break;
        }
    }
    if ( shape == WISP_SCENE_START_TWISTED )
    {
        twist( box, (double)start->turns, p );
    }
    return ( wisp_vec3 ){ (float)p[0], (float)p[1], (float)p[2] };
}

void scene_start_place( const wisp_scene_surface* entry, scene_world_surface* surface )
{
    wisp_mesh* mesh = &surface->mesh;
    const start_box box = box_of( mesh->points, mesh->vertex_count );
    double mirror = surface->pin_count > 0 ? 0.0 : box.middle[1];
    for ( int i = 0; i < surface->pin_count; ++i )
    {
        mirror += (double)mesh->points[surface->pins[i]].y / surface->pin_count;
    }
    for ( int v = 0, pin = 0; v < mesh->vertex_count && entry->has_start; ++v )
    {
        // pins are in ascending order
        const bool is_pinned = pin < surface->pin_count && surface->pins[pin] == v;
        pin += is_pinned ? 1 : 0;
        mesh->points[v] = start_of( &entry->start, &box, mirror, mesh->points[v], v, is_pinned );
    }
}
