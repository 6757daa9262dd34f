// Bending by curvature, solved implicitly once per substep: hinge after hinge, stiff bending would be as soft as the substeps are
// few. It changes velocities: in short substeps its moves are below the rounding of positions, and lost there. Equations:
// wisp/module/plate.h and docs/methods.md.
#include "cloth_bending.h"

#include <math.h>
#include <string.h>

enum
{
    MAX_STAGES = 512, // of a substep
    GRAIN = 64,       // slices per block
};

// T_s at the start of the recurrence: short waves are damped to a quarter or less per substep. Up to a third would be stable.
static const double SHORT_WAVES = 4.0;
// Angles change along tangents, which lengthen triangles: by 3 % at a quarter of a radian, threefold at half a turn. So a substep
// moves no vertex farther than this share of the least height around it. All moves are scaled down together, which keeps momenta.
static const float MAX_MOVE = 0.125f;
// Moments of angles change faster than the matrix says where triangles are deformed: the stages take it so many times.
static const double ANGLE_MARGIN = 2.0;

// ---- plates of a world ----

int cloth_find_plate( const cloth_state* state, wisp_entity entity )
{
    for ( int i = 0; i < state->plate_count; ++i )
    {
        if ( wisp_entity_equal( state->plates[i].entity, entity ) )
        {
            return i;
        }
    }
    return -1;
}

void cloth_remove_plate( cloth_state* state, wisp_entity entity, const wisp_allocator* allocator )
{
    const int i = cloth_find_plate( state, entity );
    if ( i >= 0 )
    {
        wisp_plate_release( state->plates[i].plate, allocator );
        state->plates[i] = state->plates[--state->plate_count];
    }
}

wisp_status cloth_add_plate( wisp_world* world, cloth_state* state, wisp_entity surface )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    if ( cloth_find_plate( state, surface ) >= 0 )
    {
        return WISP_OK;
    }
    cloth_plate plate = { .entity = surface };
    if ( wisp_world_reserve( world, (void**)&state->plates, &state->plate_capacity, state->plate_count,
                             sizeof( *state->plates ) ) == false ||
         wisp_plate_create( fabric, NULL, fabric->slot_count, true, wisp_world_allocator( world ), &plate.plate ) !=
             WISP_OK )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "cloth: out of memory for the bending of %d vertices",
                                fabric->vertex_count );
    }
    state->plates[state->plate_count++] = plate;
    return WISP_OK;
}

// ---- a substep ----

typedef struct bending
{
    wisp_plate_args args;
    wisp_plate_angle_args angles; // dihedral; else without rest angles
    const wisp_kernels* kernels;
    const float *position, *target; // [slot][4]; targets may be null
    float* velocity;                // [slot][4]
    float* predicted;               // [slot][4] m, where gravity and velocities lead; inverse mass
    float* moved;                   // [slot][4] m, y of the last stage
    wisp_vec3 gravity;
    float dt, to_target; // s; share of the way to a target
    float gain;          // of the first stage
    float* largest;      // [slice] move over the least height
    float scale;         // of all moves
} bending;

// Coefficients of a recurrence of some stages (van der Houwen and Sommeijer 1980).
typedef struct chebyshev
{
    double w0, w1, angle; // T_n( w0 ) = cosh( n angle )
    double reach;         // largest eigenvalue of A for which waves do not grow
} chebyshev;

static chebyshev recurrence_of( int stages )
{
    chebyshev c = { .angle = acosh( SHORT_WAVES ) / stages };
    c.w0 = cosh( c.angle );
    c.w1 = SHORT_WAVES * sinh( c.angle ) / ( stages * sinh( stages * c.angle ) );
    c.reach = ( 1.0 + c.w0 ) / c.w1;
    return c;
}

static int stages_for( double largest )
{
    int stages = 1;
    while ( stages < MAX_STAGES && recurrence_of( stages ).reach < largest )
    {
        ++stages;
    }
    return stages;
}

// As the passes that follow predict it.
static void predict( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    const float fall[3] = { b->dt * b->gravity.x, b->dt * b->gravity.y, b->dt * b->gravity.z };
    for ( int i = 32 * begin; i < 32 * end; i += 4 )
    {
        const float* x = b->position + i;
        const bool pinned = x[3] == 0.0f, carried = pinned && b->target != NULL && b->target[i + 3] != 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            const float free = x[k] + b->dt * ( b->velocity[i + k] + fall[k] );
            const float held = carried ? x[k] + b->to_target * ( b->target[i + k] - x[k] ) : x[k];
            b->predicted[i + k] = pinned ? held : free;
        }
        b->predicted[i + 3] = x[3];
    }
}

static void compute_impulse( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    b->kernels->plate_impulse( &b->args, begin, end );
}

static void measure_angles( const void* context, int begin, int end )
{
    const bending* b = context;
    b->kernels->plate_measure_angles( &b->angles, begin, end );
}

static void add_moments( const void* context, int begin, int end )
{
    const bending* b = context;
    b->kernels->plate_add_moments( &b->angles, begin, end );
}

static void run_stage( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    b->kernels->plate_stage( &b->args, begin, end );
}

// y = gain W b, where both stages before were 0.
static void begin_stages( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    for ( int slot = 8 * begin; slot < 8 * end; ++slot )
    {
        const float *impulse = b->args.impulse + 4 * (size_t)slot, weight = b->predicted[4 * (size_t)slot + 3];
        float* moved = b->moved + 4 * (size_t)slot;
        for ( int k = 0; k < 4; ++k )
        {
            moved[k] = b->gain * weight * impulse[k];
            b->args.older[4 * (size_t)slot + (size_t)k] = 0.0f;
        }
    }
}

static void accelerate( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    for ( int i = 32 * begin; i < 32 * end; ++i )
    {
        b->velocity[i] += b->scale * b->moved[i] / b->dt;
    }
}

static void measure_moves( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending* b = context;
    for ( int slice = begin; slice < end; ++slice )
    {
        float largest = 0.0f;
        for ( int slot = 8 * slice; slot < 8 * slice + 8; ++slot )
        {
            const float *y = b->moved + 4 * (size_t)slot, least = b->angles.turns.least_height[slot];
            largest = fmaxf( largest, ( y[0] * y[0] + y[1] * y[1] + y[2] * y[2] ) / ( least * least ) );
        }
        b->largest[slice] = largest;
    }
}

static void for_slices( const wisp_parallel* parallel, bending* b, wisp_range_fn* run )
{
    wisp_parallel_for( parallel, b->args.rows.slice_count, GRAIN, run, b );
}

static void run_stages( const wisp_parallel* parallel, bending* b, int stages )
{
    const chebyshev c = recurrence_of( stages );
    b->gain = (float)( c.w1 / c.w0 );
    for_slices( parallel, b, begin_stages );
    for ( int n = 2; n <= stages; ++n )
    {
        const double now = cosh( n * c.angle );
        b->args.newer = b->moved;
        b->args.momentum = (float)( cosh( ( n - 2 ) * c.angle ) / now );
        b->args.gain = (float)( 2.0 * c.w1 * cosh( ( n - 1 ) * c.angle ) / now );
        for_slices( parallel, b, run_stage );
        float* last = b->moved;
        b->moved = b->args.older;
        b->args.older = last;
    }
}

static float scale_of_moves( const wisp_parallel* parallel, bending* b )
{
    for_slices( parallel, b, measure_moves );
    float largest = 0.0f;
    for ( int slice = 0; slice < b->args.rows.slice_count; ++slice )
    {
        largest = fmaxf( largest, b->largest[slice] );
    }
    return largest > MAX_MOVE * MAX_MOVE ? MAX_MOVE / sqrtf( largest ) : 1.0f;
}

// Impulses of angles, for which the rows of the matrix stand in the stages: they are an upper bound while triangles keep half of
// their heights.
static void compute_angle_impulse( const wisp_parallel* parallel, const wisp_fabric* fabric, bending* b )
{
    memset( b->args.impulse, 0, 4 * (size_t)fabric->slot_count * sizeof( float ) );
    wisp_run_schedule( parallel, &fabric->hinge_order, measure_angles, b );
    wisp_run_schedule( parallel, &fabric->hinge_order, add_moments, b );
}

// Columns and scratch memory of a surface. @return false without memory
static bool find_arrays( wisp_frame* frame, const wisp_span* span, bending* b )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const size_t numbers = 4 * (size_t)fabric->slot_count, hinges = (size_t)fabric->hinge_order.slot_count;
    float* scratch = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker,
                                            ( 4 * numbers + hinges + numbers / 32 ) * sizeof( float ) );
    if ( scratch == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the bending of %zu particles", numbers / 4 );
        return false;
    }
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    b->kernels = wisp_frame_kernels( frame );
    b->position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    b->velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    b->target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 );
    b->gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    b->dt = wisp_frame_dt( frame, span->entity );
    b->to_target = wisp_frame_progress_left( frame, span->entity, span->substep );
    b->predicted = scratch;
    b->args.position = scratch;
    b->args.impulse = scratch + numbers;
    b->largest = scratch + 4 * numbers + hinges;
    b->moved = scratch + 2 * numbers;
    b->args.older = scratch + 3 * numbers;
    b->angles = ( wisp_plate_angle_args ){
        .slot_x4 = fabric->hinge_slot_x4,
        .rest = wisp_frame_column( frame, span->entity, WISP_HINGE_REST, 0 ),
        .position = b->predicted,
        .angle = scratch + 4 * numbers,
        .impulse = b->args.impulse,
    };
    return true;
}

void cloth_bend( wisp_frame* frame, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    wisp_plate* plate = state->plates[cloth_find_plate( state, span->entity )].plate;
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const float rigidity = *(float*)wisp_frame_column( frame, span->entity, state->bending, 0 );
    bending b = { .gain = 1.0f };
    if ( find_arrays( frame, span, &b ) == false )
    {
        return;
    }
    b.args.rate = rigidity * b.dt * b.dt;
    const bool by_angle = b.angles.rest != NULL;
    const double reach = recurrence_of( MAX_STAGES ).reach, margin = by_angle ? ANGLE_MARGIN : 1.0;
    // where a few triangles alone are too stiff, only they are lowered; a vertex lies in several of their patches
    const int lowered =
        wisp_plate_update( plate, fabric, b.position, (float)( reach / ( 4.0 * margin * (double)b.args.rate ) ) );
    b.args.rows = wisp_plate_get_rows( plate );
    const double largest = margin * (double)b.args.rate * (double)wisp_plate_max_rate( plate );
    b.args.rate *= largest > reach ? (float)( reach / largest ) : 1.0f;
    if ( lowered > 0 || largest > reach )
    {
        wisp_frame_count( frame, WISP_COUNT_STIFFNESS_CLAMPED, 1 );
    }
    for_slices( parallel, &b, predict );
    if ( by_angle )
    {
        b.angles.turns = wisp_plate_get_turns( plate );
        b.angles.rate = b.args.rate;
        b.args.rate *= (float)ANGLE_MARGIN;
        compute_angle_impulse( parallel, fabric, &b );
    }
    else
    {
        for_slices( parallel, &b, compute_impulse );
    }
    run_stages( parallel, &b, stages_for( largest ) );
    b.scale = by_angle ? scale_of_moves( parallel, &b ) : 1.0f;
    for_slices( parallel, &b, accelerate );
}
