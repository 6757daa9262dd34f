/// From what the command line says to files of pictures.
#pragma once

#include "picture_options.h"

/// Draw, write, and print a line about it to standard output. Files are written one after the other: those before a
/// failure stay.
/// @return WISP_BAD_INPUT the input is wrong, or has no such frame; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status picture_draw( const picture_options* options, wisp_error* error );
