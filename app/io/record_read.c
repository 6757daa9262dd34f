// Readers of recordings: the bytes of a file or of memory, and frames of both formats. Files are read piece by piece: a
// recording may be larger than memory. They are not mapped, because truncating a mapped file during a read kills the
// process.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- bytes -----------------------------------------------------------------------------------------------------

static wisp_status open_file( const char* path, record_source* source, wisp_error* error )
{
    // Without O_NONBLOCK a pipe without a writer would block the caller before it can be rejected.
    source->descriptor = io_file_open( path, O_NONBLOCK, IO_STANDARD_INPUT_MAX );
    struct stat info;
    if ( source->descriptor < 0 || fstat( source->descriptor, &info ) != 0 )
    {
        return record_refused( path, source->descriptor < 0 ? "open" : "examine", error );
    }
    source->size = (uint64_t)info.st_size;
    return S_ISREG( info.st_mode ) ? WISP_OK
                                   : record_wrong( error, path, "got %s, expected a file",
                                                   S_ISDIR( info.st_mode ) ? "a folder" : "a device or a pipe" );
}

static wisp_status make_room( record_source* source, size_t size, wisp_error* error )
{
    if ( size <= source->buffer_size )
    {
        return WISP_OK;
    }
    unsigned char* larger = realloc( source->buffer, size );
    if ( larger == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %zu bytes", source->name, size );
    }
    source->buffer = larger;
    source->buffer_size = size;
    return WISP_OK;
}

wisp_status record_source_read( record_source* source, uint64_t at, size_t size, const unsigned char** view,
                                wisp_error* error )
{
    if ( source->bytes != NULL )
    {
        *view = source->bytes + at;
        return WISP_OK;
    }
    wisp_status status = make_room( source, size, error );
    for ( size_t done = 0; status == WISP_OK && done < size; )
    {
        ssize_t got = pread( source->descriptor, source->buffer + done, size - done, (off_t)( at + done ) );
        if ( got > 0 )
        {
            done += (size_t)got;
        }
        else if ( got == 0 )
        {
            status = wisp_fail( error, WISP_IO_ERROR, "%s: byte %llu: the file became shorter while it was read",
                                source->name, (unsigned long long)( at + done ) );
        }
        else if ( errno != EINTR )
        {
            status = record_refused( source->name, "read", error );
        }
    }
    *view = source->buffer;
    return status;
}

wisp_status record_read_start( record_source* source, const record_start* start, const unsigned char** bytes,
                               wisp_error* error )
{
    const size_t size = source->size < start->size ? (size_t)source->size : start->size;
    WISP_TRY( record_source_read( source, 0, size, bytes, error ) );
    if ( size == 0 )
    {
        return record_wrong( error, source->name, "the file is empty" );
    }
    if ( memcmp( *bytes, start->magic, size < start->magic_size ? size : start->magic_size ) != 0 )
    {
        return record_wrong_byte( source, 0, error, "expected %s", start->what );
    }
    if ( size < start->size )
    {
        return record_wrong_byte( source, size, error, "the file ends inside the header of %zu bytes", start->size );
    }
    // Both formats have the version after the magic.
    const uint32_t version = io_get_u32( *bytes + start->magic_size ), newest = start->newest;
    return version >= 1 && version <= newest ? WISP_OK
           : newest == 1
               ? record_wrong_byte( source, start->magic_size, error, "got version %u, expected version 1", version )
               : record_wrong_byte( source, start->magic_size, error, "got version %u, expected version 1 or %u",
                                    version, newest );
}

// ---- opening ---------------------------------------------------------------------------------------------------

// @param bytes null: the file is read
static wisp_status open_recording( const char* path, const unsigned char* bytes, size_t size, bool is_cache,
                                   wisp_recording** out, wisp_error* error )
{
    record_memory memory = { 0 };
    wisp_recording* recording = record_get( &memory, sizeof *recording );
    char* name = record_copy( &memory, io_short_name( path ), strlen( io_short_name( path ) ) + 1 );
    *out = NULL;
    if ( memory.is_short )
    {
        record_release( &memory );
        return record_no_memory( path, error );
    }
    *recording = ( wisp_recording ){
        .source = { .bytes = bytes, .size = size, .descriptor = -1, .name = name },
        .memory = memory,
        .is_cache = is_cache,
    };
    wisp_status status = bytes != NULL ? WISP_OK : open_file( path, &recording->source, error );
    if ( status == WISP_OK )
    {
        status = is_cache ? record_read_cache( recording, error ) : record_read_own( recording, error );
    }
    if ( status != WISP_OK )
    {
        wisp_recording_close( recording );
        return status;
    }
    *out = recording;
    return WISP_OK;
}

wisp_status wisp_recording_open( const char* path, wisp_recording** out, wisp_error* error )
{
    return open_recording( path, NULL, 0, false, out, error );
}

wisp_status wisp_pc2_open( const char* path, wisp_recording** out, wisp_error* error )
{
    return open_recording( path, NULL, 0, true, out, error );
}

// Null marks a file, so empty memory needs an address too.
static const unsigned char nothing[1];

wisp_status wisp_recording_open_memory( const void* bytes, size_t size, const char* name, wisp_recording** out,
                                        wisp_error* error )
{
    return open_recording( name, size > 0 ? bytes : nothing, size, false, out, error );
}

wisp_status wisp_pc2_open_memory( const void* bytes, size_t size, const char* name, wisp_recording** out,
                                  wisp_error* error )
{
    return open_recording( name, size > 0 ? bytes : nothing, size, true, out, error );
}

void wisp_recording_close( wisp_recording* recording )
{
    if ( recording == NULL )
    {
        return;
    }
    if ( recording->source.descriptor >= 0 )
    {
        close( recording->source.descriptor );
    }
    free( recording->source.buffer );
    record_memory memory = recording->memory; // the recording is in it
    record_release( &memory );
}

wisp_recording_info wisp_recording_describe( const wisp_recording* recording )
{
    return recording->info;
}

const wisp_record_body* wisp_recording_body( const wisp_recording* recording, int body )
{
    return &recording->bodies[body];
}

// ---- frames ----------------------------------------------------------------------------------------------------

uint64_t record_frame_byte( const wisp_recording* recording, int index )
{
    return recording->info.first_byte + (uint64_t)index * recording->info.frame_bytes;
}

// @param at the byte in the frame where the point starts
static wisp_status refuse_point( const wisp_recording* recording, int index, const char* body, size_t vertex,
                                 size_t at, wisp_error* error )
{
    const uint64_t byte = record_frame_byte( recording, index );
    return recording->is_cache ? record_wrong_byte( &recording->source, byte + at, error,
                                                    "frame %d, point %zu is not finite", index, vertex )
                               : record_wrong( error, recording->source.name,
                                               "frame %d at byte %llu: body %s, vertex %zu is not finite", index,
                                               (unsigned long long)byte, body, vertex );
}

static wisp_status check_points( const wisp_recording* recording, int index, const unsigned char* bytes,
                                 wisp_error* error )
{
    size_t at = recording->points_at;
    for ( int b = 0; b < recording->info.body_count; ++b )
    {
        const wisp_record_body* body = &recording->bodies[b];
        for ( size_t i = 0; i < 3 * (size_t)body->vertex_count; ++i, at += 4 )
        {
            if ( !isfinite( io_get_float( bytes + at ) ) )
            {
                return refuse_point( recording, index, body->name, i / 3, at - 4 * ( i % 3 ), error );
            }
        }
        for ( size_t i = 0; i < (size_t)record_triangle_bytes( body ) / 4; ++i, at += 4 )
        {
            const uint32_t vertex = io_get_u32( bytes + at );
            if ( vertex >= (uint32_t)body->vertex_count )
            {
                return record_wrong( error, recording->source.name,
                                     "frame %d at byte %llu: body %s, triangle %zu: got vertex %u, expected 0 .. %d",
                                     index, (unsigned long long)record_frame_byte( recording, index ), body->name,
                                     i / 3, vertex, body->vertex_count - 1 );
            }
        }
    }
    return WISP_OK;
}

wisp_status wisp_recording_frame( wisp_recording* recording, int index, wisp_vec3* const* points, double* time,
                                  uint64_t* hash, wisp_error* error )
{
    const wisp_recording_info* info = &recording->info;
    if ( index < 0 || index >= info->frame_count )
    {
        return record_wrong( error, recording->source.name, "got frame %d, the %s has %d", index,
                             recording->is_cache ? "cache" : "recording", info->frame_count );
    }
    const unsigned char* bytes = NULL;
    double own_time = index;
    uint64_t own_hash = 0;
    WISP_TRY( record_source_read( &recording->source, record_frame_byte( recording, index ),
                                  (size_t)info->frame_bytes, &bytes, error ) );
    if ( !recording->is_cache )
    {
        WISP_TRY( record_check_own( recording, index, bytes, &own_time, &own_hash, error ) );
    }
    WISP_TRY( check_points( recording, index, bytes, error ) );
    const unsigned char* at = bytes + recording->points_at;
    for ( int b = 0; points != NULL && b < info->body_count; ++b )
    {
        const wisp_record_body* body = &recording->bodies[b];
        const size_t numbers = 3 * (size_t)body->vertex_count, corners = (size_t)record_triangle_bytes( body ) / 4;
        if ( points[b] != NULL )
        {
            io_get_words( points[b], at, numbers );
            io_get_words( (void*)(uintptr_t)body->triangles, at + 4 * numbers, corners );
        }
        at += 4 * ( numbers + corners );
    }
    *( time != NULL ? time : &own_time ) = own_time;
    *( hash != NULL ? hash : &own_hash ) = own_hash;
    return WISP_OK;
}
