/// For modules: parallel loops over fixed blocks. The blocks do not depend on the number of workers, so results do not either.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Runs items [begin, end) on one worker. @param worker in [0, workers), selects its scratch memory
typedef void wisp_range_fn( void* context, int begin, int end, int worker );

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
