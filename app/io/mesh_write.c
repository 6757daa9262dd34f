// Writes meshes: OBJ for readers and modelling programs, little-endian PLY for size and speed.
#include "mesh_internal.h"

#include <math.h>

#include "io_bytes.h"
#include "io_file.h"

#include "wisp/module/definition.h"

// Nine digits restore every float bit for bit.
static void put_obj_vertex( FILE* out, const wisp_mesh* mesh, int v )
{
    const wisp_vec3 p = mesh->points[v];
    fprintf( out, "v %.9g %.9g %.9g", (double)p.x, (double)p.y, (double)p.z );
    if ( mesh->colours != NULL )
    {
        const wisp_vec3 c = mesh->colours[v];
        fprintf( out, " %.9g %.9g %.9g", (double)c.x, (double)c.y, (double)c.z );
    }
    fputc( '\n', out );
}

wisp_status mesh_put_obj( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    WISP_TRY( mesh_check( mesh, name, error ) );
    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    fprintf( out, "# Wisp %s: %d vertices, %d triangles, metres\n", WISP_VERSION_STRING, mesh->vertex_count,
             mesh->triangle_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        put_obj_vertex( out, mesh, v );
    }
    for ( int v = 0; mesh->uvs != NULL && v < mesh->vertex_count; ++v )
    {
        fprintf( out, "vt %.9g %.9g\n", (double)mesh->uvs[2 * v], (double)mesh->uvs[2 * v + 1] );
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int a = mesh->triangles[3 * t] + 1, b = mesh->triangles[3 * t + 1] + 1,
                  c = mesh->triangles[3 * t + 2] + 1;
        mesh->uvs != NULL ? fprintf( out, "f %d/%d %d/%d %d/%d\n", a, a, b, b, c, c )
                          : fprintf( out, "f %d %d %d\n", a, b, c );
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

// A byte is read back as this float.
static float colour_of_byte( int byte )
{
    return (float)( (double)byte / 255.0 );
}

static int byte_of_colour( float channel )
{
    return (int)( 255.0f * fminf( fmaxf( channel, 0.0f ), 1.0f ) + 0.5f );
}

// Whether bytes, which most readers expect, restore every colour bit for bit.
static bool colours_are_bytes( const wisp_mesh* mesh )
{
    bool same = true;
    for ( int v = 0; mesh->colours != NULL && v < mesh->vertex_count; ++v )
    {
        const float c[3] = { mesh->colours[v].x, mesh->colours[v].y, mesh->colours[v].z };
        for ( int k = 0; k < 3; ++k )
        {
            same = same && colour_of_byte( byte_of_colour( c[k] ) ) == c[k] && !signbit( c[k] );
        }
    }
    return same;
}

static void put_ply_vertex( FILE* out, const wisp_mesh* mesh, int v, bool bytes )
{
    unsigned char row[32];
    size_t size = 12;
    io_put_vec3( row, mesh->points[v] );
    if ( mesh->colours != NULL && bytes )
    {
        const wisp_vec3 c = mesh->colours[v];
        row[size] = (unsigned char)byte_of_colour( c.x );
        row[size + 1] = (unsigned char)byte_of_colour( c.y );
        row[size + 2] = (unsigned char)byte_of_colour( c.z );
        size += 3;
    }
    else if ( mesh->colours != NULL )
    {
        io_put_vec3( row + size, mesh->colours[v] );
        size += 12;
    }
    if ( mesh->uvs != NULL )
    {
        io_put_float( row + size, mesh->uvs[2 * v] );
        io_put_float( row + size + 4, mesh->uvs[2 * v + 1] );
        size += 8;
    }
    fwrite( row, 1, size, out );
}

wisp_status mesh_put_ply( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    WISP_TRY( mesh_check( mesh, name, error ) );
    const bool bytes = colours_are_bytes( mesh );
    fprintf( out,
             "ply\nformat binary_little_endian 1.0\ncomment Wisp %s, metres\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n",
             WISP_VERSION_STRING, mesh->vertex_count );
    if ( mesh->colours != NULL )
    {
        const char* type = bytes ? "uchar" : "float";
        fprintf( out, "property %s red\nproperty %s green\nproperty %s blue\n", type, type, type );
    }
    fprintf( out, "%selement face %d\nproperty list uchar int vertex_indices\nend_header\n",
             mesh->uvs != NULL ? "property float s\nproperty float t\n" : "", mesh->triangle_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        put_ply_vertex( out, mesh, v, bytes );
    }
    mesh_put_triangles( out, mesh );
    return WISP_OK;
}
