/// Parallel loops over fixed blocks. The blocks do not depend on the number of workers, so results do not either.
///
/// A host with its own job system passes a wisp_parallel_for_fn as wisp_world_def.parallel_for:
///
///     static void host_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
///     {
///         for ( int block = 0; block < block_count; ++block ) // or on the host's threads, each with a worker of its own
///             run( context, block, 0 );
///     }
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

#define WISP_MAX_WORKERS 64

/// Runs items [begin, end) on one worker. @param worker in [0, workers), selects its scratch memory
typedef void wisp_range_fn( void* context, int begin, int end, int worker );

/// Runs one block of a wave.
typedef void wisp_block_fn( void* context, int block, int worker );

/// A host's own parallel loop: call run( context, block, worker ) once for every block in [0, block_count), in any
/// order, on any thread, with worker in [0, workers) and no two threads on the same worker at once; return when all
/// are done. One call a wave.
typedef void wisp_parallel_for_fn( void* user, int block_count, wisp_block_fn* run, void* context );

/// Permission to run loops in parallel at this point of the frame: on all workers, or only on the calling one.
typedef struct wisp_parallel wisp_parallel;

/// Run [0, count) in blocks of `grain` items and return when all are done. A single block runs at once on the caller.
WISP_API void wisp_parallel_for( const wisp_parallel* parallel, int count, int grain, wisp_range_fn* run,
                                 void* context );

/// Get scratch memory of a worker, 64-byte aligned and not initialised, valid until the block ends. Repeated calls do not
/// allocate.
/// @param worker the worker of the block
/// @return null if out of memory
WISP_API void* wisp_parallel_scratch( const wisp_parallel* parallel, int worker, size_t bytes );

/// @return the host's allocator, which workers may use
WISP_API const wisp_allocator* wisp_parallel_allocator( const wisp_parallel* parallel );

WISP_END_C
