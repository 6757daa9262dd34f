// Instances of one fabric side by side: up to sixteen surfaces, one per lane. A fraction of the time of single small
// surfaces (bench case "scenes", crowds), with the same bits. Surfaces may differ in all but their stiffness. Those that have only
// passes that can run for a crowd (wisp_pass.run_crowd) make all substeps in one go. Else the links run side by side in each
// substep, and the rest surface by surface.
#include "passes.h"

#include "wisp/module/components.h"

#include <stdint.h>
#include <string.h>

enum
{
    LANES = WISP_INSTANCE_LANES,
};

// Order of the passes in the declaration.
enum
{
    PREDICT,
    VELOCITY,
    LINKS,
    GRAVITY,
    TARGETS,
    DAMPING,
};

// The component with the stiffness of links.
static wisp_component material_of( const void* user )
{
    return user != NULL ? WISP_LINK_STIFFNESS : WISP_LINK_COMPLIANCE;
}

static float* instance_positions( wisp_frame* frame, wisp_entity entity )
{
    return wisp_frame_column( frame, entity, WISP_PARTICLE_POSITION, 0 );
}

// Sharp folds are projected one by one, so a surface that has some runs alone.
static bool has_folds( wisp_frame* frame, wisp_entity entity )
{
    const int32_t* count = wisp_frame_column( frame, entity, WISP_LINK_FOLDS, 1 );
    return count != NULL && *count > 0;
}

// Whether both have the same rows, or none.
static bool have_same( wisp_frame* frame, wisp_entity a, wisp_entity b, wisp_component component, size_t bytes )
{
    const void *of_a = wisp_frame_column( frame, a, component, 0 ),
               *of_b = wisp_frame_column( frame, b, component, 0 );
    return of_a == NULL || of_b == NULL ? of_a == of_b : memcmp( of_a, of_b, bytes ) == 0;
}

static bool can_join( wisp_frame* frame, wisp_entity first, wisp_entity entity, void* user )
{
    const ptrdiff_t offset = instance_positions( frame, entity ) - instance_positions( frame, first );
    const size_t bytes = (size_t)wisp_frame_fabric( frame, first )->link_order.slot_count * sizeof( float );
    return has_folds( frame, entity ) == false && wisp_frame_has( frame, entity, WISP_MAP_DAMPING ) == false &&
           wisp_frame_has( frame, entity, WISP_LINK_LAMBDA ) == false &&
           wisp_frame_has( frame, first, WISP_LINK_FOLDS ) == wisp_frame_has( frame, entity, WISP_LINK_FOLDS ) &&
           offset <= INT32_MAX && offset >= INT32_MIN && have_same( frame, first, entity, WISP_LINK_OWN, bytes ) &&
           have_same( frame, first, entity, material_of( user ), 2 * sizeof( float ) );
}

// ---- the run ----

// A pinned particle of one lane with a target.
typedef struct moved_pin
{
    float* position;     // x, its y and z are LANES and 2 LANES behind it
    const float* target; // x, y, z in m
} moved_pin;

typedef struct instances
{
    wisp_instances_args args;
    const wisp_kernels* kernels;
    int count;
    moved_pin* pins;
    int pin_count;
    int32_t wait[LANES];    // passes until folds are searched for
    bool looks_for_folds;   // else there are no bend links whose folds count
    uint32_t left;          // bits of lanes whose surfaces run alone: with folds, or without finite numbers
    double moving, solving; // s
} instances;

static bool take_memory( instances* all, const wisp_parallel* parallel, int worker )
{
    const size_t floats = (size_t)all->args.slot_count * LANES;
    float* memory = wisp_parallel_scratch( parallel, worker, 10 * floats * sizeof( float ) );
    all->args.position = memory;
    all->args.velocity = memory + 4 * floats;
    all->args.previous = memory + 7 * floats;
    return memory != NULL;
}

// Visits the pinned particles of a lane that have targets, and lists them if there is room already.
static void list_pins_of_lane( instances* all, wisp_frame* frame, wisp_entity entity, int lane )
{
    const float *position = instance_positions( frame, entity ),
                *target = wisp_frame_column( frame, entity, WISP_PARTICLE_TARGET, 0 );
    for ( size_t slot = 0; target != NULL && slot < (size_t)all->args.slot_count; ++slot )
    {
        if ( target[4 * slot + 3] != 0.0f && position[4 * slot + 3] == 0.0f )
        {
            if ( all->pins != NULL )
            {
                all->pins[all->pin_count] =
                    ( moved_pin ){ all->args.position + 4 * LANES * slot + lane, target + 4 * slot };
            }
            all->pin_count += 1;
        }
    }
}

static void list_pins( instances* all, wisp_frame* frame, const wisp_entity* entities )
{
    all->pin_count = 0;
    for ( int lane = 0; lane < all->count; ++lane )
    {
        list_pins_of_lane( all, frame, entities[lane], lane );
    }
}

// @return false if there is no memory
static bool take_pins( instances* all, wisp_frame* frame, const wisp_entity* entities, const wisp_parallel* parallel,
                       int worker )
{
    list_pins( all, frame, entities ); // counts them
    if ( all->pin_count > 0 )
    {
        const size_t bytes = (size_t)all->pin_count * sizeof( moved_pin );
        all->pins = wisp_parallel_scratch( parallel, worker, bytes );
        if ( all->pins == NULL )
        {
            return false;
        }
        list_pins( all, frame, entities );
    }
    return true;
}

// As move_pins() of particles.
static void move_instance_pins( instances* all, float fraction )
{
    for ( int i = 0; i < all->pin_count; ++i )
    {
        const moved_pin pin = all->pins[i];
        for ( int k = 0; k < 3; ++k )
        {
            float* p = pin.position + (ptrdiff_t)k * LANES;
            *p = fraction == 1.0f ? pin.target[k] : *p + fraction * ( pin.target[k] - *p );
        }
    }
}

static void set_links( instances* all, wisp_frame* frame, wisp_entity first, const void* user )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, first );
    wisp_instances_args* args = &all->args;
    args->slot_count = fabric->slot_count;
    args->area = fabric->area;
    args->link_count = fabric->link_order.slot_count;
    args->bends = fabric->link_bends;
    args->a_x4 = fabric->link_a_x4;
    args->b_x4 = fabric->link_b_x4;
    args->rest = fabric->link_rest;
    args->is_compliant = user == NULL;
    args->own = wisp_frame_column( frame, first, WISP_LINK_OWN, 0 );
    memcpy( args->alike, wisp_frame_column( frame, first, material_of( user ), 0 ), sizeof( args->alike ) );
    args->dt = wisp_frame_dt( frame, first );
    args->inverse_dt2 = 1.0f / ( args->dt * args->dt );
    all->looks_for_folds = wisp_frame_has( frame, first, WISP_LINK_FOLDS );
}

// A lane without a surface repeats the first one.
static wisp_entity place_lane( instances* all, wisp_frame* frame, const wisp_entity* entities, int lane )
{
    const wisp_entity entity = entities[lane < all->count ? lane : 0];
    all->args.offset[lane] = (int32_t)( instance_positions( frame, entity ) - all->args.position_column );
    all->wait[lane] = all->looks_for_folds ? *(int32_t*)wisp_frame_column( frame, entity, WISP_LINK_FOLDS, 2 ) : 0;
    return entity;
}

static void set_lane( instances* all, wisp_frame* frame, const wisp_entity* entities, int lane )
{
    wisp_instances_args* args = &all->args;
    const wisp_entity entity = place_lane( all, frame, entities, lane );
    const wisp_vec3* gravity = wisp_frame_column( frame, entity, WISP_PARTICLE_GRAVITY, 0 );
    if ( args->accelerates )
    {
        args->acceleration[lane] = gravity->x;
        args->acceleration[LANES + lane] = gravity->y;
        args->acceleration[2 * LANES + lane] = gravity->z;
    }
    const float* rate = wisp_frame_column( frame, entity, WISP_PARTICLE_DAMPING, 0 );
    args->keep[lane] = args->damps ? 1.0f / ( 1.0f + *rate * args->dt ) : 1.0f;
}

static void set_particles( instances* all, wisp_frame* frame, const wisp_entity* entities )
{
    wisp_instances_args* args = &all->args;
    args->position_column = instance_positions( frame, entities[0] );
    args->velocity_column = wisp_frame_column( frame, entities[0], WISP_PARTICLE_VELOCITY, 0 );
    args->previous_column = wisp_frame_column( frame, entities[0], WISP_PARTICLE_PREVIOUS, 0 );
    args->accelerates = wisp_frame_has( frame, entities[0], WISP_PARTICLE_GRAVITY );
    args->damps = wisp_frame_has( frame, entities[0], WISP_PARTICLE_DAMPING );
    for ( int lane = 0; lane < LANES; ++lane )
    {
        set_lane( all, frame, entities, lane );
    }
}

// Lanes whose folds are searched for in this pass, as passes_begin_folds() decides for a surface without folds.
static uint32_t lanes_to_search( instances* all )
{
    uint32_t lanes = 0;
    for ( int lane = 0; lane < all->count && all->looks_for_folds; ++lane )
    {
        const bool waits = all->wait[lane] > 0;
        lanes |= waits ? 0u : 1u << lane;
        all->wait[lane] = waits ? all->wait[lane] - 1 : PASSES_BETWEEN_FOLDS;
    }
    return lanes;
}

// End a substep, begin the next one, or both in one sweep where nothing comes in between.
static void advance( instances* all, wisp_frame* frame, const wisp_crowd* crowd, wisp_span* span, int substeps )
{
    const bool ends = span->substep > 0, begins = span->substep < substeps;
    const bool apart = ends && ( wisp_frame_run_crowd( frame, WISP_STAGE_VELOCITY, crowd, NULL ) ||
                                 wisp_frame_run_crowd( frame, WISP_STAGE_FORCE, crowd, NULL ) );
    double now = wisp_clock_seconds();
    if ( apart )
    {
        all->left |= all->kernels->instances_advance( &all->args, true, false );
        span->substep -= 1;
        all->moving += wisp_clock_seconds() - now;
        wisp_frame_run_crowd( frame, WISP_STAGE_VELOCITY, crowd, span );
        span->substep += 1;
    }
    if ( begins )
    {
        wisp_frame_run_crowd( frame, WISP_STAGE_FORCE, crowd, span );
    }
    now = wisp_clock_seconds();
    if ( begins || apart == false )
    {
        all->left |= all->kernels->instances_advance( &all->args, ends && apart == false, begins );
    }
    all->moving += wisp_clock_seconds() - now;
}

static void run_substeps( instances* all, wisp_frame* frame, const wisp_crowd* crowd, wisp_span span )
{
    const wisp_entity first = crowd->entities[0];
    const int substeps = wisp_frame_substeps( frame, first );
    for ( span.substep = 0; span.substep < substeps; ++span.substep )
    {
        advance( all, frame, crowd, &span, substeps );
        double now = wisp_clock_seconds();
        move_instance_pins( all, wisp_frame_progress_left( frame, first, span.substep ) );
        all->moving += wisp_clock_seconds() - now;
        now = wisp_clock_seconds();
        const uint32_t searched = lanes_to_search( all );
        all->left |= all->kernels->instances_link( &all->args, searched != 0 ) & searched;
        all->solving += wisp_clock_seconds() - now;
        wisp_frame_run_crowd( frame, WISP_STAGE_PROJECT, crowd, &span );
    }
    advance( all, frame, crowd, &span, substeps );
}

static void divide_seconds( const instances* all, double* seconds )
{
    const bool has_pins = all->pin_count > 0;
    const double part = all->moving / ( 2.0 + all->args.accelerates + all->args.damps + has_pins );
    seconds[PREDICT] = seconds[VELOCITY] = part;
    seconds[GRAVITY] = all->args.accelerates ? part : 0.0;
    seconds[TARGETS] = has_pins ? part : 0.0;
    seconds[DAMPING] = all->args.damps ? part : 0.0;
    seconds[LINKS] = all->solving;
}

// Hand over what the lanes have that are not left.
static void store( const instances* all, wisp_frame* frame, const wisp_entity* entities )
{
    const uint32_t every = ( 1u << all->count ) - 1u;
    all->kernels->instances_store( &all->args, every & ~all->left );
    for ( int lane = 0; lane < all->count && all->looks_for_folds; ++lane )
    {
        if ( ( all->left >> lane & 1 ) == 0 )
        {
            *(int32_t*)wisp_frame_column( frame, entities[lane], WISP_LINK_FOLDS, 2 ) = all->wait[lane];
        }
    }
}

// A surface that folds is left as it was, to run alone. So is one that loses its numbers, because which NaN comes out
// of arithmetic on NaNs is left open.
static uint32_t run_instances( wisp_frame* frame, const wisp_entity* entities, int count, int worker, double* seconds,
                               void* user )
{
    const uint32_t every = ( 1u << count ) - 1u;
    const wisp_span span = { .entity = entities[0], .worker = worker };
    instances all = { .kernels = wisp_frame_kernels( frame ), .count = count };
    set_links( &all, frame, entities[0], user );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, &span );
    if ( take_memory( &all, parallel, worker ) == false ||
         take_pins( &all, frame, entities, parallel, worker ) == false )
    {
        return every;
    }
    set_particles( &all, frame, entities );
    wisp_entity lanes[LANES];
    for ( int lane = 0; lane < LANES; ++lane )
    {
        lanes[lane] = entities[lane < count ? lane : 0];
    }
    all.args.pinned = all.kernels->instances_load( &all.args );
    run_substeps( &all, frame, &( wisp_crowd ){ &all.args, lanes, count, &all.left }, span );
    store( &all, frame, entities );
    divide_seconds( &all, seconds );
    return all.left & every;
}

// ---- links alone, in a substep ----

// A surface that has folds, or gets some, is left to the pass for one surface, which projects them.
static uint32_t run_instance_links( wisp_frame* frame, const wisp_entity* entities, int count, const wisp_span* span,
                                    void* user )
{
    const uint32_t every = ( 1u << count ) - 1u;
    instances all = { .kernels = wisp_frame_kernels( frame ), .count = count };
    set_links( &all, frame, entities[0], user );
    wisp_instances_args* args = &all.args;
    const size_t bytes = (size_t)args->slot_count * 4 * LANES * sizeof( float );
    args->position = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( args->position == NULL )
    {
        return every;
    }
    args->position_column = instance_positions( frame, entities[0] );
    for ( int lane = 0; lane < LANES; ++lane )
    {
        place_lane( &all, frame, entities, lane );
        all.left |= lane < count && has_folds( frame, entities[lane] ) ? 1u << lane : 0;
    }
    all.kernels->instances_load( args );
    const uint32_t searched = lanes_to_search( &all );
    all.left |= all.kernels->instances_link( args, searched != 0 ) & searched;
    all.left |= all.kernels->instances_find_lost( args );
    store( &all, frame, entities );
    return all.left & every;
}

wisp_status passes_declare_instances( wisp_registry* registry )
{
    static const char pbd[] = "pbd";
    const wisp_batch batches[] = {
        { .name = "instances.pbd",
          .required = { "particles.predict", "particles.velocity", "links.pbd" },
          .allowed = { "particles.gravity", "particles.targets", "particles.damping" },
          .pass = "links.pbd",
          .user = (void*)(uintptr_t)pbd },
        { .name = "instances.xpbd",
          .required = { "particles.predict", "particles.velocity", "links.xpbd" },
          .allowed = { "particles.gravity", "particles.targets", "particles.damping" },
          .pass = "links.xpbd" },
    };
    for ( int i = 0; i < WISP_COUNT( batches ); ++i )
    {
        wisp_batch batch = batches[i];
        batch.lanes = LANES;
        batch.can_join = can_join;
        batch.run = run_instances;
        batch.run_pass = run_instance_links;
        WISP_TRY( wisp_declare_batch( registry, &batch ) );
    }
    return WISP_OK;
}
