/// Checks of a scene before anything is built.
#pragma once

#include "render.h"

/// Points farther from the origin than this lose their shape in single precision.
#define RENDER_FARTHEST 1e6f

/// @return WISP_BAD_INPUT, and one message that names body and element
wisp_status check_scene( const render_scene* scene, wisp_error* error );

wisp_status check_camera( const render_camera* camera, wisp_error* error );
wisp_status check_options( const render_options* options, wisp_error* error );
