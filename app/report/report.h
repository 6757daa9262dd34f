/// The report: everything in the results as one HTML page that needs no other file and no network. Its charts are drawn by
/// a script; without it they are tables.
#pragma once

#include "results.h"

/// The subject of a page, in words that are the same for the same command.
typedef struct report_run
{
    const char* what; ///< the command: the title
    const char* how;  ///< the line below it; empty: none
    /// What errors say, where nothing fails by them: a sentence of the verdict. Null: errors that have limits are judged
    const char* errors;
} report_run;

/// @return WISP_IO_ERROR the stream failed; WISP_NO_MEMORY while the results were gathered
wisp_status report_write( const results* all, const report_run* run, FILE* stream, wisp_error* error );
wisp_status report_write_file( const results* all, const report_run* run, const char* path, wisp_error* error );
