// Frames on their way into a file that stores bodies one after the other: they wait in a file without a name next to the
// recording, where there is space for it, so that a crash leaves nothing behind. A frame is the points of bodies that
// move, the values of all bodies and triangles that change, as they are in memory.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

struct record_waiting
{
    FILE* file;
    double* times;     // [frame_count] s
    int capacity;      // of times
    uint64_t* offsets; // [body_count] bytes from the start of a frame to the body
    uint64_t frame_bytes;
};

static wisp_status open_file( const char* path, FILE** out, wisp_error* error )
{
    static const char hidden[] = ".wisp-XXXXXX";
    const char* slash = strrchr( path, '/' );
    size_t folder = slash == NULL ? 0 : (size_t)( slash - path ) + 1;
    char* name = malloc( folder + sizeof hidden );
    if ( name == NULL )
    {
        return record_no_memory( path, error );
    }
    memcpy( name, path, folder );
    memcpy( name + folder, hidden, sizeof hidden );
    int descriptor = mkstemp( name );
    if ( descriptor >= 0 )
    {
        unlink( name );
        *out = fdopen( descriptor, "w+b" );
    }
    wisp_status status = *out != NULL ? WISP_OK : record_refused( path, "create a file for frames beside it", error );
    if ( *out == NULL && descriptor >= 0 )
    {
        close( descriptor );
    }
    free( name );
    return status;
}

static uint64_t point_bytes( const wisp_record_body* body )
{
    return body->is_static ? 0 : sizeof( wisp_vec3 ) * (uint64_t)body->vertex_count;
}

static uint64_t value_bytes( const wisp_record_body* body )
{
    return sizeof( float ) * (uint64_t)body->vertex_count;
}

wisp_status record_waiting_open( const wisp_recorder* recorder, record_waiting** out, wisp_error* error )
{
    *out = NULL;
    record_waiting* waiting = calloc( 1, sizeof *waiting );
    if ( waiting == NULL ||
         ( waiting->offsets = calloc( (size_t)recorder->bodies.count, sizeof *waiting->offsets ) ) == NULL )
    {
        free( waiting );
        return record_no_memory( recorder->path, error );
    }
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        waiting->offsets[b] = waiting->frame_bytes;
        waiting->frame_bytes +=
            point_bytes( body ) + (uint64_t)body->value_count * value_bytes( body ) + record_triangle_bytes( body );
    }
    wisp_status status = open_file( recorder->path, &waiting->file, error );
    if ( status != WISP_OK )
    {
        record_waiting_close( waiting );
        return status;
    }
    *out = waiting;
    return WISP_OK;
}

static bool add_time( record_waiting* waiting, int frame, double time )
{
    if ( frame == waiting->capacity )
    {
        size_t capacity = waiting->capacity > 0 ? 2 * (size_t)waiting->capacity : 256;
        double* larger = capacity <= INT32_MAX ? realloc( waiting->times, capacity * sizeof *larger ) : NULL;
        if ( larger == NULL )
        {
            return false;
        }
        waiting->times = larger;
        waiting->capacity = (int)capacity;
    }
    waiting->times[frame] = time;
    return true;
}

static bool write_body( record_waiting* waiting, const wisp_record_body* body, const wisp_vec3* points )
{
    const size_t count = (size_t)body->vertex_count;
    bool written = body->is_static || fwrite( points, sizeof *points, count, waiting->file ) == count;
    for ( int i = 0; written && i < body->value_count; ++i )
    {
        written = fwrite( body->values[i].numbers, sizeof( float ), count, waiting->file ) == count;
    }
    const size_t triangle_bytes = (size_t)record_triangle_bytes( body );
    return written && fwrite( body->triangles, 1, triangle_bytes, waiting->file ) == triangle_bytes;
}

wisp_status record_waiting_add( wisp_recorder* recorder, record_waiting* waiting, const record_frame* frame,
                                wisp_error* error )
{
    if ( !add_time( waiting, recorder->frame_count, frame->time ) )
    {
        return record_no_memory( recorder->path, error );
    }
    errno = 0;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        if ( !write_body( waiting, &recorder->bodies.list[b], frame->points[b] ) )
        {
            recorder->lost = true;
            return record_refused( recorder->path, "write", error );
        }
    }
    return WISP_OK;
}

double record_waiting_time( const record_waiting* waiting, int frame )
{
    return waiting->times[frame];
}

static wisp_status read_at( const wisp_recorder* recorder, const record_waiting* waiting, uint64_t at, void* out,
                            uint64_t size, wisp_error* error )
{
    errno = 0;
    if ( fseeko( waiting->file, (off_t)at, SEEK_SET ) != 0 || fread( out, 1, (size_t)size, waiting->file ) != size )
    {
        return record_refused( recorder->path, "read the frames that waited beside it", error );
    }
    return WISP_OK;
}

wisp_status record_waiting_points( const wisp_recorder* recorder, const record_waiting* waiting, int frame, int b,
                                   wisp_vec3* out, wisp_error* error )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    const uint64_t at = (uint64_t)frame * waiting->frame_bytes + waiting->offsets[b];
    const wisp_status status = read_at( recorder, waiting, at, out, point_bytes( body ), error );
    const uint64_t triangles_at = at + point_bytes( body ) + (uint64_t)body->value_count * value_bytes( body );
    return status == WISP_OK && body->triangles_change
               ? read_at( recorder, waiting, triangles_at, (void*)(uintptr_t)body->triangles,
                          record_triangle_bytes( body ), error )
               : status;
}

wisp_status record_waiting_numbers( const wisp_recorder* recorder, const record_waiting* waiting, int frame, int b,
                                    int value, float* out, wisp_error* error )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    const uint64_t at = (uint64_t)frame * waiting->frame_bytes + waiting->offsets[b] + point_bytes( body ) +
                        (uint64_t)value * value_bytes( body );
    return read_at( recorder, waiting, at, out, value_bytes( body ), error );
}

void record_waiting_close( record_waiting* waiting )
{
    if ( waiting == NULL )
    {
        return;
    }
    if ( waiting->file != NULL )
    {
        fclose( waiting->file );
    }
    free( waiting->times );
    free( waiting->offsets );
    free( waiting );
}
