// Writes a mesh with points on its edges and inside its triangles as PLY, which has room for normals and element
// numbers, and which readers of plain meshes can still read.
#include "mesh_internal.h"

#include <math.h>
#include <string.h>

#include "io_bytes.h"
#include "io_file.h"

enum
{
    VERTEX_ROW = 28, // six floats and an int
    EDGE_ROW = 8,
};

// ---- checks ----------------------------------------------------------------------------------------------------

static int element_of( const wisp_mesh_layer* layer, int point )
{
    int32_t element;
    memcpy( &element, layer->points + 4 * (size_t)point + 3, sizeof element );
    return element;
}

static bool is_finite( const float* three )
{
    return isfinite( three[0] ) && isfinite( three[1] ) && isfinite( three[2] );
}

static wisp_status check_points( const wisp_mesh* mesh, const wisp_mesh_layer* layer, const char* name,
                                 wisp_error* error )
{
    const int64_t elements = (int64_t)layer->edge_count + mesh->triangle_count;
    for ( int i = 0; i < layer->point_count; ++i )
    {
        const size_t at = 4 * (size_t)i;
        if ( !is_finite( layer->points + at ) || !is_finite( layer->point_normals + at ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: the %s of point %d is not finite", name,
                              is_finite( layer->points + at ) ? "normal" : "place", i );
        }
        const int element = element_of( layer, i );
        if ( element < 0 || element >= elements )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: point %d is on element %d of %lld", name, i, element,
                              (long long)elements );
        }
    }
    return WISP_OK;
}

static wisp_status check_layer( const wisp_mesh* mesh, const wisp_mesh_layer* layer, const char* name,
                                wisp_error* error )
{
    if ( layer->point_count < 0 || layer->edge_count < 0 ||
         (int64_t)mesh->vertex_count + layer->point_count > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: %d vertices and %d points are more than the %d that are read back", name,
                          mesh->vertex_count, layer->point_count, WISP_MESH_VERTEX_CAP );
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 n = layer->normals[v];
        if ( !is_finite( ( const float[] ){ n.x, n.y, n.z } ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: the normal of vertex %d is not finite", name, v );
        }
    }
    for ( size_t k = 0; k < 2 * (size_t)layer->edge_count; ++k )
    {
        if ( layer->edges[k] < 0 || layer->edges[k] >= mesh->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: edge %zu: got vertex %d, expected 0 .. %d", name, k / 2,
                              (int)layer->edges[k], mesh->vertex_count - 1 );
        }
    }
    return check_points( mesh, layer, name, error );
}

// ---- rows ------------------------------------------------------------------------------------------------------

static void put_row( FILE* out, const float* place, const float* normal, int element )
{
    unsigned char row[VERTEX_ROW];
    for ( int k = 0; k < 3; ++k )
    {
        io_put_float( row + 4 * k, place[k] );
        io_put_float( row + 12 + 4 * k, normal[k] );
    }
    io_put_u32( row + 24, (uint32_t)element );
    fwrite( row, 1, sizeof row, out );
}

static void put_layer( FILE* out, const wisp_mesh* mesh, const wisp_mesh_layer* layer )
{
    fprintf( out,
             "ply\nformat binary_little_endian 1.0\ncomment Wisp %s, metres\n"
             "comment %d vertices, then %d points on elements: edges first, then triangles\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nproperty int element\n"
             "element face %d\nproperty list uchar int vertex_indices\n"
             "element edge %d\nproperty int vertex1\nproperty int vertex2\nend_header\n",
             WISP_VERSION_STRING, mesh->vertex_count, layer->point_count, mesh->vertex_count + layer->point_count,
             mesh->triangle_count, layer->edge_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v], n = layer->normals[v];
        put_row( out, ( const float[] ){ p.x, p.y, p.z }, ( const float[] ){ n.x, n.y, n.z }, -1 );
    }
    for ( int i = 0; i < layer->point_count; ++i )
    {
        const size_t at = 4 * (size_t)i;
        put_row( out, layer->points + at, layer->point_normals + at, element_of( layer, i ) );
    }
    mesh_put_triangles( out, mesh );
    for ( int e = 0; e < layer->edge_count; ++e )
    {
        unsigned char row[EDGE_ROW];
        const int32_t* edge = layer->edges + 2 * (size_t)e;
        io_put_u32( row, (uint32_t)edge[0] );
        io_put_u32( row + 4, (uint32_t)edge[1] );
        fwrite( row, 1, sizeof row, out );
    }
}

wisp_status wisp_mesh_write_layer( const char* path, const wisp_mesh* mesh, const wisp_mesh_layer* layer,
                                   wisp_error* error )
{
    const char* name = io_short_name( path );
    wisp_status status = mesh_check( mesh, name, error );
    status = status == WISP_OK ? check_layer( mesh, layer, name, error ) : status;
    io_output output;
    status = status == WISP_OK ? io_output_open( path, &output, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    put_layer( output.stream, mesh, layer );
    return io_output_commit( &output, error );
}
