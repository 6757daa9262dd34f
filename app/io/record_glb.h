/// Private to the writer of .glb: what is where in the binary part.
#pragma once

#include "record_internal.h"

/// A body in the binary part: indices, points, normals, colours, then a morph target per frame after the first one.
typedef struct glb_body
{
    int index_count;       ///< corners of triangles or ends of segments; 0: its vertices are drawn as points
    bool has_normals;      ///< a mesh with triangles
    int target_count;      ///< 0: it does not move
    uint64_t indices_at;   ///< bytes from the start
    uint64_t points_at;    ///< of everything but the indices
    record_bounds* bounds; ///< [1 + target_count] of the points, and of the displacements of each target
} glb_body;

typedef struct glb_layout
{
    glb_body* bodies; ///< [body_count]
    int frame_count;
    bool is_animated;              ///< a body has targets
    float first_time, last_time;   ///< s
    uint64_t times_at, weights_at; ///< of the animation
    uint64_t size;
} glb_layout;

typedef struct glb_file
{
    io_output output;
    record_waiting* waiting;
    wisp_vec3 *first, *points;          ///< [largest vertex_count] in the first frame and in another one
    wisp_vec3 *first_normals, *normals; ///< [largest vertex_count]
    int32_t* last;     ///< [largest triangle_count of those that change][3] of the last frame, of one body
    glb_layout layout; ///< when the recorder is closed
} glb_file;

/// Bytes of the points, normals or colours of a body.
uint64_t glb_block_bytes( const wisp_record_body* body );
/// Blocks of a body before its targets, and in each target.
int glb_base_blocks( const wisp_record_body* body, const glb_body* place );
int glb_target_blocks( const glb_body* place );

/// Write the JSON part. @return false: out of memory
bool glb_write_json( const wisp_recorder* recorder, const glb_layout* layout, char** text, size_t* size );

/// Find the bounds of a body and of its targets. Reads the frames that wait.
wisp_status glb_find_bounds( const wisp_recorder* recorder, int body, wisp_error* error );
/// Write the binary part; errors of the output are left to its commit.
wisp_status glb_put_binary( const wisp_recorder* recorder, wisp_error* error );
