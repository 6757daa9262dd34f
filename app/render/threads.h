/// Threads for callers without a job system.
#pragma once

#include "wisp/module/jobs.h"

/// A wisp_parallel_for_fn. Blocks are taken one by one from a common counter; the calling thread is worker 0. A
/// thread that the system refuses is left out.
/// @param user int*: the number of threads, in [1, WISP_MAX_WORKERS]
void threads_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context );
