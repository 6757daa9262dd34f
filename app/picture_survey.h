/// Bounds over all drawn frames: positions and values, and from them the camera, the ground and the colour range.
/// Frames are processed one after the other and none is kept.
#pragma once

#include "picture_stage.h"

/// Bounds of the content of a picture from one direction; see fit_distance() for the sums.
typedef struct picture_fit
{
    double right[2], up[2]; ///< the edges of the picture against depth
    double nearest, farthest;
} picture_fit;

typedef struct picture_survey
{
    const picture_options* options;
    bool is_turning;
    float aspect;
    render_view view;
    wisp_vec3 right, up, back;       ///< directions of the picture
    double across, along;            ///< tangents of the half angles of view, without the margin
    render_bounds moving, colliders; ///< colliders: without planes
    picture_fit fit;                 ///< of all frames
    double zoom;                     ///< m, largest distance that a single frame needs from its own middle
    bool has_mesh;
    bool has_floor; ///< a level plane
    float floor_height;
    double square_sum; ///< of the values
    double value_count;
    float max_value;
} picture_survey;

/// @param source the first frame is loaded
picture_survey picture_survey_begin( const picture_options* options, const picture_source* source, float aspect );

/// Add the loaded frame. @return the bounds of this frame alone
picture_fit picture_survey_add( const picture_source* source, picture_survey* survey );

/// The closest camera that shows everything in all frames, or the one given by the user. What travels several times its own
/// size would be a speck in it: then the camera goes along and keeps its distance.
/// @param frame bounds of the frame to be drawn, as picture_survey_add() returned them
wisp_status picture_survey_camera( const picture_survey* survey, const picture_fit* frame, render_camera* camera,
                                   wisp_error* error );
picture_look picture_survey_look( const picture_survey* survey );
