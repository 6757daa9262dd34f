// Shared by all files of recordings: messages, and paths next to a path.
#include "record_internal.h"

#include <errno.h>
#include <stdlib.h>

// ---- messages -------------------------------------------------------------------------------------------------

wisp_status record_no_memory( const char* name, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the recording", io_short_name( name ) );
}

wisp_status record_refused( const char* path, const char* what, wisp_error* error )
{
    return wisp_fail( error, WISP_IO_ERROR, "%s: cannot %s: %s", io_short_name( path ), what,
                      errno != 0 ? strerror( errno ) : "an earlier write failed" );
}

// ---- paths -----------------------------------------------------------------------------------------------------

size_t record_stem_length( const char* path )
{
    const char* slash = strrchr( path, '/' );
    const char* name = slash == NULL ? path : slash + 1;
    const char* dot = strrchr( name, '.' );
    return dot == NULL || dot == name ? strlen( path ) : (size_t)( dot - path );
}

char* record_path_with( const char* path, const char* insert )
{
    size_t stem = record_stem_length( path );
    size_t room = strlen( path ) + strlen( insert ) + 1;
    char* result = malloc( room );
    if ( result != NULL )
    {
        snprintf( result, room, "%.*s%s%s", (int)stem, path, insert, path + stem );
    }
    return result;
}
