#include "passes_common.h"

typedef struct tile_loop
{
    wisp_schedule_fn* run;
    const void* args;
    const int32_t* tile_begin; // of the colour's first tile
} tile_loop;

static void run_tiles( void* context, int begin, int end, int worker )
{
    (void)worker;
    const tile_loop* loop = context;
    loop->run( loop->args, loop->tile_begin[begin], loop->tile_begin[end] );
}

void wisp_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule, wisp_schedule_fn* run,
                        const void* args )
{
    for ( int colour = 0; colour < schedule->colour_count; ++colour )
    {
        int first = schedule->colour_tile[colour];
        tile_loop loop = { run, args, schedule->tile_begin + first };
        wisp_parallel_for( parallel, schedule->colour_tile[colour + 1] - first, 1, run_tiles, &loop );
    }
}
