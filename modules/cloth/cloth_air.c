// Air on triangles: runs the kernel ring_air with the wind of the cloth.
#include "cloth_internal.h"

#include <string.h>

typedef struct air_loop
{
    const wisp_kernels* kernels;
    wisp_ring_air_args args;
    float* copy; // of the velocities
} air_loop;

static void copy_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const air_loop* loop = context;
    const size_t first = (size_t)begin * 32, count = (size_t)( end - begin ) * 32;
    memcpy( loop->copy + first, loop->args.velocity + first, count * sizeof( float ) );
}

static void blow_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const air_loop* loop = context;
    loop->kernels->ring_air( &loop->args, begin, end );
}

void cloth_blow( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 64, // slices
    };
    const cloth_state* state = user;
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const cloth_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    const size_t bytes = (size_t)fabric->slot_count * 4 * sizeof( float );
    float* copy = wisp_parallel_scratch( parallel, span->worker, bytes );
    if ( copy == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the air on %d particles", fabric->slot_count );
        return;
    }
    air_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .old_velocity = copy,
                  .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
                  .ring_begin = fabric->ring_begin,
                  .ring_x4 = fabric->ring_x4,
                  .wind = air->wind,
                  .density = air->density,
                  .drag = air->drag,
                  .lift = air->lift,
                  .dt = wisp_frame_dt( frame, span->entity ),
                  .drag_factor = wisp_frame_column( frame, span->entity, WISP_MAP_DRAG, 0 ),
                  .lift_factor = wisp_frame_column( frame, span->entity, WISP_MAP_LIFT, 0 ) },
        .copy = copy,
    };
    wisp_parallel_for( parallel, fabric->ring_slice_count, GRAIN, copy_slices, &loop );
    wisp_parallel_for( parallel, fabric->ring_slice_count, GRAIN, blow_slices, &loop );
}

bool cloth_blows_evenly( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return wisp_frame_has( frame, entity, WISP_MAP_DRAG ) == false &&
           wisp_frame_has( frame, entity, WISP_MAP_LIFT ) == false;
}

void cloth_blow_crowd( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, crowd->entities[0] );
    const size_t bytes = (size_t)fabric->slot_count * 3 * WISP_INSTANCE_LANES * sizeof( float );
    float* copy = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( copy == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the air on %d particles", fabric->slot_count );
        return;
    }
    memcpy( copy, crowd->args->velocity, bytes );
    wisp_instances_air_args args = { .old_velocity = copy,
                                     .ring_begin = fabric->ring_begin,
                                     .ring_x4 = fabric->ring_x4 };
    for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
    {
        const cloth_air* air = wisp_frame_column( frame, crowd->entities[lane], state->air, 0 );
        args.wind[lane] = air->wind.x;
        args.wind[WISP_INSTANCE_LANES + lane] = air->wind.y;
        args.wind[2 * WISP_INSTANCE_LANES + lane] = air->wind.z;
        args.density[lane] = air->density;
        args.drag[lane] = air->drag;
        args.lift[lane] = air->lift;
    }
    wisp_frame_kernels( frame )->instances_air( crowd->args, &args );
}
