/// Output of `wisp info` for a result file of ours, and its defects.
#pragma once

#include "wisp/base.h"

#include <stdio.h>

/// Whether the first bytes of a file look like a result and not like a scene, which may be JSON too.
bool info_is_results( const char* bytes, size_t size );

/// Check a result file against the schema and print its facts and rows.
/// @return WISP_BAD_INPUT the message names the line, or the row and key; WISP_IO_ERROR
wisp_status info_results( const char* path, FILE* out, wisp_error* error );
