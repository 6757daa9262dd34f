/// Which share of a sweep a process runs: said on the command line, or by the scheduler that started it.
#pragma once

#include "wisp/base.h"

enum
{
    SWEEP_MAX_SHARDS = 9999,
};

typedef struct sweep_shard
{
    int index, count;   ///< index from 0; messages and files count from 1
    const char* source; ///< "--shard", or the variable that said it; null: nobody, so it is all of the sweep
} sweep_shard;

/// Read "2/8": the second of eight.
/// @return WISP_BAD_INPUT it is no such pair, or out of range (the message says what is expected)
wisp_status sweep_shard_parse( const char* text, sweep_shard* out, wisp_error* error );

/// Look at what schedulers tell their jobs: SLURM_ARRAY_TASK_ID, GTEST_SHARD_INDEX, PBS_ARRAY_INDEX, or the job file of HTCondor.
/// @param count of shards, as the user says it, where the scheduler does not (PBS), or not of the whole (a part of a Slurm array that is
///              submitted again); the scheduler's numbers count from 1 then. 0: not said
/// @return WISP_BAD_INPUT a variable is no number, or out of range (the message names it)
wisp_status sweep_shard_from_environment( int count, sweep_shard* out, wisp_error* error );
