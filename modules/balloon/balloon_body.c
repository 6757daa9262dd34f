// The balloon as a rigid body: mass, centre, inertia (balloon paper, eq. 16-17), and its spin by the torque (eq. 13-15).
#include "balloon_internal.h"

#include <math.h>
#include <string.h>

enum
{
    BODY_GRAIN = 2048, // particles a block: the unit of every sum
};

typedef struct moment_loop
{
    wisp_moment_args args;
    const wisp_kernels* kernels;
    wisp_moments* blocks;
    int count;
} moment_loop;

static void sum_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    const moment_loop* loop = context;
    for ( int block = begin; block < end; ++block )
    {
        int first = block * BODY_GRAIN, last = first + BODY_GRAIN < loop->count ? first + BODY_GRAIN : loop->count;
        loop->kernels->moments( &loop->args, first, last, loop->blocks + block );
    }
}

static void add_moments( wisp_moments* sum, const wisp_moments* block )
{
    const double* from = &block->mass;
    double* to = &sum->mass;
    for ( size_t i = 0; i < sizeof( wisp_moments ) / sizeof( double ); ++i )
    {
        to[i] += from[i];
    }
}

bool balloon_sum_moments( wisp_frame* frame, const wisp_span* span, const float* previous, wisp_moments* out )
{
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const int count = wisp_frame_fabric( frame, span->entity )->vertex_count;
    const int blocks = ( count + BODY_GRAIN - 1 ) / BODY_GRAIN;
    moment_loop loop = {
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .previous = previous,
                  .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
                  .origin = { previous[0], previous[1], previous[2] } },
        .kernels = wisp_frame_kernels( frame ),
        .blocks = wisp_parallel_scratch( parallel, span->worker, (size_t)blocks * sizeof( wisp_moments ) ),
        .count = count,
    };
    if ( loop.blocks == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the moments of %d vertices", count );
        return false;
    }
    wisp_parallel_for( parallel, blocks, 1, sum_blocks, &loop );
    *out = ( wisp_moments ){ 0 };
    for ( int block = 0; block < blocks; ++block )
    {
        add_moments( out, loop.blocks + block );
    }
    return true;
}

// Inverse of a symmetric matrix by its adjugate; zero where all mass lies on a line.
static void invert( const double i[6], double out[6] )
{
    const double xx = i[0], yy = i[1], zz = i[2], xy = i[3], xz = i[4], yz = i[5];
    double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    double determinant = xx * a + xy * b + xz * c, scale = xx + yy + zz;
    memset( out, 0, 6 * sizeof( double ) );
    if ( fabs( determinant ) > 1e-12 * scale * scale * scale )
    {
        out[0] = a / determinant;
        out[1] = ( xx * zz - xz * xz ) / determinant;
        out[2] = ( xx * yy - xy * xy ) / determinant;
        out[3] = b / determinant;
        out[4] = c / determinant;
        out[5] = ( xy * xz - xx * yz ) / determinant;
    }
}

static void finish( balloon_body* body, const wisp_moments* m, const float* origin )
{
    memset( body, 0, sizeof( *body ) );
    body->mass = m->mass;
    if ( !( m->mass > 0.0 ) )
    {
        return;
    }
    double c[3]; // centre from the first particle
    for ( int k = 0; k < 3; ++k )
    {
        c[k] = m->first[k] / m->mass;
        body->centre[k] = (double)origin[k] + c[k];
    }
    double xx = m->mixed[0][0] - m->mass * c[0] * c[0], yy = m->mixed[1][1] - m->mass * c[1] * c[1];
    double zz = m->mixed[2][2] - m->mass * c[2] * c[2];
    const double inertia[6] = { yy + zz,
                                xx + zz,
                                xx + yy,
                                -( m->mixed[0][1] - m->mass * c[0] * c[1] ),
                                -( m->mixed[0][2] - m->mass * c[0] * c[2] ),
                                -( m->mixed[1][2] - m->mass * c[1] * c[2] ) };
    invert( inertia, body->inverse_inertia );
    body->angular_momentum[0] = m->angular_momentum[0] - ( c[1] * m->momentum[2] - c[2] * m->momentum[1] );
    body->angular_momentum[1] = m->angular_momentum[1] - ( c[2] * m->momentum[0] - c[0] * m->momentum[2] );
    body->angular_momentum[2] = m->angular_momentum[2] - ( c[0] * m->momentum[1] - c[1] * m->momentum[0] );
}

void balloon_measure_body( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_moments sum;
    if ( balloon_sum_moments( frame, span, position, &sum ) )
    {
        finish( wisp_frame_column( frame, span->entity, state->body, 0 ), &sum, position );
    }
}

void balloon_spin_of( const balloon_body* body, const double torque[3], double out[3] )
{
    const double* i = body->inverse_inertia;
    out[0] = i[0] * torque[0] + i[3] * torque[1] + i[4] * torque[2];
    out[1] = i[3] * torque[0] + i[1] * torque[1] + i[5] * torque[2];
    out[2] = i[4] * torque[0] + i[5] * torque[1] + i[2] * torque[2];
}

// Eq. 13 with F = -mdot v n.
void balloon_torque_of( const balloon_body* body, const balloon_outlet* outlet, double out[3] )
{
    double r[3], f[3];
    for ( int k = 0; k < 3; ++k )
    {
        r[k] = outlet->place[k] - body->centre[k];
        f[k] = -outlet->mass_flow * outlet->speed * outlet->normal[k];
    }
    out[0] = r[1] * f[2] - r[2] * f[1];
    out[1] = r[2] * f[0] - r[0] * f[2];
    out[2] = r[0] * f[1] - r[1] * f[0];
}

// Eq. 14: dt I^-1 tau.
static void spin_increment( wisp_frame* frame, const wisp_span* span, const balloon_state* state, double out[3] )
{
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    double torque[3];
    balloon_torque_of( body, outlet, torque );
    balloon_spin_of( body, torque, out );
    for ( int k = 0; k < 3; ++k )
    {
        out[k] *= (double)wisp_frame_dt( frame, span->entity );
    }
}

// Add D_omega x r to the velocities, which adds exactly dt tau to the angular momentum.
void balloon_kick( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    wisp_turn_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .rows = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .centre = { body->centre[0], body->centre[1], body->centre[2] },
    };
    spin_increment( frame, span, state, args.angle );
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->turn( &args, s.begin, s.end );
}
