/// The summary of `wisp run`: the result, tables of passes, memory and counters, and notes.
#pragma once

#include "results.h"
#include "run_contact.h"
#include "run_recorder.h"
#include "stats.h"
#include "world_from_scene.h"

/// Data collected during the steps of a run.
typedef struct run_record
{
    profile_samples profile;
    double* ms;         ///< [steps]
    int steps;          ///< that were made
    int all_steps;      ///< more if the run was interrupted
    double cpu_seconds; ///< processor time of all steps
    run_contact* contact;
} run_record;

/// Fill the results of a run that has ended. Sorts the times of the record.
/// @param is_brief the result and notes alone, for people
void run_summarise( const scene_world* world, run_record* record, const run_recorder_def* recorder,
                    run_recorder_counts counts, bool is_brief, results* out );
