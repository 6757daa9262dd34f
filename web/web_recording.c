// Recordings: frames by number, from bytes that the page holds.
#include "web.h"

#include "record.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct web_recording
{
    wisp_recording* recording;
    wisp_recording_info info;
    wisp_vec3** points; // [body_count][vertex_count] of the last frame that was read
    double time;
    uint64_t hash;
    char hash_text[20];
} web_recording;

WEB_API void web_recording_close( web_recording* r )
{
    for ( int i = 0; r->points && i < r->info.body_count; ++i )
    {
        free( r->points[i] );
    }
    free( r->points );
    wisp_recording_close( r->recording );
    free( r );
}

static bool reserve( web_recording* r )
{
    r->points = calloc( (size_t)r->info.body_count, sizeof *r->points );
    bool is_there = r->points != NULL;
    for ( int i = 0; is_there && i < r->info.body_count; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( r->recording, i );
        r->points[i] = calloc( (size_t)body->vertex_count, sizeof **r->points );
        is_there = r->points[i] != NULL;
    }
    return is_there;
}

/// @param bytes [size] must stay until the recording is closed
WEB_API web_recording* web_recording_open( const void* bytes, int size, const char* name )
{
    web_recording* r = calloc( 1, sizeof *r );
    if ( !r )
    {
        wisp_fail( &web_error, WISP_NO_MEMORY, "%s: out of memory for the recording", name );
        return NULL;
    }
    if ( wisp_recording_open_memory( bytes, (size_t)size, name, &r->recording, &web_error ) != WISP_OK )
    {
        free( r );
        return NULL;
    }
    r->info = wisp_recording_describe( r->recording );
    // Without a frame nothing confirms how many vertices there are.
    if ( r->info.frame_count == 0 )
    {
        wisp_fail( &web_error, WISP_BAD_INPUT, "%s: the recording has no whole frame", name );
        web_recording_close( r );
        return NULL;
    }
    if ( !reserve( r ) )
    {
        wisp_fail( &web_error, WISP_NO_MEMORY, "%s: out of memory for a frame", name );
        web_recording_close( r );
        return NULL;
    }
    return r;
}

WEB_API int web_recording_frames( const web_recording* r )
{
    return r->info.frame_count;
}

WEB_API int web_recording_is_complete( const web_recording* r )
{
    return r->info.complete;
}

WEB_API double web_recording_dt( const web_recording* r )
{
    return r->info.dt;
}

/// Read a frame, whose time, hash and points are then those of the recording.
WEB_API int web_recording_seek( web_recording* r, int frame )
{
    return wisp_recording_frame( r->recording, frame, r->points, &r->time, &r->hash, &web_error ) == WISP_OK;
}

WEB_API double web_recording_time( const web_recording* r )
{
    return r->time;
}

WEB_API const char* web_recording_hash( web_recording* r )
{
    snprintf( r->hash_text, sizeof r->hash_text, "%016llx", (unsigned long long)r->hash );
    return r->hash_text;
}

WEB_API int web_recording_bodies( const web_recording* r )
{
    return r->info.body_count;
}

WEB_API const char* web_recording_name( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->name;
}

WEB_API int web_recording_vertices( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->vertex_count;
}

WEB_API const int32_t* web_recording_triangles( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->triangles;
}

WEB_API int web_recording_triangle_count( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->triangle_count;
}

WEB_API const int32_t* web_recording_offsets( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->offsets;
}

WEB_API int web_recording_strands( const web_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->strand_count;
}

WEB_API const float* web_recording_points( const web_recording* r, int body )
{
    return &r->points[body]->x;
}
