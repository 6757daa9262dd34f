// Time integration of particles: moves pins, applies gravity, predicts positions, computes velocities (Mueller et
// al. 2007).
#include "passes.h"

#include "wisp/module/components.h"

static float* particle_positions( wisp_frame* frame, const wisp_span* span )
{
    return wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
}

static wisp_particle_args particle_args( wisp_frame* frame, const wisp_span* span )
{
    return ( wisp_particle_args ){
        .position = particle_positions( frame, span ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .dt = wisp_frame_dt( frame, span->entity ),
    };
}

// Moves pins by the substep's fraction of the remaining distance. The last substep of an even step ends exactly at
// the target. Few vertices are pinned: masses come first, so that targets of the others are not read.
static void move_pins( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    float* position = particle_positions( frame, span );
    const float* target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    const float fraction = wisp_frame_progress_left( frame, span->entity, span->substep );
    for ( int i = 4 * s.begin; i < 4 * s.end; i += 4 )
    {
        for ( int k = 0; k < 3 && position[i + 3] == 0.0f && target[i + 3] != 0.0f; ++k )
        {
            position[i + k] =
                fraction == 1.0f ? target[i + k] : position[i + k] + fraction * ( target[i + k] - position[i + k] );
        }
    }
}

static void accelerate( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    wisp_particle_args args = particle_args( frame, span );
    args.acceleration = *gravity;
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->accelerate( &args, s.begin, s.end );
}

static void predict( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    wisp_particle_args args = particle_args( frame, span );
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->predict( &args, s.begin, s.end );
}

static void read_velocity( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    wisp_particle_args args = particle_args( frame, span );
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->velocity( &args, s.begin, s.end );
}

// Applies v' = -rate v by one implicit step, which never reverses a velocity, however large the rate.
static void damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const float* rate = wisp_frame_column( frame, span->entity, WISP_PARTICLE_DAMPING, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    const float* factor = wisp_frame_column( frame, span->entity, WISP_MAP_DAMPING, 0 );
    for ( int slot = s.begin; slot < s.end && factor != NULL; ++slot )
    {
        const float kept = 1.0f / ( 1.0f + *rate * factor[slot] * wisp_frame_dt( frame, span->entity ) );
        for ( int i = 4 * slot; i < 4 * slot + 4; ++i )
        {
            velocity[i] *= kept;
        }
    }
    if ( factor != NULL )
    {
        return;
    }
    float keep = 1.0f / ( 1.0f + *rate * wisp_frame_dt( frame, span->entity ) );
    for ( int i = 4 * s.begin; i < 4 * s.end; ++i )
    {
        velocity[i] *= keep;
    }
}

wisp_surface_motion wisp_frame_surface_motion( wisp_frame* frame, wisp_entity surface, float seconds )
{
    // one that is not solved goes along with something
    const bool is_halted =
        wisp_frame_is_halted( frame, surface ) && wisp_frame_detail( frame, surface ).level != WISP_DETAIL_NOTHING;
    return ( wisp_surface_motion ){
        .position = wisp_frame_column( frame, surface, WISP_PARTICLE_POSITION, 0 ),
        .velocity = is_halted ? NULL : wisp_frame_column( frame, surface, WISP_PARTICLE_VELOCITY, 0 ),
        .target = is_halted ? NULL : wisp_frame_column( frame, surface, WISP_PARTICLE_TARGET, 0 ),
        .seconds = seconds,
    };
}

wisp_status passes_declare_particles( wisp_registry* registry )
{
    wisp_declare_map( registry, WISP_MAP_DAMPING, WISP_PARTICLE_DAMPING, NULL );
    wisp_declare_map( registry, WISP_MAP_DAMPING, WISP_PARTICLE_EXTERNAL_SOLVER,
                      "its solver damps all vertices at one rate" );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "particles.gravity", PREDICT, PARTICLE_BLOCK,
                       accelerate ), // after all forces, which depend on the velocity before damping
            .required = { WISP_PARTICLE_GRAVITY, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_GRAVITY, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
        },
        {
            WISP_PASS( "particles.predict", PREDICT, PARTICLE_BLOCK, predict ),
            .required = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
        },
        {
            WISP_PASS( "particles.targets", PREDICT, PARTICLE_BLOCK, move_pins ),
            .required = { WISP_PARTICLE_TARGET },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_TARGET, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
        },
        {
            WISP_PASS( "particles.velocity", VELOCITY, PARTICLE_BLOCK, read_velocity ),
            .required = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
        },
        {
            WISP_PASS( "particles.damping", VELOCITY, PARTICLE_BLOCK, damp ),
            .required = { WISP_PARTICLE_DAMPING, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { WISP_PARTICLE_DAMPING, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
        },
    };
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}
