// The format of a path; reading and writing of whole files.
#include "groom_internal.h"

#include <stdlib.h>

#include "io_file.h"

static wisp_status read_bytes( const char* path, const unsigned char* bytes, size_t size, wisp_groom* out,
                               wisp_error* error )
{
    bool magic = size >= 4 && memcmp( bytes, "HAIR", 4 ) == 0;
    if ( magic || io_has_extension( path, ".hair" ) )
    {
        return wisp_groom_read_hair( bytes, size, path, out, error );
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: not a groom, expected a file that starts with \"HAIR\" or ends in .hair",
                      io_short_name( path ) );
}

wisp_status wisp_groom_read( const char* path, wisp_groom* out, wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, WISP_GROOM_FILE_CAP, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        status = read_bytes( io_input_name( path ), bytes, size, out, error );
    }
    free( bytes );
    return status;
}

typedef wisp_status groom_writer( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error );

static groom_writer* find_writer( const char* path )
{
    static const struct
    {
        const char* extension;
        groom_writer* write;
    } formats[] = {
        { ".hair", wisp_groom_write_hair },
        { ".usda", wisp_groom_write_usda },
        { ".obj", wisp_groom_write_obj },
    };
    for ( int i = 0; i < WISP_COUNT( formats ); ++i )
    {
        if ( io_has_extension( path, formats[i].extension ) )
        {
            return formats[i].write;
        }
    }
    return NULL;
}

wisp_status wisp_groom_write( const char* path, const wisp_groom* groom, wisp_error* error )
{
    groom_writer* write = find_writer( path );
    if ( write == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a file that ends in .hair, .usda or .obj",
                          io_short_name( path ) );
    }
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    return status == WISP_OK ? io_output_end( &output, write( output.stream, groom, path, error ), error ) : status;
}
