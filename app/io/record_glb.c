// Binary glTF 2.0 (Khronos 2021): a mesh per body, a morph target per frame after the first one, and an animation in
// which one weight after the other is 1. The JSON part comes first and has the bounds of everything, so the file is
// written when the recorder is closed; until then the frames wait.
#include "record_glb.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum
{
    HEADER_BYTES = 12,
    CHUNK_BYTES = 8,
    JSON_BYTES = 4000,       // of a body, generously
    JSON_TARGET_BYTES = 600, // of a body in a frame
};

// ---- layout ----------------------------------------------------------------------------------------------------

uint64_t glb_block_bytes( const wisp_record_body* body )
{
    return RECORD_POINT_SIZE * (uint64_t)body->vertex_count;
}

int glb_base_blocks( const wisp_record_body* body, const glb_body* place )
{
    return 1 + place->has_normals + ( body->colours != NULL );
}

int glb_target_blocks( const glb_body* place )
{
    return 1 + place->has_normals;
}

static int count_indices( const wisp_record_body* body )
{
    int64_t count = 3 * (int64_t)body->triangle_count;
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        const int vertices = body->offsets[s + 1] - body->offsets[s];
        count += vertices > 1 ? 2 * ( (int64_t)vertices - 1 ) : 0;
    }
    return count < INT32_MAX ? (int)count : INT32_MAX;
}

// Bytes are those of the binary part if it held so many frames.
static void lay_out( const wisp_recorder* recorder, int frame_count, glb_layout* layout )
{
    uint64_t at = 0;
    layout->frame_count = frame_count;
    layout->is_animated = false;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        glb_body* place = &layout->bodies[b];
        place->index_count = count_indices( body );
        place->has_normals = body->triangle_count > 0;
        place->target_count = body->is_static || frame_count < 2 ? 0 : frame_count - 1;
        place->indices_at = at;
        place->points_at = at + 4 * (uint64_t)place->index_count;
        const uint64_t blocks = (uint64_t)glb_base_blocks( body, place ) +
                                (uint64_t)place->target_count * (uint64_t)glb_target_blocks( place );
        at = place->points_at + blocks * glb_block_bytes( body );
        layout->is_animated = layout->is_animated || place->target_count > 0;
    }
    layout->times_at = at;
    at += layout->is_animated ? 4 * (uint64_t)frame_count : 0;
    layout->weights_at = at;
    at += layout->is_animated ? 4 * (uint64_t)frame_count * ( (uint64_t)frame_count - 1 ) : 0;
    layout->size = at;
}

// Of the whole file, rounded up.
static uint64_t file_bytes( const wisp_recorder* recorder, int frame_count, glb_layout* layout )
{
    lay_out( recorder, frame_count, layout );
    uint64_t json = 0;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        json += JSON_BYTES + JSON_TARGET_BYTES * (uint64_t)layout->bodies[b].target_count;
    }
    return layout->size + json;
}

// ---- opening ---------------------------------------------------------------------------------------------------

static bool fits( const wisp_recorder* recorder, int frame_count, glb_layout* layout )
{
    return frame_count <= WISP_RECORD_GLB_MAX_FRAMES &&
           file_bytes( recorder, frame_count, layout ) <= WISP_RECORD_GLB_MAX_BYTES;
}

// @return the most frames that the file can hold
static int max_frames( const wisp_recorder* recorder, glb_layout* layout )
{
    int least = 0, most = WISP_RECORD_GLB_MAX_FRAMES;
    while ( least < most )
    {
        const int middle = ( least + most + 1 ) / 2;
        if ( fits( recorder, middle, layout ) )
        {
            least = middle;
        }
        else
        {
            most = middle - 1;
        }
    }
    return least;
}

static wisp_status check_length( const wisp_recorder* recorder, glb_layout* layout, wisp_error* error )
{
    const int expected = recorder->frames_expected, most = max_frames( recorder, layout );
    const char* name = io_short_name( recorder->path );
    if ( most < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: one frame of these bodies is larger than the %llu MB of a .glb file", name,
                          (unsigned long long)( WISP_RECORD_GLB_MAX_BYTES >> 20 ) );
    }
    if ( expected > most )
    {
        // Frame 0 is always there.
        const int every = most > 1 ? ( expected - 1 + most - 2 ) / ( most - 1 ) : expected;
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "%s: got %d frames, expected at most %d, because a .glb file has a morph target per frame and "
            "at most %d frames and %llu MB; one in %d of these frames would fit",
            name, expected, most, WISP_RECORD_GLB_MAX_FRAMES, (unsigned long long)( WISP_RECORD_GLB_MAX_BYTES >> 20 ),
            every );
    }
    return WISP_OK;
}

static void release_layout( const wisp_recorder* recorder, glb_layout* layout )
{
    for ( int b = 0; layout->bodies != NULL && b < recorder->bodies.count; ++b )
    {
        free( layout->bodies[b].bounds );
    }
    free( layout->bodies );
}

static void release_file( const wisp_recorder* recorder, glb_file* file )
{
    if ( file->output.stream != NULL )
    {
        io_output_discard( &file->output );
    }
    record_waiting_close( file->waiting );
    release_layout( recorder, &file->layout );
    free( file->first );
    free( file->points );
    free( file->first_normals );
    free( file->normals );
    free( file->last );
    free( file );
}

static wisp_status glb_start( const wisp_recorder* recorder, glb_file* file, wisp_error* error )
{
    size_t largest = 0, triangles = 0;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const size_t count = (size_t)recorder->bodies.list[b].vertex_count;
        const size_t bytes = (size_t)record_triangle_bytes( &recorder->bodies.list[b] );
        largest = count > largest ? count : largest;
        triangles = bytes > triangles ? bytes : triangles;
    }
    file->layout.bodies = calloc( (size_t)recorder->bodies.count, sizeof *file->layout.bodies );
    file->first = malloc( largest * sizeof *file->first );
    file->points = malloc( largest * sizeof *file->points );
    file->first_normals = malloc( largest * sizeof *file->first_normals );
    file->normals = malloc( largest * sizeof *file->normals );
    file->last = malloc( triangles + 1 );
    if ( !file->layout.bodies || !file->first || !file->points || !file->first_normals || !file->normals ||
         !file->last )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = check_length( recorder, &file->layout, error );
    status = status == WISP_OK ? record_waiting_open( recorder, &file->waiting, error ) : status;
    return status == WISP_OK ? io_output_open( recorder->path, &file->output, error ) : status;
}

static wisp_status glb_open( wisp_recorder* recorder, wisp_error* error )
{
    glb_file* file = calloc( 1, sizeof *file );
    if ( file == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = glb_start( recorder, file, error );
    if ( status != WISP_OK )
    {
        release_file( recorder, file );
        return status;
    }
    recorder->file = file;
    return WISP_OK;
}

// ---- frames ----------------------------------------------------------------------------------------------------

// Displacements are differences, which must be finite too.
static wisp_status check_points( const wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        for ( int v = 0; v < recorder->bodies.list[b].vertex_count; ++v )
        {
            const wisp_vec3 p = frame->points[b][v];
            if ( fmaxf( fabsf( p.x ), fmaxf( fabsf( p.y ), fabsf( p.z ) ) ) > 0.5f * FLT_MAX )
            {
                return wisp_fail( error, WISP_BAD_INPUT,
                                  "%s: frame %d: body %s, vertex %d is too far from the origin for a .glb file",
                                  io_short_name( recorder->path ), recorder->frame_count,
                                  recorder->bodies.list[b].name, v );
            }
        }
    }
    return WISP_OK;
}

static wisp_status glb_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    glb_file* file = recorder->file;
    const char* name = io_short_name( recorder->path );
    const int count = recorder->frame_count;
    // glTF has times in single precision, which never fall below zero.
    if ( !( (float)frame->time >= 0.0f && (float)frame->time <= FLT_MAX ) ||
         ( count > 0 && (float)frame->time <= (float)recorder->last_time ) )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "%s: frame %d: got time %.9g s, expected at least 0 and, in single precision, more than that "
            "of the frame before",
            name, count, frame->time );
    }
    if ( !fits( recorder, count + 1, &file->layout ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: a .glb file of these bodies ends after %d frames", name,
                          count );
    }
    wisp_status status = check_points( recorder, frame, error );
    return status == WISP_OK ? record_waiting_add( recorder, file->waiting, frame, error ) : status;
}

// ---- whole file ------------------------------------------------------------------------------------------------

static void put_chunk_header( FILE* out, uint64_t size, const char* kind )
{
    unsigned char bytes[CHUNK_BYTES];
    io_put_u32( bytes, (uint32_t)size );
    memcpy( bytes + 4, kind, 4 );
    fwrite( bytes, 1, sizeof bytes, out );
}

// The JSON part is filled up with blanks to whole words.
static void put_json( const wisp_recorder* recorder, const char* text, size_t size )
{
    const glb_file* file = recorder->file;
    FILE* out = file->output.stream;
    const uint64_t padded = ( (uint64_t)size + 3 ) / 4 * 4;
    const uint64_t binary = file->layout.size > 0 ? CHUNK_BYTES + file->layout.size : 0;
    unsigned char header[HEADER_BYTES] = { 'g', 'l', 'T', 'F' };
    io_put_u32( header + 4, 2 );
    io_put_u32( header + 8, (uint32_t)( HEADER_BYTES + CHUNK_BYTES + padded + binary ) );
    fwrite( header, 1, sizeof header, out );
    put_chunk_header( out, padded, "JSON" );
    fwrite( text, 1, size, out );
    fwrite( "   ", 1, (size_t)( padded - size ), out );
}

static wisp_status glb_finish( const wisp_recorder* recorder, wisp_error* error )
{
    glb_file* file = recorder->file;
    const bool is_empty = recorder->frame_count == 0;
    lay_out( recorder, recorder->frame_count, &file->layout );
    file->layout.size = is_empty ? 0 : file->layout.size;
    file->layout.first_time = is_empty ? 0.0f : (float)record_waiting_time( file->waiting, 0 );
    file->layout.last_time = (float)recorder->last_time;
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->bodies.count && status == WISP_OK && !is_empty; ++b )
    {
        status = glb_find_bounds( recorder, b, error );
    }
    char* text = NULL;
    size_t size = 0;
    if ( status == WISP_OK && !glb_write_json( recorder, &file->layout, &text, &size ) )
    {
        status = record_no_memory( recorder->path, error );
    }
    if ( status == WISP_OK )
    {
        put_json( recorder, text, size );
        if ( !is_empty )
        {
            put_chunk_header( file->output.stream, file->layout.size, "BIN\0" );
        }
        status = is_empty ? WISP_OK : glb_put_binary( recorder, error );
    }
    free( text );
    // Committing ends the output, with success or without.
    return status == WISP_OK ? io_output_commit( &file->output, error ) : status;
}

static wisp_status glb_close( wisp_recorder* recorder, wisp_error* error )
{
    io_numbers numbers;
    wisp_status status = recorder->lost ? WISP_OK : io_numbers_begin( &numbers, error );
    if ( status == WISP_OK && !recorder->lost )
    {
        status = glb_finish( recorder, error );
        io_numbers_end( &numbers );
    }
    release_file( recorder, recorder->file );
    return status;
}

const record_format record_format_glb = { ".glb", false, true, glb_open, glb_frame, glb_close };
