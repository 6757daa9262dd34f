/// The input of `wisp render`: the bodies of a scene, recording, point cache, mesh or groom, frame by frame. One
/// frame is loaded at a time, in any order; a scene that has to go back restarts, which gives the same bits.
#pragma once

#include "file_kind.h"
#include "io_file.h"
#include "progress.h"
#include "record.h"
#include "world_from_scene.h"

/// Meaning of the colours of bodies.
typedef enum picture_value
{
    PICTURE_BODY,   ///< the body
    PICTURE_STRAIN, ///< largest |l / l_0 - 1| of the edges at a vertex
    PICTURE_SPEED,  ///< m/s
    PICTURE_MAP,    ///< the first map of a surface of a scene, as its source has it
} picture_value;

/// Display of boundary particles.
typedef enum picture_layer_look
{
    PICTURE_LAYER_AUTO,   ///< as with PICTURE_LAYER_NORMAL, where there are some
    PICTURE_LAYER_NORMAL, ///< their colour is the direction of their normal
    PICTURE_LAYER_CLASS,  ///< their colour shows whether they are on an edge or inside a triangle
    PICTURE_LAYER_NONE,   ///< not at all
} picture_layer_look;

/// Boundary particles of a body of the loaded frame.
typedef struct picture_layer
{
    wisp_vec3* points;  ///< [count], those on edges first
    wisp_vec3* normals; ///< [count] unit
    int count, edge_count;
    int room;      ///< capacity of the arrays
    float spacing; ///< m, about the distance between them; 0: the body has no layer
} picture_layer;

/// A body of the loaded frame. Arrays belong to the source.
typedef struct picture_body
{
    const char* name;
    scene_body_kind kind;
    bool is_led; ///< a surface that nothing solves: its kind is that of colliders
    int vertex_count;
    const int32_t* triangles; ///< [triangle_count][3], null for strands
    int triangle_count;
    const int32_t* offsets; ///< [strand_count + 1] of strands, else null
    int strand_count;
    wisp_vec3* points;  ///< [vertex_count]
    float* widths;      ///< [vertex_count] m, diameters of strands; null if unknown
    wisp_vec3* colours; ///< [vertex_count] linear RGB of strands, or null
    float* values;      ///< [vertex_count] strain, speed or map, or null where there is none
    picture_layer layer;
} picture_body;

typedef struct picture_source picture_source;

/// Functions of one kind of input; one file each.
typedef struct picture_input
{
    /// Fill the points and other arrays of every body. frame is in [0, frame_count).
    wisp_status ( *load )( picture_source* source, int frame, wisp_error* error );
    wisp_status ( *time )( picture_source* source, int frame, double* seconds, wisp_error* error );
    void ( *close )( picture_source* source );
} picture_input;

struct picture_source
{
    const char* path; ///< for messages
    picture_value value;
    const picture_input* input;
    picture_body* bodies; ///< [body_count]
    int body_count;
    double origin[3];   ///< m, place in the world that points are relative to
    int frame_count;    ///< >= 1
    int frame;          ///< the loaded one, -1: none
    bool has_seconds;   ///< frames have a time
    double step;        ///< s, the usual interval of two frames; 1 if unknown
    progress* bar;      ///< progress bar for the steps on the way to a frame, or null
    void* state;        ///< of the input
    wisp_vec3** points; ///< [body_count] the points of each body, in the form of the readers
    io_memory memory;   ///< of the state, the bodies and their arrays
};

typedef struct picture_source_def
{
    const char* path;
    const char* mesh; ///< the triangles of a point cache, or null
    picture_value value;
    picture_layer_look layer;
    bool has_layer_normals;    ///< normals of boundary particles are drawn as lines
    scene_world_options world; ///< for scenes
    int steps;                 ///< of a scene, whose last frame follows them; 0: its own
} picture_source_def;

/// @param def its texts must outlive the source
/// @param out zero on failure
/// @return WISP_BAD_INPUT the file is invalid, shows nothing, or has no such value or layer; WISP_IO_ERROR;
///        WISP_NO_MEMORY
wisp_status picture_source_open( const picture_source_def* def, picture_source* out, wisp_error* error );

/// Load a frame, unless it is loaded already.
wisp_status picture_source_load( picture_source* source, int frame, wisp_error* error );

/// Find the frame nearest to a time.
/// @return WISP_BAD_INPUT there is none within a step, or frames have no times
wisp_status picture_source_find( picture_source* source, double seconds, int* frame, wisp_error* error );

/// Zero is allowed; the source is zero afterwards.
void picture_source_close( picture_source* source );

// ---- for the inputs ----

wisp_status picture_open_scene( picture_source* source, const picture_source_def* def, wisp_error* error );

/// Make a zero state of some bytes.
wisp_status picture_start( picture_source* source, const picture_input* input, size_t state, wisp_error* error );
/// Make room for a number of bodies, all zero.
wisp_status picture_make_bodies( picture_source* source, int count, wisp_error* error );
/// Allocate the points of a body whose vertex_count is set, and values if it has some.
wisp_status picture_make_points( picture_source* source, int body, bool has_values, wisp_error* error );
/// Allocate boundary particles; existing ones are lost.
wisp_status picture_make_layer( picture_source* source, int body, int count, wisp_error* error );
/// @return WISP_NO_MEMORY if a block of the source's memory was refused
wisp_status picture_check_memory( const picture_source* source, wisp_error* error );

/// Whether a body is cloth or a balloon.
static inline bool picture_is_surface( const picture_body* body )
{
    return body->kind == SCENE_BODY_CLOTH || body->kind == SCENE_BODY_BALLOON;
}
