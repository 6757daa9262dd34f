/// Whole files in, whole files out. Internal to libwisp_io.
///
/// Reading is bounded by a cap that the caller names, never by what a file says about itself. Writing goes to a new
/// file in the same folder that takes the place of the old one in a single step, so that a write that fails, for lack
/// of room or by a crash, leaves the old file as it was.
#pragma once

#include <stdio.h>

#include "wisp/base.h"

/// Read a file whole. Works on pipes too, whose size nobody knows beforehand.
/// @param size_cap bytes; a longer file is WISP_BAD_INPUT
/// @param bytes receives a block for free(), exactly as long as the file; null for an empty file and on failure
/// @return WISP_IO_ERROR the operating system refused; WISP_BAD_INPUT a folder, or too long; WISP_NO_MEMORY
wisp_status io_file_read( const char* path, size_t size_cap, unsigned char** bytes, size_t* size, wisp_error* error );

/// A file on its way out. Exactly one of io_output_commit(), io_output_discard() and io_output_end() ends it.
typedef struct io_output
{
    FILE* stream;  ///< write here, and leave errors to io_output_commit(): the stream remembers them
    char* path;    ///< what commit replaces; symbolic links are followed
    char* partial; ///< the new file beside it; null when path is a device or a pipe, which is written in place
} io_output;

/// @return WISP_IO_ERROR the operating system refused (the message carries its reason); WISP_NO_MEMORY
wisp_status io_output_open( const char* path, io_output* output, wisp_error* error );

/// Bring everything to the disk and put the new file in the place of the old one.
/// @return WISP_IO_ERROR some write failed; the old file is untouched and the new one is gone
wisp_status io_output_commit( io_output* output, wisp_error* error );

/// Forget what was written. The old file is untouched.
void io_output_discard( io_output* output );

/// Commit what was written with status WISP_OK, discard it with any other. @return the first failure
wisp_status io_output_end( io_output* output, wisp_status status, wisp_error* error );

/// Make a folder, whose parent is there; one that is there already is as good.
/// @return WISP_IO_ERROR the operating system refused
wisp_status io_folder_make( const char* path, wisp_error* error );

/// Numbers in files have decimal points, whatever the host's locale says. Applies to the calling thread only.
typedef struct io_numbers
{
    void* plain;    ///< the C locale
    void* previous; ///< the thread's own
} io_numbers;

wisp_status io_numbers_begin( io_numbers* numbers, wisp_error* error );
void io_numbers_end( io_numbers* numbers );

/// Whether a path ends in `extension`, such as ".obj", in small or capital letters of ASCII, and has something before it.
/// The locale has no say.
bool io_has_extension( const char* path, const char* extension );

/// The end of a long path, so that a message of 500 characters still has room for what is wrong.
const char* io_short_name( const char* name );
