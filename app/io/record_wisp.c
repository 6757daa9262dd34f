// Our own recordings. Little-endian: a header, frames that are all equally long, the mark of the end.
//
//     header  "WISP\r\n\x1a\n", u32 version, u32 bodies, u64 header bytes, u64 frame bytes, f64 step seconds,
//             if the version is 2, because the origin is not 0, f64 origin[3], bodies, u64 checksum of all before
//     body    u32 kind, u32 letters of the name, u32 vertices, u32 triangles or strands,
//             name with zeros up to a multiple of 4, i32 [triangles][3] or [strands + 1]
//     frame   "WISPFRAM", u64 frame bytes, u64 index, f64 time, u64 world hash, for each body f32 [vertices][3] and,
//             if its triangles change, i32 [triangles][3]; u64 checksum of all before
//     end     "WISPEND\n", u64 frames, u64 checksum of all before
//
// Checksums of frames and of the end start from the header's, so that a frame of another recording is rejected. The
// line ends in the first bytes change if a transfer treats the file as text.
//
// The file has its final name from the start, with a whole list of bodies in it, and then only grows, so every delivered
// frame survives the end of the program. Frames go to the operating system in one write each, without a buffer in between.
// The position of each is known without a walk; a frame is accepted only after its checksum, its index and its numbers
// have been checked.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <unistd.h>

enum
{
    VERSION = 1,
    VERSION_WITH_ORIGIN = 2,
    MAGIC_SIZE = 8,
    CHECKSUM_SIZE = 8,

    AT_VERSION = 8,
    AT_BODY_COUNT = 12,
    AT_HEADER_BYTES = 16,
    AT_FRAME_BYTES = 24,
    AT_STEP_SECONDS = 32,
    AT_ORIGIN = 40, // or the bodies
    ORIGIN_SIZE = 24,

    BODY_SIZE = 16, // before the name
    MESH = 0,
    STRANDS = 1,
    CHANGING_MESH = 2, // its triangles change

    FRAME_AT_BYTES = 8,
    FRAME_AT_INDEX = 16,
    FRAME_AT_TIME = 24,
    FRAME_AT_HASH = 32,
    FRAME_AT_POINTS = 40,

    END_AT_COUNT = 8,
    END_SIZE = 24,

    // Frames of zeros at the end: blocks that a power failure left allocated and unwritten. More of them than any
    // disk buffers have another cause, and reading each would let a short hole of a file take hours.
    MAX_UNWRITTEN = 1 << 16,
};

static const char magic[] = "WISP\r\n\x1a\n", frame_magic[] = "WISPFRAM", end_magic[] = "WISPEND\n";

// Every step is a bijection of the hash and of the word, so that damage within one word is always detected.
static uint64_t checksum( uint64_t seed, const unsigned char* bytes, size_t size )
{
    uint64_t hash = seed ^ ( (uint64_t)size * 0x9e3779b97f4a7c15u );
    for ( size_t at = 0; at < size; at += 8 )
    {
        unsigned char last[8] = { 0 };
        const bool is_whole = size - at >= 8;
        if ( !is_whole )
        {
            memcpy( last, bytes + at, size - at );
        }
        hash = ( hash ^ io_get_u64( is_whole ? bytes + at : last ) ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

static size_t padded( size_t length )
{
    return ( length + 3 ) / 4 * 4;
}

static size_t point_bytes( const wisp_record_body* body )
{
    return RECORD_POINT_SIZE * (size_t)body->vertex_count;
}

static uint64_t frame_bytes( const wisp_record_body* bodies, int count )
{
    uint64_t bytes = FRAME_AT_POINTS + CHECKSUM_SIZE;
    for ( int b = 0; b < count; ++b )
    {
        bytes += point_bytes( &bodies[b] ) + record_triangle_bytes( &bodies[b] );
    }
    return bytes;
}

// ---- writing ---------------------------------------------------------------------------------------------------

typedef struct own_file
{
    uint64_t seed;         // the header's checksum
    uint64_t size;         // of the file up to the last whole frame
    unsigned char* buffer; // [frame_bytes]
    size_t frame_bytes;
} own_file;

// Corners of triangles, or offsets of strands.
static size_t number_count( const wisp_record_body* body )
{
    return body->offsets != NULL ? (size_t)body->strand_count + 1 : 3 * (size_t)body->triangle_count;
}

static bool is_placed( const wisp_recorder* recorder )
{
    return recorder->origin[0] != 0.0 || recorder->origin[1] != 0.0 || recorder->origin[2] != 0.0;
}

static uint64_t header_bytes( const wisp_recorder* recorder )
{
    uint64_t size = AT_ORIGIN + ( is_placed( recorder ) ? ORIGIN_SIZE : 0 ) + CHECKSUM_SIZE;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        size += BODY_SIZE + padded( strlen( body->name ) ) + 4 * number_count( body );
    }
    return size;
}

// @param at zeros
static unsigned char* put_body( unsigned char* at, const wisp_record_body* body )
{
    const bool strands = body->offsets != NULL;
    const size_t name_size = strlen( body->name );
    io_put_u32( at, strands ? STRANDS : body->triangles_change ? CHANGING_MESH : MESH );
    io_put_u32( at + 4, (uint32_t)name_size );
    io_put_u32( at + 8, (uint32_t)body->vertex_count );
    io_put_u32( at + 12, (uint32_t)( strands ? body->strand_count : body->triangle_count ) );
    memcpy( at + BODY_SIZE, body->name, name_size );
    at += BODY_SIZE + padded( name_size );
    io_put_words( at, strands ? body->offsets : body->triangles, number_count( body ) );
    return at + 4 * number_count( body );
}

// Replaces an old recording by the header in one step, and keeps the new file open after it.
static wisp_status write_header( wisp_recorder* recorder, const unsigned char* bytes, size_t size, wisp_error* error )
{
    io_output output;
    WISP_TRY( io_output_open( recorder->path, &output, error ) );
    fwrite( bytes, 1, size, output.stream );
    recorder->descriptor = fcntl( fileno( output.stream ), F_DUPFD_CLOEXEC, 0 );
    return recorder->descriptor >= 0
               ? io_output_commit( &output, error )
               : io_output_end( &output, record_refused( recorder->path, "keep the file open", error ), error );
}

static wisp_status own_begin( wisp_recorder* recorder, wisp_error* error )
{
    own_file* file = recorder->file;
    const uint64_t size = header_bytes( recorder );
    if ( size > WISP_RECORD_HEADER_CAP )
    {
        return record_wrong( error, recorder->path, "a list of bodies of %llu bytes is longer than the %llu allowed",
                             (unsigned long long)size, (unsigned long long)WISP_RECORD_HEADER_CAP );
    }
    file->size = size;
    file->frame_bytes = (size_t)frame_bytes( recorder->bodies, recorder->body_count );
    file->buffer = io_get( &recorder->memory, file->frame_bytes );
    io_memory memory = { 0 };
    unsigned char* bytes = io_get( &memory, (size_t)size );
    if ( file->buffer == NULL || bytes == NULL )
    {
        io_release( &memory );
        return record_no_memory( recorder->path, error );
    }
    memcpy( bytes, magic, MAGIC_SIZE );
    io_put_u32( bytes + AT_VERSION, is_placed( recorder ) ? VERSION_WITH_ORIGIN : VERSION );
    io_put_u32( bytes + AT_BODY_COUNT, (uint32_t)recorder->body_count );
    io_put_u64( bytes + AT_HEADER_BYTES, size );
    io_put_u64( bytes + AT_FRAME_BYTES, file->frame_bytes );
    io_put_double( bytes + AT_STEP_SECONDS, recorder->dt );
    unsigned char* at = bytes + AT_ORIGIN;
    for ( int k = 0; k < 3 && is_placed( recorder ); ++k, at += 8 )
    {
        io_put_double( at, recorder->origin[k] );
    }
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        at = put_body( at, &recorder->bodies[b] );
    }
    file->seed = checksum( 0, bytes, (size_t)size - CHECKSUM_SIZE );
    io_put_u64( at, file->seed );
    const wisp_status status = write_header( recorder, bytes, (size_t)size, error );
    io_release( &memory );
    return status;
}

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

// Write a frame or the mark of the end, with its checksum. A part of it is removed after a failure, so that the next attempt
// starts where this one did.
static wisp_status append( wisp_recorder* recorder, unsigned char* bytes, size_t size, wisp_error* error )
{
    own_file* file = recorder->file;
    io_put_u64( bytes + size - CHECKSUM_SIZE, checksum( file->seed, bytes, size - CHECKSUM_SIZE ) );
    if ( write_all( recorder->descriptor, bytes, size ) )
    {
        file->size += size;
        return WISP_OK;
    }
    const wisp_status status = record_refused( recorder->path, "write", error );
    const off_t end = (off_t)file->size;
    recorder->lost =
        ftruncate( recorder->descriptor, end ) != 0 || lseek( recorder->descriptor, end, SEEK_SET ) != end;
    return status;
}

static wisp_status own_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const own_file* file = recorder->file;
    memcpy( file->buffer, frame_magic, MAGIC_SIZE );
    io_put_u64( file->buffer + FRAME_AT_BYTES, file->frame_bytes );
    io_put_u64( file->buffer + FRAME_AT_INDEX, (uint64_t)recorder->frame_count );
    io_put_double( file->buffer + FRAME_AT_TIME, frame->time );
    io_put_u64( file->buffer + FRAME_AT_HASH, frame->hash );
    unsigned char* at = file->buffer + FRAME_AT_POINTS;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        io_put_words( at, frame->points[b], 3 * (size_t)body->vertex_count );
        at += point_bytes( body );
        io_put_words( at, body->triangles, (size_t)record_triangle_bytes( body ) / 4 );
        at += record_triangle_bytes( body );
    }
    return append( recorder, file->buffer, file->frame_bytes, error );
}

// Without the mark of the end, a recording truncated between two frames would look complete.
static wisp_status own_end( wisp_recorder* recorder, wisp_error* error )
{
    unsigned char bytes[END_SIZE];
    memcpy( bytes, end_magic, MAGIC_SIZE );
    io_put_u64( bytes + END_AT_COUNT, (uint64_t)recorder->frame_count );
    const wisp_status status = append( recorder, bytes, sizeof bytes, error );
    // Devices and pipes have nothing to flush to a disk, and return EINVAL.
    return status == WISP_OK && fsync( recorder->descriptor ) != 0 && errno != EINVAL && errno != EROFS
               ? record_refused( recorder->path, "write", error )
               : status;
}

const record_format record_format_wisp = {
    ".wisp",        .has_origin = true, .file_size = sizeof( own_file ), .begin = own_begin, .frame = own_frame,
    .end = own_end,
};

// ---- reading the header ----------------------------------------------------------------------------------------

// Bytes of a header that exist.
typedef struct header_cursor
{
    const record_source* source;
    const unsigned char* bytes;
    size_t at, end;
    wisp_error* error;
} header_cursor;

// Length of the header, bounded by the file. The checksum is not verified yet, so nothing here is trusted.
static wisp_status find_header( wisp_recording* recording, wisp_error* error )
{
    static const record_start start = { magic, MAGIC_SIZE, "the start of a recording", AT_ORIGIN,
                                        VERSION_WITH_ORIGIN };
    record_source* source = &recording->source;
    const unsigned char* bytes = NULL;
    WISP_TRY( record_read_start( source, &start, &bytes, error ) );
    const uint64_t header = recording->info.first_byte = io_get_u64( bytes + AT_HEADER_BYTES );
    const int least =
        AT_ORIGIN + ( io_get_u32( bytes + AT_VERSION ) == VERSION_WITH_ORIGIN ? ORIGIN_SIZE : 0 ) + CHECKSUM_SIZE;
    if ( header < (uint64_t)least || header > WISP_RECORD_HEADER_CAP )
    {
        return record_wrong_byte( source, AT_HEADER_BYTES, error, "got a header of %llu bytes, expected %d .. %llu",
                                  (unsigned long long)header, least, (unsigned long long)WISP_RECORD_HEADER_CAP );
    }
    return header <= source->size
               ? WISP_OK
               : record_wrong_byte( source, source->size, error,
                                    "the file ends inside the list of bodies, which ends at byte %llu",
                                    (unsigned long long)header );
}

// @return the next bytes; null: the header ends before
static const unsigned char* take( header_cursor* cursor, uint64_t size, int body )
{
    const size_t at = cursor->at;
    if ( size > cursor->end - at )
    {
        record_wrong_byte( cursor->source, at, cursor->error, "the list of bodies ends inside body %d", body );
        return NULL;
    }
    cursor->at += (size_t)size;
    return cursor->bytes + at;
}

static wisp_status read_body( header_cursor* cursor, io_memory* memory, int b, wisp_record_body* body )
{
    const unsigned char* head = take( cursor, BODY_SIZE, b );
    if ( head == NULL )
    {
        return WISP_BAD_INPUT;
    }
    const uint32_t kind = io_get_u32( head ), letters = io_get_u32( head + 4 );
    const uint32_t vertices = io_get_u32( head + 8 ), elements = io_get_u32( head + 12 );
    if ( kind > CHANGING_MESH || letters > WISP_RECORD_MAX_NAME || vertices >= INT_MAX || elements >= INT_MAX )
    {
        return record_wrong_byte(
            cursor->source, cursor->at - BODY_SIZE, cursor->error,
            "body %d cannot be of kind %u with a name of %u letters, %u vertices and %u elements", b, kind, letters,
            vertices, elements );
    }
    const uint64_t count = kind == STRANDS ? (uint64_t)elements + 1 : 3 * (uint64_t)elements;
    const size_t at = cursor->at;
    const unsigned char* bytes = take( cursor, padded( letters ) + 4 * count, b );
    if ( bytes == NULL )
    {
        return WISP_BAD_INPUT;
    }
    char* name = io_get( memory, letters + 1 );
    int32_t* numbers = count > 0 ? io_get( memory, (size_t)count * sizeof *numbers ) : NULL;
    if ( memory->is_short )
    {
        return record_no_memory( cursor->source->name, cursor->error );
    }
    memcpy( name, bytes, letters );
    // Indices beyond the signed range become negative and are refused as such.
    io_get_words( numbers, bytes + padded( letters ), (size_t)count );
    body->name = name;
    body->vertex_count = (int)vertices;
    body->triangles_change = kind == CHANGING_MESH;
    *( kind == STRANDS ? &body->offsets : &body->triangles ) = numbers;
    *( kind == STRANDS ? &body->strand_count : &body->triangle_count ) = (int)elements;
    return strlen( name ) == letters
               ? WISP_OK
               : record_wrong_byte( cursor->source, at, cursor->error, "a zero is inside the name of body %d", b );
}

static wisp_status read_bodies( wisp_recording* recording, header_cursor* cursor )
{
    const uint32_t count = io_get_u32( cursor->bytes + AT_BODY_COUNT );
    if ( count < 1 || count > WISP_RECORD_MAX_BODIES )
    {
        return record_wrong_byte( cursor->source, AT_BODY_COUNT, cursor->error, "got %u bodies, expected 1 to %d",
                                  count, WISP_RECORD_MAX_BODIES );
    }
    recording->info.body_count = (int)count;
    recording->bodies = io_get( &recording->memory, count * sizeof *recording->bodies );
    WISP_TRY( recording->bodies != NULL ? WISP_OK : record_no_memory( cursor->source->name, cursor->error ) );
    for ( int b = 0; b < (int)count; ++b )
    {
        WISP_TRY( read_body( cursor, &recording->memory, b, &recording->bodies[b] ) );
    }
    if ( cursor->at != cursor->end )
    {
        return record_wrong_byte( cursor->source, cursor->at, cursor->error, "%zu bytes follow the last body",
                                  cursor->end - cursor->at );
    }
    return record_check_bodies( recording->bodies, (int)count, cursor->source->name, cursor->error );
}

static wisp_status read_origin( wisp_recording* recording, header_cursor* cursor )
{
    const bool is_there = io_get_u32( cursor->bytes + AT_VERSION ) == VERSION_WITH_ORIGIN;
    double* origin = recording->info.origin;
    for ( int k = 0; k < 3 && is_there; ++k, cursor->at += 8 )
    {
        origin[k] = io_get_double( cursor->bytes + cursor->at );
    }
    return isfinite( origin[0] + origin[1] + origin[2] )
               ? WISP_OK
               : record_wrong_byte( cursor->source, AT_ORIGIN, cursor->error, "the origin is not finite" );
}

static wisp_status read_header( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    record_source* source = &recording->source;
    const size_t size = (size_t)info->first_byte, end = size - CHECKSUM_SIZE;
    const unsigned char* bytes = NULL;
    WISP_TRY( record_source_read( source, 0, size, &bytes, error ) );
    recording->seed = checksum( 0, bytes, end );
    if ( recording->seed != io_get_u64( bytes + end ) )
    {
        return record_wrong_byte( source, end, error,
                                  "the header is damaged, its checksum does not match its bytes" );
    }
    header_cursor cursor = { source, bytes, AT_ORIGIN, end, error };
    WISP_TRY( read_origin( recording, &cursor ) );
    WISP_TRY( read_bodies( recording, &cursor ) );
    info->dt = io_get_double( bytes + AT_STEP_SECONDS );
    if ( !isfinite( info->dt ) || info->dt <= 0.0 )
    {
        return record_wrong_byte( source, AT_STEP_SECONDS, error,
                                  "got %g seconds between two frames, expected more than 0", info->dt );
    }
    info->frame_bytes = io_get_u64( bytes + AT_FRAME_BYTES );
    const uint64_t needed = frame_bytes( recording->bodies, info->body_count );
    return info->frame_bytes == needed && (size_t)needed == needed
               ? WISP_OK
               : record_wrong_byte( source, AT_FRAME_BYTES, error,
                                    "got frames of %llu bytes, expected %llu for these bodies",
                                    (unsigned long long)info->frame_bytes, (unsigned long long)needed );
}

// ---- where frames end ------------------------------------------------------------------------------------------

// The mark of the end is accepted only directly after the last whole frame.
static wisp_status read_end( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    const uint64_t at = record_frame_byte( recording, info->frame_count );
    const unsigned char* bytes = NULL;
    const wisp_status status = record_source_read( &recording->source, at, END_SIZE, &bytes, error );
    const size_t end = END_SIZE - CHECKSUM_SIZE;
    if ( status != WISP_OK || memcmp( bytes, end_magic, MAGIC_SIZE ) != 0 ||
         checksum( recording->seed, bytes, end ) != io_get_u64( bytes + end ) )
    {
        return status;
    }
    const uint64_t count = io_get_u64( bytes + END_AT_COUNT );
    if ( count != (uint64_t)info->frame_count )
    {
        return record_wrong_byte( &recording->source, at, error,
                                  "the mark of the end counts %llu frames, the file has %d",
                                  (unsigned long long)count, info->frame_count );
    }
    info->complete = true;
    info->tail_bytes = 0;
    return WISP_OK;
}

static wisp_status drop_unwritten( wisp_recording* recording, wisp_error* error )
{
    static const unsigned char zeros[FRAME_AT_POINTS];
    wisp_recording_info* info = &recording->info;
    for ( int dropped = 0; info->frame_count > 0; ++dropped )
    {
        const uint64_t at = record_frame_byte( recording, info->frame_count - 1 );
        const unsigned char* bytes = NULL;
        const wisp_status status = record_source_read( &recording->source, at, sizeof zeros, &bytes, error );
        if ( status != WISP_OK || memcmp( bytes, zeros, sizeof zeros ) != 0 )
        {
            return status;
        }
        if ( dropped == MAX_UNWRITTEN )
        {
            return record_wrong_byte( &recording->source, at, error, "more than %d frames of zeros end the file",
                                      MAX_UNWRITTEN );
        }
        info->frame_count -= 1;
        info->tail_bytes += info->frame_bytes;
    }
    return WISP_OK;
}

static wisp_status count_frames( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    const uint64_t size = recording->source.size - info->first_byte, count = size / info->frame_bytes;
    if ( count > INT_MAX )
    {
        return record_wrong( error, recording->source.name, "%llu frames are more than a recording can hold",
                             (unsigned long long)count );
    }
    info->frame_count = (int)count;
    info->tail_bytes = size % info->frame_bytes;
    const wisp_status status = info->tail_bytes == END_SIZE ? read_end( recording, error ) : WISP_OK;
    return status == WISP_OK && !info->complete ? drop_unwritten( recording, error ) : status;
}

wisp_status record_read_own( wisp_recording* recording, wisp_error* error )
{
    recording->points_at = FRAME_AT_POINTS;
    wisp_status status = find_header( recording, error );
    status = status == WISP_OK ? read_header( recording, error ) : status;
    return status == WISP_OK ? count_frames( recording, error ) : status;
}

// ---- frames ----------------------------------------------------------------------------------------------------

wisp_status record_check_own( const wisp_recording* recording, int index, const unsigned char* bytes, double* time,
                              uint64_t* hash, wisp_error* error )
{
    const size_t size = (size_t)recording->info.frame_bytes, end = size - CHECKSUM_SIZE;
    *time = io_get_double( bytes + FRAME_AT_TIME );
    *hash = io_get_u64( bytes + FRAME_AT_HASH );
    const bool has_head =
        memcmp( bytes, frame_magic, MAGIC_SIZE ) == 0 && io_get_u64( bytes + FRAME_AT_BYTES ) == size;
    const char* damage =
        checksum( recording->seed, bytes, end ) != io_get_u64( bytes + end ) ? "its checksum does not match its bytes"
        : !has_head                                                          ? "it does not start as frames do"
        : io_get_u64( bytes + FRAME_AT_INDEX ) != (uint64_t)index            ? "it has the number of another frame"
        : !isfinite( *time )                                                 ? "its time is not finite"
                                                                             : NULL;
    return damage == NULL ? WISP_OK
                          : record_wrong( error, recording->source.name, "frame %d at byte %llu is damaged: %s",
                                          index, (unsigned long long)record_frame_byte( recording, index ), damage );
}
