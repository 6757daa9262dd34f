/// Work cut into fixed blocks and handed to workers. The cut never depends on the number of workers, so neither does
/// a result. Modules and engine rooms see only this; who the workers are is known in one room.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

#define WISP_MAX_WORKERS 64

/// Runs items [begin, end) on one worker. @param worker in [0, workers), for scratch memory of its own.
typedef void wisp_range_fn( void* context, int begin, int end, int worker );

/// Runs one block of a wave; the engine hands it to a host's own job system.
typedef void wisp_block_fn( void* context, int block, int worker );

/// A host's own parallel loop: call run( context, block, worker ) once for every block in [0, block_count), in any
/// order, on any thread, with worker in [0, workers) and no two threads on the same worker at once; return when all
/// are done. One call a wave.
typedef void wisp_parallel_for_fn( void* user, int block_count, wisp_block_fn* run, void* context );

/// The right to run loops in parallel at this place of the frame: all workers, or only the calling one.
typedef struct wisp_parallel wisp_parallel;

/// Run [0, count) in blocks of `grain` items and return when all are done. A single block runs at once on the caller.
WISP_API void wisp_parallel_for( const wisp_parallel* parallel, int count, int grain, wisp_range_fn* run,
                                 void* context );

/// Scratch memory of a worker, 64-byte aligned and not initialised, until the block that asked for it ends. Costs
/// nothing once warm.
/// @param worker the number that the block was given
/// @return null without memory
WISP_API void* wisp_parallel_scratch( const wisp_parallel* parallel, int worker, size_t bytes );

/// The host's memory as the workers may use it.
WISP_API const wisp_allocator* wisp_parallel_allocator( const wisp_parallel* parallel );

WISP_END_C
