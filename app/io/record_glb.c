// Binary glTF 2.0 (Khronos 2021): a mesh per body, a morph target per frame after the first one, and an animation in
// which one weight after the other is 1. The JSON part comes first and has the bounds of everything, so the file is
// written when the recorder is closed; until then the frames wait.
//
// A body is blocks of vectors in the binary part: points, normals and colours of the first frame, then a target per frame,
// which is displacements and changes of normals. A target moves vertices and cannot change triangles. Where a body tears,
// all frames have the triangles of the last one, and a vertex is where its corners are in the frame: in one place with its
// twins until they are split.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum
{
    HEADER_BYTES = 12,
    CHUNK_BYTES = 8,
    JSON_BYTES = 4000,       // of a body, generously
    JSON_TARGET_BYTES = 600, // of a body in a frame

    FLOAT = 5126,
    UNSIGNED_INT = 5125,
    POINTS = 0,
    LINES = 1,
    TRIANGLES = 4,
};

typedef struct glb_file
{
    wisp_vec3* first[2]; // [most_vertices] points and unit normals of the body in the first frame
    wisp_vec3* vectors;  // [most_vertices] of another frame
    int32_t* last;       // [most_triangles] of the last frame
    int most_frames;     // that the file can hold
    FILE* json;
    bool is_first; // item of a list: no comma before it
    int accessor_count, view_count;
    uint64_t size; // of the views so far
} glb_file;

// ---- layout ----------------------------------------------------------------------------------------------------

static bool has_normals( const wisp_record_body* body )
{
    return body->triangle_count > 0;
}

static uint64_t block_bytes( const wisp_record_body* body )
{
    return RECORD_POINT_SIZE * (uint64_t)body->vertex_count;
}

// Blocks before the targets, and of each target.
static int count_base( const wisp_record_body* body )
{
    return 1 + has_normals( body ) + ( body->colours != NULL );
}

static int count_per_target( const wisp_record_body* body )
{
    return 1 + has_normals( body );
}

static int count_targets( const wisp_record_body* body, int frame_count )
{
    return body->is_static || frame_count < 2 ? 0 : frame_count - 1;
}

// Corners of triangles or ends of segments; 0: the vertices are drawn as points.
static uint64_t count_indices( const wisp_record_body* body )
{
    uint64_t count = 3 * (uint64_t)body->triangle_count;
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        const int vertices = body->offsets[s + 1] - body->offsets[s];
        count += vertices > 1 ? 2 * ( (uint64_t)vertices - 1 ) : 0;
    }
    return count;
}

static bool is_animated( const wisp_recorder* recorder )
{
    bool moves = false;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        moves = moves || count_targets( &recorder->bodies[b], recorder->frame_count ) > 0;
    }
    return moves;
}

// ---- opening ---------------------------------------------------------------------------------------------------

// The most frames that the file can hold, from the bytes of all but the targets, of a target of all bodies, and of n times
// and n - 1 weights for each, if the file had n frames.
static int count_most_frames( const wisp_recorder* recorder )
{
    uint64_t base = 0, target = 0;
    bool moves = false;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        base += JSON_BYTES + 4 * count_indices( body ) + (uint64_t)count_base( body ) * block_bytes( body );
        target += body->is_static ? 0 : JSON_TARGET_BYTES + (uint64_t)count_per_target( body ) * block_bytes( body );
        moves = moves || !body->is_static;
    }
    for ( uint64_t n = 1; n <= WISP_RECORD_GLB_MAX_FRAMES; ++n )
    {
        if ( base + ( n - 1 ) * target + ( moves && n > 1 ? 4 * n * n : 0 ) > WISP_RECORD_GLB_MAX_BYTES )
        {
            return (int)n - 1;
        }
    }
    return WISP_RECORD_GLB_MAX_FRAMES;
}

static wisp_status check_length( const wisp_recorder* recorder, int most, wisp_error* error )
{
    const int expected = recorder->frames_expected;
    const unsigned long long megabytes = WISP_RECORD_GLB_MAX_BYTES >> 20;
    if ( most < 1 )
    {
        return record_wrong( error, recorder->path,
                             "one frame of these bodies is larger than the %llu MB of a .glb file", megabytes );
    }
    if ( expected > most )
    {
        // Frame 0 is always there.
        const int every = most > 1 ? ( expected - 1 + most - 2 ) / ( most - 1 ) : expected;
        return record_wrong(
            error, recorder->path,
            "got %d frames, expected at most %d, because a .glb file has a morph target per frame and "
            "at most %d frames and %llu MB; one in %d of these frames would fit",
            expected, most, WISP_RECORD_GLB_MAX_FRAMES, megabytes, every );
    }
    return WISP_OK;
}

static wisp_status glb_begin( wisp_recorder* recorder, wisp_error* error )
{
    glb_file* file = recorder->file;
    const size_t bytes = (size_t)recorder->most_vertices * sizeof( wisp_vec3 );
    file->first[0] = record_get( &recorder->memory, bytes );
    file->first[1] = record_get( &recorder->memory, bytes );
    file->vectors = record_get( &recorder->memory, bytes );
    file->last = record_get( &recorder->memory, recorder->most_triangles );
    if ( recorder->memory.is_short )
    {
        return record_no_memory( recorder->path, error );
    }
    file->most_frames = count_most_frames( recorder );
    const wisp_status status = check_length( recorder, file->most_frames, error );
    return status == WISP_OK ? record_wait_open( recorder, error ) : status;
}

// ---- frames ----------------------------------------------------------------------------------------------------

// Displacements are differences, which must be finite too.
static wisp_status check_points( const wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        for ( int v = 0; v < recorder->bodies[b].vertex_count; ++v )
        {
            const wisp_vec3 p = frame->points[b][v];
            if ( fmaxf( fabsf( p.x ), fmaxf( fabsf( p.y ), fabsf( p.z ) ) ) > 0.5f * FLT_MAX )
            {
                return record_wrong( error, recorder->path,
                                     "frame %d: body %s, vertex %d is too far from the origin for a .glb file",
                                     recorder->frame_count, recorder->bodies[b].name, v );
            }
        }
    }
    return WISP_OK;
}

static wisp_status glb_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const glb_file* file = recorder->file;
    const int count = recorder->frame_count;
    const float time = (float)frame->time;
    // glTF has times in single precision, which never fall below zero.
    if ( !( time >= 0.0f && time <= FLT_MAX ) || ( count > 0 && time <= (float)recorder->last_time ) )
    {
        return record_wrong(
            error, recorder->path,
            "frame %d: got time %.9g s, expected at least 0 and, in single precision, more than that "
            "of the frame before",
            count, frame->time );
    }
    if ( count >= file->most_frames )
    {
        return record_wrong( error, recorder->path, "a .glb file of these bodies ends after %d frames", count );
    }
    const wisp_status status = check_points( recorder, frame, error );
    return status == WISP_OK ? record_wait_add( recorder, frame, error ) : status;
}

// ---- blocks ----------------------------------------------------------------------------------------------------

// The points of a frame, or its unit normals, at the vertices of the last frame.
static void load( wisp_recorder* recorder, int b, int frame, bool are_normals, wisp_vec3* out )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies[b];
    const wisp_vec3* vectors = record_wait_load( recorder, frame, b );
    vectors = are_normals ? record_normals( recorder, b, vectors ) : vectors;
    memcpy( out, vectors, (size_t)body->vertex_count * sizeof *out );
    if ( body->triangles_change )
    {
        record_carry_corners( body, body->triangles, file->last, out );
    }
    for ( int v = 0; v < body->vertex_count && are_normals; ++v )
    {
        // The format demands unit normals, also of vertices whose triangles cancel.
        const bool is_zero = out[v].x == 0.0f && out[v].y == 0.0f && out[v].z == 0.0f;
        out[v] = is_zero ? ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } : out[v];
    }
}

// Load what all blocks of a body need: the triangles of the last frame, and the first frame.
static void load_body( wisp_recorder* recorder, int b )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies[b];
    record_wait_load( recorder, recorder->frame_count - 1, b );
    memcpy( file->last, body->triangles, (size_t)record_triangle_bytes( body ) );
    load( recorder, b, 0, false, file->first[0] );
    if ( has_normals( body ) )
    {
        load( recorder, b, 0, true, file->first[1] );
    }
}

static const wisp_vec3* load_block( wisp_recorder* recorder, int b, int block )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies[b];
    const int base = count_base( body ), per_target = count_per_target( body );
    if ( block < base )
    {
        return block < per_target ? file->first[block] : body->colours;
    }
    const int part = ( block - base ) % per_target;
    load( recorder, b, 1 + ( block - base ) / per_target, part == 1, file->vectors );
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        const wisp_vec3 from = file->first[part][v], to = file->vectors[v];
        file->vectors[v] = ( wisp_vec3 ){ to.x - from.x, to.y - from.y, to.z - from.z };
    }
    return file->vectors;
}

static int count_blocks( const wisp_recorder* recorder, int b )
{
    const wisp_record_body* body = &recorder->bodies[b];
    return count_base( body ) + count_targets( body, recorder->frame_count ) * count_per_target( body );
}

// ---- JSON part -------------------------------------------------------------------------------------------------

static void begin_list( glb_file* file, const char* name )
{
    fprintf( file->json, "\"%s\":[", name );
    file->is_first = true;
}

// @return where an item of a list is to be written, after the comma
static FILE* next( glb_file* file )
{
    fputs( file->is_first ? "" : ",", file->json );
    file->is_first = false;
    return file->json;
}

static void write_nodes( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "nodes" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        fprintf( next( file ), "%d", b );
    }
    fputs( "]}],", file->json );
    begin_list( file, "nodes" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        fprintf( next( file ), "{\"name\":\"%s\",\"mesh\":%d}", recorder->bodies[b].name, b );
    }
}

// Modelling programs show the names of targets.
static void write_targets( glb_file* file, const wisp_record_body* body, int count, int accessor )
{
    fputs( ",", file->json );
    begin_list( file, "targets" );
    for ( int t = 0; t < count; ++t )
    {
        fprintf( next( file ), "{\"POSITION\":%d", accessor++ );
        if ( has_normals( body ) )
        {
            fprintf( file->json, ",\"NORMAL\":%d", accessor++ );
        }
        fputs( "}", file->json );
    }
    fputs( "]}],\"extras\":{", file->json );
    begin_list( file, "targetNames" );
    for ( int t = 0; t < count; ++t )
    {
        fprintf( next( file ), "\"frame_%04d\"", t + 2 );
    }
    fputs( "]}}", file->json );
}

// The accessors of a body are its indices and its blocks.
static void write_meshes( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    FILE* out = file->json;
    int accessor = 0;
    begin_list( file, "meshes" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        const bool has_indices = count_indices( body ) > 0;
        const int mode = !has_indices ? POINTS : body->offsets != NULL ? LINES : TRIANGLES;
        const int targets = count_targets( body, recorder->frame_count ), block = accessor + has_indices;
        fprintf( out, "%s{\"name\":\"%s\",\"primitives\":[{\"mode\":%d,\"material\":%d", b > 0 ? "," : "", body->name,
                 mode, b );
        if ( has_indices )
        {
            fprintf( out, ",\"indices\":%d", accessor );
        }
        fprintf( out, ",\"attributes\":{\"POSITION\":%d", block );
        if ( has_normals( body ) )
        {
            fprintf( out, ",\"NORMAL\":%d", block + 1 );
        }
        if ( body->colours != NULL )
        {
            fprintf( out, ",\"COLOR_0\":%d", block + 1 + has_normals( body ) );
        }
        fputs( "}", out );
        targets > 0 ? write_targets( file, body, targets, block + count_base( body ) ) : (void)fputs( "}]}", out );
        accessor = block + count_blocks( recorder, b );
    }
}

// The colours of vertices are multiplied with that of the material, which is then white.
static void write_materials( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "materials" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        const wisp_vec3 c = body->colours != NULL ? ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f } : record_base_colour( body );
        fprintf( next( file ),
                 "{\"name\":\"%s\",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
                 "[%.9g,%.9g,%.9g,1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}",
                 body->name, (double)c.x, (double)c.y, (double)c.z );
    }
}

// @param at bytes from the start of the view @param bounds null: none
static void write_accessor( glb_file* file, uint64_t at, int component, uint64_t count, const char* type,
                            const record_bounds* bounds )
{
    fprintf( next( file ),
             "{\"bufferView\":%d,\"byteOffset\":%llu,\"componentType\":%d,\"count\":%llu,\"type\":\"%s\"",
             file->view_count, (unsigned long long)at, component, (unsigned long long)count, type );
    if ( bounds != NULL )
    {
        const wisp_vec3 a = bounds->least, b = bounds->most;
        fprintf( file->json, ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", (double)a.x, (double)a.y,
                 (double)a.z, (double)b.x, (double)b.y, (double)b.z );
    }
    fputs( "}", file->json );
    ++file->accessor_count;
}

// The indices of a body are a view, and its blocks another one. The bounds of points and displacements are exact.
static void write_body_accessors( wisp_recorder* recorder, int b )
{
    glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies[b];
    const int base = count_base( body ), per_target = count_per_target( body );
    if ( count_indices( body ) > 0 )
    {
        write_accessor( file, 0, UNSIGNED_INT, count_indices( body ), "SCALAR", NULL );
        ++file->view_count;
    }
    load_body( recorder, b );
    for ( int i = 0; i < count_blocks( recorder, b ); ++i )
    {
        const bool is_position = i < base ? i == 0 : ( i - base ) % per_target == 0;
        record_bounds bounds = { .filled = false };
        if ( is_position )
        {
            record_extend_bounds( &bounds, load_block( recorder, b, i ), body->vertex_count );
        }
        write_accessor( file, (uint64_t)i * block_bytes( body ), FLOAT, (uint64_t)body->vertex_count, "VEC3",
                        is_position ? &bounds : NULL );
    }
    ++file->view_count;
}

// The times and weights of the animation are the last two accessors, in the last view.
static void write_accessors( wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "accessors" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        write_body_accessors( recorder, b );
    }
    if ( is_animated( recorder ) )
    {
        const uint64_t count = (uint64_t)recorder->frame_count;
        fprintf( next( file ),
                 "{\"bufferView\":%d,\"componentType\":%d,\"count\":%llu,\"type\":\"SCALAR\",\"min\":[%.9g],"
                 "\"max\":[%.9g]}",
                 file->view_count, FLOAT, (unsigned long long)count, (double)(float)record_wait_time( recorder, 0 ),
                 (double)(float)recorder->last_time );
        ++file->accessor_count;
        write_accessor( file, 4 * count, FLOAT, count * ( count - 1 ), "SCALAR", NULL );
    }
}

static void write_view( glb_file* file, uint64_t size, const char* more )
{
    fprintf( next( file ), "{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu%s}", (unsigned long long)file->size,
             (unsigned long long)size, more );
    file->size += size;
}

static void write_views( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "bufferViews" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        if ( count_indices( body ) > 0 )
        {
            write_view( file, 4 * count_indices( body ), ",\"target\":34963" ); // indices
        }
        write_view( file, (uint64_t)count_blocks( recorder, b ) * block_bytes( body ),
                    ",\"byteStride\":12,\"target\":34962" ); // vertices
    }
    if ( is_animated( recorder ) )
    {
        write_view( file, 4 * (uint64_t)recorder->frame_count * (uint64_t)recorder->frame_count, "" );
    }
}

// All bodies that move have the same weights.
static void write_animation( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    fprintf( file->json,
             ",\"animations\":[{\"name\":\"recording\",\"samplers\":[{\"input\":%d,\"output\":%d,"
             "\"interpolation\":\"LINEAR\"}],",
             file->accessor_count - 2, file->accessor_count - 1 );
    begin_list( file, "channels" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        if ( !recorder->bodies[b].is_static )
        {
            fprintf( next( file ), "{\"sampler\":0,\"target\":{\"node\":%d,\"path\":\"weights\"}}", b );
        }
    }
    fputs( "]}]", file->json );
}

static void write_json( wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    fputs( "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Wisp " WISP_VERSION_STRING "\"}", file->json );
    if ( recorder->frame_count > 0 )
    {
        fputs( ",\"scene\":0,\"scenes\":[{", file->json );
        write_nodes( recorder );
        fputs( "],", file->json );
        write_meshes( recorder );
        fputs( "],", file->json );
        write_materials( recorder );
        fputs( "],", file->json );
        write_accessors( recorder );
        fputs( "],", file->json );
        write_views( recorder );
        fprintf( file->json, "],\"buffers\":[{\"byteLength\":%llu}]", (unsigned long long)file->size );
    }
    if ( is_animated( recorder ) )
    {
        write_animation( recorder );
    }
    fputs( "}", file->json );
}

// ---- binary part -----------------------------------------------------------------------------------------------

static void put_indices( FILE* out, const wisp_record_body* body )
{
    if ( body->offsets == NULL )
    {
        record_put_words( out, body->triangles, 3 * (size_t)body->triangle_count );
        return;
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            record_put_words( out, ( const int[] ){ v, v + 1 }, 2 );
        }
    }
}

// In frame f the weight of target f - 1 is 1, in the first frame none.
static void put_animation( const wisp_recorder* recorder, FILE* out )
{
    const int count = recorder->frame_count;
    for ( int f = 0; f < count; ++f )
    {
        const float time = (float)record_wait_time( recorder, f );
        record_put_words( out, &time, 1 );
    }
    for ( int f = 0; f < count; ++f )
    {
        for ( int t = 0; t + 1 < count; ++t )
        {
            const float weight = t + 1 == f ? 1.0f : 0.0f;
            record_put_words( out, &weight, 1 );
        }
    }
}

static void put_binary( wisp_recorder* recorder, FILE* out )
{
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        load_body( recorder, b );
        record_set_triangles( body, ( (const glb_file*)recorder->file )->last );
        put_indices( out, body );
        for ( int i = 0; i < count_blocks( recorder, b ); ++i )
        {
            record_put_words( out, load_block( recorder, b, i ), 3 * (size_t)body->vertex_count );
        }
    }
    if ( is_animated( recorder ) )
    {
        put_animation( recorder, out );
    }
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
static void put_json( FILE* out, const char* text, size_t size, uint64_t binary )
{
    const uint64_t padded = ( (uint64_t)size + 3 ) / 4 * 4;
    unsigned char header[HEADER_BYTES] = { 'g', 'l', 'T', 'F' };
    io_put_u32( header + 4, 2 );
    io_put_u32( header + 8, (uint32_t)( HEADER_BYTES + CHUNK_BYTES + padded + binary ) );
    fwrite( header, 1, sizeof header, out );
    put_chunk_header( out, padded, "JSON" );
    fwrite( text, 1, size, out );
    fwrite( "   ", 1, (size_t)( padded - size ), out );
}

static wisp_status glb_end( wisp_recorder* recorder, wisp_error* error )
{
    glb_file* file = recorder->file;
    FILE* out = recorder->outputs[0].stream;
    char* text = NULL;
    size_t size = 0;
    file->json = open_memstream( &text, &size );
    bool is_written = file->json != NULL;
    if ( is_written )
    {
        write_json( recorder );
        is_written = !ferror( file->json );
        is_written = fclose( file->json ) == 0 && is_written;
    }
    if ( is_written )
    {
        put_json( out, text, size, file->size > 0 ? CHUNK_BYTES + file->size : 0 );
    }
    free( text );
    if ( is_written && recorder->frame_count > 0 )
    {
        put_chunk_header( out, file->size, "BIN\0" );
        put_binary( recorder, out );
    }
    return is_written ? WISP_OK : record_no_memory( recorder->path, error );
}

const record_format record_format_glb = {
    ".glb",         .has_normals = true, .file_size = sizeof( glb_file ), .begin = glb_begin, .frame = glb_frame,
    .end = glb_end,
};
