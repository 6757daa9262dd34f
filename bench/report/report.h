/// The report: everything in the results as one HTML page that needs no other file, no network and no script.
#pragma once

#include "results.h"

/// @param what was run, in the words of the command line; the page's title
/// @return WISP_IO_ERROR the stream refused a byte; WISP_NO_MEMORY while the results were gathered
wisp_status report_write( const results* all, const char* what, FILE* stream, wisp_error* error );
/// A picture that cannot be read is a sentence in its place and no error.
wisp_status report_write_file( const results* all, const char* what, const char* path, wisp_error* error );
