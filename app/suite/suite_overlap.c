#include "suite_overlap.h"

#include "wisp/module/collision_mesh.h"

#include <math.h>
#include <stdlib.h>

// A balloon after the last step.
typedef struct balloon
{
    wisp_vec3* points; // [count]
    int count;
    float thickness, reach; // m, what it keeps apart; half of its smallest extent
    double centre[3];       // m
    wisp_collision_mesh* mesh;
} balloon;

typedef struct work
{
    balloon* balloons; // [count]
    int count, largest;
    wisp_mesh_query* queries;   // [largest]
    wisp_mesh_nearest* nearest; // [largest]
} work;

// As contact has it.
static float thickness_of( const scene_world* world, int surface )
{
    const wisp_fabric* fabric = world->surfaces[surface].fabric;
    const float given = world->scene->surfaces[surface].contact.thickness;
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double x = (double)( a.x - b.x ), y = (double)( a.y - b.y ), z = (double)( a.z - b.z );
        sum += sqrt( x * x + y * y + z * z );
    }
    return given > 0.0f ? given : (float)( 0.25 * sum / fabric->edge_count );
}

static void measure( balloon* b )
{
    wisp_vec3 low = b->points[0], high = low;
    for ( int v = 0; v < b->count; ++v )
    {
        const wisp_vec3 p = b->points[v];
        low = ( wisp_vec3 ){ fminf( low.x, p.x ), fminf( low.y, p.y ), fminf( low.z, p.z ) };
        high = ( wisp_vec3 ){ fmaxf( high.x, p.x ), fmaxf( high.y, p.y ), fmaxf( high.z, p.z ) };
        b->centre[0] += (double)p.x / b->count;
        b->centre[1] += (double)p.y / b->count;
        b->centre[2] += (double)p.z / b->count;
    }
    b->reach = 0.5f * fminf( high.x - low.x, fminf( high.y - low.y, high.z - low.z ) );
}

static wisp_status add_balloon( const scene_world* world, int surface, work* w, wisp_error* error )
{
    const int number = world->scene->strands_count + surface;
    const scene_body body = scene_world_body( world, number );
    balloon* b = &w->balloons[w->count++];
    *b = ( balloon ){ .points = malloc( (size_t)body.vertex_count * sizeof( wisp_vec3 ) ),
                      .count = body.vertex_count };
    w->largest = body.vertex_count > w->largest ? body.vertex_count : w->largest;
    wisp_status status = b->points ? scene_world_points( world, number, b->points, error )
                                   : wisp_fail( error, WISP_NO_MEMORY, "no memory to measure how balloons overlap" );
    if ( status == WISP_OK )
    {
        b->thickness = thickness_of( world, surface );
        measure( b );
        const wisp_collision_mesh_def def = {
            .points = b->points,
            .triangles = body.triangles,
            .point_count = body.vertex_count,
            .triangle_count = body.triangle_count,
            .deforms = true,
        };
        status = wisp_collision_mesh_create( &def, NULL, &b->mesh, error );
    }
    return status;
}

static float distance_from( const wisp_mesh_nearest* nearest )
{
    return nearest->triangle >= 0 ? nearest->distance : INFINITY;
}

// Distances of the vertices of one balloon from another, into `nearest`.
static void ask( work* w, const balloon* from, const balloon* to )
{
    for ( int v = 0; v < from->count; ++v )
    {
        w->queries[v] = ( wisp_mesh_query ){ .point = from->points[v], .radius = to->reach };
    }
    wisp_collision_mesh_closest( to->mesh, w->queries, from->count, w->nearest, NULL );
}

static void find_depth( work* w, suite_overlap* out )
{
    int missed = 0, vertices = 0;
    for ( int i = 0; i < w->count * w->count; ++i )
    {
        const balloon *from = &w->balloons[i / w->count], *to = &w->balloons[i % w->count];
        const float thickness = 0.5f * ( from->thickness + to->thickness );
        if ( from == to )
        {
            vertices += from->count;
            continue;
        }
        ask( w, from, to );
        for ( int v = 0; v < from->count; ++v )
        {
            const float distance = distance_from( &w->nearest[v] );
            out->depth = fmax( out->depth, (double)( thickness - distance ) );
            missed += distance < 0.5f * thickness ? 1 : 0;
        }
    }
    out->missed = (double)missed / vertices;
}

static void find_wall( work* w, suite_overlap* out )
{
    static const float NEXT_TO = 1.5f; // thicknesses
    const balloon *one = &w->balloons[0], *other = &w->balloons[1];
    double axis[3], length = 0.0, sum = 0.0, squares = 0.0, farthest = 0.0;
    int count = 0;
    for ( int k = 0; k < 3; ++k )
    {
        axis[k] = other->centre[k] - one->centre[k];
        length += axis[k] * axis[k];
    }
    ask( w, one, other );
    for ( int v = 0; v < one->count; ++v )
    {
        const wisp_vec3 p = one->points[v];
        const double d[3] = { (double)p.x - one->centre[0], (double)p.y - one->centre[1],
                              (double)p.z - one->centre[2] };
        if ( distance_from( &w->nearest[v] ) < NEXT_TO * one->thickness )
        {
            const double along = ( d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] ) / sqrt( length );
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - along * along;
            sum += along;
            squares += along * along;
            farthest = fmax( farthest, sqrt( fmax( square, 0.0 ) ) );
            ++count;
        }
    }
    const double mean = sum / count;
    out->wall_radius = count > 0 ? farthest : NAN;
    out->wall_unevenness = count > 0 ? sqrt( fmax( squares / count - mean * mean, 0.0 ) ) : NAN;
}

wisp_status suite_overlap_find( const scene_world* world, suite_overlap* out, wisp_error* error )
{
    *out = ( suite_overlap ){ .wall_radius = NAN, .wall_unevenness = NAN };
    work w = { .balloons = calloc( (size_t)world->scene->surface_count + 1, sizeof( balloon ) ) };
    wisp_status status = w.balloons ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for balloons" );
    for ( int i = 0; i < world->scene->surface_count && status == WISP_OK; ++i )
    {
        status = world->scene->surfaces[i].has_balloon ? add_balloon( world, i, &w, error ) : WISP_OK;
    }
    w.queries = malloc( (size_t)w.largest * sizeof *w.queries + 1 );
    w.nearest = malloc( (size_t)w.largest * sizeof *w.nearest + 1 );
    if ( status == WISP_OK && ( w.queries == NULL || w.nearest == NULL ) )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory to measure how balloons overlap" );
    }
    if ( status == WISP_OK && w.count > 1 )
    {
        find_depth( &w, out );
        find_wall( &w, out );
    }
    for ( int i = 0; i < w.count; ++i )
    {
        wisp_collision_mesh_release( w.balloons[i].mesh );
        free( w.balloons[i].points );
    }
    free( w.balloons );
    free( w.queries );
    free( w.nearest );
    return status;
}
