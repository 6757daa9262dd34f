/// Declarations shared by the files of passes: registering a table of passes, and running a schedule of
/// constraints.
#pragma once

#include "wisp/module/module.h"

/// Callback for a range of a fabric's schedule on one worker: groups of eight constraints [begin, end).
typedef void passes_schedule_fn( const void* args, int begin, int end );

/// Run a schedule: tile colours one after another, the tiles of a colour in parallel.
void passes_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule, passes_schedule_fn* run,
                          const void* args );
