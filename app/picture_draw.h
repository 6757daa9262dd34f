/// From the options of `wisp render` to files of pictures.
#pragma once

#include "options.h"
#include "picture_source.h"
#include "render.h"

/// The frames to draw.
typedef enum picture_choice
{
    PICTURE_LAST,
    PICTURE_FRAME,  ///< `first`
    PICTURE_TIME,   ///< `seconds`
    PICTURE_FRAMES, ///< `first` to `last` by `step`
} picture_choice;

typedef enum picture_ground
{
    PICTURE_GROUND_AUTO,
    PICTURE_GROUND_NONE,
    PICTURE_GROUND_HEIGHT,
} picture_ground;

#define PICTURE_FRAME_END -1 ///< the last frame of the input

typedef struct picture_options
{
    picture_source_def source;
    const char* output;
    int width, height; ///< 0: not given
    int samples;
    int workers; ///< 0: one per core

    picture_choice choice;
    int first, last, step;
    double seconds;
    bool is_sheet;
    int columns;   ///< 0: nearly square
    int turntable; ///< views, 0: none

    bool has_range;
    float range[2];

    bool has_camera;
    wisp_vec3 eye, target;
    bool has_from; ///< `view` has the angles given by the user
    render_view view;

    wisp_vec3 cut_normal; ///< what is drawn has cut_normal . p <= cut_offset; zero: everything
    float cut_offset;

    picture_ground ground;
    float ground_height;
    wisp_vec3 background[2]; ///< top and bottom, linear
} picture_options;

/// Draw, write, and print a line per file to standard output. Files are written one after the other: earlier ones
/// remain after a failure.
/// @return WISP_BAD_INPUT the input is invalid, or has no such frame; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status picture_draw( const picture_options* options, wisp_error* error );
