/// A small glTF file made by hand: a strip of two boxes of skin on two joints that bend, in two primitives that share an
/// edge, with colours, texture coordinates and an animation of each kind of interpolation.
#pragma once

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct gltf_bytes
{
    unsigned char data[8192];
    size_t size;
} gltf_bytes;

static inline void gltf_put( gltf_bytes* b, const void* from, size_t size )
{
    memcpy( b->data + b->size, from, size );
    b->size += size;
}

static inline void gltf_put_u32( gltf_bytes* b, uint32_t value )
{
    gltf_put( b, &value, sizeof value );
}

/// Where the arrays of the skinned strip begin in the binary part.
enum
{
    STRIP_POINTS = 0,      // 2 x 4 x vec3 float: each primitive has its own vertices
    STRIP_COLOURS = 96,    // 2 x 4 x vec4 of bytes, normalized
    STRIP_UVS = 128,       // 2 x 4 x vec2 float
    STRIP_JOINTS = 192,    // 2 x 4 x 4 bytes
    STRIP_WEIGHTS = 224,   // 2 x 4 x 4 float
    STRIP_INDICES = 352,   // 2 x 6 x uint16
    STRIP_MATRICES = 376,  // 2 x 16 float
    STRIP_TIMES = 504,     // 2 float: 0.5 s and 1.5 s
    STRIP_ROTATIONS = 512, // 2 x 4 float: none, and a quarter turn about z
    STRIP_MOVES = 544,     // 2 x 3 float: none, and 2 along y
    STRIP_SPLINE = 568,    // 2 x 3 x 3 float
    STRIP_BYTES = 640,
};

static inline gltf_bytes gltf_strip_binary( void )
{
    gltf_bytes b = { { 0 }, 0 };
    // x = 0, 1 and 2 at y = 0 and 1; the vertices of x = 1 are in both primitives
    static const float xs[2][4] = { { 0, 1, 1, 0 }, { 1, 2, 2, 1 } }, ys[4] = { 0, 0, 1, 1 };
    for ( int i = 0; i < 8; ++i )
    {
        const float p[3] = { xs[i / 4][i % 4], ys[i % 4], 0.0f };
        gltf_put( &b, p, sizeof p );
    }
    for ( int i = 0; i < 8; ++i )
    {
        const unsigned char c[4] = { (unsigned char)( 51 * xs[i / 4][i % 4] ), 255, 0, 9 };
        gltf_put( &b, c, sizeof c );
    }
    for ( int i = 0; i < 8; ++i )
    {
        // another piece of the picture for the second primitive: a seam
        const float uv[2] = { xs[i / 4][i % 4] + ( i < 4 ? 0.0f : 5.0f ), 0.25f };
        gltf_put( &b, uv, sizeof uv );
    }
    for ( int i = 0; i < 8; ++i )
    {
        const unsigned char joints[4] = { 0, 1, 0, 0 };
        gltf_put( &b, joints, sizeof joints );
    }
    for ( int i = 0; i < 8; ++i )
    {
        const float x = xs[i / 4][i % 4], second = x == 0.0f ? 0.0f : x == 1.0f ? 0.5f : 1.0f;
        const float weights[4] = { 1.0f - second, second, 0.0f, 0.0f };
        gltf_put( &b, weights, sizeof weights );
    }
    for ( int p = 0; p < 2; ++p )
    {
        static const uint16_t corners[6] = { 0, 1, 2, 0, 2, 3 };
        gltf_put( &b, corners, sizeof corners );
    }
    for ( int j = 0; j < 2; ++j )
    {
        // columns; the second joint is at x = 1
        const float m[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, j == 0 ? 0.0f : -1.0f, 0, 0, 1 };
        gltf_put( &b, m, sizeof m );
    }
    static const float times[2] = { 0.5f, 1.5f }, half = 0.70710678118654752f;
    static const float rotations[8] = { 0, 0, 0, 1, 0, 0, half, half }, moves[6] = { 0, 0, 0, 0, 2, 0 };
    // rows of in-tangent, value, out-tangent: from 0 with slope 3 to (1, 0, 0) with slope 0
    static const float spline[18] = { 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0 };
    gltf_put( &b, times, sizeof times );
    gltf_put( &b, rotations, sizeof rotations );
    gltf_put( &b, moves, sizeof moves );
    gltf_put( &b, spline, sizeof spline );
    return b;
}

#define STRIP_ACCESSOR( at, type, count, kind )                                                                      \
    "{\"bufferView\":0,\"byteOffset\":" #at ",\"componentType\":" #type ",\"count\":" #count ",\"type\":\"" kind "\"}"

#define STRIP_PRIMITIVE( a, b, c, d, e, f )                                                                          \
    "{\"attributes\":{\"POSITION\":" #a ",\"COLOR_0\":" #b ",\"TEXCOORD_0\":" #c ",\"JOINTS_0\":" #d                 \
    ",\"WEIGHTS_0\":" #e "},\"indices\":" #f "}"

#define STRIP_NODES                                                                                                  \
    "[{\"name\":\"body\",\"mesh\":0,\"skin\":0,\"translation\":[7,7,7]},"                                            \
    "{\"name\":\"root\",\"children\":[2],\"translation\":[0,0,1]},{\"name\":\"tip\",\"translation\":[1,0,0]}]"

/// @param buffer what the JSON says of the buffer
static inline void gltf_strip_json( char* text, size_t size, const char* buffer )
{
    snprintf(
        text, size,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":" STRIP_NODES
        ",\"meshes\":[{\"name\":\"strip\",\"primitives\":[" STRIP_PRIMITIVE( 0, 2, 4, 6, 8, 10 ) "," STRIP_PRIMITIVE(
            1, 3, 5, 7, 9,
            11 ) "]}],"
                 "\"skins\":[{\"name\":\"bones\",\"joints\":[1,2],\"inverseBindMatrices\":12}],"
                 "\"animations\":[{\"name\":\"bend\",\"samplers\":[{\"input\":13,\"output\":14},{\"input\":13,"
                 "\"output\":15,"
                 "\"interpolation\":\"STEP\"},{\"input\":13,\"output\":16,\"interpolation\":\"CUBICSPLINE\"}],"
                 "\"channels\":["
                 "{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"rotation\"}},"
                 "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"translation\"}},"
                 "{\"sampler\":2,\"target\":{\"node\":2,\"path\":\"translation\"}}]}],"
                 "\"accessors\":[" STRIP_ACCESSOR( 0, 5126, 4, "VEC3" ) "," STRIP_ACCESSOR(
                     48, 5126, 4,
                     "VEC3" ) ","
                              "{\"bufferView\":0,\"byteOffset\":96,\"componentType\":5121,\"normalized\":true,"
                              "\"count\":4,\"type\":\"VEC4\"},"
                              "{\"bufferView\":0,\"byteOffset\":112,\"componentType\":5121,\"normalized\":true,"
                              "\"count\":4,\"type\":\"VEC4\"}," STRIP_ACCESSOR( 128, 5126, 4, "VEC2" ) "," STRIP_ACCESSOR( 160, 5126, 4, "VEC2" ) "," STRIP_ACCESSOR(
                                  192,
                                  5121, 4, "VEC4" ) "," STRIP_ACCESSOR( 208, 5121, 4,
                                                                        "VEC4" ) "," STRIP_ACCESSOR( 224, 5126, 4,
                                                                                                     "VEC4" ) "," STRIP_ACCESSOR( 288,
                                                                                                                                  5126, 4, "VEC4" ) "," STRIP_ACCESSOR( 352,
                                                                                                                                                                        5123, 6, "SCALAR" ) "," STRIP_ACCESSOR( 364,
                                                                                                                                                                                                                5123, 6, "SCALAR" ) "," STRIP_ACCESSOR( 376, 5126, 2, "MAT4" ) ","
                                                                                                                                                                                                                                                                               "{\"bufferView\":0,\"byteOffset\":504,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\",\"min\":[0.5],\"max\":[1.5]}," STRIP_ACCESSOR( 512,
                                                                                                                                                                                                                                                                                                                                                                                                                           5126, 2, "VEC4" ) "," STRIP_ACCESSOR( 544,
                                                                                                                                                                                                                                                                                                                                                                                                                                                                 5126, 2, "VEC3" ) "," STRIP_ACCESSOR( 568,
                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                       5126,
                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                       6,
                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                       "VEC3" ) "],"
                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                                "\"bufferViews\":[{\"buffer\":0,\"byteLength\":640}],\"buffers\":[{%s\"byteLength\":640}]}",
        buffer );
}

/// JSON and a binary part as one file.
static inline gltf_bytes gltf_binary_file( const char* json, const gltf_bytes* binary )
{
    gltf_bytes b = { { 0 }, 0 };
    const uint32_t length = (uint32_t)strlen( json ), padded = ( length + 3 ) / 4 * 4;
    gltf_put( &b, "glTF", 4 );
    gltf_put_u32( &b, 2 );
    gltf_put_u32( &b, 12 + 8 + padded + 8 + (uint32_t)binary->size );
    gltf_put_u32( &b, padded );
    gltf_put( &b, "JSON", 4 );
    gltf_put( &b, json, length );
    gltf_put( &b, "   ", padded - length );
    gltf_put_u32( &b, (uint32_t)binary->size );
    gltf_put( &b, "BIN\0", 4 );
    gltf_put( &b, binary->data, binary->size );
    return b;
}
