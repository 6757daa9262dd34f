// Writer of our own recordings. The file has its final name from the start, with a whole list of bodies in it, and
// then only grows, so every delivered frame survives the end of the program. Frames go to the operating system in one
// write each, without a buffer in between.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct own_file
{
    int descriptor;
    uint64_t seed;         // the header's checksum
    uint64_t size;         // of the file up to the last whole frame
    unsigned char* buffer; // [frame_bytes]
    size_t frame_bytes;
} own_file;

// ---- the header ------------------------------------------------------------------------------------------------

static size_t number_count( const wisp_record_body* body )
{
    return body->offsets != NULL ? (size_t)body->strand_count + 1 : 3 * (size_t)body->triangle_count;
}

static size_t padded( size_t length )
{
    return ( length + 3 ) / 4 * 4;
}

static uint64_t header_bytes( const record_bodies* bodies )
{
    uint64_t size = RECORD_AT_BODIES + RECORD_CHECKSUM_SIZE;
    for ( int b = 0; b < bodies->count; ++b )
    {
        size += RECORD_BODY_SIZE + padded( strlen( bodies->list[b].name ) ) + 4 * number_count( &bodies->list[b] );
    }
    return size;
}

static unsigned char* put_numbers( unsigned char* at, const int32_t* numbers, size_t count )
{
    for ( size_t i = 0; i < count; ++i, at += 4 )
    {
        io_put_u32( at, (uint32_t)numbers[i] );
    }
    return at;
}

static unsigned char* put_body( unsigned char* at, const wisp_record_body* body )
{
    bool strands = body->offsets != NULL;
    size_t name_size = strlen( body->name );
    io_put_u32( at, strands ? RECORD_STRANDS : body->triangles_change ? RECORD_CHANGING_MESH : RECORD_MESH );
    io_put_u32( at + 4, (uint32_t)name_size );
    io_put_u32( at + 8, (uint32_t)body->vertex_count );
    io_put_u32( at + 12, (uint32_t)( strands ? body->strand_count : body->triangle_count ) );
    at += RECORD_BODY_SIZE;
    memset( at, 0, padded( name_size ) );
    memcpy( at, body->name, name_size );
    at += padded( name_size );
    return put_numbers( at, strands ? body->offsets : body->triangles, number_count( body ) );
}

static void put_header( unsigned char* bytes, size_t size, const wisp_recorder* recorder, own_file* file )
{
    memcpy( bytes, RECORD_MAGIC, RECORD_MAGIC_SIZE );
    io_put_u32( bytes + RECORD_AT_VERSION, RECORD_VERSION );
    io_put_u32( bytes + RECORD_AT_BODY_COUNT, (uint32_t)recorder->bodies.count );
    io_put_u64( bytes + RECORD_AT_HEADER_BYTES, size );
    io_put_u64( bytes + RECORD_AT_FRAME_BYTES, file->frame_bytes );
    io_put_double( bytes + RECORD_AT_STEP_SECONDS, recorder->dt );
    unsigned char* at = bytes + RECORD_AT_BODIES;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        at = put_body( at, &recorder->bodies.list[b] );
    }
    file->seed = record_checksum( 0, bytes, size - RECORD_CHECKSUM_SIZE );
    io_put_u64( at, file->seed );
}

// Replaces an old recording by the header in one step, and keeps the new file open after it.
static wisp_status write_header( const wisp_recorder* recorder, const unsigned char* bytes, own_file* file,
                                 wisp_error* error )
{
    io_output output;
    wisp_status status = io_output_open( recorder->path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    fwrite( bytes, 1, (size_t)file->size, output.stream );
    file->descriptor = fcntl( fileno( output.stream ), F_DUPFD_CLOEXEC, 0 );
    if ( file->descriptor < 0 )
    {
        status = record_refused( recorder->path, "keep the file open", error );
        io_output_discard( &output );
        return status;
    }
    status = io_output_commit( &output, error );
    if ( status != WISP_OK )
    {
        close( file->descriptor );
    }
    return status;
}

static wisp_status own_start( const wisp_recorder* recorder, own_file* file, wisp_error* error )
{
    uint64_t size = header_bytes( &recorder->bodies );
    if ( size > WISP_RECORD_HEADER_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: a list of bodies of %llu bytes is longer than the %llu allowed",
                          io_short_name( recorder->path ), (unsigned long long)size,
                          (unsigned long long)WISP_RECORD_HEADER_CAP );
    }
    file->size = size;
    file->frame_bytes =
        RECORD_FRAME_AT_POINTS + (size_t)record_frame_bytes( &recorder->bodies ) + RECORD_CHECKSUM_SIZE;
    file->buffer = malloc( file->frame_bytes );
    unsigned char* header = malloc( (size_t)size );
    wisp_status status = WISP_OK;
    if ( file->buffer == NULL || header == NULL )
    {
        status = record_no_memory( recorder->path, error );
    }
    else
    {
        put_header( header, (size_t)size, recorder, file );
        status = write_header( recorder, header, file, error );
    }
    free( header );
    return status;
}

static wisp_status own_open( wisp_recorder* recorder, wisp_error* error )
{
    own_file* file = calloc( 1, sizeof *file );
    if ( file == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = own_start( recorder, file, error );
    if ( status != WISP_OK )
    {
        free( file->buffer );
        free( file );
        return status;
    }
    recorder->file = file;
    return WISP_OK;
}

// ---- frames ----------------------------------------------------------------------------------------------------

static bool write_all( int descriptor, const unsigned char* bytes, size_t size )
{
    for ( size_t done = 0; done < size; )
    {
        ssize_t written = write( descriptor, bytes + done, size - done );
        if ( written < 0 && errno != EINTR )
        {
            return false;
        }
        done += written > 0 ? (size_t)written : 0;
    }
    return true;
}

// A partial frame is removed, so that the next attempt starts where this one did.
static wisp_status append( wisp_recorder* recorder, const unsigned char* bytes, size_t size, wisp_error* error )
{
    own_file* file = recorder->file;
    if ( write_all( file->descriptor, bytes, size ) )
    {
        file->size += size;
        return WISP_OK;
    }
    wisp_status status = record_refused( recorder->path, "write", error );
    off_t end = (off_t)file->size;
    recorder->lost = ftruncate( file->descriptor, end ) != 0 || lseek( file->descriptor, end, SEEK_SET ) != end;
    return status;
}

static wisp_status own_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    own_file* file = recorder->file;
    unsigned char* bytes = file->buffer;
    memcpy( bytes, RECORD_FRAME_MAGIC, RECORD_MAGIC_SIZE );
    io_put_u64( bytes + RECORD_FRAME_AT_BYTES, file->frame_bytes );
    io_put_u64( bytes + RECORD_FRAME_AT_INDEX, (uint64_t)recorder->frame_count );
    io_put_double( bytes + RECORD_FRAME_AT_TIME, frame->time );
    io_put_u64( bytes + RECORD_FRAME_AT_HASH, frame->hash );
    unsigned char* at = bytes + RECORD_FRAME_AT_POINTS;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        record_put_points( at, frame->points[b], body->vertex_count );
        at += RECORD_POINT_SIZE * (size_t)body->vertex_count;
        at = body->triangles_change ? put_numbers( at, body->triangles, number_count( body ) ) : at;
    }
    io_put_u64( at, record_checksum( file->seed, bytes, file->frame_bytes - RECORD_CHECKSUM_SIZE ) );
    return append( recorder, bytes, file->frame_bytes, error );
}

// Without the mark of the end, a recording truncated between two frames would look complete.
static wisp_status write_end( wisp_recorder* recorder, wisp_error* error )
{
    own_file* file = recorder->file;
    unsigned char bytes[RECORD_END_SIZE];
    memcpy( bytes, RECORD_END_MAGIC, RECORD_MAGIC_SIZE );
    io_put_u64( bytes + RECORD_END_AT_COUNT, (uint64_t)recorder->frame_count );
    uint64_t checksum = record_checksum( file->seed, bytes, sizeof bytes - RECORD_CHECKSUM_SIZE );
    io_put_u64( bytes + sizeof bytes - RECORD_CHECKSUM_SIZE, checksum );
    wisp_status status = append( recorder, bytes, sizeof bytes, error );
    // Devices and pipes have nothing to flush to a disk, and return EINVAL.
    if ( status == WISP_OK && fsync( file->descriptor ) != 0 && errno != EINVAL && errno != EROFS )
    {
        status = record_refused( recorder->path, "write", error );
    }
    return status;
}

static wisp_status own_close( wisp_recorder* recorder, wisp_error* error )
{
    own_file* file = recorder->file;
    wisp_status status = recorder->lost ? WISP_OK : write_end( recorder, error );
    if ( close( file->descriptor ) != 0 && status == WISP_OK )
    {
        status = record_refused( recorder->path, "write", error );
    }
    free( file->buffer );
    free( file );
    return status;
}

const record_format record_format_wisp = { ".wisp", false, false, own_open, own_frame, own_close };
