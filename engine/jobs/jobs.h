/// Workers of a world: persistent OpenMP threads, the host's own parallel loop, or the calling thread alone.
#pragma once

#include "wisp/module/jobs.h"

typedef struct jobs_pool jobs_pool;

/// @param workers 1 .. WISP_MAX_WORKERS @param host may be null
/// @return null without memory
jobs_pool* jobs_create( const wisp_allocator* allocator, int workers, wisp_parallel_for_fn* host, void* host_user );
void jobs_destroy( jobs_pool* pool );

int jobs_workers( const jobs_pool* pool );
/// @return bytes of scratch memory of all workers; those of the pool itself are added to `pool_bytes`
size_t jobs_memory( const jobs_pool* pool, size_t* pool_bytes );

/// Cores this process may run on; at least 1, at most WISP_MAX_WORKERS. Does not touch OpenMP.
int jobs_default_workers( void );

/// Run driver( context ) on the calling thread while the workers stand by for waves inside it. Does not wait for late
/// workers, except the first time, until all of them run.
/// @return false if the system starts no thread: the driver ran, with all blocks on the calling thread
bool jobs_enter( jobs_pool* pool, void ( *driver )( void* context ), void* context );

/// Run one wave, from inside jobs_enter(): blocks [0, block_count), each once, on any worker. Returns when all are
/// done.
void jobs_run_wave( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context );

/// Run blocks one after another on the calling thread as worker 0.
void jobs_run_inline( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context );

/// Run one block inside another one, on its worker. Scratch memory that it takes is released when it ends.
void jobs_run_within( jobs_pool* pool, int block, wisp_block_fn* run, void* context, int worker );

/// All workers: valid on the driver thread while no wave runs.
const wisp_parallel* jobs_everyone( const jobs_pool* pool );
/// Only this worker.
const wisp_parallel* jobs_alone( const jobs_pool* pool, int worker );
