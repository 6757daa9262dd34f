/// Files that must be refused: a good file, what is done to it, and words of the message that must follow.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum
{
    BAD_FILE_MAX = 2048, ///< bytes
};

#define BITS_NAN 0x7fc00000u
#define BITS_INF 0x7f800000u
#define BITS_ONE 0x3f800000u

typedef struct bad_file_patch
{
    int at, width; // bytes; width 0 ends the list
    uint64_t value;
} bad_file_patch;

typedef struct bad_file
{
    const char* name;
    int size; // the good file is cut, or zeros follow it
    bad_file_patch patches[4];
    const char* words;
} bad_file;

/// Files that are made from the same good one.
typedef struct bad_file_list
{
    const bad_file* files;
    int count;
    void ( *write_good )( unsigned char* bytes );        ///< bytes [BAD_FILE_MAX]
    void ( *seal )( unsigned char* bytes, size_t size ); ///< correct the checksums, so that what they protect is read
} bad_file_list;

static inline void put_number( unsigned char* bytes, int at, int width, uint64_t value )
{
    for ( int i = 0; i < width; ++i )
    {
        bytes[at + i] = (unsigned char)( value >> 8 * i & 255 );
    }
}

/// Make the bytes of one file of a list.
/// @param bytes [BAD_FILE_MAX]
/// @return the size of the file
static inline size_t bad_file_build( const bad_file_list* list, int number, unsigned char* bytes )
{
    const bad_file* bad = list->files + number;
    list->write_good( bytes );
    for ( int i = 0; i < 4 && bad->patches[i].width > 0; ++i )
    {
        put_number( bytes, bad->patches[i].at, bad->patches[i].width, bad->patches[i].value );
    }
    if ( list->seal != NULL )
    {
        list->seal( bytes, (size_t)bad->size );
    }
    return (size_t)bad->size;
}
