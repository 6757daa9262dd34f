/// Declarations shared by the files of passes: registering a table of passes, and running a schedule of
/// constraints.
#pragma once

#include "wisp/module/module.h"

/// Callback for a range of a fabric's schedule on one worker: groups of eight constraints [begin, end).
typedef void passes_schedule_fn( const void* args, int begin, int end );

/// Run a schedule: tile colours one after another, the tiles of a colour in parallel.
void passes_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule, passes_schedule_fn* run,
                          const void* args );

/// Let a kernel of links find folded bend links, if the entity has link.folds: while there are some, and from time to time.
/// @return false if there is no memory for their bits, which is reported
bool passes_begin_folds( wisp_frame* frame, const wisp_span* span, wisp_link_args* args );

/// Project the hinges of folded bend links. Their order is that of the links, so bits do not depend on workers.
/// @param folded bits that a kernel of links has stored, from passes_begin_folds()
void passes_open_folds( wisp_frame* frame, const wisp_span* span, const uint64_t* folded );
