#include "file_kind.h"

#include "info_results.h"
#include "io_file.h"

#include <errno.h>
#include <string.h>

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
        { ".hair", FILE_GROOM },     { ".tfx", FILE_GROOM },       { ".obj", FILE_MESH },
        { ".ply", FILE_MESH },       { ".yaml", FILE_SCENE },      { ".yml", FILE_SCENE },
        { ".wisp", FILE_RECORDING }, { ".pc2", FILE_POINT_CACHE }, { ".json", FILE_SCENE },
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

wisp_status file_kind_find( const char* path, file_kind* kind, wisp_error* error )
{
    FILE* file = fopen( path, "rb" );
    if ( !file )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", path, strerror( errno ) );
    }
    char head[4096];
    size_t size = fread( head, 1, sizeof( head ), file );
    bool failed = ferror( file ) != 0;
    int cause = errno;
    fclose( file );
    if ( failed )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", path, strerror( cause ) );
    }
    *kind = kind_of( path, head, size );
    return WISP_OK;
}
