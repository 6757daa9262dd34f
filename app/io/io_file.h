/// Reading and writing of whole files. Internal to libwisp_io.
///
/// Reading is bounded by a cap of the caller, never by the contents of a file. Writing goes to a new file in the same
/// folder that replaces the old one in a single step, so that a failed write, for lack of space or by a crash, leaves
/// the old file unchanged.
#pragma once

#include <stdio.h>

#include "wisp/base.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C"
{
#endif

    /// Blocks of memory that are released together. Zero-initialised is empty.
    typedef struct io_memory
    {
        struct io_block* last;
        bool is_short; ///< a block was refused
    } io_memory;

    /// @return zeroed bytes, aligned for any type; null without memory, which `is_short` remembers
    void* io_get( io_memory* memory, size_t size );
    /// @return a copy; null if `from` is null, and without memory
    void* io_copy( io_memory* memory, const void* from, size_t size );
    void io_release( io_memory* memory );

#ifdef __cplusplus
}
#endif

/// Whether a path is "-": standard input where it is read, standard output where it is written. Standard input is read
/// once, as far as its readers need it, and kept in a file without a name, so that it can be opened again.
bool io_is_standard( const char* path );

/// What messages call a file that is read: its path, or "standard input".
const char* io_input_name( const char* path );

/// Open a file, or standard input, to be read from its beginning.
/// @param flags of open(), besides O_RDONLY
/// @param most bytes that the caller can use: of longer standard input a part is there, which is longer than that
/// @return a descriptor that is closed in other programs, or -1 with errno; EFBIG: more than IO_STANDARD_INPUT_MAX bytes
int io_file_open( const char* path, int flags, unsigned long long most );

#define IO_STANDARD_INPUT_MAX ( 1ull << 33 ) ///< bytes

/// Read a whole file. Works on pipes too, whose size is not known in advance.
/// @param size_cap bytes; a longer file is WISP_BAD_INPUT
/// @param bytes receives a block for free(), exactly as long as the file; null for an empty file and on failure
/// @return WISP_IO_ERROR an error of the operating system; WISP_BAD_INPUT a folder, or too long; WISP_NO_MEMORY
wisp_status io_file_read( const char* path, size_t size_cap, unsigned char** bytes, size_t* size, wisp_error* error );

/// A file being written. Exactly one of io_output_commit(), io_output_discard() and io_output_end() ends it.
typedef struct io_output
{
    FILE* stream;  ///< write here, and leave errors to io_output_commit(): the stream remembers them
    char* path;    ///< file that commit replaces; symbolic links are followed
    char* partial; ///< the new file next to it; null when it has no name yet, or path is written in place
    bool
        has_name; ///< false: the new file gets a name when it is whole, so that nothing remains if the program is killed
    bool in_place; ///< path is a device, a pipe or standard output
} io_output;

/// @param path "-" is standard output
/// @return WISP_IO_ERROR an error of the operating system (the message has its reason); WISP_NO_MEMORY
wisp_status io_output_open( const char* path, io_output* output, wisp_error* error );

/// Flush everything to the disk and replace the old file by the new one.
/// @return WISP_IO_ERROR some write failed; the old file is unchanged and the new one is deleted
wisp_status io_output_commit( io_output* output, wisp_error* error );

/// Discard the new file. The old file is unchanged.
void io_output_discard( io_output* output );

/// Commit with status WISP_OK, discard with any other. @return the first failure
wisp_status io_output_end( io_output* output, wisp_status status, wisp_error* error );

/// Write a whole file. @return WISP_IO_ERROR, and the file is as before
wisp_status io_file_write( const char* path, const void* bytes, size_t size, wisp_error* error );

/// Make a folder, whose parent exists; an existing folder is accepted.
/// @return WISP_IO_ERROR an error of the operating system
wisp_status io_folder_make( const char* path, wisp_error* error );

/// Use decimal points for numbers in files in every locale of the host. Applies to the calling thread only.
typedef struct io_numbers
{
    void* plain;    ///< the C locale
    void* previous; ///< the thread's own
} io_numbers;

wisp_status io_numbers_begin( io_numbers* numbers, wisp_error* error );
void io_numbers_end( io_numbers* numbers );

/// Whether a path ends in `extension`, such as ".obj", in lower or upper case ASCII, after at least one character.
/// Independent of the locale.
bool io_has_extension( const char* path, const char* extension );

/// Write numbers of four bytes each, little-endian.
void io_write_words( FILE* out, const void* words, size_t count );

/// Whether a text is a name: 1 to `most` of the characters A-Z a-z 0-9 _ -. Names become parts of paths, so it has no slash and no dot.
bool io_is_name( const char* text, int most );

/// The box around points; empty when zero-initialised.
typedef struct io_bounds
{
    wisp_vec3 least, most;
    bool filled;
} io_bounds;

void io_extend_bounds( io_bounds* bounds, const wisp_vec3* points, int count );
/// As `x 0 .. 1, y 0 .. 1, z 0 .. 1 m`.
void io_print_bounds( FILE* out, const io_bounds* bounds );

/// The name of a file without its folders.
const char* io_file_name( const char* path );
/// Bytes of the path before that, with the slash.
size_t io_folder_length( const char* path );

/// The end of a long path, so that a message of 500 characters has room for the error.
const char* io_short_name( const char* name );
