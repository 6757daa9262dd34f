// Frames of reference that move: what particles do not feel of the motion carries them. In: poses of the frame. Out: positions and
// velocities of particles.
//
// Within a substep of a particle, previous' = C( previous ), v' = R v and the prediction is previous' + dt v', with C the unfelt rigid
// motion and R its rotation. Collision and contact get the uncarried previous position, so that they see the motion in the world; it is
// carried again before velocities are computed from it. So a particle that nothing touches keeps the bits of its velocity.
#include "passes.h"

#include "wisp/module/double3.h"
#include "wisp/module/components.h"
#include <math.h>
#include <string.h>

// ---- frames ----

typedef struct rotation
{
    double x, y, z, w;
} rotation;

// Rotation that takes one pose to another, the shorter way: b a^-1.
static rotation turn_between( wisp_quat from, wisp_quat to )
{
    const double ax = -(double)from.x, ay = -(double)from.y, az = -(double)from.z, aw = (double)from.w;
    const double bx = (double)to.x, by = (double)to.y, bz = (double)to.z, bw = (double)to.w;
    const rotation r = { bw * ax + bx * aw + by * az - bz * ay, bw * ay - bx * az + by * aw + bz * ax,
                         bw * az + bx * ay - by * ax + bz * aw, bw * aw - bx * ax - by * ay - bz * az };
    return r.w < 0.0 ? ( rotation ){ -r.x, -r.y, -r.z, -r.w } : r;
}

// A fraction of a rotation, by the normalised line from the identity. Rotations of a substep are small.
static rotation part_of( rotation r, double fraction )
{
    const rotation q = { fraction * r.x, fraction * r.y, fraction * r.z, fraction * r.w + 1.0 - fraction };
    const double scale = 1.0 / sqrt( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w );
    return ( rotation ){ q.x * scale, q.y * scale, q.z * scale, q.w * scale };
}

static void write_turn( rotation q, float turn[9] )
{
    const double rows[9] = {
        -2.0 * ( q.y * q.y + q.z * q.z ), 2.0 * ( q.x * q.y - q.z * q.w ),  2.0 * ( q.x * q.z + q.y * q.w ),
        2.0 * ( q.x * q.y + q.z * q.w ),  -2.0 * ( q.x * q.x + q.z * q.z ), 2.0 * ( q.y * q.z - q.x * q.w ),
        2.0 * ( q.x * q.z - q.y * q.w ),  2.0 * ( q.y * q.z + q.x * q.w ),  -2.0 * ( q.x * q.x + q.y * q.y ),
    };
    for ( int k = 0; k < 9; ++k )
    {
        turn[k] = (float)rows[k];
    }
}

bool wisp_frame_find_motion( wisp_frame* frame, const wisp_span* span, wisp_frame_motion_args* args,
                             wisp_quat* unfelt_turn )
{
    const wisp_transform* pose = wisp_frame_column( frame, span->entity, WISP_PARTICLE_FRAME, 0 );
    const float* felt = wisp_frame_column( frame, span->entity, WISP_PARTICLE_FRAME, 1 );
    const int32_t* moves = wisp_frame_column( frame, span->entity, WISP_PARTICLE_FRAME, 2 );
    if ( *moves == 0 )
    {
        return false;
    }
    const float begin = span->substep > 0 ? wisp_frame_progress( frame, span->entity, span->substep ) : 0.0f,
                end = wisp_frame_progress( frame, span->entity, span->substep + 1 );
    const rotation turn = turn_between( wisp_transform_interpolate( pose[0], pose[1], begin ).rotation,
                                        wisp_transform_interpolate( pose[0], pose[1], end ).rotation );
    const rotation part = part_of( turn, 1.0 - (double)felt[1] );
    write_turn( part, args->turn );
    *unfelt_turn = ( wisp_quat ){ (float)part.x, (float)part.y, (float)part.z, (float)part.w };
    const double unfelt = ( 1.0 - (double)felt[0] ) * ( (double)end - (double)begin ), at = (double)begin;
    const double3 displacement = double3_between( pose[0].translation, pose[1].translation );
    args->shift = double3_narrow( double3_scale( displacement, unfelt ) );
    args->origin = double3_narrow( double3_mul_add( double3_widen( pose[0].translation ), at, displacement ) );
    return true;
}

static bool find_unfelt_motion( wisp_frame* frame, const wisp_span* span, wisp_frame_motion_args* args )
{
    wisp_quat turn;
    return wisp_frame_find_motion( frame, span, args, &turn );
}

// ---- once per step ----

void wisp_frame_update_pose( wisp_frame* frame, wisp_entity entity )
{
    wisp_transform* pose = wisp_frame_column( frame, entity, WISP_PARTICLE_FRAME, 0 );
    int32_t* moves = wisp_frame_column( frame, entity, WISP_PARTICLE_FRAME, 2 );
    pose[0] = wisp_frame_reached( frame, pose[0], pose[1] );
    pose[1] = pose[2];
    *moves = memcmp( pose, pose + 1, sizeof( *pose ) ) != 0 ? 1 : 0;
}

static void move_frame( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    if ( wisp_frame_has( frame, span->entity, WISP_PARTICLE_EXTERNAL_SOLVER ) )
    {
        wisp_frame_fail( frame, WISP_CONFLICT,
                         "entity %u: has a moving frame, which an external solver does not support",
                         span->entity.index );
    }
    wisp_frame_update_pose( frame, span->entity );
}

// ---- each substep ----

static void move_with_frame( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    wisp_frame_motion_args args;
    if ( find_unfelt_motion( frame, span, &args ) == false )
    {
        return;
    }
    const wisp_span s = wisp_frame_particles( frame, span );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const float dt = wisp_frame_dt( frame, span->entity );
    const size_t first = 4 * (size_t)s.begin, bytes = 4 * (size_t)( s.end - s.begin ) * sizeof( float );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    float* uncarried = wisp_frame_column( frame, span->entity, WISP_PARTICLE_UNCARRIED, 0 );
    memcpy( uncarried + first, previous + first, bytes );
    kernels->move_points( &args, previous, s.begin, s.end );
    kernels->turn_vectors( &args, velocity, s.begin, s.end );
    for ( int i = 4 * s.begin; i < 4 * s.end; i += 4 )
    {
        for ( int k = 0; k < 3 && position[i + 3] > 0.0f; ++k )
        {
            position[i + k] = velocity[i + k] * dt + previous[i + k]; // as in the kernel predict
        }
    }
}

static void restore_previous( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const int32_t* moves = wisp_frame_column( frame, span->entity, WISP_PARTICLE_FRAME, 2 );
    const wisp_span s = wisp_frame_particles( frame, span );
    float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    const float* uncarried = wisp_frame_column( frame, span->entity, WISP_PARTICLE_UNCARRIED, 0 );
    if ( *moves != 0 )
    {
        const size_t first = 4 * (size_t)s.begin, bytes = 4 * (size_t)( s.end - s.begin ) * sizeof( float );
        memcpy( previous + first, uncarried + first, bytes );
    }
}

static void move_previous_with_frame( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    wisp_frame_motion_args args;
    if ( find_unfelt_motion( frame, span, &args ) )
    {
        const wisp_span s = wisp_frame_particles( frame, span );
        float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
        wisp_frame_kernels( frame )->move_points( &args, previous, s.begin, s.end );
    }
}

// The motion that coarse sheets remember is relative to the frame, as velocities are.
static void turn_levels_with_frame( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    static const int VECTORS[] = { 0, 1, 2, 4 }; // what counts when a substep begins
    wisp_frame_motion_args args;
    if ( find_unfelt_motion( frame, span, &args ) )
    {
        const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
        const int count = fabric->level_count > 0 ? fabric->levels[fabric->level_count - 1].row_count : 0;
        for ( int i = 0; i < WISP_COUNT( VECTORS ); ++i )
        {
            float* rows = wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, VECTORS[i] );
            wisp_frame_kernels( frame )->turn_vectors( &args, rows, 0, count );
        }
    }
}

wisp_status passes_declare_moving_frame( wisp_registry* registry )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "particles.frame", INPUT, ENTITY, move_frame ),
            .required = { WISP_PARTICLE_FRAME, WISP_PARTICLE_POSITION },
            .reads = { WISP_PARTICLE_FRAME, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_FRAME, WISP_PARTICLE_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "particles.carry", PREDICT, PARTICLE_BLOCK, move_with_frame ),
            .required = { WISP_PARTICLE_FRAME, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_FRAME, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_VELOCITY,
                        WISP_PARTICLE_UNCARRIED },
        },
        {
            WISP_PASS( "surface.levels_frame", PREDICT, ENTITY, turn_levels_with_frame ),
            .required = { WISP_PARTICLE_FRAME, WISP_SURFACE_LEVELS, WISP_LEVEL_MOTION },
            .reads = { WISP_PARTICLE_FRAME, WISP_LEVEL_MOTION },
            .writes = { WISP_LEVEL_MOTION },
        },
        {
            WISP_PASS(
                "particles.carry_previous", VELOCITY, PARTICLE_BLOCK,
                move_previous_with_frame ), // not among what it reads: so it comes before velocities are computed
            .required = { WISP_PARTICLE_FRAME, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_FRAME },
            .writes = { WISP_PARTICLE_PREVIOUS },
        },
    };
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}

wisp_status passes_declare_seen_motion( wisp_registry* registry )
{
    const wisp_pass pass = {
        WISP_PASS( "particles.uncarry", PREDICT, PARTICLE_BLOCK, restore_previous ),
        .required = { WISP_PARTICLE_FRAME, WISP_PARTICLE_VELOCITY },
        .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
        .reads = { WISP_PARTICLE_FRAME, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_UNCARRIED },
        .writes = { WISP_PARTICLE_PREVIOUS },
    };
    return wisp_declare_pass( registry, &pass );
}

// ---- largest speed ----

static void limit_speed( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_span s = wisp_frame_particles( frame, span );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const float* speed = wisp_frame_column( frame, span->entity, WISP_PARTICLE_MAX_SPEED, 0 );
    const int count = wisp_frame_kernels( frame )->limit_speed( velocity, *speed, s.begin, s.end );
    if ( count > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_SPEED_LIMITED, (uint64_t)count );
    }
}

wisp_status passes_declare_max_speed( wisp_registry* registry )
{
    const wisp_pass pass = {
        WISP_PASS( "particles.max_speed", VELOCITY, PARTICLE_BLOCK, limit_speed ),
        .required = { WISP_PARTICLE_MAX_SPEED, WISP_PARTICLE_VELOCITY },
        .reads = { WISP_PARTICLE_MAX_SPEED, WISP_PARTICLE_VELOCITY },
        .writes = { WISP_PARTICLE_VELOCITY },
    };
    return wisp_declare_pass( registry, &pass );
}
