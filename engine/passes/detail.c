// Surfaces where nothing is solved, and on the way there. In: where pins go in the step, or the frame. Out: positions and velocities of a
// rigid motion; on the way there, velocities that come closer to it.
//
// The rotation that takes the pins to their targets is found from their moments by iteration (Mueller, Bender, Chentanez, Macklin
// 2016, "A robust method to extract the rotational part of deformations"), with a normalised quaternion in place of the exponential.
// It starts from the rotation of the frame, which is kept where pins leave one open: with a single pin, or about the line of two.
#include "passes.h"

#include "wisp/module/components.h"

#include <math.h>
#include <string.h>

static const wisp_column_def COLUMNS[] = { { "state", sizeof( passes_detail ) } };

_Static_assert( sizeof( passes_detail ) == 32, "without padding" );

/// x' = to + turn ( x - from ).
typedef struct rigid_motion
{
    double from[3], to[3];
    double q[4]; // x y z w, of unit length
    double turn[9];
} rigid_motion;

// ---- rotation ----

static void write_pin_turn( const double q[4], double turn[9] )
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double rows[9] = {
        1.0 - 2.0 * ( y * y + z * z ), 2.0 * ( x * y - z * w ),       2.0 * ( x * z + y * w ),
        2.0 * ( x * y + z * w ),       1.0 - 2.0 * ( x * x + z * z ), 2.0 * ( y * z - x * w ),
        2.0 * ( x * z - y * w ),       2.0 * ( y * z + x * w ),       1.0 - 2.0 * ( x * x + y * y ),
    };
    memcpy( turn, rows, sizeof( rows ) );
}

// q <- ( v, 1 ) q, of unit length: a rotation about v by about 2 |v|.
static void turn_further( double q[4], const double v[3] )
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[4] = { x + v[0] * w + v[1] * z - v[2] * y, y + v[1] * w + v[2] * x - v[0] * z,
                          z + v[2] * w + v[0] * y - v[1] * x, w - v[0] * x - v[1] * y - v[2] * z };
    const double scale = 1.0 / sqrt( r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] );
    for ( int k = 0; k < 4; ++k )
    {
        q[k] = scale * r[k];
    }
}

// Turn until the columns of the rotation agree with the moments, sum( target arm^T ), as far as they can.
static void fit_turn( rigid_motion* m, const double moments[9] )
{
    enum
    {
        MAX_TURNS = 40, // rotations of a step are small: it takes four or five
    };
    double change = 1.0;
    for ( int i = 0; i < MAX_TURNS && change > 1e-24; ++i )
    {
        write_pin_turn( m->q, m->turn );
        double axis[3] = { 0.0, 0.0, 0.0 }, agreement = 1e-30;
        for ( int c = 0; c < 3; ++c )
        {
            const double r[3] = { m->turn[c], m->turn[3 + c], m->turn[6 + c] };
            const double a[3] = { moments[c], moments[3 + c], moments[6 + c] };
            axis[0] += r[1] * a[2] - r[2] * a[1];
            axis[1] += r[2] * a[0] - r[0] * a[2];
            axis[2] += r[0] * a[1] - r[1] * a[0];
            agreement += r[0] * a[0] + r[1] * a[1] + r[2] * a[2];
        }
        change = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            axis[k] *= 0.5 / fabs( agreement );
            change += axis[k] * axis[k];
        }
        // no further than a quarter turn at once: about there the agreement is lost
        for ( int k = 0; k < 3 && change > 1.0; ++k )
        {
            axis[k] /= sqrt( change );
        }
        turn_further( m->q, axis );
    }
    write_pin_turn( m->q, m->turn );
}

// ---- motion of a step ----

// The motion of the frame, else none.
static rigid_motion motion_of_frame( wisp_frame* frame, wisp_entity entity )
{
    const wisp_transform* pose = wisp_frame_column( frame, entity, WISP_PARTICLE_FRAME, 0 );
    rigid_motion m = { .q = { 0.0, 0.0, 0.0, 1.0 } };
    if ( pose != NULL )
    {
        const wisp_vec3 a = pose[0].translation, b = pose[1].translation;
        const wisp_quat p = pose[0].rotation, q = pose[1].rotation;
        const double from[3] = { (double)a.x, (double)a.y, (double)a.z };
        const double to[3] = { (double)b.x, (double)b.y, (double)b.z };
        memcpy( m.from, from, sizeof( from ) );
        memcpy( m.to, to, sizeof( to ) );
        // q p^-1, in an order in which its axis is exactly zero where both are the same
        const double px = -(double)p.x, py = -(double)p.y, pz = -(double)p.z, pw = (double)p.w;
        const double qx = (double)q.x, qy = (double)q.y, qz = (double)q.z, qw = (double)q.w;
        const double r[4] = { ( qw * px + qx * pw ) + ( qy * pz - qz * py ),
                              ( qw * py + qy * pw ) + ( qz * px - qx * pz ),
                              ( qw * pz + qz * pw ) + ( qx * py - qy * px ), qw * pw - qx * px - qy * py - qz * pz };
        memcpy( m.q, r, sizeof( r ) );
    }
    write_pin_turn( m.q, m.turn );
    return m;
}

// The motion that takes pins to their targets. Pins that rest have moments that are symmetric to the bit, so they turn nothing.
static void fit_pins( rigid_motion* m, const float* position, const float* target, int count )
{
    double from[3] = { 0.0, 0.0, 0.0 }, to[3] = { 0.0, 0.0, 0.0 }, moments[9] = { 0.0 };
    int pins = 0;
    for ( int i = 0; i < 4 * count; i += 4 )
    {
        const bool counts = target[i + 3] != 0.0f && position[i + 3] == 0.0f;
        pins += counts ? 1 : 0;
        for ( int k = 0; k < 3 && counts; ++k )
        {
            from[k] += (double)position[i + k];
            to[k] += (double)target[i + k];
        }
    }
    if ( pins == 0 )
    {
        return;
    }
    for ( int k = 0; k < 3; ++k )
    {
        m->from[k] = from[k] / pins;
        m->to[k] = to[k] / pins;
    }
    for ( int i = 0; i < 4 * count; i += 4 )
    {
        for ( int k = 0; k < 9 && target[i + 3] != 0.0f && position[i + 3] == 0.0f; ++k )
        {
            moments[k] +=
                ( (double)target[i + k / 3] - m->to[k / 3] ) * ( (double)position[i + k % 3] - m->from[k % 3] );
        }
    }
    fit_turn( m, moments );
}

typedef struct detail_loop
{
    rigid_motion motion;
    bool is_motion; // there is some
    float *position, *velocity;
    const float* target; // null: no pins
    double seconds;      // of the step
    float keep;          // of the relative velocity; below 0: positions move
} detail_loop;

static void move_row( const detail_loop* loop, int i )
{
    const rigid_motion* m = &loop->motion;
    double moved[3];
    for ( int k = 0; k < 3; ++k )
    {
        double to = m->to[k];
        for ( int c = 0; c < 3; ++c )
        {
            to += m->turn[3 * k + c] * ( (double)loop->position[i + c] - m->from[c] );
        }
        moved[k] = loop->is_motion ? to - (double)loop->position[i + k] : 0.0;
    }
    const bool is_pin = loop->target != NULL && loop->target[i + 3] != 0.0f && loop->position[i + 3] == 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const float speed = (float)( moved[k] / loop->seconds );
        if ( loop->keep >= 0.0f )
        {
            loop->velocity[i + k] = speed + loop->keep * ( loop->velocity[i + k] - speed );
            continue;
        }
        loop->velocity[i + k] = loop->position[i + 3] > 0.0f ? speed : 0.0f;
        loop->position[i + k] = is_pin ? loop->target[i + k] : (float)( (double)loop->position[i + k] + moved[k] );
    }
}

static void move_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    for ( int slot = begin; slot < end; ++slot )
    {
        move_row( context, 4 * slot );
    }
}

static bool is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    const wisp_detail_frame detail = wisp_frame_detail( frame, entity );
    return detail.level == WISP_DETAIL_NOTHING || detail.keep < 1.0f;
}

static void move( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    enum
    {
        GRAIN = 2048,
    };
    const wisp_detail_frame detail = wisp_frame_detail( frame, span->entity );
    const int count = wisp_frame_fabric( frame, span->entity )->slot_count;
    detail_loop loop = {
        .motion = motion_of_frame( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 ),
        .seconds = (double)wisp_frame_dt( frame, span->entity ) * wisp_frame_substeps( frame, span->entity ),
        .keep = detail.level == WISP_DETAIL_NOTHING ? -1.0f : detail.keep,
    };
    if ( loop.target != NULL )
    {
        fit_pins( &loop.motion, loop.position, loop.target, count );
    }
    const rigid_motion* m = &loop.motion;
    loop.is_motion = m->q[0] != 0.0 || m->q[1] != 0.0 || m->q[2] != 0.0 || m->from[0] != m->to[0] ||
                     m->from[1] != m->to[1] || m->from[2] != m->to[2];
    wisp_parallel_for( wisp_frame_parallel( frame, span ), count, GRAIN, move_rows, &loop );
}

wisp_status passes_declare_detail( wisp_registry* registry, wisp_component* out )
{
    *out = WISP_COMPONENT( registry, "detail.state", WISP_TABLE_ENTITY, COLUMNS );
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( *out, passes_detail, level, 0, WISP_DETAIL_COUNT - 1 ),
        WISP_MEMBER_RANGE( *out, passes_detail, active, 0, WISP_DETAIL_COUNT - 1 ),
        WISP_MEMBER_RANGE( *out, passes_detail, from, 0, WISP_DETAIL_COUNT - 1 ),
        WISP_MEMBER_RANGE( *out, passes_detail, divisor, 1, 1000000 ),
        WISP_MEMBER_RANGE( *out, passes_detail, blend_steps, 0, 1000000 ),
        WISP_MEMBER_RANGE( *out, passes_detail, elapsed, 0, 1000000 ),
        WISP_MEMBER_RANGE( *out, passes_detail, substeps, 0, INT32_MAX ),
        WISP_MEMBER_RANGE( *out, passes_detail, of_substeps, 0, INT32_MAX ),
    };
    WISP_TRY( wisp_declare_indices( registry, ranges, WISP_COUNT( ranges ) ) );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "detail.move", INPUT, ENTITY, move ),
            .required = { *out, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .excluded = { WISP_PARTICLE_TARGET },
            .reads = { *out, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .should_run = is_due,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "detail.follow_pins", INPUT, ENTITY, move ),
            .required = { *out, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_TARGET },
            .reads = { *out, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_TARGET },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .should_run = is_due,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return *out != 0 ? wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL ) : WISP_BAD_INPUT;
}
