/// Rows of a sweep by item: of a part that is gone on with, or of all parts of a folder. What does not fit is refused.
#pragma once

#include "sweep_row.h"

typedef struct sweep_share
{
    int there, of; ///< items of a share, as its rows say; 0: no row is there
} sweep_share;

/// Zero-initialised is empty, and then the first row says of which sweep it is.
typedef struct sweep_merge
{
    sweep_row like;   ///< a row whose sweep all others are of
    char origin[300]; ///< of it, for messages
    /// [like.items] of two runs of an item the first, with the times of the second if it has none. item is 0 where no row is there
    sweep_row* rows;
    int* second;         ///< [like.items] another shard that ran it too; 0: none did
    sweep_share* shares; ///< [like.shards]
    int count;           ///< items that are there
    int run_twice;       ///< items that two shards ran, with the same bits
} sweep_merge;

/// Say of which sweep rows must be. @param origin for messages
wisp_status sweep_merge_begin( const sweep_row* like, const char* origin, sweep_merge* out, wisp_error* error );
/// Add a row. @param place where it is from, for messages
/// @return WISP_BAD_INPUT it is of another sweep, or has other bits than another run of the item (the message says which); WISP_NO_MEMORY
wisp_status sweep_merge_add( const sweep_row* row, const char* place, sweep_merge* out, wisp_error* error );
/// Add the lines of a part. The last one may lack its end, where a process was stopped, and is left out then.
/// @param whole receives the bytes up to the end of the last line
/// @return WISP_BAD_INPUT a line is no row, or cannot be added (the message has file and line)
wisp_status sweep_merge_parse( const char* bytes, size_t size, const char* path, sweep_merge* out, size_t* whole,
                               wisp_error* error );
/// The same from a file.
wisp_status sweep_merge_part( const char* path, sweep_merge* out, size_t* whole, wisp_error* error );
/// Add all files of a folder whose names end in .jsonl, and check that nothing is missing.
/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT as above, or a share or an item is missing (the message says what); WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status sweep_merge_folder( const char* folder, sweep_merge* out, wisp_error* error );
void sweep_merge_release( sweep_merge* merge );
