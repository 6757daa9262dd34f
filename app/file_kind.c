#include "file_kind.h"

#include "gltf.h"
#include "io_file.h"
#include "results_read.h"

#include <errno.h>
#include <string.h>

#define HEAD_BYTES 4096

static bool begins_with( const char* head, size_t size, const char* start, size_t length )
{
    return size >= length && memcmp( head, start, length ) == 0;
}

static file_kind kind_of( const char* path, const char* head, size_t size )
{
    static const struct
    {
        const char* extension;
        file_kind kind;
    } names[] = {
        { ".hair", FILE_GROOM }, { ".obj", FILE_MESH },       { ".ply", FILE_MESH },        { ".yaml", FILE_SCENE },
        { ".yml", FILE_SCENE },  { ".wisp", FILE_RECORDING }, { ".pc2", FILE_POINT_CACHE }, { ".json", FILE_SCENE },
    };
    if ( begins_with( head, size, "HAIR", 4 ) )
    {
        return FILE_GROOM;
    }
    if ( begins_with( head, size, "WISP\r\n\x1a\n", 8 ) )
    {
        return FILE_RECORDING;
    }
    if ( begins_with( head, size, "POINTCACHE2", 12 ) )
    {
        return FILE_POINT_CACHE;
    }
    if ( io_has_extension( path, ".json" ) && info_is_results( head, size ) )
    {
        return FILE_RESULTS;
    }
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        if ( io_has_extension( path, names[i].extension ) )
        {
            return names[i].kind;
        }
    }
    return FILE_UNKNOWN;
}

// Whether a line is one of an OBJ file: a keyword and a blank, where a scene has a key and a colon.
static bool is_obj_line( const char* line, size_t length )
{
    static const char* const words[] = { "v", "vn", "vt", "f", "l", "o", "g", "s", "mtllib", "usemtl" };
    const size_t word = strcspn( line, " \t\r\n" );
    bool is_one = false;
    for ( int i = 0; i < WISP_COUNT( words ) && word < length; ++i )
    {
        is_one = is_one || ( strlen( words[i] ) == word && memcmp( line, words[i], word ) == 0 );
    }
    return is_one;
}

// Standard input has no name. Its first line that is no comment tells a mesh from a scene and from results.
// @param head [size], with a zero behind it
static file_kind kind_of_text( const char* head, size_t size )
{
    if ( begins_with( head, size, "ply", 3 ) )
    {
        return FILE_MESH;
    }
    const char* line = head;
    while ( *line == '#' || *line == '\n' || *line == '\r' || *line == ' ' )
    {
        line += *line == '#' ? strcspn( line, "\n" ) : 1;
    }
    if ( *line == '{' && info_is_results( head, size ) )
    {
        return FILE_RESULTS;
    }
    const bool is_text = memchr( head, '\0', size ) == NULL;
    return !is_text ? FILE_UNKNOWN : is_obj_line( line, size - (size_t)( line - head ) ) ? FILE_MESH : FILE_SCENE;
}

wisp_status file_kind_find( const char* path, file_kind* kind, wisp_error* error )
{
    // The name of a mesh may follow that of the file, so only the extension decides; the reader reports the rest.
    if ( gltf_is_path( path ) )
    {
        *kind = FILE_MESH;
        return WISP_OK;
    }
    const int descriptor = io_file_open( path, 0, HEAD_BYTES );
    FILE* file = descriptor >= 0 ? fdopen( descriptor, "rb" ) : NULL;
    if ( !file )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_input_name( path ), strerror( errno ) );
    }
    char head[HEAD_BYTES + 1];
    size_t size = fread( head, 1, sizeof( head ) - 1, file );
    head[size] = '\0';
    bool failed = ferror( file ) != 0;
    int cause = errno;
    fclose( file );
    if ( failed )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_input_name( path ), strerror( cause ) );
    }
    *kind = io_is_standard( path ) ? kind_of_text( head, size ) : FILE_UNKNOWN;
    *kind = *kind != FILE_UNKNOWN ? *kind : kind_of( path, head, size );
    return WISP_OK;
}
