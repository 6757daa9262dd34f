// Recordings: frames by number, from bytes that the page holds.
#include "web.h"

#include <stdio.h>

WEB_API void web_recording_close( binding_recording* r )
{
    binding_recording_close( r );
}

/// @param bytes [size] must stay until the recording is closed
WEB_API binding_recording* web_recording_open( const void* bytes, int size, const char* name )
{
    binding_recording* r = NULL;
    return binding_recording_open_memory( bytes, (size_t)size, name, &r, &web_error ) == WISP_OK ? r : NULL;
}

WEB_API int web_recording_frames( const binding_recording* r )
{
    return binding_recording_frames( r );
}

WEB_API int web_recording_is_complete( const binding_recording* r )
{
    return binding_recording_is_complete( r );
}

WEB_API double web_recording_dt( const binding_recording* r )
{
    return binding_recording_dt( r );
}

/// Read a frame, whose time, hash and points are then those of the recording.
WEB_API int web_recording_seek( binding_recording* r, int frame )
{
    return binding_recording_seek( r, frame, &web_error ) == WISP_OK;
}

WEB_API double web_recording_time( const binding_recording* r )
{
    return binding_recording_time( r );
}

WEB_API const char* web_recording_hash( const binding_recording* r )
{
    static char text[20];
    snprintf( text, sizeof text, "%016llx", (unsigned long long)binding_recording_hash( r ) );
    return text;
}

WEB_API int web_recording_bodies( const binding_recording* r )
{
    return binding_recording_bodies( r );
}

WEB_API const char* web_recording_name( const binding_recording* r, int body )
{
    return binding_recording_name( r, body );
}

WEB_API int web_recording_vertices( const binding_recording* r, int body )
{
    return binding_recording_vertices( r, body );
}

WEB_API const int32_t* web_recording_triangles( const binding_recording* r, int body )
{
    return binding_recording_triangles( r, body );
}

WEB_API int web_recording_tears( const binding_recording* r, int body )
{
    return binding_recording_tears( r, body );
}

WEB_API int web_recording_triangle_count( const binding_recording* r, int body )
{
    return binding_recording_triangle_count( r, body );
}

WEB_API const int32_t* web_recording_offsets( const binding_recording* r, int body )
{
    return binding_recording_offsets( r, body );
}

WEB_API int web_recording_strands( const binding_recording* r, int body )
{
    return binding_recording_strands( r, body );
}

WEB_API const float* web_recording_points( const binding_recording* r, int body )
{
    return binding_recording_points( r, body );
}
