/// Private to the recording files.
#pragma once

#include <stdio.h>
#include <string.h>

#include "io_bytes.h"
#include "io_file.h"
#include "record.h"

enum
{
    RECORD_POINT_SIZE = 12, ///< bytes of three little-endian floats
};

// ---- messages ----

/// "NAME: " and a message. @return WISP_BAD_INPUT
wisp_status record_wrong( wisp_error* error, const char* name, const char* format, ... ) WISP_PRINTF( 3, 4 );
wisp_status record_no_memory( const char* name, wisp_error* error );
/// An error of the operating system, with the reason in errno.
wisp_status record_refused( const char* path, const char* what, wisp_error* error );

// ---- bodies ----

/// Check all requirements of record.h on bodies.
/// @param name of the file in messages
wisp_status record_check_bodies( const wisp_record_body* bodies, int count, const char* name, wisp_error* error );
/// Check the triangles of a mesh.
wisp_status record_check_mesh( const wisp_record_body* body, const char* name, wisp_error* error );

/// Copy bodies; the numbers of values remain the caller's. @return null without memory
wisp_record_body* record_copy_bodies( io_memory* memory, const wisp_record_body* bodies, int count );

/// Bytes of the triangles of a body if they change, else 0.
uint64_t record_triangle_bytes( const wisp_record_body* body );
/// Replace triangles that change. @param triangles [triangle_count][3]
void record_set_triangles( const wisp_record_body* body, const int32_t* triangles );
/// Copy triangles if they change. @param out [triangle_count][3]
void record_keep_triangles( const wisp_record_body* body, int32_t* out );

/// The first number that is not finite, or -1; three numbers a point.
int64_t record_find_not_finite( const float* numbers, size_t count );

/// Carry vectors at vertices to later triangles, in which vertices are split: each corner keeps its vector. What corners get
/// instead of their vertex had no corner before.
/// @param now, later [triangle_count][3] @param vectors [vertex_count]
void record_carry_corners( const wisp_record_body* body, const int32_t* now, const int32_t* later,
                           wisp_vec3* vectors );

/// Linear RGB of a body without colours.
wisp_vec3 record_base_colour( const wisp_record_body* body );

// ---- writers ----

/// A frame with the points of all bodies. Triangles that change and values are in the recorder's bodies.
typedef struct record_frame
{
    double time;
    uint64_t hash;
    const wisp_vec3* const* points; ///< [body_count]
} record_frame;

/// What a recorder knows of a body besides.
typedef struct record_input
{
    const int32_t* triangles; ///< the caller's, where they change
    wisp_vec3* fixed;         ///< points of a static body in the first frame
    uint64_t waits_at;        ///< bytes from the start of a frame that waits
} record_input;

typedef struct record_format record_format;

struct wisp_recorder
{
    const record_format* format;
    io_memory memory;
    wisp_record_body* bodies; ///< [body_count]
    record_input* inputs;     ///< [body_count]
    int body_count;
    int most_vertices; ///< of a body
    char* path;
    char* beside; ///< [beside_size] room for a path beside it
    size_t beside_size;
    double dt;
    double origin[3]; ///< m, that points are relative to
    wisp_vec3**
        moved; ///< [body_count][vertex_count] points in the world, of a format without an origin that is not 0; else null
    double last_time; ///< of the previous frame, if there is one
    int frame_count;
    int frames_expected;      ///< 0: unknown
    wisp_track_point* tracks; ///< [track_count]
    int track_count;
    bool lost;  ///< a write failed that cannot be undone
    void* file; ///< the format's own

    int descriptor;     ///< of .wisp, else -1
    io_output* outputs; ///< [body_count] files that appear when the recorder is closed
    struct record_waiting* waiting;
    wisp_vec3* kept_points;  ///< [most_vertices] and
    int32_t* kept_triangles; ///< of another frame that waits, for its format

    double* normal_sums; ///< [most_vertices][3]; null without normals
    wisp_vec3* normals;  ///< [most_vertices]
};

/// Functions of a format, in which numbers have decimal points in every locale. Frames are checked before.
struct record_format
{
    const char* extension;
    bool has_values;  ///< holds the values of bodies
    bool has_normals; ///< calls record_normals()
    bool has_origin;  ///< says what points are relative to
    size_t file_size; ///< bytes of recorder->file, zeroed
    /// Check the bodies, then open files; null: nothing to do. The recorder closes them after a failure.
    wisp_status ( *begin )( wisp_recorder* recorder, wisp_error* error );
    wisp_status ( *frame )( wisp_recorder* recorder, const record_frame* frame, wisp_error* error );
    /// Write what comes after the frames, unless they are lost; null: nothing. The recorder puts the files in place.
    wisp_status ( *end )( wisp_recorder* recorder, wisp_error* error );
};

extern const record_format record_format_wisp, record_format_pc2, record_format_pvd, record_format_obj,
    record_format_usda, record_format_glb, record_format_tracks;

/// A path without its extension, and what comes after it instead: drape.pc2, "_%s.pc2" -> drape_cloth.pc2. Its length is at
/// most that of the path, its extension and a body's name, and 32. @return valid until the next call
const char* record_path_beside( wisp_recorder* recorder, const char* format, ... ) WISP_PRINTF( 2, 3 );
/// Extension of the recorder's path with its dot, or "".
const char* record_extension( const wisp_recorder* recorder );

/// Compute the unit normals of a mesh, weighted by area as those of the engine; 0 where they cancel.
/// @return [vertex_count], valid until the next call
const wisp_vec3* record_normals( const wisp_recorder* recorder, int body, const wisp_vec3* points );

// Frames that wait in a file without a name until all are known, because a format stores bodies one after the other.

/// Open that file, and after it the output of the recorder.
wisp_status record_wait_open( wisp_recorder* recorder, wisp_error* error );
/// Add a frame after those of the recorder. A write that failed loses the recording.
wisp_status record_wait_add( wisp_recorder* recorder, const record_frame* frame, wisp_error* error );
/// Seconds of a frame.
double record_wait_time( const wisp_recorder* recorder, int frame );
/// Read a body of a frame: its triangles that change and its values become those of the frame. A failure is remembered for
/// record_wait_close(), so that writers need not end. @return [vertex_count] points, valid until the next call
const wisp_vec3* record_wait_load( wisp_recorder* recorder, int frame, int body );
/// @return the first failure of record_wait_load()
wisp_status record_wait_close( wisp_recorder* recorder, wisp_error* error );

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

/// @param at, size within the source
/// @param view receives the bytes, valid until the next call
wisp_status record_source_read( record_source* source, uint64_t at, size_t size, const unsigned char** view,
                                wisp_error* error );
/// "NAME: byte AT: " and a message. @return WISP_BAD_INPUT
wisp_status record_wrong_byte( const record_source* source, uint64_t at, wisp_error* error, const char* format, ... )
    WISP_PRINTF( 4, 5 );

/// How a file starts: a magic, the version, and the rest of a header that has the same length in every file.
typedef struct record_start
{
    const char* magic;
    size_t magic_size;
    const char* what; ///< the magic in a message
    size_t size;
    uint32_t newest; ///< version
} record_start;

/// Read it. @param bytes receives its bytes, valid until the next call of record_source_read()
wisp_status record_read_start( record_source* source, const record_start* start, const unsigned char** bytes,
                               wisp_error* error );

struct wisp_recording
{
    record_source source;
    io_memory memory;
    wisp_record_body* bodies;
    wisp_recording_info info;
    bool is_cache;                  ///< .pc2
    size_t points_at;               ///< bytes from the start of a frame to its points
    float start_frame, sample_rate; ///< of a .pc2: frames of the host's time line
    uint64_t seed;                  ///< of a .wisp: the header's checksum
};

/// Where a frame starts.
uint64_t record_frame_byte( const wisp_recording* recording, int index );
/// Read the headers of both formats, and count the frames.
wisp_status record_read_own( wisp_recording* recording, wisp_error* error );
wisp_status record_read_cache( wisp_recording* recording, wisp_error* error );
/// Check a frame of a .wisp, apart from its points and triangles.
wisp_status record_check_own( const wisp_recording* recording, int index, const unsigned char* bytes, double* time,
                              uint64_t* hash, wisp_error* error );
