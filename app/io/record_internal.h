/// Private to the recording files.
#pragma once

#include <string.h>

#include "io_bytes.h"
#include "io_file.h"
#include "record.h"

// ---- our own format ----
//
// Little-endian. A header, frames that are all equally long, the mark of the end:
//
//     header  "WISP\r\n\x1a\n", u32 version, u32 bodies, u64 header bytes, u64 frame bytes, f64 step seconds,
//             bodies, u64 checksum of all before
//     body    u32 kind, u32 letters of the name, u32 vertices, u32 triangles or strands,
//             name with zeros up to a multiple of 4, i32 [triangles][3] or [strands + 1]
//     frame   "WISPFRAM", u64 frame bytes, u64 index, f64 time, u64 world hash, for each body f32 [vertices][3] and,
//             if its triangles change, i32 [triangles][3]; u64 checksum of all before
//     end     "WISPEND\n", u64 frames, u64 checksum of all before
//
// Checksums of frames and of the end start from the header's, so that a frame of another recording is rejected. The
// line ends in the first bytes change if a transfer treats the file as text.

enum
{
    RECORD_VERSION = 1,
    RECORD_MAGIC_SIZE = 8,
    RECORD_CHECKSUM_SIZE = 8,

    RECORD_AT_VERSION = 8,
    RECORD_AT_BODY_COUNT = 12,
    RECORD_AT_HEADER_BYTES = 16,
    RECORD_AT_FRAME_BYTES = 24,
    RECORD_AT_STEP_SECONDS = 32,
    RECORD_AT_BODIES = 40,

    RECORD_BODY_SIZE = 16, // before the name
    RECORD_MESH = 0,
    RECORD_STRANDS = 1,
    RECORD_CHANGING_MESH = 2, // its triangles change

    RECORD_FRAME_AT_BYTES = 8,
    RECORD_FRAME_AT_INDEX = 16,
    RECORD_FRAME_AT_TIME = 24,
    RECORD_FRAME_AT_HASH = 32,
    RECORD_FRAME_AT_POINTS = 40,

    RECORD_END_AT_COUNT = 8,
    RECORD_END_SIZE = 24,

    RECORD_POINT_SIZE = 12,
};

#define RECORD_MAGIC "WISP\r\n\x1a\n"
#define RECORD_FRAME_MAGIC "WISPFRAM"
#define RECORD_END_MAGIC "WISPEND\n"

/// Every step is a bijection of the hash and of the word, so that damage within one word is always detected.
uint64_t record_checksum( uint64_t seed, const unsigned char* bytes, size_t size );

/// Little-endian floats out of and into bytes.
void record_get_points( const unsigned char* bytes, int count, wisp_vec3* points );
void record_put_points( unsigned char* bytes, const wisp_vec3* points, int count );

// ---- bodies ----

/// Bodies that own their arrays.
typedef struct record_bodies
{
    wisp_record_body* list;
    const int32_t** sources; ///< [count] of a recorder: the caller's triangles where they change, else null
    int count;
} record_bodies;

/// Check all requirements of record.h on bodies.
/// @param name of the file in messages
wisp_status record_check_bodies( const wisp_record_body* bodies, int count, const char* name, wisp_error* error );

/// Check the triangles of a mesh.
wisp_status record_check_mesh( const wisp_record_body* body, const char* name, wisp_error* error );

wisp_status record_copy_bodies( const wisp_record_body* bodies, int count, const char* name, record_bodies* out,
                                wisp_error* error );

/// Release what was allocated so far; pointers that are null are allowed.
void record_release_bodies( record_bodies* bodies );

/// Bytes of the points of all bodies, and of triangles that change, in a frame of our own format.
uint64_t record_frame_bytes( const record_bodies* bodies );

/// Bytes of the triangles of a body if they change, else 0.
uint64_t record_triangle_bytes( const wisp_record_body* body );

/// Replace triangles that change. @param triangles [triangle_count][3]
void record_set_triangles( const wisp_record_body* body, const int32_t* triangles );

/// The first number of a body that is not finite, or -1; three numbers a vertex.
int64_t record_find_not_finite( const wisp_vec3* points, int count );

// ---- writers ----

typedef struct record_frame
{
    double time;
    uint64_t hash;
    const wisp_vec3* const* points;
} record_frame;

typedef struct record_format record_format;

struct wisp_recorder
{
    const record_format* format;
    record_bodies bodies;
    char* path;
    double dt;
    double last_time; ///< of the previous frame, if there is one
    int frame_count;
    int frames_expected; ///< 0: unknown
    bool lost;           ///< a write failed that cannot be undone
    void* file;          ///< the format's own

    wisp_vec3** fixed;   ///< [body_count] points of static bodies in the first frame; null for the others
    double* normal_sums; ///< [largest vertex_count of a mesh][3]; null without normals
    wisp_vec3* normals;  ///< [largest vertex_count of a mesh]
};

/// Functions of a format. Frames are checked before.
struct record_format
{
    const char* extension;
    bool has_values;  ///< holds the values of bodies
    bool has_normals; ///< calls record_normals()
    /// Fill recorder->file; a failure leaves nothing behind.
    wisp_status ( *open )( wisp_recorder* recorder, wisp_error* error );
    wisp_status ( *frame )( wisp_recorder* recorder, const record_frame* frame, wisp_error* error );
    /// Finish and free recorder->file, or discard it where recorder->lost.
    wisp_status ( *close )( wisp_recorder* recorder, wisp_error* error );
};

extern const record_format record_format_wisp, record_format_pc2, record_format_pvd, record_format_obj,
    record_format_usda, record_format_glb;

// ---- what formats for pictures have in common ----

/// Compute the unit normals of a mesh, weighted by area as those of the engine; 0 where they cancel.
/// @return [vertex_count], valid until the next call
const wisp_vec3* record_normals( const wisp_recorder* recorder, int body, const wisp_vec3* points );

/// Carry vectors at vertices to later triangles, in which vertices are split: each corner keeps its vector. What corners get
/// instead of their vertex had no corner before.
/// @param now, later [triangle_count][3] @param vectors [vertex_count]
void record_carry_corners( const wisp_record_body* body, const int32_t* now, const int32_t* later,
                           wisp_vec3* vectors );

/// Linear RGB of a body without colours.
wisp_vec3 record_base_colour( const wisp_record_body* body );

/// Frames that wait in a file without a name until all are known, because a format stores bodies one after the other.
typedef struct record_waiting record_waiting;

wisp_status record_waiting_open( const wisp_recorder* recorder, record_waiting** out, wisp_error* error );
/// Add a frame after those of the recorder. A write that failed loses the recording.
wisp_status record_waiting_add( wisp_recorder* recorder, record_waiting* waiting, const record_frame* frame,
                                wisp_error* error );
/// Seconds of a frame.
double record_waiting_time( const record_waiting* waiting, int frame );
/// Points of a body that is not static; triangles that change become those of the frame. @param out [vertex_count]
wisp_status record_waiting_points( const wisp_recorder* recorder, const record_waiting* waiting, int frame, int body,
                                   wisp_vec3* out, wisp_error* error );
/// A value of a body. @param out [vertex_count]
wisp_status record_waiting_numbers( const wisp_recorder* recorder, const record_waiting* waiting, int frame, int body,
                                    int value, float* out, wisp_error* error );
/// Null is allowed.
void record_waiting_close( record_waiting* waiting );

/// The path with `insert` before its extension: drape.pc2, _cloth -> drape_cloth.pc2.
/// @return for free(); null without memory
char* record_path_with( const char* path, const char* insert );

/// Position of the extension; the end of the path if there is none.
size_t record_stem_length( const char* path );

wisp_status record_no_memory( const char* name, wisp_error* error );

/// An error of the operating system, with the reason in errno.
wisp_status record_refused( const char* path, const char* what, wisp_error* error );

// ---- readers ----

/// Bytes of a file or in memory, read from anywhere.
typedef struct record_source
{
    const unsigned char* bytes; ///< null: of a file
    unsigned char* buffer;      ///< of a file: the last bytes read
    size_t buffer_size;
    uint64_t size;
    int descriptor;
    char* name; ///< short, for messages
} record_source;

/// @return WISP_IO_ERROR; WISP_BAD_INPUT not a regular file, which random access requires; WISP_NO_MEMORY
wisp_status record_source_open( const char* path, record_source* source, wisp_error* error );
wisp_status record_source_open_memory( const void* bytes, size_t size, const char* name, record_source* source,
                                       wisp_error* error );
void record_source_close( record_source* source );

/// @param at, size within the source
/// @param view receives the bytes, valid until the next call
wisp_status record_source_read( record_source* source, uint64_t at, size_t size, const unsigned char** view,
                                wisp_error* error );

// ---- printing ----

/// The box around points; empty when zero-initialised.
typedef struct record_bounds
{
    wisp_vec3 least, most;
    bool filled;
} record_bounds;

void record_extend_bounds( record_bounds* bounds, const wisp_vec3* points, int count );
