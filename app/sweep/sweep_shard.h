/// The share of a sweep that a process runs.
#pragma once

#include "wisp/base.h"

enum
{
    SWEEP_MAX_SHARDS = 9999,
};

typedef struct sweep_shard
{
    int index, count; ///< index from 0; messages and files count from 1
} sweep_shard;

/// Read "2/8": the second of eight.
/// @return WISP_BAD_INPUT it is no such pair, or out of range (the message says what is expected)
wisp_status sweep_shard_parse( const char* text, sweep_shard* out, wisp_error* error );
