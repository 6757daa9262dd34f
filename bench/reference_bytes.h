/// What the files in data/reference are made of: numbers with their lowest byte first, a checksum behind them, and a
/// length that no file makes longer than its reader expects.
#pragma once

#include "wisp/base.h"

/// What each of these files begins with; behind it comes the version.
#define REFERENCE_MAGIC "WISPTRUT"
#define REFERENCE_MAGIC_SIZE 8

/// Read a number of the given width and advance behind it.
uint64_t reference_take( const unsigned char** at, int size );
double reference_take_double( const unsigned char** at );
float reference_take_float( const unsigned char** at );

void reference_put( unsigned char** at, int size, uint64_t value );
void reference_put_double( unsigned char** at, double value );
void reference_put_float( unsigned char** at, float value );

/// Is there room for a head and a tail, and does it begin as references do? @return WISP_BAD_INPUT, with a message
/// that names the file
wisp_status reference_check_beginning( const unsigned char* bytes, size_t size, int head, int tail, const char* name,
                                       wisp_error* error );

/// FNV-1a.
uint64_t reference_checksum( const unsigned char* bytes, size_t size );

/// All of a file, but at most `room` bytes: ask for one more than the longest that is good, so that a longer one is
/// seen to be one.
/// @param bytes receives what is to be freed, after a failure too
/// @return WISP_IO_ERROR the operating system refused; WISP_NO_MEMORY
wisp_status reference_read_bytes( const char* path, size_t room, unsigned char** bytes, size_t* size,
                                  wisp_error* error );
/// @return WISP_IO_ERROR
wisp_status reference_write_bytes( const char* path, const void* bytes, size_t size, wisp_error* error );
