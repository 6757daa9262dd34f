/// The items of a sweep: rows of a suite, which share they are in, and what is measured of them.
#pragma once

#include "suite_judge.h"
#include "suite_motion.h"
#include "sweep_row.h"

/// Hash of what decides about an item: its name, its scene with all settings, its length, its checks. Files that the scene names are not in it.
uint64_t sweep_key( const suite_row* row );
/// Hash of all items of a suite and of what their errors are measured against.
uint64_t sweep_suite_key( const wisp_suite* suite );

/// Read "2/8": the second of eight.
/// @return WISP_BAD_INPUT it is no such pair, or out of range (the message says what is expected)
wisp_status sweep_shard_parse( const char* text, int* shard, int* shards, wisp_error* error );
/// Whether a shard runs an item. One item in a hundred is run by two, whose hashes must agree. @param shard from 1
bool sweep_runs( uint64_t key, int shard, int shards );

/// What items are run with.
typedef struct sweep_settings
{
    const wisp_suite* suite;
    suite_references* references;
    suite_twins* twins;
    const sweep_row* like; ///< what all rows have: of the sweep, the share and the machine
    int workers;           ///< of timed runs; 0: no times
} sweep_settings;

/// Run a row of the suite. What fails is in the row. @param number from 0
/// @return WISP_CONFLICT: it was interrupted
wisp_status sweep_run_item( const sweep_settings* settings, int number, sweep_row* out, wisp_error* error );
