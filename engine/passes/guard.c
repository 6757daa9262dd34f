// The state check: after the substeps, an entity with particles that are not finite or out of bounds is reset to
// its last valid state and halted, without affecting others. Derived quantities are computed afterwards, so no
// other pass reads NaN.
#include "passes.h"

#include "wisp/module/components.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

// Bounds of the state: a float at 1e6 m has a resolution of 6 cm, and no simulated speed reaches 1e6 m/s.
static const float BOUND = 1e6f;

typedef struct guard_loop
{
    const wisp_kernels* kernels;
    float *position, *velocity;
    float *good_position, *good_velocity;
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

static void keep( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    size_t first = (size_t)begin * 32, bytes = (size_t)( end - begin ) * 32 * sizeof( float );
    memcpy( loop->good_position + first, loop->position + first, bytes );
    memcpy( loop->good_velocity + first, loop->velocity + first, bytes );
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
    // inverse masses stay: a pin set or released since the last valid step must keep its state
    for ( size_t i = 0; i < (size_t)loop->slot_count * 4; i += 4 )
    {
        memcpy( loop->position + i, loop->good_position + i, 3 * sizeof( float ) );
        memcpy( loop->velocity + i, loop->good_velocity + i, 4 * sizeof( float ) );
    }
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
        .good_position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_LAST_VALID, 0 ),
        .good_velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_LAST_VALID, 1 ),
        .slot_count = wisp_frame_fabric( frame, span->entity )->slot_count,
    };
    atomic_init( &loop.first_bad, loop.slot_count );
    wisp_parallel_for( parallel, loop.slot_count / 8, GRAIN, check, &loop );
    if ( atomic_load( &loop.first_bad ) < loop.slot_count )
    {
        restore( frame, span->entity, &loop );
    }
    else
    {
        wisp_parallel_for( parallel, loop.slot_count / 8, GRAIN, keep, &loop );
    }
}

wisp_status passes_declare_state_check( wisp_registry* registry )
{
    const wisp_pass pass = {
        .name = "particles.state_check",
        .stage = WISP_STAGE_CHECK,
        .domain = WISP_DOMAIN_ENTITY,
        .required = { WISP_PARTICLE_LAST_VALID, WISP_PARTICLE_VELOCITY },
        .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_LAST_VALID },
        .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_LAST_VALID },
        .run = guard,
    };
    return wisp_declare_pass( registry, &pass );
}
