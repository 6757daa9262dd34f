// Near constraints: links and hinges, in the order of the cooked fabric.
#include "passes.h"

#include "wisp/module/components.h"
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

// ---- tethers ----

// Tethers: distances to attachments, once per substep before the near constraints.

enum
{
    SLOT_GRAIN = 2048, // particles per block: about 1.5 microseconds
};

WISP_KERNEL_LOOP( tether_loop, run_tethers, tether, wisp_tether_args, 8 )

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
        WISP_PASS( "surface.tethers", PREDICT, ENTITY, project_tethers ),
        .required = { WISP_SURFACE_TETHERS },
        .reads = { WISP_SURFACE_TETHERS, WISP_PARTICLE_POSITION },
        .writes = { WISP_PARTICLE_POSITION },
        .detail = WISP_PASS_FINE,
    };
    return wisp_declare_pass( registry, &pass );
}

// ---- constraints ----

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
    call->args.bends = fabric->link_bends;
    call->first = span->iteration == 0;
    wisp_run_schedule( wisp_frame_parallel( frame, span ), &fabric->link_order, run_links, call );
}

// Links, then the hinges of bend links that were too short to be projected.
static void project_links( wisp_frame* frame, const wisp_span* span, wisp_component alike, link_call* call )
{
    memcpy( call->args.alike, wisp_frame_column( frame, span->entity, alike, 0 ), sizeof( call->args.alike ) );
    call->args.own = wisp_frame_column( frame, span->entity, WISP_LINK_OWN, 0 );
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
    project_links( frame, span, WISP_LINK_STIFFNESS, &call );
}

// Lambda has rows with several iterations per substep only.
static void links_xpbd( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    link_call call = { .kernel = wisp_frame_kernels( frame )->link_xpbd };
    call.args.lambda = wisp_frame_column( frame, span->entity, WISP_LINK_LAMBDA, 0 );
    call.args.inverse_dt2 = inverse_dt2( frame, span->entity );
    project_links( frame, span, WISP_LINK_COMPLIANCE, &call );
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

// Bending by pbd, by angles or by curvature. In xpbd a module bends plates as a whole (wisp/module/plate.h).
static void project_hinges( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const bool by_angle = wisp_frame_has( frame, span->entity, WISP_HINGE_REST );
    hinge_call call = { .kernel = by_angle ? kernels->hinge_dihedral : kernels->hinge_isometric };
    call.args.rest = wisp_frame_column( frame, span->entity, by_angle ? WISP_HINGE_REST : WISP_HINGE_COTANGENT, 0 );
    call.args.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    call.args.slot_x4 = fabric->hinge_slot_x4;
    call.args.stiffness = wisp_frame_column( frame, span->entity, WISP_HINGE_STIFFNESS, 0 );
    wisp_run_schedule( wisp_frame_parallel( frame, span ), &fabric->hinge_order, run_hinges, &call );
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
        { WISP_PASS( "links.xpbd", PROJECT, ENTITY, links_xpbd ), .required = { WISP_LINK_COMPLIANCE },
          .reads = { WISP_PARTICLE_POSITION, WISP_LINK_COMPLIANCE, lambda },
          .writes = { WISP_PARTICLE_POSITION, lambda }, .detail = WISP_PASS_FINE },
        PROJECTION( "hinges.dihedral_pbd", project_hinges, WISP_HINGE_REST, WISP_HINGE_STIFFNESS ),
        PROJECTION( "hinges.isometric_pbd", project_hinges, WISP_HINGE_COTANGENT, WISP_HINGE_STIFFNESS ),
        { WISP_PASS( "hinges.folds", PROJECT, ENTITY, passes_open_hinges ), .required = { WISP_HINGE_FOLDS },
          .fabric = WISP_FABRIC_SPANS, .reads = { WISP_PARTICLE_POSITION, WISP_HINGE_FOLDS },
          .writes = { WISP_PARTICLE_POSITION }, .detail = WISP_PASS_FINE },
        PROJECTION( "links.limit", links_limit, WISP_LINK_LIMIT ),
    };
#undef PROJECTION
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}

// ---- guard ----

// The state check: after the substeps, an entity with particles that are not finite or out of bounds is reset to
// its last valid state, at rest, and halted, without affecting others. Derived quantities are computed afterwards, so no
// other pass reads NaN.

// Bounds of the state: a float at 1e6 m has a resolution of 6 cm, and no simulated speed reaches 1e6 m/s.
static const float BOUND = 1e6f;

typedef struct guard_loop
{
    const wisp_kernels* kernels;
    float *position, *velocity;
    int slot_count;
    _Atomic int first_bad; // lowest slot out of bounds, slot_count if there is none
} guard_loop;

static void check( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    const wisp_bound_args args = { loop->position, loop->velocity, BOUND };
    int slot = loop->kernels->find_out_of_bounds( &args, begin * 8, end * 8 );
    int lowest = atomic_load_explicit( &loop->first_bad, memory_order_relaxed );
    while ( slot < end * 8 && slot < lowest &&
            atomic_compare_exchange_weak( &loop->first_bad, &lowest, slot ) == false )
    {
    }
}

// Puts vertices back, at rest. Inverse masses stay: a pin set or released since the last valid step must keep its state.
static void put_back( wisp_frame* frame, wisp_entity entity, guard_loop* loop )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, entity );
    const wisp_vec3* points = wisp_frame_column( frame, entity, WISP_SURFACE_POINTS, 0 );
    for ( size_t slot = 0; slot < (size_t)fabric->vertex_count; ++slot )
    {
        const wisp_vec3 p = wisp_to_rows( points[fabric->slot_vertex[slot]], wisp_frame_offset( frame, entity ) );
        memcpy( loop->position + 4 * slot, &p, sizeof( p ) );
    }
    memset( loop->velocity, 0, (size_t)loop->slot_count * 4 * sizeof( float ) );
}

static void restore( wisp_frame* frame, wisp_entity entity, guard_loop* loop )
{
    int slot = atomic_load( &loop->first_bad );
    const float* p = loop->position + (size_t)slot * 4;
    const wisp_vec3 o = wisp_frame_offset( frame, entity );
    char message[300];
    snprintf(
        message, sizeof( message ),
        "entity %u: vertex %d left its bounds in step %llu at (%g, %g, %g); the entity is halted in the state of "
        "the previous step",
        entity.index, wisp_frame_fabric( frame, entity )->slot_vertex[slot],
        (unsigned long long)wisp_frame_step( frame ), (double)( p[0] - o.x ), (double)( p[1] - o.y ),
        (double)( p[2] - o.z ) );
    put_back( frame, entity, loop );
    int32_t* levels = wisp_frame_column( frame, entity, WISP_SURFACE_LEVELS, 2 );
    if ( levels != NULL )
    {
        *levels = 0; // coarse sheets forget what they did
    }
    wisp_frame_halt( frame, entity, message );
}

static void guard( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    enum
    {
        GRAIN = 2048 / 8, // slots, in groups of eight
    };
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    guard_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .slot_count = wisp_frame_fabric( frame, span->entity )->slot_count,
    };
    atomic_init( &loop.first_bad, loop.slot_count );
    wisp_parallel_for( parallel, loop.slot_count / 8, GRAIN, check, &loop );
    if ( atomic_load( &loop.first_bad ) < loop.slot_count )
    {
        restore( frame, span->entity, &loop );
    }
}

wisp_status passes_declare_state_check( wisp_registry* registry )
{
    const wisp_pass pass = {
        WISP_PASS( "particles.state_check", CHECK, ENTITY, guard ),
        .required = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_SURFACE_POINTS },
        .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
    };
    return wisp_declare_pass( registry, &pass );
}
