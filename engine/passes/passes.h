/// The passes that every world has.
#pragma once

#include "wisp/module/module.h"

wisp_status passes_declare( wisp_registry* registry );

wisp_status passes_declare_particles( wisp_registry* registry );
wisp_status passes_declare_far( wisp_registry* registry );
wisp_status passes_declare_constraints( wisp_registry* registry );
wisp_status passes_declare_guard( wisp_registry* registry );
wisp_status passes_declare_surface( wisp_registry* registry );

/// Declare a table of passes, the first failure ends it.
wisp_status passes_declare_all( wisp_registry* registry, const wisp_pass* passes, int count );

/// A range of a fabric's schedule on one worker: groups of eight constraints [begin, end).
typedef void passes_schedule_fn( const void* job, int begin, int end );

/// Run a schedule: tile colours one after another, the tiles of a colour in parallel.
void passes_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule, passes_schedule_fn* run,
                          const void* job );
