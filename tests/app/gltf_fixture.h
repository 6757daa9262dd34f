/// Small glTF files of tests/bad/gltf, taken apart so that tests may change them. strip.glb is a strip of two boxes of skin on
/// two joints that bend, in two primitives that share an edge, with colours, texture coordinates and an animation of each kind
/// of interpolation. quad.glb is a square with two morph targets: one moves its vertices along z by 1, 2, 3, 4, the other is
/// sparse and moves vertex 2 by (5, 6, 7).
#pragma once

#include "files.h"
#include "gltf.h"

/// Where arrays of the strip begin in its binary part.
enum
{
    STRIP_POINTS = 0,      // 2 x 4 x vec3 float: each primitive has its own vertices
    STRIP_WEIGHTS = 224,   // 2 x 4 x 4 float
    STRIP_INDICES = 352,   // 2 x 6 x uint16
    STRIP_MATRICES = 376,  // 2 x 16 float
    STRIP_TIMES = 504,     // 2 float: 0.5 s and 1.5 s
    STRIP_ROTATIONS = 512, // 2 x 4 float: none, and a quarter turn about z
};

typedef struct gltf_parts
{
    char json[7000];
    unsigned char binary[1024];
    size_t size; ///< of the binary part
} gltf_parts;

static inline gltf_parts gltf_open( const char* name )
{
    char path[1024];
    size_t size;
    uint32_t length;
    snprintf( path, sizeof path, WISP_SOURCE_ROOT "/tests/bad/gltf/%s", name );
    SCOPED( free_local ) char* bytes = read_bytes( path, &size );
    gltf_parts parts = { .json = "" };
    memcpy( &length, bytes + 12, sizeof length );
    memcpy( parts.json, bytes + 20, length );
    parts.size = size - 28 - length;
    memcpy( parts.binary, bytes + 28 + length, parts.size );
    return parts;
}

/// Replace a piece of the text, which must be there.
static inline void gltf_edit( gltf_parts* parts, const char* from, const char* to )
{
    char* found = strstr( parts->json, from );
    assert_non_null( found );
    memmove( found + strlen( to ), found + strlen( from ), strlen( found + strlen( from ) ) + 1 );
    memcpy( found, to, strlen( to ) );
}

/// @return the file, exactly as long as it is, so that a sanitizer detects a read beyond its end; for free()
static inline unsigned char* gltf_file( const gltf_parts* parts, size_t* size )
{
    const uint32_t length = (uint32_t)strlen( parts->json ), padded = ( length + 3 ) / 4 * 4,
                   binary = (uint32_t)parts->size;
    const uint32_t head[] = { 0x46546c67, 2, 28 + padded + binary, padded, 0x4e4f534a },
                   middle[] = { binary, 0x004e4942 };
    unsigned char* file = checked_malloc( head[2] );
    memset( file, ' ', head[2] );
    memcpy( file, head, sizeof head );
    memcpy( file + 20, parts->json, length );
    memcpy( file + 20 + padded, middle, sizeof middle );
    memcpy( file + 28 + padded, parts->binary, binary );
    *size = head[2];
    return file;
}

static inline wisp_status gltf_read_parts( const gltf_parts* parts, const char* name, int flags, gltf_model* model,
                                           wisp_error* error )
{
    size_t size;
    SCOPED( free_local ) unsigned char* file = gltf_file( parts, &size );
    return gltf_read_bytes( file, size, NULL, name, flags, model, error );
}

/// A file whose text has one piece replaced, or none.
static inline gltf_model gltf_good( const char* name, const char* from, const char* to, int flags )
{
    gltf_parts parts = gltf_open( name );
    gltf_model model;
    wisp_error error = { .status = WISP_OK };
    gltf_edit( &parts, from, to );
    assert_ok( gltf_read_parts( &parts, name, flags, &model, &error ), error );
    return model;
}
