/// Format of the files in data/reference: numbers with their lowest byte first, a checksum after them, and a length
/// bounded by the reader.
#pragma once

#include "wisp/base.h"

/// First bytes of each of these files; the version follows.
#define REFERENCE_MAGIC "WISPTRUT"
#define REFERENCE_MAGIC_SIZE 8

/// Read a number of the given width and advance past it.
uint64_t reference_take( const unsigned char** at, int size );
double reference_take_double( const unsigned char** at );

void reference_put( unsigned char** at, int size, uint64_t value );
void reference_put_double( unsigned char** at, double value );

/// Check that a head and a tail fit, and that it begins like a reference. @return WISP_BAD_INPUT, with a message that
/// names the file
wisp_status reference_check_beginning( const unsigned char* bytes, size_t size, int head, int tail, const char* name,
                                       wisp_error* error );

/// FNV-1a.
uint64_t reference_checksum( const unsigned char* bytes, size_t size );

/// Read a whole file, but at most `room` bytes: pass one more than the longest valid length, to detect a longer file.
/// @param bytes receives a block to be freed, after a failure too
/// @return WISP_IO_ERROR an error of the operating system; WISP_NO_MEMORY
wisp_status reference_read_bytes( const char* path, size_t room, unsigned char** bytes, size_t* size,
                                  wisp_error* error );
/// @return WISP_IO_ERROR
wisp_status reference_write_bytes( const char* path, const void* bytes, size_t size, wisp_error* error );
