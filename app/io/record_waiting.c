// Frames on their way into a file that stores bodies one after the other: they wait in a file without a name next to the
// recording, where there is space for it, so that a crash leaves nothing behind. A frame is the points of bodies that
// move, the values of all bodies and triangles that change, as they are in memory.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct record_waiting
{
    FILE* file;
    double* times; // [capacity] s
    size_t capacity;
    uint64_t frame_bytes;
    float* body;      // numbers of 4 bytes of the largest body in a frame: points, values, triangles
    wisp_error error; // the first failure of reading
} record_waiting;

// Bytes of the points, of a value, and of the whole body in a frame.
static size_t point_bytes( const wisp_record_body* body )
{
    return body->is_static ? 0 : sizeof( wisp_vec3 ) * (size_t)body->vertex_count;
}

static size_t value_bytes( const wisp_record_body* body )
{
    return sizeof( float ) * (size_t)body->vertex_count;
}

static size_t body_bytes( const wisp_record_body* body )
{
    return point_bytes( body ) + (size_t)body->value_count * value_bytes( body ) +
           (size_t)record_triangle_bytes( body );
}

static wisp_status open_file( const wisp_recorder* recorder, wisp_error* error )
{
    const char* path = recorder->path;
    snprintf( recorder->beside, recorder->beside_size, "%.*s.wisp-XXXXXX", (int)( io_file_name( path ) - path ),
              path );
    const int descriptor = mkstemp( recorder->beside );
    FILE* file = descriptor >= 0 ? fdopen( descriptor, "w+b" ) : NULL;
    const wisp_status status =
        file != NULL ? WISP_OK : record_refused( path, "create a file for frames beside it", error );
    if ( descriptor >= 0 )
    {
        unlink( recorder->beside );
    }
    if ( descriptor >= 0 && file == NULL )
    {
        close( descriptor );
    }
    recorder->waiting->file = file;
    return status;
}

wisp_status record_wait_open( wisp_recorder* recorder, wisp_error* error )
{
    io_memory* memory = &recorder->memory;
    record_waiting* waiting = recorder->waiting = io_get( memory, sizeof *waiting );
    size_t largest = 0;
    for ( int b = 0; waiting != NULL && b < recorder->body_count; ++b )
    {
        const size_t bytes = body_bytes( &recorder->bodies[b] );
        recorder->inputs[b].waits_at = waiting->frame_bytes;
        waiting->frame_bytes += bytes;
        largest = bytes > largest ? bytes : largest;
    }
    // Triangles are no more bytes than their body.
    recorder->kept_points = io_get( memory, (size_t)recorder->most_vertices * sizeof( wisp_vec3 ) );
    recorder->kept_triangles = io_get( memory, largest );
    float* body = io_get( memory, largest );
    if ( memory->is_short )
    {
        return record_no_memory( recorder->path, error );
    }
    waiting->body = body;
    const wisp_status status = open_file( recorder, error );
    return status == WISP_OK ? io_output_open( recorder->path, &recorder->outputs[0], error ) : status;
}

static bool add_time( wisp_recorder* recorder, double time )
{
    record_waiting* waiting = recorder->waiting;
    const size_t count = (size_t)recorder->frame_count;
    if ( count == waiting->capacity )
    {
        double* larger = io_get( &recorder->memory, ( 2 * count + 256 ) * sizeof *larger );
        if ( larger == NULL )
        {
            return false;
        }
        waiting->times = count > 0 ? memcpy( larger, waiting->times, count * sizeof *larger ) : larger;
        waiting->capacity = 2 * count + 256;
    }
    waiting->times[count] = time;
    return true;
}

static void write_body( FILE* out, const wisp_record_body* body, const wisp_vec3* points )
{
    fwrite( points, 1, point_bytes( body ), out );
    for ( int i = 0; i < body->value_count; ++i )
    {
        fwrite( body->values[i].numbers, 1, value_bytes( body ), out );
    }
    if ( body->triangles_change )
    {
        fwrite( body->triangles, 1, (size_t)record_triangle_bytes( body ), out );
    }
}

wisp_status record_wait_add( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    FILE* out = recorder->waiting->file;
    if ( !add_time( recorder, frame->time ) )
    {
        return record_no_memory( recorder->path, error );
    }
    errno = 0;
    for ( int b = 0; b < recorder->body_count && !ferror( out ); ++b )
    {
        write_body( out, &recorder->bodies[b], frame->points[b] );
    }
    recorder->lost = ferror( out ) != 0;
    return recorder->lost ? record_refused( recorder->path, "write", error ) : WISP_OK;
}

double record_wait_time( const wisp_recorder* recorder, int frame )
{
    return recorder->waiting->times[frame];
}

const wisp_vec3* record_wait_load( wisp_recorder* recorder, int frame, int b )
{
    record_waiting* waiting = recorder->waiting;
    const wisp_record_body* body = &recorder->bodies[b];
    const off_t at = (off_t)( (uint64_t)frame * waiting->frame_bytes + recorder->inputs[b].waits_at );
    const size_t size = body_bytes( body );
    errno = 0;
    const bool is_read =
        fseeko( waiting->file, at, SEEK_SET ) == 0 && fread( waiting->body, 1, size, waiting->file ) == size;
    const float* part = waiting->body + point_bytes( body ) / 4;
    for ( int i = 0; i < body->value_count; ++i, part += body->vertex_count )
    {
        ( (wisp_record_value*)(uintptr_t)body->values )[i].numbers = part;
    }
    if ( is_read )
    {
        record_set_triangles( body, (const int32_t*)part );
    }
    else if ( waiting->error.status == WISP_OK )
    {
        record_refused( recorder->path, "read the frames that waited beside it", &waiting->error );
    }
    return body->is_static ? recorder->inputs[b].fixed : (const wisp_vec3*)waiting->body;
}

wisp_status record_wait_close( wisp_recorder* recorder, wisp_error* error )
{
    record_waiting* waiting = recorder->waiting;
    recorder->waiting = NULL;
    if ( waiting != NULL && waiting->file != NULL )
    {
        fclose( waiting->file );
    }
    return waiting != NULL && waiting->error.status != WISP_OK
               ? wisp_fail( error, waiting->error.status, "%s", waiting->error.message )
               : WISP_OK;
}
