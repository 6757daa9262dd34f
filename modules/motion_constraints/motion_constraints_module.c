// Motion constraints: components and passes. The equations are those of the kernels motion_constraint and motion_targets.
#include "motion_constraints_state.h"

#include <string.h>

MOTION_COMPONENTS( WISP_COMPONENT_COLUMNS )

enum
{
    SLOT_GRAIN = 2048, // particles per block, as of tethers
};

// ---- once per step: paths of the targets ----

WISP_KERNEL_LOOP( target_loop, run_targets, motion_targets, wisp_motion_target_args, 8 )

// Fraction of the last step's displacements that the step has left, because it was no whole number of substeps.
static float left_by_last_step( wisp_frame* frame )
{
    const wisp_quat straight = { 0.0f, 0.0f, 0.0f, 1.0f };
    const wisp_transform from = { straight, { 0.0f, 0.0f, 0.0f } }, to = { straight, { 1.0f, 0.0f, 0.0f } };
    return 1.0f - wisp_frame_reached( frame, from, to ).translation.x;
}

static bool have_moved( wisp_frame* frame, wisp_entity entity, void* user )
{
    const motion_state* state = user;
    const motion_settings* settings = wisp_frame_column( frame, entity, state->settings, 0 );
    return settings->moves != MOTION_STILL;
}

static void move_targets( wisp_frame* frame, const wisp_span* span, void* user )
{
    const motion_state* state = user;
    const wisp_entity e = span->entity;
    motion_settings* settings = wisp_frame_column( frame, e, state->settings, 0 );
    const target_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = {
            .target = wisp_frame_column( frame, e, state->distance, 0 ),
            .displacement = wisp_frame_column( frame, e, state->distance, 1 ),
            .next = wisp_frame_column( frame, e, state->distance, 2 ),
            .max_distance = wisp_frame_column( frame, e, state->distance, 3 ),
            .bound = wisp_frame_column( frame, e, state->distance, 4 ),
            .normal = wisp_frame_column( frame, e, state->backstop, 0 ),
            .normal_change = wisp_frame_column( frame, e, state->backstop, 1 ),
            .next_normal = wisp_frame_column( frame, e, state->backstop, 2 ),
            .backstop_distance = wisp_frame_column( frame, e, state->backstop, 3 ),
            .left = left_by_last_step( frame ),
        },
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), wisp_frame_fabric( frame, e )->slot_count / 8,
                       SLOT_GRAIN / 8, run_targets, (void*)&loop );
    settings->moves = settings->moves == MOTION_NEW || loop.args.left > 0.0f ? MOTION_ENDS : MOTION_STILL;
}

// ---- each substep ----

static float* lambda_of( wisp_frame* frame, const wisp_span* span, const motion_state* state,
                         const wisp_span* particles )
{
    float* lambda = wisp_frame_column( frame, span->entity, state->lambda, 0 );
    if ( lambda != NULL && span->iteration == 0 )
    {
        const size_t count = 2 * (size_t)( particles->end - particles->begin );
        memset( lambda + 2 * (size_t)particles->begin, 0, count * sizeof( float ) );
    }
    return lambda;
}

static wisp_motion_constraint_args constraint_args( wisp_frame* frame, const wisp_span* span,
                                                    const motion_state* state )
{
    const wisp_entity e = span->entity;
    const motion_settings* s = wisp_frame_column( frame, e, state->settings, 0 );
    const float dt = wisp_frame_dt( frame, e ), inverse_dt2 = 1.0f / ( dt * dt );
    return ( wisp_motion_constraint_args ){
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .target = wisp_frame_column( frame, e, state->distance, 0 ),
        .displacement = wisp_frame_column( frame, e, state->distance, 1 ),
        .max_distance = wisp_frame_column( frame, e, state->distance, 3 ),
        .bound = wisp_frame_column( frame, e, state->distance, 4 ),
        .normal = wisp_frame_column( frame, e, state->backstop, 0 ),
        .normal_change = wisp_frame_column( frame, e, state->backstop, 1 ),
        .backstop_distance = wisp_frame_column( frame, e, state->backstop, 3 ),
        .curvature = wisp_frame_column( frame, e, state->backstop, 4 ),
        .left = 1.0f - wisp_frame_progress( frame, e, span->substep + 1 ),
        .distance = { s->stiffness[0], s->compliance[0] * inverse_dt2 },
        .backstop = { s->stiffness[1], s->compliance[1] * inverse_dt2 },
    };
}

static void project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_motion_constraint_args args = constraint_args( frame, span, user );
    args.lambda = lambda_of( frame, span, user, &s );
    wisp_frame_kernels( frame )->motion_constraint( &args, s.begin, s.end );
}

// A solver of velocities has moved the particles already: what moves them on is added to their velocities.
static void project_external( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_motion_constraint_args args = constraint_args( frame, span, user );
    args.lambda = lambda_of( frame, span, user, &s );
    args.velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    args.inverse_dt = 1.0f / wisp_frame_dt( frame, span->entity );
    wisp_frame_kernels( frame )->motion_constraint( &args, s.begin, s.end );
}

// ---- declaration ----

static void turn_rows( float* rows, int slot_count, wisp_quat turn )
{
    for ( int slot = 0; slot < slot_count; ++slot )
    {
        float* v = rows + 24 * (size_t)( slot / 8 ) + slot % 8;
        const wisp_vec3 to = wisp_quat_rotate( turn, ( wisp_vec3 ){ v[0], v[8], v[16] } );
        v[0] = to.x;
        v[8] = to.y;
        v[16] = to.z;
    }
}

static wisp_status teleported( void* memory, wisp_world* world, wisp_entity entity,
                               const wisp_teleport_motion* teleport, bool* is_moved )
{
    (void)is_moved;
    const motion_state* state = memory;
    motion_settings* settings = wisp_world_column( world, entity, state->settings, 0 );
    if ( settings != NULL )
    {
        const int count = wisp_world_fabric( world, entity )->slot_count;
        const wisp_quat turn = teleport->motion.rotation;
        turn_rows( wisp_world_column( world, entity, state->distance, 1 ), count, turn );
        for ( int column = 0; column < 3 && wisp_world_has( world, entity, state->backstop ); ++column )
        {
            turn_rows( wisp_world_column( world, entity, state->backstop, column ), count, turn );
        }
        settings->moves = MOTION_NEW;
    }
    return WISP_OK;
}

static wisp_status declare_passes( wisp_registry* r, motion_state* state )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "motion_constraints.targets", INPUT, ENTITY, move_targets ),
            .required = { state->settings, state->distance },
            .reads = { state->settings, state->distance },
            .writes = { state->distance },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .should_run = have_moved,
        },
        {
            WISP_PASS( "motion_constraints.project", PROJECT, PARTICLE_BLOCK, project ),
            .required = { state->settings, state->distance },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->distance, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
        },
        {
            WISP_PASS( "motion_constraints.project_external", PROJECT, PARTICLE_BLOCK, project_external ),
            .required = { state->settings, state->distance, WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->distance, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), state );
}

static wisp_status declare( wisp_registry* r )
{
    motion_state* s = wisp_declare_state( r, sizeof( motion_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .teleported = teleported } );
    MOTION_COMPONENTS( WISP_COMPONENT_DECLARE )
    wisp_declare_places( r, s->distance, 0, WISP_PLACE_EIGHTS );
    wisp_declare_places( r, s->distance, 2, WISP_PLACE_EIGHTS );
    wisp_declare_places( r, s->distance, 4, WISP_PLACE_QUADS );
    const wisp_index_range moves = WISP_MEMBER_RANGE( s->settings, motion_settings, moves, MOTION_STILL, MOTION_NEW );
    WISP_TRY( wisp_declare_indices( r, &moves, 1 ) );
    s->has_iterations = wisp_registry_iterations( r ) > 1;
    return s->lambda != 0 ? declare_passes( r, s ) : WISP_BAD_INPUT;
}

const wisp_module wisp_motion_constraints_module = { .name = "motion_constraints", .declare = declare };
