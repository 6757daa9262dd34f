#include "image.h"

#include "io_file.h"

#include <png.h>

// libpng's simplified interface: it catches internal errors and returns a message.
static wisp_status write_to( FILE* stream, const char* path, const image* picture, wisp_error* error )
{
    png_image png = { .version = PNG_IMAGE_VERSION };
    png.width = (png_uint_32)picture->width;
    png.height = (png_uint_32)picture->height;
    png.format = PNG_FORMAT_RGB;
    int good = png_image_write_to_stdio( &png, stream, 0, picture->rgb, 3 * picture->width, NULL );
    png_image_free( &png );
    if ( good == 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: cannot write the picture: %s", io_short_name( path ),
                          png.message );
    }
    return WISP_OK;
}

wisp_status image_write_png( const char* path, const image* picture, wisp_error* error )
{
    if ( picture->rgb == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: an empty picture is not written", io_short_name( path ) );
    }
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    return status == WISP_OK ? io_output_end( &output, write_to( output.stream, path, picture, error ), error )
                             : status;
}
