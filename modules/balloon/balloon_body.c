// The balloon as a rigid body: mass, centre, inertia (balloon paper, eq. 16-17), and its spin by the torque (eq. 13-15).
#include "balloon_internal.h"

#include <math.h>
#include <string.h>

enum
{
    BODY_GRAIN = 2048, // particles a block: the unit of every sum
};

/// Moments about the first particle, which keeps digits far from the origin.
typedef struct moments
{
    double mass, first[3], second[6]; // second: xx yy zz xy xz yz
    double momentum[3], angular[3];
} moments;

typedef struct body_loop
{
    const float *position, *velocity;
    moments* blocks;
    int count;
} body_loop;

static void add_particle( moments* m, const float* p, const float* v, const float* origin )
{
    double mass = p[3] > 0.0f ? 1.0 / (double)p[3] : 0.0;
    double x = (double)p[0] - (double)origin[0], y = (double)p[1] - (double)origin[1],
           z = (double)p[2] - (double)origin[2];
    double px = mass * (double)v[0], py = mass * (double)v[1], pz = mass * (double)v[2];
    m->mass += mass;
    m->first[0] += mass * x;
    m->first[1] += mass * y;
    m->first[2] += mass * z;
    m->second[0] += mass * x * x;
    m->second[1] += mass * y * y;
    m->second[2] += mass * z * z;
    m->second[3] += mass * x * y;
    m->second[4] += mass * x * z;
    m->second[5] += mass * y * z;
    m->momentum[0] += px;
    m->momentum[1] += py;
    m->momentum[2] += pz;
    m->angular[0] += y * pz - z * py;
    m->angular[1] += z * px - x * pz;
    m->angular[2] += x * py - y * px;
}

static void sum_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    const body_loop* loop = context;
    for ( int block = begin; block < end; ++block )
    {
        int last = ( block + 1 ) * BODY_GRAIN < loop->count ? ( block + 1 ) * BODY_GRAIN : loop->count;
        moments m = { 0 };
        for ( int slot = block * BODY_GRAIN; slot < last; ++slot )
        {
            add_particle( &m, loop->position + (size_t)slot * 4, loop->velocity + (size_t)slot * 4, loop->position );
        }
        loop->blocks[block] = m;
    }
}

static void add_moments( moments* sum, const moments* block )
{
    const double* from = &block->mass;
    double* to = &sum->mass;
    for ( size_t i = 0; i < sizeof( moments ) / sizeof( double ); ++i )
    {
        to[i] += from[i];
    }
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

static void finish( balloon_body* body, const moments* m, const float* origin )
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
    double xx = m->second[0] - m->mass * c[0] * c[0], yy = m->second[1] - m->mass * c[1] * c[1];
    double zz = m->second[2] - m->mass * c[2] * c[2];
    const double inertia[6] = { yy + zz,
                                xx + zz,
                                xx + yy,
                                -( m->second[3] - m->mass * c[0] * c[1] ),
                                -( m->second[4] - m->mass * c[0] * c[2] ),
                                -( m->second[5] - m->mass * c[1] * c[2] ) };
    invert( inertia, body->inverse_inertia );
    body->angular_momentum[0] = m->angular[0] - ( c[1] * m->momentum[2] - c[2] * m->momentum[1] );
    body->angular_momentum[1] = m->angular[1] - ( c[2] * m->momentum[0] - c[0] * m->momentum[2] );
    body->angular_momentum[2] = m->angular[2] - ( c[0] * m->momentum[1] - c[1] * m->momentum[0] );
}

void balloon_measure_body( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    int blocks = ( fabric->vertex_count + BODY_GRAIN - 1 ) / BODY_GRAIN;
    body_loop loop = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .blocks = wisp_parallel_scratch( parallel, span->worker, (size_t)blocks * sizeof( moments ) ),
        .count = fabric->vertex_count,
    };
    if ( loop.blocks == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the inertia of %d vertices",
                         fabric->vertex_count );
        return;
    }
    wisp_parallel_for( parallel, blocks, 1, sum_blocks, &loop );
    moments sum = { 0 };
    for ( int block = 0; block < blocks; ++block )
    {
        add_moments( &sum, loop.blocks + block );
    }
    finish( wisp_frame_column( frame, span->entity, state->body, 0 ), &sum, loop.position );
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
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    double w[3];
    spin_increment( frame, span, state, w );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        const float* p = position + (size_t)slot * 4;
        float* v = velocity + (size_t)slot * 4;
        double r[3] = { (double)p[0] - body->centre[0], (double)p[1] - body->centre[1],
                        (double)p[2] - body->centre[2] };
        double moves = p[3] > 0.0f ? 1.0 : 0.0;
        v[0] += (float)( moves * ( w[1] * r[2] - w[2] * r[1] ) );
        v[1] += (float)( moves * ( w[2] * r[0] - w[0] * r[2] ) );
        v[2] += (float)( moves * ( w[0] * r[1] - w[1] * r[0] ) );
    }
}

// The printed form, for comparison: a separate angular velocity turns the positions by one step's rotation.
void balloon_turn_printed( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    balloon_turn* turn = wisp_frame_column( frame, span->entity, state->turn, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    double w[3];
    spin_increment( frame, span, state, w );
    double half[3], square = 1.0, dt = (double)wisp_frame_dt( frame, span->entity );
    for ( int k = 0; k < 3; ++k )
    {
        turn->omega[k] += isfinite( w[k] ) ? w[k] : 0.0; // the state check restores particles, but not this
        half[k] = 0.5 * dt * turn->omega[k];
        square += half[k] * half[k];
    }
    // eq. 15 from the identity, normalised: q = (1, half) / sqrt( 1 + half^2 ); x + 2 q_v x (q_v x x + q_w x)
    const int count = wisp_frame_fabric( frame, span->entity )->vertex_count;
    for ( int slot = 0; slot < count; ++slot )
    {
        float* p = position + (size_t)slot * 4;
        double r[3] = { (double)p[0] - body->centre[0], (double)p[1] - body->centre[1],
                        (double)p[2] - body->centre[2] };
        double t[3] = { half[1] * r[2] - half[2] * r[1] + r[0], half[2] * r[0] - half[0] * r[2] + r[1],
                        half[0] * r[1] - half[1] * r[0] + r[2] };
        double u[3] = { half[1] * t[2] - half[2] * t[1], half[2] * t[0] - half[0] * t[2],
                        half[0] * t[1] - half[1] * t[0] };
        for ( int k = 0; k < 3 && p[3] > 0.0f; ++k )
        {
            p[k] = (float)( body->centre[k] + r[k] + 2.0 * u[k] / square );
        }
    }
}
