#include "contact_overlap.h"

#include "wisp/collision_mesh.h"

#include <math.h>
#include <stdlib.h>

/// One surface against the others.
typedef struct overlap_work
{
    contact_world* world;
    wisp_collision_mesh* tree; // of the surface that is asked
    wisp_mesh_query* queries;
    wisp_mesh_nearest* nearest;
    float* distances; // [vertex_count] of the first surface from the nearest other
} overlap_work;

static wisp_status build( overlap_work* work, const wisp_vec3* points, wisp_error* error )
{
    const wisp_mesh* mesh = &work->world->scene->mesh;
    const wisp_collision_mesh_def def = {
        .points = points,
        .triangles = mesh->triangles,
        .point_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .search = WISP_MESH_SEARCH_VOXELS,
    };
    return wisp_collision_mesh_create( &def, NULL, &work->tree, error );
}

static wisp_status ask( overlap_work* work, int query, contact_overlap* out, wisp_error* error )
{
    const wisp_vec3* points;
    const int count = work->world->scene->mesh.vertex_count;
    const float thickness = work->world->scene->thickness;
    const wisp_status status = contact_points( work->world, query, &points, error );
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        work->queries[v] = ( wisp_mesh_query ){ points[v], PRESS_RADIUS };
    }
    if ( status == WISP_OK )
    {
        wisp_collision_mesh_closest( work->tree, work->queries, count, work->nearest, NULL );
    }
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        const float distance = work->nearest[v].triangle >= 0 ? work->nearest[v].distance : INFINITY;
        out->overlap = fmax( out->overlap, (double)( thickness - distance ) );
        out->missed += distance < 0.5f * thickness ? 1 : 0;
        work->distances[v] = query == 0 ? fminf( work->distances[v], distance ) : work->distances[v];
    }
    return status;
}

// The wall of the first surface to another one.
static wisp_status observe_wall( overlap_work* work, contact_overlap* out, wisp_error* error )
{
    static const float NEXT_TO = 1.5f; // thicknesses
    const wisp_vec3* points;
    const float within = NEXT_TO * work->world->scene->thickness;
    const wisp_status status = contact_points( work->world, 0, &points, error );
    double sum = 0.0, squares = 0.0, farthest = 0.0;
    for ( int v = 0; v < work->world->scene->mesh.vertex_count && status == WISP_OK; ++v )
    {
        if ( work->distances[v] < within )
        {
            const double x = (double)points[v].x, y = (double)points[v].y, z = (double)points[v].z;
            sum += x;
            squares += x * x;
            farthest = fmax( farthest, sqrt( y * y + z * z ) );
            ++out->touching;
        }
    }
    const double mean = sum / out->touching;
    out->unevenness = out->touching > 0 ? sqrt( fmax( squares / out->touching - mean * mean, 0.0 ) ) : NAN;
    out->patch = out->touching > 0 ? farthest : NAN;
    return status;
}

static wisp_status find( overlap_work* work, contact_overlap* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int queried = 0; queried < work->world->surface_count && status == WISP_OK; ++queried )
    {
        const wisp_vec3* points;
        status = contact_points( work->world, queried, &points, error );
        status = status == WISP_OK ? build( work, points, error ) : status;
        for ( int query = 0; query < work->world->surface_count && status == WISP_OK; ++query )
        {
            status = query != queried ? ask( work, query, out, error ) : WISP_OK;
        }
        wisp_collision_mesh_release( work->tree );
        work->tree = NULL;
    }
    return status == WISP_OK ? observe_wall( work, out, error ) : status;
}

wisp_status contact_find_overlap( contact_world* world, contact_overlap* out, wisp_error* error )
{
    const size_t count = (size_t)world->scene->mesh.vertex_count;
    overlap_work work = {
        .world = world,
        .queries = malloc( count * sizeof( wisp_mesh_query ) ),
        .nearest = malloc( count * sizeof( wisp_mesh_nearest ) ),
        .distances = malloc( count * sizeof( float ) ),
    };
    *out = ( contact_overlap ){ .overlap = 0.0 };
    wisp_status status = work.queries && work.nearest && work.distances
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory to measure how deep surfaces overlap" );
    for ( size_t v = 0; v < count && status == WISP_OK; ++v )
    {
        work.distances[v] = INFINITY;
    }
    status = status == WISP_OK ? find( &work, out, error ) : status;
    free( work.queries );
    free( work.nearest );
    free( work.distances );
    return status;
}
