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
