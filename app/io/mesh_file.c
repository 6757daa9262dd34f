// The format of a path; reading and writing of whole files.
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

#include "gltf.h"
#include "io_file.h"

typedef wisp_status mesh_reader( const void* bytes, size_t size, const char* name, wisp_mesh* out,
                                 wisp_error* error );
typedef wisp_status mesh_writer( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error );

typedef struct mesh_format
{
    const char* extension;
    mesh_reader* read;
    mesh_writer* write;
} mesh_format;

static const mesh_format formats[] = {
    { ".obj", wisp_mesh_read_obj, mesh_put_obj },
    { ".ply", wisp_mesh_read_ply, mesh_put_ply },
};

static const mesh_format* find_format( const char* path )
{
    for ( int i = 0; i < WISP_COUNT( formats ); ++i )
    {
        if ( io_has_extension( path, formats[i].extension ) )
        {
            return &formats[i];
        }
    }
    return NULL;
}

wisp_status wisp_mesh_read( const char* path, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    const bool has_name = !io_is_standard( path );
    if ( gltf_is_path( path ) )
    {
        return gltf_mesh_read( path, out, error );
    }
    const mesh_format* format = find_format( path );
    if ( format == NULL && has_name )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: not a mesh, expected a file that ends in .obj, .ply, .glb or .gltf",
                          io_short_name( path ) );
    }
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, WISP_MESH_FILE_CAP, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        // Standard input has no extension, but a PLY begins with its name.
        format = has_name ? format : &formats[size >= 3 && memcmp( bytes, "ply", 3 ) == 0 ? 1 : 0];
        status = format->read( bytes, size, io_input_name( path ), out, error );
    }
    free( bytes );
    return status;
}

static wisp_status write_file( const char* path, mesh_writer* write, const wisp_mesh* mesh, wisp_error* error )
{
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    return status == WISP_OK ? io_output_end( &output, write( output.stream, mesh, path, error ), error ) : status;
}

wisp_status wisp_mesh_write_obj( const char* path, const wisp_mesh* mesh, wisp_error* error )
{
    return write_file( path, mesh_put_obj, mesh, error );
}

wisp_status wisp_mesh_write_ply( const char* path, const wisp_mesh* mesh, wisp_error* error )
{
    return write_file( path, mesh_put_ply, mesh, error );
}

wisp_status wisp_mesh_write( const char* path, const wisp_mesh* mesh, wisp_error* error )
{
    const mesh_format* format = find_format( path );
    if ( format == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a file that ends in .obj or .ply",
                          io_short_name( path ) );
    }
    return write_file( path, format->write, mesh, error );
}
