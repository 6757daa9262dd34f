/// Recordings: the position of every vertex of a scene, frame by frame. Written while a scene runs, read back to
/// replay it.
///
///     extension  read  write  what it is
///     .wisp      yes   yes    our own: every bit of every frame, checksums, survives a crash
///     .pc2       yes   yes    point cache 2, for modifiers of modelling programs; one body per file
///     .pvd       no    yes    ParaView's list of times; frames are .vtp files in a folder next to it
///     .obj       no    yes    one numbered file per frame
///     .usda      no    yes    USD text: meshes and curves with time samples
///     .glb       no    yes    binary glTF 2.0: a morph target per frame, and an animation of their weights
///
/// A recording has a list of bodies that is fixed when it starts, and frames that hold the points of all of them.
/// Files are untrusted bytes: memory is allocated only after the file is known to be long enough to fill it.
#pragma once

#include <stdio.h>

#include "wisp/base.h"

#ifdef __cplusplus
extern "C"
{
#endif

/// Letters of a body's name; the rest is as in scenes: A-Z a-z 0-9 _ -
#define WISP_RECORD_MAX_NAME 64

/// Bodies of one recording.
#define WISP_RECORD_MAX_BODIES 4096

/// Bytes of the longest list of bodies that is read: names, triangles, offsets.
#define WISP_RECORD_HEADER_CAP ( (uint64_t)1 << 30 )

/// Frames of a .glb file: programs keep every morph target in memory, and three.js one layer of a texture for each.
#define WISP_RECORD_GLB_MAX_FRAMES 1000

/// Bytes of a .glb file: readers in browsers load it as one block of memory.
#define WISP_RECORD_GLB_MAX_BYTES ( (uint64_t)1 << 30 )

    /// A number per vertex that changes with the frames, such as strain.
    typedef struct wisp_record_value
    {
        const char* name; ///< 1 to WISP_RECORD_MAX_NAME of A-Z a-z 0-9 _, no digit first, no two of a body the same
        const float* numbers; ///< [vertex_count], finite; not copied: each wisp_recorder_frame() reads them
    } wisp_record_value;

    /// A body: strands if it has offsets, else a triangle mesh.
    typedef struct wisp_record_body
    {
        const char* name;         ///< 1 to WISP_RECORD_MAX_NAME letters, no two bodies the same
        const int32_t* triangles; ///< mesh: [triangle_count][3] vertices, counter-clockwise; may be null
        const int32_t* offsets;   ///< strands: [strand_count + 1]; strand s: offsets[s] .. offsets[s + 1] - 1
        int vertex_count;         ///< >= 1
        int triangle_count;       ///< >= 0, of a mesh
        int strand_count;         ///< >= 1, of strands

        // What .pvd, .usda and .glb hold besides. Other formats and the readers leave it out, but for the last.
        const float* widths;             ///< [vertex_count] m, diameters of strands, >= 0; null: none
        const wisp_vec3* colours;        ///< [vertex_count] linear RGB in [0, 1]; null: none
        wisp_vec3 base_colour;           ///< linear RGB in [0, 1] of a body without colours; (0, 0, 0): a light grey
        const wisp_record_value* values; ///< [value_count], see wisp_record_has_values()
        int value_count;                 ///< >= 0
        bool is_static;                  ///< its points are those of the first frame in every frame
        /// Vertices are split, so that corners get other vertices: each wisp_recorder_frame() reads `triangles` again,
        /// and each wisp_recording_frame() fills it. .glb has the triangles of the last frame in all frames, .pc2 none.
        bool triangles_change;
    } wisp_record_body;

    // ---- writing -----------------------------------------------------------------------------------------------

    typedef enum wisp_record_format
    {
        WISP_RECORD_BY_NAME, ///< the extension of the path decides
        WISP_RECORD_WISP,
        WISP_RECORD_TRACKS, ///< not by name: it holds only `tracks`
    } wisp_record_format;

    /// A vertex to follow.
    typedef struct wisp_track_point
    {
        int body;
        int vertex;
    } wisp_track_point;

    /// The bodies of a recording. Copied; need not outlive the call.
    typedef struct wisp_recorder_def
    {
        const wisp_record_body* bodies;
        int body_count; ///< 1 to WISP_RECORD_MAX_BODIES
        double dt;      ///< s, > 0, between two frames; .usda counts its time codes in it
        double origin
            [3]; ///< m, finite: what points are relative to. .wisp, .usda and .glb say it; others hold points in the world
        int frame_count; ///< expected; .glb refuses more than it can hold before the first one. 0: unknown
        const wisp_track_point* tracks; ///< [track_count] of WISP_RECORD_TRACKS
        int track_count;
    } wisp_recorder_def;

    typedef struct wisp_recorder wisp_recorder;

    /// Start a recording. The files of each format:
    /// - .wisp: `path` at once, with the list of bodies; a frame is in the file when wisp_recorder_frame() returns.
    /// - .pc2: `path` when the recorder is closed. Several bodies are one file each: `drape_<body>.pc2`.
    /// - .pvd: `path` when the recorder is closed, a file `drape/<body>_0001.vtp` per body and frame at once.
    /// - .obj: `drape_0001.obj` per frame at once, for `drape.obj`. Frames count from 1.
    /// - tracks: `path` when the recorder is closed: a line of names, `time,cloth.0.x,...`, then a line per frame, with enough
    ///   digits to restore every bit.
    /// - .usda, .glb: `path` when the recorder is closed; until then the frames are in a file without a name next to it.
    /// An existing file is replaced in one step. Numbered files of a longer recording under the same name remain
    /// beyond the last frame.
    /// @param out receives the recorder, for wisp_recorder_close(); null on failure
    /// @return WISP_BAD_INPUT an unknown extension, or a body (the message names it) that is malformed or does not
    ///        fit the format, or more frames than the format can hold; WISP_IO_ERROR; WISP_NO_MEMORY
    WISP_API wisp_status wisp_recorder_open( const char* path, wisp_record_format format,
                                             const wisp_recorder_def* def, wisp_recorder** out, wisp_error* error );

    /// Whether files of this name hold the values of bodies: .pvd and .usda do.
    WISP_API bool wisp_record_has_values( const char* path );

    /// Add a frame.
    /// @param time s, finite, greater than that of the frame before
    /// @param hash of the world's state, to be compared by a replay; 0: none. Only .wisp keeps it.
    /// @param points [body_count][vertex_count], m, finite
    /// @return WISP_BAD_INPUT the time, a number that is not finite, a static body that has moved, or a frame more than
    ///        the format can hold: nothing is written and the recording continues.
    ///        WISP_IO_ERROR: .wisp, .pvd and .obj keep the frames before, and the call may be repeated;
    ///        .pc2, .usda, .glb and tracks are lost, and wisp_recorder_close() reports it again.
    WISP_API wisp_status wisp_recorder_frame( wisp_recorder* recorder, double time, uint64_t hash,
                                              const wisp_vec3* const* points, wisp_error* error );

    /// Finish the files and free the recorder, at any frame and after any failure too: the files are valid and hold the
    /// frames so far, however many were expected. Null is allowed.
    /// @return WISP_IO_ERROR the first file that could not be finished: the old one, if there was one, is unchanged,
    ///        except for .wisp, which keeps its whole frames and lacks only the mark of its end
    WISP_API wisp_status wisp_recorder_close( wisp_recorder* recorder, wisp_error* error );

    // ---- reading .wisp -----------------------------------------------------------------------------------------

    typedef struct wisp_recording wisp_recording;

    typedef struct wisp_recording_info
    {
        double dt;            ///< s, between two frames
        double origin[3];     ///< m, place in the world that points are relative to
        int body_count;       ///< >= 1
        int frame_count;      ///< whole frames, including damaged ones
        uint64_t frame_bytes; ///< of one frame; all have the same length
        uint64_t first_byte;  ///< where frame 0 starts
        uint64_t tail_bytes;  ///< bytes after the last whole frame, apart from the mark of the end: a truncated frame
        bool complete;        ///< the recorder was closed: the mark of the end is there, followed by nothing
    } wisp_recording_info;

    /// Open a file and read its list of bodies. Frames are read and checked one by one on request. A truncated
    /// recording opens with its whole frames; wisp_recording_describe() reports the truncation.
    /// @param out receives the recording, for wisp_recording_close(); null on failure
    /// @return WISP_IO_ERROR an error of the operating system; WISP_BAD_INPUT not a recording, or its list of bodies
    ///        is damaged (the message names the byte); WISP_NO_MEMORY
    WISP_API wisp_status wisp_recording_open( const char* path, wisp_recording** out, wisp_error* error );

    /// The same for bytes in memory, which are not copied and must outlive the recording.
    /// @param name for messages
    WISP_API wisp_status wisp_recording_open_memory( const void* bytes, size_t size, const char* name,
                                                     wisp_recording** out, wisp_error* error );

    /// Null is allowed.
    WISP_API void wisp_recording_close( wisp_recording* recording );

    WISP_API wisp_recording_info wisp_recording_describe( const wisp_recording* recording );

    /// @param body 0 .. body_count - 1
    /// @return belongs to the recording. Triangles that change are those of the last frame whose points of this body were read,
    ///        at first those with which it was opened. Without a frame nothing confirms vertex_count: allocate memory only if there
    ///        is a frame, which the file is then long enough to fill.
    WISP_API const wisp_record_body* wisp_recording_body( const wisp_recording* recording, int body );

    /// Read a frame, in any order. The bits are the recorded ones. Not thread-safe: one recording has one buffer.
    /// @param index 0 .. frame_count - 1
    /// @param points [body_count][vertex_count] to be filled, and triangles that change with them; null, or null for a body,
    ///        if not needed
    /// @param time, hash may be null
    /// @return WISP_BAD_INPUT no such frame, or a damaged one: the message names its number and the byte where it
    ///         starts, and nothing is filled; WISP_IO_ERROR; WISP_NO_MEMORY
    WISP_API wisp_status wisp_recording_frame( wisp_recording* recording, int index, wisp_vec3* const* points,
                                               double* time, uint64_t* hash, wisp_error* error );

    /// Read every frame; print the contents of the recording and its defects.
    /// @param name of the recording in the text
    /// @return WISP_BAD_INPUT a frame is damaged, or its time is not after the previous one: everything is printed
    ///        nevertheless, and the error has the first. A truncated recording is reported, not rejected.
    ///        WISP_IO_ERROR; WISP_NO_MEMORY
    WISP_API wisp_status wisp_recording_print( FILE* out, wisp_recording* recording, const char* name,
                                               wisp_error* error );

    // ---- reading .pc2 ------------------------------------------------------------------------------------------

    /// Open a point cache: a recording of one body, the vertices of a mesh without its triangles, in which frame n is at n s.
    /// The file must be exactly as long as its header states: it has no checksum, so only its length can show a defect.
    /// @return as wisp_recording_open()
    WISP_API wisp_status wisp_pc2_open( const char* path, wisp_recording** out, wisp_error* error );
    WISP_API wisp_status wisp_pc2_open_memory( const void* bytes, size_t size, const char* name, wisp_recording** out,
                                               wisp_error* error );

#ifdef __cplusplus
}
#endif
