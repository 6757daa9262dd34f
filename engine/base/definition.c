#include "wisp/module/definition.h"

#include <string.h>

void wisp_def_init( void* def, size_t size, const void* values, size_t value_size )
{
    if ( def == NULL || size < sizeof( uint32_t ) )
    {
        return;
    }
    // A host that was compiled with a newer version finds zeros in what this one does not know.
    const size_t known = size < value_size ? size : value_size;
    const uint32_t stored = (uint32_t)size;
    memset( def, 0, size );
    memcpy( def, values, known );
    memcpy( def, &stored, sizeof( stored ) );
}

wisp_status wisp_def_read( void* values, const void* given, const char* filled_by, wisp_error* error )
{
    if ( given == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "definition: got null, expected one from %s()", filled_by );
    }
    uint32_t own, size;
    memcpy( &own, values, sizeof( own ) );
    memcpy( &size, given, sizeof( size ) );
    if ( size <= sizeof( size ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "definition: got size %u, expected one that %s() has filled",
                          (unsigned)size, filled_by );
    }
    if ( size > own )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "definition: got size %u, expected at most %u: %s() has not filled it, or the program was "
                          "compiled with a newer version than %s",
                          (unsigned)size, (unsigned)own, filled_by, wisp_version() );
    }
    memcpy( values, given, size );
    memcpy( values, &own, sizeof( own ) );
    return WISP_OK;
}
