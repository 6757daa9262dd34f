/// Parts of a sweep made one: checked against each other, in the order of the suite.
#pragma once

#include "results.h"
#include "sweep_part.h"

/// An item of a merged sweep.
typedef struct sweep_merged
{
    const sweep_record* record; ///< of the part with the lowest number
    int part;
    const sweep_record* timed; ///< of a part with times; null: none has
    int timed_part;
} sweep_merged;

typedef struct sweep_merge
{
    sweep_part* parts; ///< [part_count] by shard
    int part_count;
    sweep_merged* items; ///< [header.items]
    int run_twice;       ///< items that two shards ran, with the same hash
} sweep_merge;

/// Read all parts in a folder and check that they are a whole sweep of one suite and one version.
/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT nothing is there, a part or an item is missing or not done, parts are of different sweeps, an item has two hashes
///         (the message says which); WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status sweep_merge_read( const char* folder, sweep_merge* out, wisp_error* error );
void sweep_merge_release( sweep_merge* merge );

/// The processor of a part, with its instruction set: times of different ones are not compared.
void sweep_processor( const sweep_header* header, char out[160] );

/// Fit what a step costs to the vertices and substeps of the items of each scene, and add a table of how well that predicts items that took no
/// part in the fit. Scenes with too few sizes are left out.
void sweep_add_models( const sweep_merge* merge, results* out );

/// Make tables, charts and rows. What differs from what a suite expects, or could not be run, is a failure of the results.
void sweep_report( const sweep_merge* merge, results* out );
