// Point caches. Little-endian: a header of 32 bytes ("POINTCACHE2", zero, i32 version, i32 points, f32 start frame,
// f32 sample rate, i32 samples), then three floats per point, sample after sample. It has no times: a sample belongs
// to the frame start + sample rate * number of the host's time line.
#include "record_internal.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

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

// One file per body, because the format has one mesh only.
typedef struct pc2_files
{
    io_output* outputs; // [body_count]
    int opened;
} pc2_files;

static void discard_files( pc2_files* files )
{
    for ( int i = 0; i < files->opened; ++i )
    {
        io_output_discard( &files->outputs[i] );
    }
    free( files->outputs );
    free( files );
}

static wisp_status open_file( const wisp_recorder* recorder, int b, io_output* output, wisp_error* error )
{
    char insert[WISP_RECORD_MAX_NAME + 2] = "";
    if ( recorder->bodies.count > 1 )
    {
        snprintf( insert, sizeof insert, "_%s", recorder->bodies.list[b].name );
    }
    char* path = record_path_with( recorder->path, insert );
    wisp_status status =
        path != NULL ? io_output_open( path, output, error ) : record_no_memory( recorder->path, error );
    free( path );
    if ( status != WISP_OK )
    {
        return status;
    }
    // The number of samples is known at the end, and stays 0 until then.
    unsigned char header[HEADER_SIZE] = { 0 };
    memcpy( header, magic, sizeof magic );
    io_put_u32( header + AT_VERSION, VERSION );
    io_put_u32( header + AT_POINT_COUNT, (uint32_t)recorder->bodies.list[b].vertex_count );
    io_put_float( header + AT_START, 0.0f );
    io_put_float( header + AT_RATE, 1.0f );
    fwrite( header, 1, sizeof header, output->stream );
    return WISP_OK;
}

static wisp_status pc2_open( wisp_recorder* recorder, wisp_error* error )
{
    pc2_files* files = calloc( 1, sizeof *files );
    if ( files == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    files->outputs = calloc( (size_t)recorder->bodies.count, sizeof *files->outputs );
    wisp_status status = files->outputs != NULL ? WISP_OK : record_no_memory( recorder->path, error );
    for ( int b = 0; status == WISP_OK && b < recorder->bodies.count; ++b )
    {
        status = open_file( recorder, b, &files->outputs[b], error );
        files->opened += status == WISP_OK;
    }
    if ( status != WISP_OK )
    {
        discard_files( files );
        return status;
    }
    recorder->file = files;
    return WISP_OK;
}

static bool write_points( FILE* out, const wisp_vec3* points, int count )
{
    bool written = true;
    for ( int v = 0; v < count && written; ++v )
    {
        unsigned char bytes[RECORD_POINT_SIZE];
        io_put_vec3( bytes, points[v] );
        written = fwrite( bytes, 1, sizeof bytes, out ) == sizeof bytes;
    }
    return written;
}

static wisp_status pc2_write_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    pc2_files* files = recorder->file;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        if ( !write_points( files->outputs[b].stream, frame->points[b], recorder->bodies.list[b].vertex_count ) )
        {
            recorder->lost = true;
            return record_refused( files->outputs[b].path, "write", error );
        }
    }
    return WISP_OK;
}

static wisp_status finish_file( io_output* output, int sample_count, wisp_error* error )
{
    unsigned char bytes[4];
    io_put_u32( bytes, (uint32_t)sample_count );
    if ( fseek( output->stream, AT_SAMPLE_COUNT, SEEK_SET ) != 0 )
    {
        wisp_status status = record_refused( output->path, "go back to the header", error );
        io_output_discard( output );
        return status;
    }
    fwrite( bytes, 1, sizeof bytes, output->stream );
    return io_output_commit( output, error );
}

static wisp_status pc2_finish( wisp_recorder* recorder, wisp_error* error )
{
    pc2_files* files = recorder->file;
    if ( recorder->lost )
    {
        discard_files( files );
        return WISP_OK;
    }
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        // A failure of one body's file does not end the files of the others; the first failure is reported.
        wisp_status finished =
            finish_file( &files->outputs[b], recorder->frame_count, status == WISP_OK ? error : NULL );
        status = status == WISP_OK ? finished : status;
    }
    free( files->outputs );
    free( files );
    return status;
}

const record_format record_format_pc2 = { ".pc2", false, false, pc2_open, pc2_write_frame, pc2_finish };

// ---- reading ---------------------------------------------------------------------------------------------------

struct wisp_pc2
{
    record_source source;
    wisp_pc2_info info;
};

static wisp_status check_size( const wisp_pc2* cache, wisp_error* error )
{
    // At most 2^31 * 12 bytes a sample: the product with the samples is bounded by division.
    uint64_t sample = RECORD_POINT_SIZE * (uint64_t)cache->info.point_count;
    uint64_t size = cache->source.size - HEADER_SIZE;
    uint64_t samples = (uint64_t)cache->info.frame_count;
    if ( samples > size / sample )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %llu: the file ends inside sample %llu of %llu, which are %llu bytes each",
                          cache->source.name, (unsigned long long)cache->source.size,
                          (unsigned long long)( size / sample ), (unsigned long long)samples,
                          (unsigned long long)sample );
    }
    if ( samples * sample != size )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %llu: %llu bytes follow the last sample",
                          cache->source.name, (unsigned long long)( HEADER_SIZE + samples * sample ),
                          (unsigned long long)( size - samples * sample ) );
    }
    return WISP_OK;
}

static wisp_status check_counts( wisp_pc2* cache, const unsigned char* bytes, wisp_error* error )
{
    uint32_t points = io_get_u32( bytes + AT_POINT_COUNT );
    uint32_t samples = io_get_u32( bytes + AT_SAMPLE_COUNT );
    if ( points < 1 || points >= INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got %u points, expected 1 to %d", cache->source.name,
                          AT_POINT_COUNT, points, INT_MAX - 1 );
    }
    if ( samples > INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got %u samples, expected 0 to %d", cache->source.name,
                          AT_SAMPLE_COUNT, samples, INT_MAX );
    }
    cache->info = ( wisp_pc2_info ){
        .point_count = (int)points,
        .frame_count = (int)samples,
        .start_frame = io_get_float( bytes + AT_START ),
        .sample_rate = io_get_float( bytes + AT_RATE ),
    };
    if ( !isfinite( cache->info.start_frame ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: the start frame is not finite", cache->source.name,
                          AT_START );
    }
    if ( !isfinite( cache->info.sample_rate ) || cache->info.sample_rate <= 0.0f )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got a sample rate of %g, expected more than 0",
                          cache->source.name, AT_RATE, (double)cache->info.sample_rate );
    }
    return check_size( cache, error );
}

static wisp_status read_pc2_header( wisp_pc2* cache, wisp_error* error )
{
    record_source* source = &cache->source;
    if ( source->size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", source->name );
    }
    size_t size = source->size < HEADER_SIZE ? (size_t)source->size : HEADER_SIZE;
    const unsigned char* bytes = NULL;
    wisp_status status = record_source_read( source, 0, size, &bytes, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( memcmp( bytes, magic, size < sizeof magic ? size : sizeof magic ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: expected \"POINTCACHE2\" and a zero", source->name );
    }
    if ( size < HEADER_SIZE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the file ends inside the header of %d bytes",
                          source->name, size, HEADER_SIZE );
    }
    uint32_t version = io_get_u32( bytes + AT_VERSION );
    if ( version != VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got version %u, expected version %d", source->name,
                          AT_VERSION, version, VERSION );
    }
    return check_counts( cache, bytes, error );
}

static wisp_status open_cache( record_source* source, wisp_pc2** out, wisp_error* error )
{
    wisp_pc2* cache = calloc( 1, sizeof *cache );
    if ( cache == NULL )
    {
        wisp_status status = record_no_memory( source->name, error );
        record_source_close( source );
        return status;
    }
    cache->source = *source;
    wisp_status status = read_pc2_header( cache, error );
    if ( status != WISP_OK )
    {
        wisp_pc2_close( cache );
        return status;
    }
    *out = cache;
    return WISP_OK;
}

wisp_status wisp_pc2_open( const char* path, wisp_pc2** out, wisp_error* error )
{
    *out = NULL;
    record_source source;
    wisp_status status = record_source_open( path, &source, error );
    return status == WISP_OK ? open_cache( &source, out, error ) : status;
}

wisp_status wisp_pc2_open_memory( const void* bytes, size_t size, const char* name, wisp_pc2** out,
                                  wisp_error* error )
{
    *out = NULL;
    record_source source;
    wisp_status status = record_source_open_memory( bytes, size, name, &source, error );
    return status == WISP_OK ? open_cache( &source, out, error ) : status;
}

void wisp_pc2_close( wisp_pc2* cache )
{
    if ( cache != NULL )
    {
        record_source_close( &cache->source );
        free( cache );
    }
}

wisp_pc2_info wisp_pc2_describe( const wisp_pc2* cache )
{
    return cache->info;
}

wisp_status wisp_pc2_frame( wisp_pc2* cache, int index, wisp_vec3* points, wisp_error* error )
{
    const char* name = cache->source.name;
    if ( index < 0 || index >= cache->info.frame_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got frame %d, the cache has %d", name, index,
                          cache->info.frame_count );
    }
    size_t size = RECORD_POINT_SIZE * (size_t)cache->info.point_count;
    uint64_t at = HEADER_SIZE + (uint64_t)index * size;
    const unsigned char* bytes = NULL;
    wisp_status status = record_source_read( &cache->source, at, size, &bytes, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int v = 0; v < cache->info.point_count; ++v )
    {
        size_t offset = RECORD_POINT_SIZE * (size_t)v;
        wisp_vec3 point = io_get_vec3( bytes + offset );
        if ( record_find_not_finite( &point, 1 ) >= 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %llu: frame %d, point %d is not finite", name,
                              (unsigned long long)( at + offset ), index, v );
        }
    }
    record_get_points( bytes, cache->info.point_count, points );
    return WISP_OK;
}
