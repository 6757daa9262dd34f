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
    MAGIC = 0x46546c67, // glTF
    JSON_CHUNK = 0x4e4f534a,
    BINARY_CHUNK = 0x004e4942,
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
    int most_frames;     // that the file can hold
    bool is_animated;    // a body has targets
    FILE* json;
    bool is_first; // item of a list: no comma before it
    int accessor_count, view_count;
    uint64_t size; // of the views so far
} glb_file;

// ---- layout ----------------------------------------------------------------------------------------------------

// A body in a file of so many frames.
typedef struct glb_shape
{
    const wisp_record_body* body;
    uint64_t index_count; // corners of triangles or ends of segments; 0: the vertices are drawn as points
    uint64_t block_bytes; //
    int base, part_count; // blocks before the targets, and of each target: points and, of triangles, normals
    int target_count;     //
    int block_count;      // of all
} glb_shape;

static glb_shape shape_of( const wisp_recorder* recorder, int b, int frame_count )
{
    const wisp_record_body* body = &recorder->bodies[b];
    glb_shape shape = {
        .body = body,
        .index_count = 3 * (uint64_t)body->triangle_count,
        .block_bytes = RECORD_POINT_SIZE * (uint64_t)body->vertex_count,
        .part_count = body->triangle_count > 0 ? 2 : 1,
        .target_count = body->is_static || frame_count < 2 ? 0 : frame_count - 1,
    };
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        const int vertices = body->offsets[s + 1] - body->offsets[s];
        shape.index_count += vertices > 1 ? 2 * ( (uint64_t)vertices - 1 ) : 0;
    }
    shape.base = shape.part_count + ( body->colours != NULL );
    shape.block_count = shape.base + shape.target_count * shape.part_count;
    return shape;
}

// ---- opening ---------------------------------------------------------------------------------------------------

// The most frames that the file can hold: all that is there once, a target of all bodies for each frame after the first, and,
// if something moves, n times with n - 1 weights each.
static int count_most_frames( const wisp_recorder* recorder )
{
    uint64_t once = 0, target = 0;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const glb_shape shape = shape_of( recorder, b, 2 );
        once += JSON_BYTES + 4 * shape.index_count + (uint64_t)shape.base * shape.block_bytes;
        target += shape.target_count > 0 ? JSON_TARGET_BYTES + (uint64_t)shape.part_count * shape.block_bytes : 0;
    }
    uint64_t n = 1;
    while ( n <= WISP_RECORD_GLB_MAX_FRAMES &&
            once + ( n - 1 ) * target + ( target > 0 && n > 1 ? 4 * n * n : 0 ) <= WISP_RECORD_GLB_MAX_BYTES )
    {
        ++n;
    }
    return (int)n - 1;
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
    file->first[0] = io_get( &recorder->memory, bytes );
    file->first[1] = io_get( &recorder->memory, bytes );
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
        const float* numbers = &frame->points[b]->x;
        for ( size_t i = 0; i < 3 * (size_t)recorder->bodies[b].vertex_count; ++i )
        {
            if ( fabsf( numbers[i] ) > 0.5f * FLT_MAX )
            {
                return record_wrong( error, recorder->path,
                                     "frame %d: body %s, vertex %zu is too far from the origin for a .glb file",
                                     recorder->frame_count, recorder->bodies[b].name, i / 3 );
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
    const wisp_record_body* body = &recorder->bodies[b];
    const wisp_vec3* vectors = record_wait_load( recorder, frame, b );
    vectors = are_normals ? record_normals( recorder, b, vectors ) : vectors;
    memcpy( out, vectors, (size_t)body->vertex_count * sizeof *out );
    if ( body->triangles_change )
    {
        record_carry_corners( body, body->triangles, recorder->kept_triangles, out );
    }
    for ( int v = 0; v < body->vertex_count && are_normals; ++v )
    {
        // The format demands unit normals, also of vertices whose triangles cancel.
        const bool is_zero = out[v].x == 0.0f && out[v].y == 0.0f && out[v].z == 0.0f;
        out[v] = is_zero ? ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } : out[v];
    }
}

// Load what all blocks of a body need: the triangles of the last frame, and the first frame.
static glb_shape begin_body( wisp_recorder* recorder, int b )
{
    const glb_file* file = recorder->file;
    const glb_shape shape = shape_of( recorder, b, recorder->frame_count );
    record_wait_load( recorder, recorder->frame_count - 1, b );
    record_keep_triangles( shape.body, recorder->kept_triangles ); // of the last frame
    for ( int part = 0; part < shape.part_count; ++part )
    {
        load( recorder, b, 0, part == 1, file->first[part] );
    }
    return shape;
}

static const wisp_vec3* load_block( wisp_recorder* recorder, int b, const glb_shape* shape, int block )
{
    const glb_file* file = recorder->file;
    wisp_vec3* vectors = recorder->kept_points;
    if ( block < shape->base )
    {
        return block < shape->part_count ? file->first[block] : shape->body->colours;
    }
    const int part = ( block - shape->base ) % shape->part_count;
    load( recorder, b, 1 + ( block - shape->base ) / shape->part_count, part == 1, vectors );
    for ( int v = 0; v < shape->body->vertex_count; ++v )
    {
        const wisp_vec3 from = file->first[part][v], to = vectors[v];
        vectors[v] = ( wisp_vec3 ){ to.x - from.x, to.y - from.y, to.z - from.z };
    }
    return vectors;
}

// ---- JSON part -------------------------------------------------------------------------------------------------

static void begin_list( glb_file* file, const char* before )
{
    fputs( before, file->json );
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
    begin_list( file, ",\"scene\":0,\"scenes\":[{\"nodes\":[" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        fprintf( next( file ), "%d", b );
    }
    begin_list( file, "]}],\"nodes\":[" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const double* o = recorder->origin;
        fprintf( next( file ), "{\"name\":\"%s\",\"mesh\":%d", recorder->bodies[b].name, b );
        if ( o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 )
        {
            fprintf( file->json, ",\"translation\":[%.17g,%.17g,%.17g]", o[0], o[1], o[2] );
        }
        fputs( "}", file->json );
    }
}

// Points and normals, of the first frame or of a target.
static void write_parts( const glb_file* file, const glb_shape* shape, int accessor )
{
    fprintf( file->json, "{\"POSITION\":%d", accessor );
    if ( shape->part_count > 1 )
    {
        fprintf( file->json, ",\"NORMAL\":%d", accessor + 1 );
    }
}

// Modelling programs show the names of targets.
static void write_targets( glb_file* file, const glb_shape* shape, int accessor )
{
    begin_list( file, ",\"targets\":[" );
    for ( int t = 0; t < shape->target_count; ++t, accessor += shape->part_count )
    {
        next( file );
        write_parts( file, shape, accessor );
        fputs( "}", file->json );
    }
    begin_list( file, "]}],\"extras\":{\"targetNames\":[" );
    for ( int t = 0; t < shape->target_count; ++t )
    {
        fprintf( next( file ), "\"frame_%04d\"", t + 2 );
    }
    fputs( "]}}", file->json );
}

// The accessors of a body are its indices and its blocks.
static void write_meshes( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    int accessor = 0;
    fputs( "],\"meshes\":[", file->json );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const glb_shape shape = shape_of( recorder, b, recorder->frame_count );
        const bool has_indices = shape.index_count > 0;
        const int mode = !has_indices ? POINTS : shape.body->offsets != NULL ? LINES : TRIANGLES;
        fprintf( file->json, "%s{\"name\":\"%s\",\"primitives\":[{\"mode\":%d,\"material\":%d", b > 0 ? "," : "",
                 shape.body->name, mode, b );
        if ( has_indices )
        {
            fprintf( file->json, ",\"indices\":%d", accessor++ );
        }
        fputs( ",\"attributes\":", file->json );
        write_parts( file, &shape, accessor );
        if ( shape.body->colours != NULL )
        {
            fprintf( file->json, ",\"COLOR_0\":%d", accessor + shape.part_count );
        }
        fputs( shape.target_count > 0 ? "}" : "}}]}", file->json );
        if ( shape.target_count > 0 )
        {
            write_targets( file, &shape, accessor + shape.base );
        }
        accessor += shape.block_count;
    }
}

// The colours of vertices are multiplied with that of the material, which is then white.
static void write_materials( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "],\"materials\":[" );
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

// Of the view that comes next. @param at bytes from its start @param bounds null: none
static void write_accessor( glb_file* file, uint64_t at, int component, uint64_t count, const char* type,
                            const io_bounds* bounds )
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
    const glb_shape shape = begin_body( recorder, b );
    if ( shape.index_count > 0 )
    {
        write_accessor( file, 0, UNSIGNED_INT, shape.index_count, "SCALAR", NULL );
        ++file->view_count;
    }
    for ( int i = 0; i < shape.block_count; ++i )
    {
        const bool is_position = i < shape.base ? i == 0 : ( i - shape.base ) % shape.part_count == 0;
        io_bounds bounds = { .filled = false };
        if ( is_position )
        {
            io_extend_bounds( &bounds, load_block( recorder, b, &shape, i ), shape.body->vertex_count );
        }
        write_accessor( file, (uint64_t)i * shape.block_bytes, FLOAT, (uint64_t)shape.body->vertex_count, "VEC3",
                        is_position ? &bounds : NULL );
    }
    ++file->view_count;
}

// The times and weights of the animation are the last two accessors, in the last view.
static void write_accessors( wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    begin_list( file, "],\"accessors\":[" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        write_body_accessors( recorder, b );
    }
    if ( file->is_animated )
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
    begin_list( file, "],\"bufferViews\":[" );
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const glb_shape shape = shape_of( recorder, b, recorder->frame_count );
        if ( shape.index_count > 0 )
        {
            write_view( file, 4 * shape.index_count, ",\"target\":34963" ); // indices
        }
        write_view( file, (uint64_t)shape.block_count * shape.block_bytes,
                    ",\"byteStride\":12,\"target\":34962" ); // vertices
    }
    if ( file->is_animated )
    {
        write_view( file, 4 * (uint64_t)recorder->frame_count * (uint64_t)recorder->frame_count, "" );
    }
    fprintf( file->json, "],\"buffers\":[{\"byteLength\":%llu}]", (unsigned long long)file->size );
}

// All bodies that move have the same weights.
static void write_animation( const wisp_recorder* recorder )
{
    glb_file* file = recorder->file;
    fprintf( file->json,
             ",\"animations\":[{\"name\":\"recording\",\"samplers\":[{\"input\":%d,\"output\":%d,"
             "\"interpolation\":\"LINEAR\"}]",
             file->accessor_count - 2, file->accessor_count - 1 );
    begin_list( file, ",\"channels\":[" );
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
        write_nodes( recorder );
        write_meshes( recorder );
        write_materials( recorder );
        write_accessors( recorder );
        write_views( recorder );
    }
    if ( file->is_animated )
    {
        write_animation( recorder );
    }
    fputs( "}", file->json );
}

// ---- binary part -----------------------------------------------------------------------------------------------

static void put_indices( FILE* out, const wisp_record_body* body )
{
    io_write_words( out, body->triangles, 3 * (size_t)body->triangle_count );
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            io_write_words( out, ( const int[] ){ v, v + 1 }, 2 );
        }
    }
}

// In frame f the weight of target f - 1 is 1, in the first frame none.
static void put_animation( const wisp_recorder* recorder, FILE* out )
{
    const int count = recorder->frame_count;
    for ( int f = 0; f < count; ++f )
    {
        io_write_words( out, &( const float ){ (float)record_wait_time( recorder, f ) }, 1 );
    }
    for ( int i = 0; i < count * ( count - 1 ); ++i )
    {
        const bool is_own = i % ( count - 1 ) + 1 == i / ( count - 1 );
        io_write_words( out, &( const float ){ is_own ? 1.0f : 0.0f }, 1 );
    }
}

static void put_binary( wisp_recorder* recorder, FILE* out )
{
    const glb_file* file = recorder->file;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const glb_shape shape = begin_body( recorder, b );
        record_set_triangles( shape.body, recorder->kept_triangles );
        put_indices( out, shape.body );
        for ( int i = 0; i < shape.block_count; ++i )
        {
            io_write_words( out, load_block( recorder, b, &shape, i ), 3 * (size_t)shape.body->vertex_count );
        }
    }
    if ( file->is_animated )
    {
        put_animation( recorder, out );
    }
}

// ---- whole file ------------------------------------------------------------------------------------------------

// The JSON part is filled up with blanks to whole words.
static void put_json( FILE* out, const char* text, size_t size, uint64_t binary )
{
    const size_t padded = ( size + 3 ) / 4 * 4;
    const uint64_t whole = 20 + padded + ( binary > 0 ? 8 + binary : 0 );
    const uint32_t header[5] = { MAGIC, 2, (uint32_t)whole, (uint32_t)padded, JSON_CHUNK };
    io_write_words( out, header, 5 );
    fwrite( text, 1, size, out );
    fwrite( "   ", 1, padded - size, out );
}

static wisp_status glb_end( wisp_recorder* recorder, wisp_error* error )
{
    glb_file* file = recorder->file;
    FILE* out = recorder->outputs[0].stream;
    char* text = NULL;
    size_t size = 0;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        file->is_animated = file->is_animated || shape_of( recorder, b, recorder->frame_count ).target_count > 0;
    }
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
        put_json( out, text, size, file->size );
    }
    free( text );
    if ( is_written && file->size > 0 )
    {
        io_write_words( out, ( const uint32_t[] ){ (uint32_t)file->size, BINARY_CHUNK }, 2 );
        put_binary( recorder, out );
    }
    return is_written ? WISP_OK : record_no_memory( recorder->path, error );
}

const record_format record_format_glb = {
    ".glb",
    .has_normals = true,
    .has_origin = true,
    .file_size = sizeof( glb_file ),
    .begin = glb_begin,
    .frame = glb_frame,
    .end = glb_end,
};
