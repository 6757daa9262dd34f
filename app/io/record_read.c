// Readers of recordings: the bytes of a file or of memory, and frames of both formats. Files are read piece by piece: a
// recording may be larger than memory. They are not mapped, because truncating a mapped file during a read kills the
// process.
#include "record_internal.h"

#include "wisp/module/definition.h"

#include <errno.h>

// ---- tracks ----

// Vertex tracks as comma-separated values. Names of bodies have no commas and no quotes, so nothing needs quoting.

static wisp_status check_track( const wisp_recorder* recorder, int i, wisp_error* error )
{
    const int body = recorder->tracks[i].body, vertex = recorder->tracks[i].vertex;
    if ( body < 0 || body >= recorder->body_count )
    {
        return record_wrong( error, recorder->path, "track %d names body %d of %d", i, body, recorder->body_count );
    }
    const wisp_record_body* of = &recorder->bodies[body];
    return vertex >= 0 && vertex < of->vertex_count
               ? WISP_OK
               : record_wrong( error, recorder->path, "track %d names vertex %d of body %s, which has %d", i, vertex,
                               of->name, of->vertex_count );
}

static wisp_status track_begin( wisp_recorder* recorder, wisp_error* error )
{
    if ( recorder->track_count < 1 )
    {
        return record_wrong( error, recorder->path, "got %d vertices, expected at least 1", recorder->track_count );
    }
    for ( int i = 0; i < recorder->track_count; ++i )
    {
        WISP_TRY( check_track( recorder, i, error ) );
    }
    WISP_TRY( io_output_open( recorder->path, &recorder->outputs[0], error ) );
    FILE* out = recorder->outputs[0].stream;
    fputs( "time", out );
    for ( int i = 0; i < 3 * recorder->track_count; ++i )
    {
        const wisp_track_point point = recorder->tracks[i / 3];
        fprintf( out, ",%s.%d.%c", recorder->bodies[point.body].name, point.vertex, "xyz"[i % 3] );
    }
    fputs( "\n", out );
    return WISP_OK;
}

static wisp_status track_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    FILE* out = recorder->outputs[0].stream;
    errno = 0;
    // Seventeen digits restore every double bit for bit, nine every float.
    fprintf( out, "%.17g", frame->time );
    for ( int i = 0; i < recorder->track_count; ++i )
    {
        const wisp_vec3 p = frame->points[recorder->tracks[i].body][recorder->tracks[i].vertex];
        fprintf( out, ",%.9g,%.9g,%.9g", (double)p.x, (double)p.y, (double)p.z );
    }
    fputs( "\n", out );
    recorder->lost = ferror( out ) != 0;
    return recorder->lost ? record_refused( recorder->path, "write", error ) : WISP_OK;
}

const record_format record_format_tracks = { ".csv", .begin = track_begin, .frame = track_frame };

// ---- info ----

// Output of `wisp info` for recordings and point caches: their statistics, then their defects, by frame.

enum
{
    LISTED = 10, // limit of listed damaged frames; the others are counted
};

// Results of reading every frame.
typedef struct survey
{
    wisp_recording* recording;
    wisp_recording_info info;
    wisp_vec3** points; // [body_count], null without a frame
    io_bounds* bounds;  // [body_count]
    double first_time, last_time;
    int read_count;   // frames that are not damaged
    int hashed_count; // of them, those with a hash of the world
    wisp_error damage[LISTED];
    int damage_count;
} survey;

// Damage of one frame is noted and the next one read; an error of the operating system ends it.
static wisp_status read_frames( survey* s, const char* name, wisp_error* error )
{
    for ( int f = 0; f < s->info.frame_count; ++f )
    {
        wisp_error cause = { .status = WISP_OK };
        double time = 0.0;
        uint64_t hash = 0;
        const wisp_status status = wisp_recording_frame( s->recording, f, s->points, &time, &hash, &cause );
        if ( status != WISP_OK && status != WISP_BAD_INPUT )
        {
            return wisp_fail( error, status, "%s", cause.message );
        }
        if ( status == WISP_OK && s->read_count > 0 && time <= s->last_time )
        {
            record_wrong( &cause, name,
                          "frame %d: got time %.9g s, expected more than %.9g s, that of the frame before", f, time,
                          s->last_time );
        }
        if ( cause.status != WISP_OK && s->damage_count++ < LISTED )
        {
            s->damage[s->damage_count - 1] = cause;
        }
        if ( status == WISP_OK )
        {
            s->first_time = s->read_count == 0 ? time : s->first_time;
            s->last_time = time;
            ++s->read_count;
            s->hashed_count += hash != 0;
        }
        for ( int b = 0; b < s->info.body_count && status == WISP_OK; ++b )
        {
            io_extend_bounds( &s->bounds[b], s->points[b], s->recording->bodies[b].vertex_count );
        }
    }
    return WISP_OK;
}

static void print_bounds( FILE* out, const io_bounds* bounds )
{
    if ( bounds->filled )
    {
        fputs( ", ", out );
        io_print_bounds( out, bounds );
    }
    fputs( "\n", out );
}

static void print_cache( FILE* out, const survey* s, const char* name )
{
    fprintf( out, "%s: point cache of %d frames\n", name, s->info.frame_count );
    fprintf( out, "  %-20s from %.6g, every %.6g\n", "frames", (double)s->recording->start_frame,
             (double)s->recording->sample_rate );
    fprintf( out, "  %-20s %d", "points", s->recording->bodies[0].vertex_count );
    print_bounds( out, &s->bounds[0] );
}

static void print_own( FILE* out, const survey* s, const char* name )
{
    fprintf( out, "%s: recording of %d frames\n", name, s->info.frame_count );
    fprintf( out, "  %-20s %.6g s\n", "step", s->info.dt );
    const double* o = s->info.origin;
    if ( o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 )
    {
        fprintf( out, "  %-20s %.9g, %.9g, %.9g m, which points are relative to\n", "origin", o[0], o[1], o[2] );
    }
    if ( s->read_count > 0 )
    {
        fprintf( out, "  %-20s %.6g .. %.6g s\n", "time", s->first_time, s->last_time );
    }
    fprintf( out, "  %-20s %llu bytes\n", "frame", (unsigned long long)s->info.frame_bytes );
    fprintf( out, "  %-20s of %d frames\n", "hash of the world", s->hashed_count );
    fprintf( out, "  %-20s %d\n", "bodies", s->info.body_count );
    for ( int b = 0; b < s->info.body_count; ++b )
    {
        const wisp_record_body* body = &s->recording->bodies[b];
        const bool strands = body->offsets != NULL;
        fprintf( out, "    %-18s %d %s, %d vertices", body->name, strands ? body->strand_count : body->triangle_count,
                 strands                  ? "strands"
                 : body->triangles_change ? "triangles that change"
                                          : "triangles",
                 body->vertex_count );
        print_bounds( out, &s->bounds[b] );
    }
}

// A recording that was not closed is valid up to its end, and the reader must know that end.
static wisp_status print_defects( FILE* out, const survey* s, wisp_error* error )
{
    const unsigned long long end = record_frame_byte( s->recording, s->info.frame_count );
    if ( s->info.tail_bytes > 0 )
    {
        fprintf( out, "  wrong: the recording was cut: %llu bytes from byte %llu on are not a whole frame\n",
                 (unsigned long long)s->info.tail_bytes, end );
    }
    else if ( !s->info.complete )
    {
        fprintf( out, "  wrong: the recording was not finished: the mark of the end is missing at byte %llu\n", end );
    }
    for ( int i = 0; i < s->damage_count && i < LISTED; ++i )
    {
        fprintf( out, "  wrong: %s\n", s->damage[i].message );
    }
    if ( s->damage_count > LISTED )
    {
        fprintf( out, "  wrong: and %d more frames\n", s->damage_count - LISTED );
    }
    if ( s->damage_count == 0 && s->info.complete )
    {
        fputs( "  no defects\n", out );
    }
    return s->damage_count == 0 ? WISP_OK : wisp_fail( error, s->damage[0].status, "%s", s->damage[0].message );
}

// Vertex counts are used only if there is a frame: the file is then long enough to fill the memory.
static survey* make_survey( io_memory* memory, wisp_recording* recording )
{
    const wisp_recording_info info = wisp_recording_describe( recording );
    survey* s = io_get( memory, sizeof *s );
    wisp_vec3** points = io_get( memory, (size_t)info.body_count * sizeof *points );
    io_bounds* bounds = io_get( memory, (size_t)info.body_count * sizeof *bounds );
    for ( int b = 0; b < info.body_count && info.frame_count > 0 && !memory->is_short; ++b )
    {
        points[b] = io_get( memory, (size_t)recording->bodies[b].vertex_count * sizeof **points );
    }
    if ( memory->is_short )
    {
        return NULL;
    }
    *s = ( survey ){ .recording = recording, .info = info, .points = points, .bounds = bounds };
    return s;
}

wisp_status wisp_recording_print( FILE* out, wisp_recording* recording, const char* name, wisp_error* error )
{
    io_memory memory = { 0 };
    survey* s = make_survey( &memory, recording );
    io_numbers numbers;
    wisp_status status = s != NULL ? io_numbers_begin( &numbers, error ) : record_no_memory( name, error );
    if ( status == WISP_OK )
    {
        status = read_frames( s, name, error );
        if ( status == WISP_OK )
        {
            recording->is_cache ? print_cache( out, s, name ) : print_own( out, s, name );
            status = print_defects( out, s, error );
        }
        io_numbers_end( &numbers );
    }
    io_release( &memory );
    return status;
}

// ---- reading ----

#define _XOPEN_SOURCE 700

#include "wisp/module/definition.h"

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
    io_memory memory = { 0 };
    wisp_recording* recording = io_get( &memory, sizeof *recording );
    char* name = io_copy( &memory, io_short_name( path ), strlen( io_short_name( path ) ) + 1 );
    *out = NULL;
    if ( memory.is_short )
    {
        io_release( &memory );
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
    io_memory memory = recording->memory; // the recording is in it
    io_release( &memory );
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
