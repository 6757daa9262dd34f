// Any bytes as a .wisp and as a .pc2 file: rejected with a message, or described and read frame by frame. Checksums
// would hide nearly all bytes after them, so a second run corrects them.
#include "fuzz.h"

#include "../bad/seal_recording.h"
#include "record.h"

static void demand_finite( const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        demand( isfinite( points[v].x ) && isfinite( points[v].y ) && isfinite( points[v].z ) );
    }
}

static void demand_body( const wisp_record_body* body )
{
    demand( body->name[0] != 0 && strlen( body->name ) <= WISP_RECORD_MAX_NAME && strchr( body->name, '/' ) == NULL );
    demand( body->vertex_count >= 1 );
    for ( int t = 0; t < 3 * body->triangle_count; ++t )
    {
        demand( body->triangles[t] >= 0 && body->triangles[t] < body->vertex_count );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        demand( body->offsets[s] <= body->offsets[s + 1] && body->offsets[s + 1] <= body->vertex_count );
    }
}

// All bytes are accounted for: header, whole frames, and either a reported tail or the mark of the end.
// @param mark bytes of the mark of the end
static void demand_sizes( const wisp_recording_info* info, size_t size, size_t mark )
{
    uint64_t end = info->first_byte + (uint64_t)info->frame_count * info->frame_bytes;
    demand( info->frame_count >= 0 && info->body_count >= 1 && info->dt > 0.0 );
    demand( info->complete ? info->tail_bytes == 0 && end + mark == size : end + info->tail_bytes == size );
}

// Accepted frames are finite; rejected ones leave no trace in the points.
static bool read_frames( wisp_recording* recording, wisp_vec3** points, int body_count, int frame_count )
{
    bool good = true;
    double before = -INFINITY;
    for ( int f = 0; f < frame_count; ++f )
    {
        wisp_error error = { .status = WISP_OK };
        double time = 0.0;
        wisp_status status = wisp_recording_frame( recording, f, points, &time, NULL, &error );
        if ( status != WISP_OK )
        {
            demand_refusal( status, &error );
        }
        good = good && status == WISP_OK && time > before;
        before = time;
        for ( int b = 0; status == WISP_OK && b < body_count; ++b )
        {
            demand_finite( points[b], wisp_recording_body( recording, b )->vertex_count );
            demand_body( wisp_recording_body( recording, b ) );
        }
    }
    return good;
}

static void print_recording( wisp_recording* recording, bool good )
{
    char* text = NULL;
    size_t length = 0;
    wisp_error error = { .status = WISP_OK };
    FILE* stream = open_memstream( &text, &length );
    demand( stream != NULL );
    wisp_status status = wisp_recording_print( stream, recording, "fuzz.wisp", &error );
    fclose( stream );
    demand( ( status == WISP_OK ) == good && length > 0 );
    free( text );
}

static void use_recording( wisp_recording* recording, size_t size, size_t mark )
{
    wisp_recording_info info = wisp_recording_describe( recording );
    demand_sizes( &info, size, mark );
    wisp_vec3** points = calloc( (size_t)info.body_count, sizeof *points );
    demand( points != NULL );
    for ( int b = 0; b < info.body_count; ++b )
    {
        const wisp_record_body* body = wisp_recording_body( recording, b );
        demand_body( body );
        points[b] = info.frame_count > 0 ? malloc( (size_t)body->vertex_count * sizeof **points ) : NULL;
    }
    bool good = read_frames( recording, points, info.body_count, info.frame_count );
    print_recording( recording, good );
    for ( int b = 0; b < info.body_count; ++b )
    {
        free( points[b] );
    }
    free( points );
}

static void run_wisp( const uint8_t* data, size_t size )
{
    wisp_recording* recording = NULL;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_recording_open_memory( data, size, "fuzz.wisp", &recording, &error );
    demand( ( recording == NULL ) == ( status != WISP_OK ) );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        return;
    }
    use_recording( recording, size, 24 );
    wisp_recording_close( recording );
}

static void run_sealed( const uint8_t* data, size_t size )
{
    unsigned char* copy = malloc( size > 0 ? size : 1 );
    demand( copy != NULL );
    if ( size > 0 )
    {
        memcpy( copy, data, size );
    }
    bad_recording_seal( copy, size );
    run_wisp( copy, size );
    free( copy );
}

static void run_pc2( const uint8_t* data, size_t size )
{
    wisp_recording* cache = NULL;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_pc2_open_memory( data, size, "fuzz.pc2", &cache, &error );
    demand( ( cache == NULL ) == ( status != WISP_OK ) );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        return;
    }
    use_recording( cache, size, 0 );
    wisp_recording_close( cache );
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    run_wisp( data, size );
    run_sealed( data, size );
    run_pc2( data, size );
    return 0;
}
