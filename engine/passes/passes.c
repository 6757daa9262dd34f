#include "passes.h"

#include "wisp/module/components.h"

// What may be in integers of shared components. Links and hinges of folds are counted in groups, found half spaces past those kept.
static const wisp_index_range RANGES[] = {
    WISP_COLUMN_RANGE( WISP_PARTICLE_EXTERNAL_SOLVER, 0, 0, 1 ),
    WISP_COLUMN_RANGE( WISP_PARTICLE_HALF_SPACES, 0, 0, INT32_MAX ),
    WISP_COLUMN_RANGE( WISP_PARTICLE_FRAME, 2, 0, 1 ),
    WISP_COLUMN_RANGE( WISP_SURFACE_ELASTIC, 1, 0, 1 ),
    WISP_COLUMN_RANGE( WISP_STRAND_REACH, 1, 0, 1 ),
    WISP_COLUMN_RANGE( WISP_STRAND_REACH, 2, 0, 1 ),
    WISP_COLUMN_RANGE( WISP_LINK_FOLDS, 2, 0, PASSES_BETWEEN_FOLDS ),
    WISP_COLUMN_RANGE( WISP_HINGE_FOLDS, 2, 0, PASSES_BETWEEN_FOLDS ),
    WISP_COLUMN_RANGE( WISP_SURFACE_LEVELS, 0, 0, 64 ),
    WISP_COLUMN_RANGE( WISP_SURFACE_LEVELS, 1, 0, 64 ),
    WISP_COLUMN_RANGE( WISP_SURFACE_LEVELS, 2, LEVELS_RESTARTED, LEVELS_MOVING ),
    { .component = WISP_SURFACE_LEVELS, .column = 3, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_PARTICLE },
    { .component = WISP_LINK_FOLDS, .column = 1, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_LINK },
    { .component = WISP_HINGE_FOLDS, .column = 1, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_HINGE },
    { .component = WISP_LINK_CONSTANT, .column = 1, .kind = WISP_INDEX_SAME },
    { .component = WISP_HINGE_CONSTANT, .column = 1, .kind = WISP_INDEX_SAME },
};

wisp_status passes_declare( wisp_registry* registry )
{
    // Order of passes in the same stage: prediction, coarse sheets, tethers, near constraints. The state check runs
    // before any derived quantity.
    typedef wisp_status declare_fn( wisp_registry * registry );
    static declare_fn* const ALL[] = { passes_declare_particles,   passes_declare_moving_frame,
                                       passes_declare_levels,      passes_declare_max_speed,
                                       passes_declare_tethers,     passes_declare_seen_motion,
                                       passes_declare_constraints, passes_declare_state_check,
                                       passes_declare_surface,     passes_declare_instances };
    wisp_status status = wisp_declare_indices( registry, RANGES, WISP_COUNT( RANGES ) );
    for ( int i = 0; i < WISP_COUNT( ALL ) && status == WISP_OK; ++i )
    {
        status = ALL[i]( registry );
    }
    return status;
}

// ---- schedules ----

typedef struct tile_loop
{
    void ( *run )( const void* args, int begin, int end );
    const void* args;
    const int32_t* tile_begin; // of the colour's first tile
} tile_loop;

static void run_tiles( void* context, int begin, int end, int worker )
{
    (void)worker;
    const tile_loop* loop = context;
    loop->run( loop->args, loop->tile_begin[begin], loop->tile_begin[end] );
}

void wisp_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule,
                        void ( *run )( const void* args, int begin, int end ), const void* args )
{
    for ( int colour = 0; colour < schedule->colour_count; ++colour )
    {
        int first = schedule->colour_tile[colour];
        tile_loop loop = { run, args, schedule->tile_begin + first };
        wisp_parallel_for( parallel, schedule->colour_tile[colour + 1] - first, 1, run_tiles, &loop );
    }
}

// ---- sums ----

typedef struct sum_loop
{
    const wisp_kernels* kernels;
    const wisp_summation* sum;
    double* sums; // [block][sum_count]
} sum_loop;

static void sum_items( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sum_loop* loop = context;
    const wisp_summation* s = loop->sum;
    for ( int block = begin; block < end; ++block )
    {
        const int first = block * s->grain,
                  last = first + s->grain < s->item_count ? first + s->grain : s->item_count;
        s->run( loop->kernels, s->args, first, last, loop->sums + (size_t)block * (size_t)s->sum_count );
    }
}

bool wisp_frame_sum( wisp_frame* frame, const wisp_span* span, const wisp_summation* sum, double* sums )
{
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const int blocks = ( sum->item_count + sum->grain - 1 ) / sum->grain, count = blocks * sum->sum_count;
    sum_loop loop = { wisp_frame_kernels( frame ), sum,
                      wisp_parallel_scratch( parallel, span->worker, (size_t)count * sizeof( double ) ) };
    memset( sums, 0, (size_t)sum->sum_count * sizeof( double ) );
    if ( loop.sums == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for %d sums of %d items", count, sum->item_count );
        return false;
    }
    wisp_parallel_for( parallel, blocks, sum->together, sum_items, &loop );
    for ( int i = 0; i < count; ++i )
    {
        sums[i % sum->sum_count] += loop.sums[i];
    }
    return true;
}
