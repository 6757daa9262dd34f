// Constraints over long distances, once a substep before the near ones: tethers to the attachments, and coarse levels that
// carry a stretch across the mesh in one pass where near links need as many passes as the mesh has rows.
#include "passes.h"

#include "wisp/components.h"

#include <string.h>

typedef struct tether_loop
{
    wisp_tether_job job;
    const wisp_kernels* kernels;
} tether_loop;

enum
{
    SLOT_GRAIN = 2048, // particles a block: about a microsecond and a half
    GROUP_GRAIN = 128, // groups of eight links
    CHILD_GRAIN = 128, // slices of eight children
};

static void run_tethers( void* context, int begin, int end, int worker )
{
    (void)worker;
    const tether_loop* loop = context;
    loop->kernels->tether( &loop->job, begin * 8, end * 8 );
}

static void project_tethers( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    tether_loop loop = { .kernels = wisp_frame_kernels( frame ) };
    loop.job.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    loop.job.slack = *(float*)wisp_frame_column( frame, span->entity, WISP_SURFACE_TETHERS, 0 );
    loop.job.anchor4 = fabric->tether4;
    loop.job.rest = fabric->tether_rest;
    loop.job.layer_count = fabric->tether_count;
    loop.job.slot_count = fabric->slot_count;
    wisp_parallel_for( wisp_frame_parallel( frame, span ), fabric->slot_count / 8, SLOT_GRAIN / 8, run_tethers,
                       &loop );
}

// ---- coarse levels ----

typedef struct link_loop
{
    wisp_link_job job;
    const wisp_kernels* kernels;
    int first; // link of the colour
} link_loop;

static void run_links( void* context, int begin, int end, int worker )
{
    (void)worker;
    const link_loop* loop = context;
    loop->kernels->link_unilateral( &loop->job, loop->first + 8 * begin, loop->first + 8 * end );
}

// A level's colours share no vertex, so each may be cut between any two groups.
static void project_level( const wisp_parallel* parallel, const wisp_schedule* schedule, link_loop* loop )
{
    for ( int colour = 0; colour < schedule->colour_count; ++colour )
    {
        int begin = schedule->tile_begin[schedule->colour_tile[colour]];
        int end = schedule->tile_begin[schedule->colour_tile[colour + 1]];
        loop->first = begin;
        wisp_parallel_for( parallel, ( end - begin ) / 8, GROUP_GRAIN, run_links, loop );
    }
}

typedef struct prolong_loop
{
    wisp_prolong_job job;
    const wisp_kernels* kernels;
} prolong_loop;

static void run_prolong( void* context, int begin, int end, int worker )
{
    (void)worker;
    const prolong_loop* loop = context;
    loop->kernels->prolong( &loop->job, begin, end );
}

static void remember( float* before, const float* position, const wisp_fabric_level* level )
{
    for ( int i = 0; i < level->vertex_count; ++i )
    {
        memcpy( before + level->vertex4[i], position + level->vertex4[i], 4 * sizeof( float ) );
    }
}

// How far the vertices of a level have come by now, once for all of their children.
static void measure( float* moved, const float* before, const float* position, const wisp_fabric_level* level )
{
    for ( int i = 0; i < level->vertex_count; ++i )
    {
        int32_t vertex4 = level->vertex4[i];
        for ( int k = 0; k < 4; ++k )
        {
            moved[vertex4 + k] = position[vertex4 + k] - before[vertex4 + k];
        }
    }
}

static void project_levels( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    int passes = *(int32_t*)wisp_frame_column( frame, span->entity, WISP_SURFACE_LEVELS, 0 );
    const size_t numbers = (size_t)fabric->slot_count * 4;
    float* before = wisp_parallel_scratch( parallel, span->worker, 2 * numbers * sizeof( float ) );
    if ( before == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "no memory for the coarse levels of %d particles",
                         fabric->slot_count );
        return;
    }
    float* moved = before + numbers;
    // the finest coarse level holds the vertices of all levels
    if ( fabric->level_count > 0 )
    {
        remember( before, position, fabric->levels );
    }
    for ( int l = fabric->level_count - 1; l >= 0; --l )
    {
        const wisp_fabric_level* level = fabric->levels + l;
        link_loop links = { { .position = position, .a4 = level->a4, .b4 = level->b4, .rest = level->rest },
                            kernels,
                            0 };
        for ( int pass = 0; pass < passes; ++pass )
        {
            project_level( parallel, &level->schedule, &links );
        }
        measure( moved, before, position, level );
        prolong_loop children = {
            { position, moved, level->child4, level->parent4, level->weight },
            kernels,
        };
        wisp_parallel_for( parallel, ( level->child_count + 7 ) / 8, CHILD_GRAIN, run_prolong, &children );
    }
}

wisp_status passes_declare_far( wisp_registry* registry )
{
    const wisp_pass passes[] = {
        {
            .name = "surface.tethers",
            .stage = WISP_STAGE_PREDICT,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { WISP_SURFACE_TETHERS },
            .reads = { WISP_SURFACE_TETHERS, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
            .run = project_tethers,
        },
        {
            .name = "surface.levels",
            .stage = WISP_STAGE_PREDICT,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { WISP_SURFACE_LEVELS },
            .reads = { WISP_SURFACE_LEVELS, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
            .run = project_levels,
        },
    };
    return passes_declare_all( registry, passes, WISP_COUNT( passes ) );
}
