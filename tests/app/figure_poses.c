// Write the posed figure as meshes, to look at, and print how it stands: figure_poses MOTIONS.yaml CLIP COUNT TRIANGLES PREFIX
#include "figure.h"

#include "wisp/module/intersections.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int count_intersections( const wisp_mesh* mesh, int32_t* edges, int edge_count, const wisp_vec3* points )
{
    float* xyzw = calloc( 4 * (size_t)mesh->vertex_count, sizeof *xyzw );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        memcpy( xyzw + 4 * v, &points[v], sizeof( wisp_vec3 ) );
    }
    const wisp_intersection_args args = { .xyzw = xyzw,
                                          .edges = edges,
                                          .edge_count = edge_count,
                                          .triangles = mesh->triangles,
                                          .triangle_count = mesh->triangle_count };
    wisp_intersections found = { 0 };
    const int count =
        wisp_intersections_find( &found, NULL, &args, NULL ) == WISP_OK ? found.count : -1;
    for ( int i = 0; i < count && i < 3; ++i )
    {
        const wisp_vec3 p = points[edges[2 * found.list[i].edge]], q = mesh->points[edges[2 * found.list[i].edge]];
        printf( "    at (%.3f, %.3f, %.3f), at rest (%.3f, %.3f, %.3f)\n", (double)p.x, (double)p.y, (double)p.z,
                (double)q.x, (double)q.y, (double)q.z );
    }
    wisp_intersections_release( &found, NULL );
    free( xyzw );
    return count;
}

int main( int argc, char** argv )
{
    if ( argc != 6 )
    {
        return 2;
    }
    wisp_figure_generator generator = wisp_default_figure_generator();
    generator.triangle_count = atoi( argv[4] );
    wisp_figure figure;
    wisp_animation clip = { 0 };
    wisp_skin* skin = NULL;
    wisp_error error = { 0 };
    FILE* file = fopen( argv[1], "rb" );
    static char text[1 << 20];
    const size_t size = file != NULL ? fread( text, 1, sizeof( text ), file ) : 0;
    if ( wisp_figure_generate( &generator, &figure, &error ) != WISP_OK ||
         wisp_animation_parse( text, size, argv[1], argv[2], &figure.skeleton, 1.0f, &clip, &error ) != WISP_OK ||
         wisp_skeleton_skin( &figure.skeleton, figure.mesh.points, &figure.weights, &skin, &error ) != WISP_OK )
    {
        fprintf( stderr, "%s\n", error.message );
        return 2;
    }
    int32_t* edges = malloc( 3 * (size_t)figure.mesh.triangle_count * sizeof *edges );
    int edge_count = 0;
    for ( int c = 0; c < 3 * figure.mesh.triangle_count; ++c )
    {
        const int32_t a = figure.mesh.triangles[c], b = figure.mesh.triangles[c % 3 == 2 ? c - 2 : c + 1];
        if ( a < b )
        {
            edges[2 * edge_count] = a;
            edges[2 * edge_count++ + 1] = b;
        }
    }
    wisp_mesh posed = figure.mesh;
    posed.points = malloc( (size_t)posed.vertex_count * sizeof *posed.points );
    wisp_affine joints[64];
    wisp_skin_pose pose = { 0 };
    const int count = atoi( argv[3] );
    for ( int i = 0; i < count; ++i )
    {
        const float time = clip.duration * (float)i / (float)( clip.loops ? count : count - 1 );
        wisp_skeleton_pose( &figure.skeleton, &clip, time, joints );
        for ( int method = 0; method < 2; ++method )
        {
            if ( wisp_skin_points( skin, &pose, (wisp_skin_method)method, joints, posed.points, &error ) != WISP_OK )
            {
                fprintf( stderr, "%s\n", error.message );
                return 2;
            }
            float lowest = 1e9f;
            for ( int v = 0; v < posed.vertex_count; ++v )
            {
                lowest = posed.points[v].y < lowest ? posed.points[v].y : lowest;
            }
            const int crossed = count_intersections( &figure.mesh, edges, edge_count, posed.points );
            printf( "%s %.3f s, %s: lowest %.3f m, %d intersections\n", argv[2], (double)time,
                    method == 0 ? "linear" : "dual quaternions", (double)lowest, crossed );
        }
        char name[512];
        snprintf( name, sizeof( name ), "%s_%02d.obj", argv[5], i );
        wisp_mesh_write( name, &posed, &error );
    }
    free( edges );
    free( posed.points );
    wisp_skin_pose_release( &pose, NULL );
    wisp_skin_release( skin );
    wisp_animation_release( &clip );
    wisp_figure_release( &figure );
    return 0;
}
