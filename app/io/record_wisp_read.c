// Reader of our own recordings. Frames have equal length, so the position of each is known without a walk; a frame is
// accepted only after its checksum, its index and its numbers have been checked.
#include "record_internal.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum
{
    // Frames of zeros at the end: blocks that a power failure left allocated and unwritten. More of them than any
    // disk buffers have another cause, and reading each would let a short hole of a file take hours.
    MAX_UNWRITTEN = 1 << 16,
};

struct wisp_recording
{
    record_source source;
    record_bodies bodies;
    wisp_recording_info info;
    uint64_t seed; // the header's checksum
};

// ---- the header ------------------------------------------------------------------------------------------------

// A reader of header bytes that exist.
typedef struct header_cursor
{
    const unsigned char* bytes;
    size_t at, end;
    const char* name;
} header_cursor;

static wisp_status check_magic( const unsigned char* bytes, uint64_t size, const char* name, wisp_error* error )
{
    if ( size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", name );
    }
    if ( memcmp( bytes, RECORD_MAGIC, size < RECORD_MAGIC_SIZE ? (size_t)size : RECORD_MAGIC_SIZE ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: expected the start of a recording", name );
    }
    if ( size < RECORD_AT_BODIES )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %llu: the file ends inside the header of %d bytes", name,
                          (unsigned long long)size, RECORD_AT_BODIES );
    }
    return WISP_OK;
}

// Length of the header, bounded by the file. The checksum is not verified yet, so nothing here is trusted.
static wisp_status find_header( wisp_recording* recording, wisp_error* error )
{
    record_source* source = &recording->source;
    size_t size = source->size < RECORD_AT_BODIES ? (size_t)source->size : RECORD_AT_BODIES;
    const unsigned char* bytes = NULL;
    wisp_status status = record_source_read( source, 0, size, &bytes, error );
    if ( status == WISP_OK )
    {
        status = check_magic( bytes, source->size, source->name, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    uint32_t version = io_get_u32( bytes + RECORD_AT_VERSION );
    if ( version != RECORD_VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got version %u, expected version %d", source->name,
                          RECORD_AT_VERSION, version, RECORD_VERSION );
    }
    uint64_t header = io_get_u64( bytes + RECORD_AT_HEADER_BYTES );
    if ( header < RECORD_AT_BODIES + RECORD_CHECKSUM_SIZE || header > WISP_RECORD_HEADER_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got a header of %llu bytes, expected %d .. %llu",
                          source->name, RECORD_AT_HEADER_BYTES, (unsigned long long)header,
                          RECORD_AT_BODIES + RECORD_CHECKSUM_SIZE, (unsigned long long)WISP_RECORD_HEADER_CAP );
    }
    if ( header > source->size )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %llu: the file ends inside the list of bodies, which ends at byte %llu",
                          source->name, (unsigned long long)source->size, (unsigned long long)header );
    }
    recording->info.first_byte = header;
    return WISP_OK;
}

static wisp_status need( const header_cursor* cursor, uint64_t size, int body, wisp_error* error )
{
    if ( size > cursor->end - cursor->at )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the list of bodies ends inside body %d", cursor->name,
                          cursor->at, body );
    }
    return WISP_OK;
}

static wisp_status read_name( header_cursor* cursor, int b, uint32_t size, wisp_record_body* body, wisp_error* error )
{
    char* name = calloc( (size_t)size + 1, 1 );
    if ( name == NULL )
    {
        return record_no_memory( cursor->name, error );
    }
    memcpy( name, cursor->bytes + cursor->at, size );
    body->name = name;
    if ( strlen( name ) != size )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: a zero is inside the name of body %d", cursor->name,
                          cursor->at, b );
    }
    return WISP_OK;
}

static int32_t* read_numbers( const header_cursor* cursor, size_t count )
{
    int32_t* numbers = malloc( count * sizeof *numbers );
    for ( size_t i = 0; numbers != NULL && i < count; ++i )
    {
        // Two's complement: indices beyond the signed range become negative and are refused as such.
        uint32_t bits = io_get_u32( cursor->bytes + cursor->at + 4 * i );
        memcpy( &numbers[i], &bits, sizeof bits );
    }
    return numbers;
}

static wisp_status read_body( header_cursor* cursor, int b, wisp_record_body* body, wisp_error* error )
{
    wisp_status status = need( cursor, RECORD_BODY_SIZE, b, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const unsigned char* head = cursor->bytes + cursor->at;
    uint32_t kind = io_get_u32( head );
    uint32_t name_size = io_get_u32( head + 4 );
    uint32_t vertices = io_get_u32( head + 8 );
    uint32_t elements = io_get_u32( head + 12 );
    if ( kind > RECORD_CHANGING_MESH || name_size > WISP_RECORD_MAX_NAME || vertices >= INT_MAX ||
         elements >= INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %zu: body %d cannot be of kind %u with a name of %u letters, %u vertices and %u "
                          "elements",
                          cursor->name, cursor->at, b, kind, name_size, vertices, elements );
    }
    cursor->at += RECORD_BODY_SIZE;
    bool strands = kind == RECORD_STRANDS;
    size_t name_room = ( name_size + 3 ) / 4 * 4;
    uint64_t count = strands ? (uint64_t)elements + 1 : 3 * (uint64_t)elements;
    status = need( cursor, name_room + 4 * count, b, error );
    if ( status == WISP_OK )
    {
        status = read_name( cursor, b, name_size, body, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    cursor->at += name_room;
    int32_t* numbers = count > 0 ? read_numbers( cursor, (size_t)count ) : NULL;
    if ( numbers == NULL && count > 0 )
    {
        return record_no_memory( cursor->name, error );
    }
    cursor->at += 4 * (size_t)count;
    body->vertex_count = (int)vertices;
    body->triangles_change = kind == RECORD_CHANGING_MESH;
    *( strands ? &body->offsets : &body->triangles ) = numbers;
    *( strands ? &body->strand_count : &body->triangle_count ) = (int)elements;
    return WISP_OK;
}

static wisp_status read_bodies( wisp_recording* recording, header_cursor* cursor, wisp_error* error )
{
    uint32_t count = io_get_u32( cursor->bytes + RECORD_AT_BODY_COUNT );
    if ( count < 1 || count > WISP_RECORD_MAX_BODIES )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got %u bodies, expected 1 to %d", cursor->name,
                          RECORD_AT_BODY_COUNT, count, WISP_RECORD_MAX_BODIES );
    }
    recording->bodies =
        ( record_bodies ){ .list = calloc( count, sizeof *recording->bodies.list ), .count = (int)count };
    if ( recording->bodies.list == NULL )
    {
        return record_no_memory( cursor->name, error );
    }
    wisp_status status = WISP_OK;
    for ( int b = 0; status == WISP_OK && b < recording->bodies.count; ++b )
    {
        status = read_body( cursor, b, &recording->bodies.list[b], error );
    }
    if ( status == WISP_OK && cursor->at != cursor->end )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: %zu bytes follow the last body", cursor->name,
                            cursor->at, cursor->end - cursor->at );
    }
    return status == WISP_OK
               ? record_check_bodies( recording->bodies.list, recording->bodies.count, cursor->name, error )
               : status;
}

static wisp_status read_stats( wisp_recording* recording, const header_cursor* cursor, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    info->body_count = recording->bodies.count;
    info->dt = io_get_double( cursor->bytes + RECORD_AT_STEP_SECONDS );
    if ( !isfinite( info->dt ) || info->dt <= 0.0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %d: got %g seconds between two frames, expected more than 0", cursor->name,
                          RECORD_AT_STEP_SECONDS, info->dt );
    }
    info->frame_bytes = io_get_u64( cursor->bytes + RECORD_AT_FRAME_BYTES );
    uint64_t needed = RECORD_FRAME_AT_POINTS + record_frame_bytes( &recording->bodies ) + RECORD_CHECKSUM_SIZE;
    if ( info->frame_bytes != needed || (size_t)needed != needed )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %d: got frames of %llu bytes, expected %llu for these bodies", cursor->name,
                          RECORD_AT_FRAME_BYTES, (unsigned long long)info->frame_bytes, (unsigned long long)needed );
    }
    return WISP_OK;
}

static wisp_status read_header( wisp_recording* recording, wisp_error* error )
{
    const unsigned char* bytes = NULL;
    size_t size = (size_t)recording->info.first_byte;
    wisp_status status = record_source_read( &recording->source, 0, size, &bytes, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t end = size - RECORD_CHECKSUM_SIZE;
    header_cursor cursor = { bytes, RECORD_AT_BODIES, end, recording->source.name };
    recording->seed = record_checksum( 0, bytes, end );
    if ( recording->seed != io_get_u64( bytes + end ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %zu: the header is damaged, its checksum does not match its bytes", cursor.name,
                          end );
    }
    status = read_bodies( recording, &cursor, error );
    return status == WISP_OK ? read_stats( recording, &cursor, error ) : status;
}

// ---- where frames end ------------------------------------------------------------------------------------------

static uint64_t frame_byte( const wisp_recording* recording, int index )
{
    return recording->info.first_byte + (uint64_t)index * recording->info.frame_bytes;
}

// The mark of the end is accepted only directly after the last whole frame.
static wisp_status read_end( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    uint64_t at = frame_byte( recording, info->frame_count );
    const unsigned char* bytes = NULL;
    wisp_status status = record_source_read( &recording->source, at, RECORD_END_SIZE, &bytes, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t end = RECORD_END_SIZE - RECORD_CHECKSUM_SIZE;
    uint64_t checksum = record_checksum( recording->seed, bytes, end );
    if ( memcmp( bytes, RECORD_END_MAGIC, RECORD_MAGIC_SIZE ) != 0 || checksum != io_get_u64( bytes + end ) )
    {
        return WISP_OK;
    }
    uint64_t count = io_get_u64( bytes + RECORD_END_AT_COUNT );
    if ( count != (uint64_t)info->frame_count )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT, "%s: byte %llu: the mark of the end counts %llu frames, the file has %d",
            recording->source.name, (unsigned long long)at, (unsigned long long)count, info->frame_count );
    }
    info->complete = true;
    info->tail_bytes = 0;
    return WISP_OK;
}

static wisp_status is_unwritten( wisp_recording* recording, int index, bool* unwritten, wisp_error* error )
{
    static const unsigned char zeros[RECORD_FRAME_AT_POINTS];
    const unsigned char* bytes = NULL;
    wisp_status status =
        record_source_read( &recording->source, frame_byte( recording, index ), sizeof zeros, &bytes, error );
    *unwritten = status == WISP_OK && memcmp( bytes, zeros, sizeof zeros ) == 0;
    return status;
}

static wisp_status drop_unwritten( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    wisp_status status = WISP_OK;
    bool unwritten = true;
    for ( int dropped = 0; info->frame_count > 0; ++dropped )
    {
        status = is_unwritten( recording, info->frame_count - 1, &unwritten, error );
        if ( status != WISP_OK || !unwritten )
        {
            break;
        }
        if ( dropped == MAX_UNWRITTEN )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %llu: more than %d frames of zeros end the file",
                              recording->source.name,
                              (unsigned long long)frame_byte( recording, info->frame_count - 1 ), MAX_UNWRITTEN );
        }
        info->frame_count -= 1;
        info->tail_bytes += info->frame_bytes;
    }
    return status;
}

static wisp_status count_frames( wisp_recording* recording, wisp_error* error )
{
    wisp_recording_info* info = &recording->info;
    uint64_t size = recording->source.size - info->first_byte;
    uint64_t count = size / info->frame_bytes;
    if ( count > INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %llu frames are more than a recording can hold",
                          recording->source.name, (unsigned long long)count );
    }
    info->frame_count = (int)count;
    info->tail_bytes = size % info->frame_bytes;
    wisp_status status = info->tail_bytes == RECORD_END_SIZE ? read_end( recording, error ) : WISP_OK;
    return status == WISP_OK && !info->complete ? drop_unwritten( recording, error ) : status;
}

// ---- opening ---------------------------------------------------------------------------------------------------

static wisp_status read_recording( wisp_recording* recording, wisp_error* error )
{
    wisp_status status = find_header( recording, error );
    if ( status == WISP_OK )
    {
        status = read_header( recording, error );
    }
    return status == WISP_OK ? count_frames( recording, error ) : status;
}

static wisp_status open_source( record_source* source, wisp_recording** out, wisp_error* error )
{
    wisp_recording* recording = calloc( 1, sizeof *recording );
    if ( recording == NULL )
    {
        wisp_status status = record_no_memory( source->name, error );
        record_source_close( source );
        return status;
    }
    recording->source = *source;
    wisp_status status = read_recording( recording, error );
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
    *out = NULL;
    record_source source;
    wisp_status status = record_source_open( path, &source, error );
    return status == WISP_OK ? open_source( &source, out, error ) : status;
}

wisp_status wisp_recording_open_memory( const void* bytes, size_t size, const char* name, wisp_recording** out,
                                        wisp_error* error )
{
    *out = NULL;
    record_source source;
    wisp_status status = record_source_open_memory( bytes, size, name, &source, error );
    return status == WISP_OK ? open_source( &source, out, error ) : status;
}

void wisp_recording_close( wisp_recording* recording )
{
    if ( recording != NULL )
    {
        record_release_bodies( &recording->bodies );
        record_source_close( &recording->source );
        free( recording );
    }
}

wisp_recording_info wisp_recording_describe( const wisp_recording* recording )
{
    return recording->info;
}

const wisp_record_body* wisp_recording_body( const wisp_recording* recording, int body )
{
    return &recording->bodies.list[body];
}

// ---- frames ----------------------------------------------------------------------------------------------------

static wisp_status damaged( const wisp_recording* recording, int index, const char* how, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: frame %d at byte %llu is damaged: %s", recording->source.name,
                      index, (unsigned long long)frame_byte( recording, index ), how );
}

static wisp_status check_head( const wisp_recording* recording, int index, const unsigned char* bytes,
                               wisp_error* error )
{
    size_t end = (size_t)recording->info.frame_bytes - RECORD_CHECKSUM_SIZE;
    if ( record_checksum( recording->seed, bytes, end ) != io_get_u64( bytes + end ) )
    {
        return damaged( recording, index, "its checksum does not match its bytes", error );
    }
    if ( memcmp( bytes, RECORD_FRAME_MAGIC, RECORD_MAGIC_SIZE ) != 0 ||
         io_get_u64( bytes + RECORD_FRAME_AT_BYTES ) != recording->info.frame_bytes )
    {
        return damaged( recording, index, "it does not start as frames do", error );
    }
    if ( io_get_u64( bytes + RECORD_FRAME_AT_INDEX ) != (uint64_t)index )
    {
        return damaged( recording, index, "it has the number of another frame", error );
    }
    return isfinite( io_get_double( bytes + RECORD_FRAME_AT_TIME ) )
               ? WISP_OK
               : damaged( recording, index, "its time is not finite", error );
}

static wisp_status check_triangles( const wisp_recording* recording, int index, const unsigned char* bytes,
                                    const wisp_record_body* body, wisp_error* error )
{
    for ( size_t i = 0; body->triangles_change && i < 3 * (size_t)body->triangle_count; ++i )
    {
        const uint32_t vertex = io_get_u32( bytes + 4 * i );
        if ( vertex >= (uint32_t)body->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: frame %d at byte %llu: body %s, triangle %zu: got vertex %u, expected 0 .. %d",
                              recording->source.name, index, (unsigned long long)frame_byte( recording, index ),
                              body->name, i / 3, vertex, body->vertex_count - 1 );
        }
    }
    return WISP_OK;
}

static wisp_status check_points( const wisp_recording* recording, int index, const unsigned char* bytes,
                                 wisp_error* error )
{
    size_t at = RECORD_FRAME_AT_POINTS;
    for ( int b = 0; b < recording->bodies.count; ++b )
    {
        const wisp_record_body* body = &recording->bodies.list[b];
        for ( int v = 0; v < body->vertex_count; ++v, at += RECORD_POINT_SIZE )
        {
            wisp_vec3 point = io_get_vec3( bytes + at );
            if ( record_find_not_finite( &point, 1 ) >= 0 )
            {
                return wisp_fail( error, WISP_BAD_INPUT,
                                  "%s: frame %d at byte %llu: body %s, vertex %d is not finite",
                                  recording->source.name, index, (unsigned long long)frame_byte( recording, index ),
                                  body->name, v );
            }
        }
        wisp_status status = check_triangles( recording, index, bytes + at, body, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        at += (size_t)record_triangle_bytes( body );
    }
    return WISP_OK;
}

static void get_triangles( const unsigned char* bytes, const wisp_record_body* body )
{
    int32_t* to = (int32_t*)(uintptr_t)body->triangles;
    for ( size_t i = 0; body->triangles_change && i < 3 * (size_t)body->triangle_count; ++i )
    {
        to[i] = (int32_t)io_get_u32( bytes + 4 * i );
    }
}

wisp_status wisp_recording_frame( wisp_recording* recording, int index, wisp_vec3* const* points, double* time,
                                  uint64_t* hash, wisp_error* error )
{
    if ( index < 0 || index >= recording->info.frame_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got frame %d, the recording has %d", recording->source.name,
                          index, recording->info.frame_count );
    }
    const unsigned char* bytes = NULL;
    wisp_status status = record_source_read( &recording->source, frame_byte( recording, index ),
                                             (size_t)recording->info.frame_bytes, &bytes, error );
    if ( status == WISP_OK )
    {
        status = check_head( recording, index, bytes, error );
    }
    if ( status == WISP_OK )
    {
        status = check_points( recording, index, bytes, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t at = RECORD_FRAME_AT_POINTS;
    for ( int b = 0; points != NULL && b < recording->bodies.count; ++b )
    {
        const wisp_record_body* body = &recording->bodies.list[b];
        if ( points[b] != NULL )
        {
            record_get_points( bytes + at, body->vertex_count, points[b] );
            get_triangles( bytes + at + RECORD_POINT_SIZE * (size_t)body->vertex_count, body );
        }
        at += RECORD_POINT_SIZE * (size_t)body->vertex_count + (size_t)record_triangle_bytes( body );
    }
    if ( time != NULL )
    {
        *time = io_get_double( bytes + RECORD_FRAME_AT_TIME );
    }
    if ( hash != NULL )
    {
        *hash = io_get_u64( bytes + RECORD_FRAME_AT_HASH );
    }
    return WISP_OK;
}
