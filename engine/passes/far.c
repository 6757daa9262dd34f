// Long-range constraints, once per substep before the near ones: tethers to attachments, and coarse levels. A
// coarse level propagates a stretch across the mesh in one pass; near links need as many passes as the mesh has
// rows.
#include "passes.h"
#include "passes_common.h"

#include "wisp/module/components.h"

#include <string.h>

typedef struct tether_loop
{
    wisp_tether_args args;
    const wisp_kernels* kernels;
} tether_loop;

enum
{
    SLOT_GRAIN = 2048,  // particles per block: about 1.5 microseconds
    VERTEX_GRAIN = 512, // vertices of a level per block
    CHILD_GRAIN = 64,   // slices of eight children per block
};

static void run_tethers( void* context, int begin, int end, int worker )
{
    (void)worker;
    const tether_loop* loop = context;
    loop->kernels->tether( &loop->args, begin * 8, end * 8 );
}

static void project_tethers( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    tether_loop loop = { .kernels = wisp_frame_kernels( frame ) };
    loop.args.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    loop.args.slack = *(float*)wisp_frame_column( frame, span->entity, WISP_SURFACE_TETHERS, 0 );
    loop.args.anchor_x4 = fabric->tether_x4;
    loop.args.rest = fabric->tether_rest;
    loop.args.layer_count = fabric->tether_count;
    loop.args.slot_count = fabric->slot_count;
    wisp_parallel_for( wisp_frame_parallel( frame, span ), fabric->slot_count / 8, SLOT_GRAIN / 8, run_tethers,
                       &loop );
}

// ---- coarse levels ----

typedef struct link_call
{
    wisp_link_args args;
    const wisp_kernels* kernels;
} link_call;

static void run_links( const void* context, int begin, int end )
{
    const link_call* call = context;
    call->kernels->link_unilateral( &call->args, begin, end );
}

typedef struct prolong_loop
{
    wisp_prolong_args args;
    const wisp_kernels* kernels;
} prolong_loop;

static void run_prolong( void* context, int begin, int end, int worker )
{
    (void)worker;
    const prolong_loop* loop = context;
    loop->kernels->prolong( &loop->args, begin, end );
}

// Vertices of a level: positions, positions before its constraints, and displacements.
typedef struct vertex_loop
{
    const wisp_fabric_level* level;
    const float* position;
    float *before, *moved;
} vertex_loop;

static void remember( void* context, int begin, int end, int worker )
{
    (void)worker;
    const vertex_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t vertex_x4 = loop->level->vertex_x4[i];
        memcpy( loop->before + vertex_x4, loop->position + vertex_x4, 4 * sizeof( float ) );
    }
}

// Computes displacements once for all children of a vertex.
static void measure( void* context, int begin, int end, int worker )
{
    (void)worker;
    const vertex_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t vertex_x4 = loop->level->vertex_x4[i];
        const float *p = loop->position + vertex_x4, *q = loop->before + vertex_x4;
        const float moved[4] = { p[0] - q[0], p[1] - q[1], p[2] - q[2], p[3] - q[3] };
        memcpy( loop->moved + vertex_x4, moved, sizeof( moved ) );
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
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the coarse levels of %d particles",
                         fabric->slot_count );
        return;
    }
    vertex_loop vertices = {
        .level = fabric->levels, .position = position, .before = before, .moved = before + numbers
    };
    // the finest coarse level contains the vertices of all levels
    if ( fabric->level_count > 0 )
    {
        wisp_parallel_for( parallel, fabric->levels->vertex_count, VERTEX_GRAIN, remember, &vertices );
    }
    for ( int l = fabric->level_count - 1; l >= 0; --l )
    {
        const wisp_fabric_level* level = fabric->levels + l;
        const link_call links = {
            { .position = position, .a_x4 = level->a_x4, .b_x4 = level->b_x4, .rest = level->rest },
            kernels,
        };
        for ( int pass = 0; pass < passes; ++pass )
        {
            wisp_run_schedule( parallel, &level->schedule, run_links, &links );
        }
        vertices.level = level;
        wisp_parallel_for( parallel, level->vertex_count, VERTEX_GRAIN, measure, &vertices );
        prolong_loop children = {
            { position, vertices.moved, level->child_x4, level->parent_x4, level->weight },
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
            .required = { WISP_SURFACE_TETHERS },
            .reads = { WISP_SURFACE_TETHERS, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
            .run = project_tethers,
        },
        {
            .name = "surface.levels",
            .stage = WISP_STAGE_PREDICT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { WISP_SURFACE_LEVELS },
            .reads = { WISP_SURFACE_LEVELS, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
            .run = project_levels,
        },
    };
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}
