// What formats for pictures have in common: normals, vectors at split vertices, and a colour for bodies without one.
#include "record_internal.h"

#include <math.h>

// In double: the edges of small triangles far from the origin are exact, and their products do not overflow.
static void add_triangle( double* sums, const wisp_vec3* points, const int32_t* corner )
{
    const wisp_vec3 a = points[corner[0]], b = points[corner[1]], c = points[corner[2]];
    const double p[3] = { (double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z };
    const double q[3] = { (double)c.x - (double)a.x, (double)c.y - (double)a.y, (double)c.z - (double)a.z };
    for ( int k = 0; k < 3; ++k )
    {
        const int i = ( k + 1 ) % 3, j = ( k + 2 ) % 3;
        const double n = p[i] * q[j] - p[j] * q[i];
        sums[3 * (size_t)corner[0] + (size_t)k] += n;
        sums[3 * (size_t)corner[1] + (size_t)k] += n;
        sums[3 * (size_t)corner[2] + (size_t)k] += n;
    }
}

const wisp_vec3* record_normals( const wisp_recorder* recorder, int b, const wisp_vec3* points )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    double* sums = recorder->normal_sums;
    memset( sums, 0, 3 * (size_t)body->vertex_count * sizeof *sums );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        add_triangle( sums, points, body->triangles + 3 * (size_t)t );
    }
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        const double* n = sums + 3 * (size_t)v;
        const double length = sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
        recorder->normals[v] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        if ( length > 0.0 )
        {
            recorder->normals[v] =
                ( wisp_vec3 ){ (float)( n[0] / length ), (float)( n[1] / length ), (float)( n[2] / length ) };
        }
    }
    return recorder->normals;
}

void record_carry_corners( const wisp_record_body* body, const int32_t* now, const int32_t* later,
                           wisp_vec3* vectors )
{
    for ( size_t i = 0; i < 3 * (size_t)body->triangle_count; ++i )
    {
        vectors[later[i]] = vectors[now[i]];
    }
}

wisp_vec3 record_base_colour( const wisp_record_body* body )
{
    const wisp_vec3 c = body->base_colour;
    return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f ? c : ( wisp_vec3 ){ 0.6f, 0.6f, 0.6f };
}
