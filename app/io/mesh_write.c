// Writes meshes: OBJ for readers and modelling programs, little-endian PLY for size and speed.
#include "mesh_internal.h"

#include "io_bytes.h"
#include "io_file.h"

wisp_status mesh_put_obj( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    wisp_status status = mesh_check( mesh, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    io_numbers numbers;
    status = io_numbers_begin( &numbers, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    fprintf( out, "# Wisp %s: %d vertices, %d triangles, metres\n", WISP_VERSION_STRING, mesh->vertex_count,
             mesh->triangle_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        wisp_vec3 p = mesh->points[v];
        // Nine digits restore every float bit for bit.
        fprintf( out, "v %.9g %.9g %.9g\n", (double)p.x, (double)p.y, (double)p.z );
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* triangle = mesh->triangles + 3 * t;
        fprintf( out, "f %d %d %d\n", triangle[0] + 1, triangle[1] + 1, triangle[2] + 1 );
    }
    io_numbers_end( &numbers );
    return WISP_OK;
}

void mesh_put_triangles( FILE* out, const wisp_mesh* mesh )
{
    unsigned char row[13];
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* triangle = mesh->triangles + 3 * t;
        row[0] = 3;
        for ( int k = 0; k < 3; ++k )
        {
            io_put_u32( row + 1 + 4 * k, (uint32_t)triangle[k] );
        }
        fwrite( row, 1, sizeof row, out );
    }
}

wisp_status mesh_put_ply( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    wisp_status status = mesh_check( mesh, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    fprintf( out,
             "ply\nformat binary_little_endian 1.0\ncomment Wisp %s, metres\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
             "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
             WISP_VERSION_STRING, mesh->vertex_count, mesh->triangle_count );
    unsigned char row[12];
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        io_put_vec3( row, mesh->points[v] );
        fwrite( row, 1, sizeof row, out );
    }
    mesh_put_triangles( out, mesh );
    return WISP_OK;
}
