/// From the options of the command line to files of pictures.
#pragma once

#include "picture_options.h"

/// Draw, write, and print a line per file to standard output. Files are written one after the other: earlier ones
/// remain after a failure.
/// @return WISP_BAD_INPUT the input is invalid, or has no such frame; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status picture_draw( const picture_options* options, wisp_error* error );
