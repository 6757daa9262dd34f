// Near constraints: links and hinges, in the order of the cooked fabric.
#include "passes.h"

#include "wisp/module/components.h"

#include <string.h>

// A kernel with its arguments, so that all constraints share one loop over tiles.
typedef struct link_call
{
    wisp_link_args args;
    void ( *kernel )( const wisp_link_args* args, int begin, int end );
    bool first; // first iteration of the substep: lambda starts at 0
} link_call;

static void run_links( const void* context, int begin, int end )
{
    const link_call* call = context;
    if ( call->first && call->args.lambda != NULL )
    {
        memset( call->args.lambda + begin, 0, (size_t)( end - begin ) * sizeof( float ) );
    }
    call->kernel( &call->args, begin, end );
}

static void run_all_links( wisp_frame* frame, const wisp_span* span, link_call* call )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    call->args.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    call->args.a_x4 = fabric->link_a_x4;
    call->args.b_x4 = fabric->link_b_x4;
    call->args.rest = fabric->link_rest;
    call->first = span->iteration == 0;
    wisp_run_schedule( wisp_frame_parallel( frame, span ), &fabric->link_order, run_links, call );
}

// Links, then the hinges of bend links that were too short to be projected.
static void project_links( wisp_frame* frame, const wisp_span* span, link_call* call )
{
    if ( passes_begin_folds( frame, span, &call->args ) == false )
    {
        return;
    }
    run_all_links( frame, span, call );
    if ( call->args.folded != NULL )
    {
        passes_open_folds( frame, span, (const uint64_t*)(const void*)call->args.folded );
    }
}

static float inverse_dt2( const wisp_frame* frame, wisp_entity entity )
{
    float dt = wisp_frame_dt( frame, entity );
    return 1.0f / ( dt * dt );
}

static void links_pbd( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    link_call call = { .kernel = wisp_frame_kernels( frame )->link_pbd };
    call.args.stiffness = wisp_frame_column( frame, span->entity, WISP_LINK_STIFFNESS, 0 );
    project_links( frame, span, &call );
}

// Lambda has rows with several iterations per substep only.
static void links_xpbd( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    link_call call = { .kernel = wisp_frame_kernels( frame )->link_xpbd };
    call.args.compliance = wisp_frame_column( frame, span->entity, WISP_LINK_COMPLIANCE, 0 );
    call.args.lambda = wisp_frame_column( frame, span->entity, WISP_LINK_LAMBDA, 0 );
    call.args.inverse_dt2 = inverse_dt2( frame, span->entity );
    project_links( frame, span, &call );
}

static void links_limit( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    link_call call = { .kernel = wisp_frame_kernels( frame )->link_limit };
    call.args.minimum = *(float*)wisp_frame_column( frame, span->entity, WISP_LINK_LIMIT, 0 );
    call.args.maximum = *(float*)wisp_frame_column( frame, span->entity, WISP_LINK_LIMIT, 1 );
    run_all_links( frame, span, &call );
}

typedef struct hinge_call
{
    wisp_hinge_args args;
    void ( *kernel )( const wisp_hinge_args* args, int begin, int end );
} hinge_call;

static void run_hinges( const void* context, int begin, int end )
{
    const hinge_call* call = context;
    call->kernel( &call->args, begin, end );
}

// Bending by pbd. In xpbd a module bends plates as a whole (wisp/module/plate.h).
static void project_hinges( wisp_frame* frame, const wisp_span* span, hinge_call* call )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    call->args.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    call->args.slot_x4 = fabric->hinge_slot_x4;
    call->args.stiffness = wisp_frame_column( frame, span->entity, WISP_HINGE_STIFFNESS, 0 );
    wisp_run_schedule( wisp_frame_parallel( frame, span ), &fabric->hinge_order, run_hinges, call );
}

static void hinges_dihedral( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    hinge_call call = { .kernel = wisp_frame_kernels( frame )->hinge_dihedral };
    call.args.rest = wisp_frame_column( frame, span->entity, WISP_HINGE_REST, 0 );
    project_hinges( frame, span, &call );
}

static void hinges_isometric( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    hinge_call call = { .kernel = wisp_frame_kernels( frame )->hinge_isometric };
    call.args.rest = wisp_frame_column( frame, span->entity, WISP_HINGE_COTANGENT, 0 );
    project_hinges( frame, span, &call );
}

wisp_status passes_declare_constraints( wisp_registry* registry )
{
    const wisp_component lambda = wisp_registry_iterations( registry ) > 1 ? WISP_LINK_LAMBDA : 0;
#define PROJECTION( text, function, ... )                                                                            \
    {                                                                                                                \
        .name = text, .stage = WISP_STAGE_PROJECT, .domain = WISP_DOMAIN_ENTITY, .required = { __VA_ARGS__ },        \
        .reads = { WISP_PARTICLE_POSITION, __VA_ARGS__ }, .writes = { WISP_PARTICLE_POSITION }, .run = function,     \
        .detail = WISP_PASS_FINE,                                                                                    \
    }
    const wisp_pass passes[] = {
        PROJECTION( "links.pbd", links_pbd, WISP_LINK_STIFFNESS ),
        { .name = "links.xpbd",
          .stage = WISP_STAGE_PROJECT,
          .domain = WISP_DOMAIN_ENTITY,
          .required = { WISP_LINK_COMPLIANCE },
          .reads = { WISP_PARTICLE_POSITION, WISP_LINK_COMPLIANCE, lambda },
          .writes = { WISP_PARTICLE_POSITION, lambda },
          .run = links_xpbd,
          .detail = WISP_PASS_FINE },
        PROJECTION( "hinges.dihedral_pbd", hinges_dihedral, WISP_HINGE_REST, WISP_HINGE_STIFFNESS ),
        PROJECTION( "hinges.isometric_pbd", hinges_isometric, WISP_HINGE_COTANGENT, WISP_HINGE_STIFFNESS ),
        { .name = "hinges.folds",
          .stage = WISP_STAGE_PROJECT,
          .domain = WISP_DOMAIN_ENTITY,
          .required = { WISP_HINGE_FOLDS },
          .fabric = WISP_FABRIC_SPANS,
          .reads = { WISP_PARTICLE_POSITION, WISP_HINGE_FOLDS },
          .writes = { WISP_PARTICLE_POSITION },
          .run = passes_open_hinges,
          .detail = WISP_PASS_FINE },
        PROJECTION( "links.limit", links_limit, WISP_LINK_LIMIT ),
    };
#undef PROJECTION
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}
