// Tethers: distances to attachments, once per substep before the near constraints.
#include "passes.h"

#include "wisp/module/components.h"

typedef struct tether_loop
{
    wisp_tether_args args;
    const wisp_kernels* kernels;
} tether_loop;

enum
{
    SLOT_GRAIN = 2048, // particles per block: about 1.5 microseconds
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

wisp_status passes_declare_tethers( wisp_registry* registry )
{
    const wisp_pass pass = {
        .name = "surface.tethers",
        .stage = WISP_STAGE_PREDICT,
        .domain = WISP_DOMAIN_ENTITY,
        .required = { WISP_SURFACE_TETHERS },
        .reads = { WISP_SURFACE_TETHERS, WISP_PARTICLE_POSITION },
        .writes = { WISP_PARTICLE_POSITION },
        .run = project_tethers,
        .detail = WISP_PASS_FINE,
    };
    return wisp_declare_pass( registry, &pass );
}
