/// The items of a sweep: rows of a suite, which share they are in, and what is measured of them.
#pragma once

#include "suite_judge.h"
#include "suite_motion.h"
#include "sweep_part.h"

/// Hash of what decides about an item: its name, its scene with all settings, its length, its checks. Files that the scene names are not in it.
uint64_t sweep_key( const suite_row* row );
/// Hash of all items of a suite and of what their errors are measured against.
uint64_t sweep_suite_key( const wisp_suite* suite );

/// Whether an item is run by two shards, whose hashes must agree: one in a hundred.
bool sweep_is_run_twice( uint64_t key );
/// Whether a shard runs an item.
bool sweep_runs( const sweep_shard* shard, uint64_t key );

/// What items are run with.
typedef struct sweep_settings
{
    const wisp_suite* suite;
    const suite_reference* reference;
    suite_twins* twins;
    int workers; ///< of timed runs; 0: no times
} sweep_settings;

/// Run an item. What fails is in the record.
/// @return WISP_CONFLICT: it was interrupted
wisp_status sweep_run_item( const sweep_settings* settings, int item, sweep_record* out, wisp_error* error );
