/// The bodies of a loaded frame in the form of the renderer: materials, colours, ground.
#pragma once

#include "io_file.h"
#include "picture_draw.h"

/// Data that are constant from picture to picture.
typedef struct picture_look
{
    picture_value value;
    float range[2]; ///< values at the ends of the colour map
    picture_layer_look layer;
    bool has_layer_normals;
    bool has_ground;
    float ground_height;
    wisp_vec3 background[2];
    wisp_vec3 cut_normal; ///< bodies are drawn where cut_normal . p <= cut_offset; zero: whole
    float cut_offset;
    bool* is_glass; ///< [body_count] colliders that would hide what moves, or null; the caller's
} picture_look;

/// Zero-initialised is empty. Release with picture_stage_release().
typedef struct picture_stage
{
    render_scene scene;
    render_mesh* meshes;
    render_curves* curves;
    render_points* points;
    io_memory memory; ///< of all these, of colours and radii
} picture_stage;

/// @param out points into the source, whose frame must stay loaded
wisp_status picture_stage_make( const picture_source* source, const picture_look* look, picture_stage* out,
                                wisp_error* error );
void picture_stage_release( picture_stage* stage );

/// Find the colliders that hide a surface of the loaded frame, so that they are drawn as glass.
/// @param look gets `is_glass`
/// @param memory receives it
/// @return WISP_NO_MEMORY; otherwise as render_find_hiding()
wisp_status picture_stage_find_glass( const picture_source* source, const render_camera* camera, picture_look* look,
                                      io_memory* memory, wisp_error* error );

/// Whether a body is a level infinite plane, which is drawn as the ground.
bool picture_is_floor( const picture_body* body );
