#include "report_data.h"

#include "base64.h"
#include "io_file.h"
#include "report_text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// ---- reading ----

typedef struct picture_bytes
{
    unsigned char* bytes;
    size_t size;
    unsigned width, height; ///< pixels
} picture_bytes;

static unsigned read_big_endian( const unsigned char* b )
{
    return (unsigned)b[0] << 24 | (unsigned)b[1] << 16 | (unsigned)b[2] << 8 | b[3];
}

// Its beginning, its size and its end: enough that a browser does not get another file or half a picture.
static bool check_png( picture_bytes* picture )
{
    static const unsigned char head[16] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n',
                                            0,    0,   0,   13,  'I',  'H',  'D',  'R' };
    static const unsigned char tail[12] = { 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82 };
    if ( picture->size < sizeof( head ) + 17 + sizeof( tail ) ||
         memcmp( picture->bytes, head, sizeof( head ) ) != 0 ||
         memcmp( picture->bytes + picture->size - sizeof( tail ), tail, sizeof( tail ) ) != 0 )
    {
        return false;
    }
    picture->width = read_big_endian( picture->bytes + 16 );
    picture->height = read_big_endian( picture->bytes + 20 );
    return picture->width - 1 < 0x7fffffffu && picture->height - 1 < 0x7fffffffu;
}

// @return null, or the error
static const char* read_stream( FILE* file, picture_bytes* out )
{
    struct stat info;
    if ( fstat( fileno( file ), &info ) != 0 || !S_ISREG( info.st_mode ) )
    {
        return "it is not a file";
    }
    if ( info.st_size > REPORT_PICTURE_BYTES_MAX )
    {
        return "it is larger than 16 MB";
    }
    out->bytes = malloc( (size_t)info.st_size + 1 );
    if ( !out->bytes )
    {
        return "there is no memory for it";
    }
    out->size = fread( out->bytes, 1, (size_t)info.st_size, file );
    if ( ferror( file ) )
    {
        return strerror( errno );
    }
    return check_png( out ) ? NULL : "it is not a whole PNG";
}

static const char* read_picture( const char* path, picture_bytes* out )
{
    // Opening a pipe would wait for a writer, so the type of the file is checked first.
    struct stat info;
    if ( stat( path, &info ) != 0 )
    {
        return strerror( errno );
    }
    FILE* file = S_ISREG( info.st_mode ) ? fopen( path, "rb" ) : NULL;
    if ( !file )
    {
        return S_ISREG( info.st_mode ) ? strerror( errno ) : "it is not a file";
    }
    const char* wrong = read_stream( file, out );
    fclose( file );
    return wrong;
}

// ---- writing ----

void report_put_picture( const results_picture* picture, int number, FILE* stream )
{
    picture_bytes content = { .bytes = NULL };
    const char* wrong = read_picture( picture->path, &content );
    fprintf( stream, "<figure class=\"card picture\" id=\"picture-%d\">\n", number );
    if ( wrong )
    {
        fputs( "<p class=\"empty\">The picture ", stream );
        // Folders depend on the machine, the name does not.
        report_put_text( io_file_name( picture->path ), stream );
        fputs( " cannot be shown: ", stream );
        report_put_text( wrong, stream );
        fputs( ".</p>\n", stream );
    }
    else
    {
        fprintf( stream, "<img width=\"%u\" height=\"%u\" alt=\"", content.width, content.height );
        report_put_text( picture->caption, stream );
        fputs( "\" src=\"data:image/png;base64,", stream );
        io_base64 picture_text = { .out = stream };
        io_base64_put( &picture_text, content.bytes, content.size );
        io_base64_end( &picture_text );
        fputs( "\"/>\n", stream );
    }
    fputs( "<figcaption>", stream );
    report_put_text( picture->caption, stream );
    fputs( "</figcaption>\n</figure>\n", stream );
    free( content.bytes );
}
