/// The page of `wisp view`: one HTML file that `./dev web` builds, in which data take the place of one word.
#pragma once

#include "wisp/base.h"

#include <jansson.h>

/// Files of a page, all together.
#define VIEW_MAX_BYTES ( 64u << 20 )

/// Read a file into the page's data. @param name as the page knows it
/// @return WISP_BAD_INPUT the files exceed VIEW_MAX_BYTES; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status view_add_file( json_t* files, const char* name, const char* path, size_t* total, wisp_error* error );

/// Write the page with its data.
/// @return WISP_IO_ERROR there is no page to fill (the message says how to build one), or `path` cannot be written
wisp_status view_page_write( const json_t* data, const char* path, size_t* size, wisp_error* error );
