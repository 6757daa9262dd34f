/// Pictures written by a program.
#pragma once

#include "unit.h"

#include <png.h>

typedef struct picture
{
    int width, height;
    unsigned char* rgb; ///< [height][width][3]
} picture;

static inline picture read_picture( const char* path )
{
    png_image info = { .version = PNG_IMAGE_VERSION };
    if ( !png_image_begin_read_from_file( &info, path ) )
    {
        fail_msg( "%s: %s", path, info.message );
    }
    info.format = PNG_FORMAT_RGB;
    picture out = { (int)info.width, (int)info.height, malloc( PNG_IMAGE_SIZE( info ) ) };
    assert_non_null( out.rgb );
    assert_true( png_image_finish_read( &info, NULL, out.rgb, 0, NULL ) != 0 );
    return out;
}
