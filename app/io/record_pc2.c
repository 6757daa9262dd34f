// Point caches. Little-endian: a header of 32 bytes ("POINTCACHE2", zero, i32 version, i32 points, f32 start frame,
// f32 sample rate, i32 samples), then three floats per point, sample after sample. It has no times: a sample belongs
// to the frame start + sample rate * number of the host's time line.
#include "record_internal.h"

#include "wisp/module/definition.h"
#include <errno.h>
#include <limits.h>
#include <math.h>

// ---- .obj ----

// Wavefront OBJ, one file per frame: for programs without a notion of time. A segment of a strand is an `l` line of
// its own, although the format allows a whole strand in one: Blender reads only the first segment of a longer line.

// The vertices of all bodies are numbered together, from 1.
static void write_elements( FILE* out, const wisp_record_body* body, int first )
{
    for ( int t = 0; body->offsets == NULL && t < body->triangle_count; ++t )
    {
        const int32_t* corner = body->triangles + 3 * (size_t)t;
        fprintf( out, "f %d %d %d\n", first + corner[0], first + corner[1], first + corner[2] );
    }
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            fprintf( out, "l %d %d\n", first + v, first + v + 1 );
        }
    }
}

// Every frame is a file that is finished on its own.
static wisp_status obj_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const int number = recorder->frame_count + 1;
    const char* path = record_path_beside( recorder, "_%04d%s", number, record_extension( recorder ) );
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    FILE* out = output.stream;
    fprintf( out, "# Wisp %s: frame %d at %.17g s, metres\n", WISP_VERSION_STRING, number, frame->time );
    int first = 1;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        fprintf( out, "o %s\n", body->name );
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            const wisp_vec3 p = frame->points[b][v];
            // Nine digits restore every float bit for bit.
            fprintf( out, "v %.9g %.9g %.9g\n", (double)p.x, (double)p.y, (double)p.z );
        }
        write_elements( out, body, first );
        first += body->vertex_count;
    }
    return io_output_commit( &output, error );
}

const record_format record_format_obj = { ".obj", .frame = obj_frame };

// ---- .pc2 ----

enum
{
    HEADER_SIZE = 32,
    AT_VERSION = 12,
    AT_POINT_COUNT = 16,
    AT_START = 20,
    AT_RATE = 24,
    AT_SAMPLE_COUNT = 28,
    VERSION = 1,
};

static const char magic[12] = "POINTCACHE2";

// ---- writing ---------------------------------------------------------------------------------------------------

// One file per body, because the format has one mesh only. The number of samples is known at the end, and stays 0 until then.
static wisp_status pc2_begin( wisp_recorder* recorder, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int b = 0; status == WISP_OK && b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        const char* extension = record_extension( recorder );
        const char* path = recorder->body_count == 1 ? recorder->path
                                                     : record_path_beside( recorder, "_%s%s", body->name, extension );
        status = io_output_open( path, &recorder->outputs[b], error );
        if ( status == WISP_OK )
        {
            unsigned char header[HEADER_SIZE] = { 0 };
            memcpy( header, magic, sizeof magic );
            io_put_u32( header + AT_VERSION, VERSION );
            io_put_u32( header + AT_POINT_COUNT, (uint32_t)body->vertex_count );
            io_put_float( header + AT_START, 0.0f );
            io_put_float( header + AT_RATE, 1.0f );
            fwrite( header, 1, sizeof header, recorder->outputs[b].stream );
        }
    }
    return status;
}

static wisp_status pc2_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const io_output* output = &recorder->outputs[b];
        errno = 0;
        io_write_words( output->stream, frame->points[b], 3 * (size_t)recorder->bodies[b].vertex_count );
        if ( ferror( output->stream ) )
        {
            recorder->lost = true;
            return record_refused( output->path, "write", error );
        }
    }
    return WISP_OK;
}

static wisp_status finish_file( io_output* output, int sample_count, wisp_error* error )
{
    if ( fseek( output->stream, AT_SAMPLE_COUNT, SEEK_SET ) != 0 )
    {
        const wisp_status status = record_refused( output->path, "go back to the header", error );
        io_output_discard( output );
        return status;
    }
    io_write_words( output->stream, &sample_count, 1 );
    return io_output_commit( output, error );
}

// A failure of one body's file does not end the files of the others; the first failure is reported.
static wisp_status pc2_end( wisp_recorder* recorder, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        wisp_error* first = status == WISP_OK ? error : NULL;
        const wisp_status finished = finish_file( &recorder->outputs[b], recorder->frame_count, first );
        status = status == WISP_OK ? finished : status;
    }
    return status;
}

const record_format record_format_pc2 = { ".pc2", .begin = pc2_begin, .frame = pc2_frame, .end = pc2_end };

// ---- reading ---------------------------------------------------------------------------------------------------

static wisp_status check_size( const wisp_recording* cache, uint64_t samples, wisp_error* error )
{
    // At most 2^31 * 12 bytes a sample: the product with the samples is bounded by division.
    const uint64_t sample = cache->info.frame_bytes, size = cache->source.size - HEADER_SIZE;
    if ( samples > size / sample )
    {
        return record_wrong_byte( &cache->source, cache->source.size, error,
                                  "the file ends inside sample %llu of %llu, which are %llu bytes each",
                                  (unsigned long long)( size / sample ), (unsigned long long)samples,
                                  (unsigned long long)sample );
    }
    return samples * sample == size ? WISP_OK
                                    : record_wrong_byte( &cache->source, HEADER_SIZE + samples * sample, error,
                                                         "%llu bytes follow the last sample",
                                                         (unsigned long long)( size - samples * sample ) );
}

static wisp_status read_counts( wisp_recording* cache, const unsigned char* bytes, wisp_error* error )
{
    const uint32_t points = io_get_u32( bytes + AT_POINT_COUNT ), samples = io_get_u32( bytes + AT_SAMPLE_COUNT );
    if ( points < 1 || points >= INT_MAX )
    {
        return record_wrong_byte( &cache->source, AT_POINT_COUNT, error, "got %u points, expected 1 to %d", points,
                                  INT_MAX - 1 );
    }
    if ( samples > INT_MAX )
    {
        return record_wrong_byte( &cache->source, AT_SAMPLE_COUNT, error, "got %u samples, expected 0 to %d", samples,
                                  INT_MAX );
    }
    cache->start_frame = io_get_float( bytes + AT_START );
    cache->sample_rate = io_get_float( bytes + AT_RATE );
    if ( !isfinite( cache->start_frame ) )
    {
        return record_wrong_byte( &cache->source, AT_START, error, "the start frame is not finite" );
    }
    if ( !isfinite( cache->sample_rate ) || cache->sample_rate <= 0.0f )
    {
        return record_wrong_byte( &cache->source, AT_RATE, error, "got a sample rate of %g, expected more than 0",
                                  (double)cache->sample_rate );
    }
    cache->info = ( wisp_recording_info ){
        .dt = 1.0,
        .body_count = 1,
        .frame_count = (int)samples,
        .frame_bytes = RECORD_POINT_SIZE * (uint64_t)points,
        .first_byte = HEADER_SIZE,
        .complete = true,
    };
    const wisp_record_body body = { .name = "points", .vertex_count = (int)points };
    cache->bodies = record_copy_bodies( &cache->memory, &body, 1 );
    return cache->bodies != NULL ? check_size( cache, samples, error )
                                 : record_no_memory( cache->source.name, error );
}

wisp_status record_read_cache( wisp_recording* cache, wisp_error* error )
{
    static const record_start start = { magic, sizeof magic, "\"POINTCACHE2\" and a zero", HEADER_SIZE, 1 };
    const unsigned char* bytes = NULL;
    const wisp_status status = record_read_start( &cache->source, &start, &bytes, error );
    return status == WISP_OK ? read_counts( cache, bytes, error ) : status;
}
