// Damping that does not touch rigid motion (Mueller et al. 2007, section 3.5): what a velocity differs from that of
// the rigid motion with the same momentum and angular momentum dies away; the rigid motion stays.
#include "cloth_internal.h"

#include <math.h>
#include <string.h>

typedef struct rigid_motion
{
    double mass, centre[3], velocity[3], angular[3];
} rigid_motion;

static void cross_product( const double a[3], const double b[3], double out[3] )
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// Solve I w = L for a symmetric I by its adjugate. Where all mass lies on a line I has no inverse, but its two
// moments across the line are equal, each half the trace, and L is across it too; with all mass at one point there is
// no turning.
static void solve_inertia( const double i[6], const double l[3], double w[3] )
{
    const double xx = i[0], yy = i[1], zz = i[2], xy = i[3], xz = i[4], yz = i[5];
    double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    double determinant = xx * a + xy * b + xz * c, scale = xx + yy + zz;
    memset( w, 0, 3 * sizeof( double ) );
    if ( fabs( determinant ) <= 1e-12 * scale * scale * scale )
    {
        for ( int k = 0; k < 3 && scale > 0.0; ++k )
        {
            w[k] = 2.0 * l[k] / scale;
        }
        return;
    }
    double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
    w[0] = ( a * l[0] + b * l[1] + c * l[2] ) / determinant;
    w[1] = ( b * l[0] + d * l[1] + e * l[2] ) / determinant;
    w[2] = ( c * l[0] + e * l[1] + f * l[2] ) / determinant;
}

// ---- sums ----

// Sums are taken of a block of slots each, then over the blocks, in a fixed order whoever takes them, and in double: angular
// momentum must survive thousands of steps.
typedef struct block_sums
{
    double mass, centre[3], velocity[3];
    double inertia[6], momentum[3];
} block_sums;

enum
{
    MOST_BLOCKS = 64,
    LEAST_BLOCK = 1024, // slots
};

typedef struct damping_loop
{
    const float* position;
    float* velocity;
    int slot_count, block; // slots of a block
    block_sums* sums;      // [block]
    rigid_motion rigid;
    double keep; // of the difference
} damping_loop;

static double mass_of( const float* position )
{
    return position[3] > 0.0f ? 1.0 / (double)position[3] : 0.0;
}

static int end_of( const damping_loop* loop, int block )
{
    const int end = ( block + 1 ) * loop->block;
    return end < loop->slot_count ? end : loop->slot_count;
}

static void sum_linear( void* context, int begin, int end, int worker )
{
    (void)worker;
    damping_loop* loop = context;
    for ( int block = begin; block < end; ++block )
    {
        block_sums sum = { 0 };
        for ( int slot = block * loop->block; slot < end_of( loop, block ); ++slot )
        {
            const float *p = loop->position + (size_t)slot * 4, *v = loop->velocity + (size_t)slot * 4;
            const double mass = mass_of( p );
            sum.mass += mass;
            for ( int k = 0; k < 3; ++k )
            {
                sum.centre[k] += mass * (double)p[k];
                sum.velocity[k] += mass * (double)v[k];
            }
        }
        loop->sums[block] = sum;
    }
}

// About the centre.
static void sum_angular( void* context, int begin, int end, int worker )
{
    (void)worker;
    damping_loop* loop = context;
    const rigid_motion m = loop->rigid;
    for ( int block = begin; block < end; ++block )
    {
        double inertia[6] = { 0 }, momentum[3] = { 0 };
        for ( int slot = block * loop->block; slot < end_of( loop, block ); ++slot )
        {
            const float *p = loop->position + (size_t)slot * 4, *v = loop->velocity + (size_t)slot * 4;
            const double mass = mass_of( p );
            double r[3], u[3], l[3];
            for ( int k = 0; k < 3; ++k )
            {
                r[k] = (double)p[k] - m.centre[k];
                u[k] = (double)v[k] - m.velocity[k];
            }
            cross_product( r, u, l );
            for ( int k = 0; k < 3; ++k )
            {
                momentum[k] += mass * l[k];
            }
            inertia[0] += mass * ( r[1] * r[1] + r[2] * r[2] );
            inertia[1] += mass * ( r[0] * r[0] + r[2] * r[2] );
            inertia[2] += mass * ( r[0] * r[0] + r[1] * r[1] );
            inertia[3] -= mass * r[0] * r[1];
            inertia[4] -= mass * r[0] * r[2];
            inertia[5] -= mass * r[1] * r[2];
        }
        memcpy( loop->sums[block].inertia, inertia, sizeof( inertia ) );
        memcpy( loop->sums[block].momentum, momentum, sizeof( momentum ) );
    }
}

static void add( double* to, const double* terms, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        to[k] += terms[k];
    }
}

static void measure( damping_loop* loop, const wisp_parallel* parallel )
{
    const int blocks = ( loop->slot_count + loop->block - 1 ) / loop->block;
    rigid_motion* m = &loop->rigid;
    wisp_parallel_for( parallel, blocks, 1, sum_linear, loop );
    for ( int b = 0; b < blocks; ++b )
    {
        m->mass += loop->sums[b].mass;
        add( m->centre, loop->sums[b].centre, 3 );
        add( m->velocity, loop->sums[b].velocity, 3 );
    }
    for ( int k = 0; k < 3 && m->mass > 0.0; ++k )
    {
        m->centre[k] /= m->mass;
        m->velocity[k] /= m->mass;
    }
    wisp_parallel_for( parallel, blocks, 1, sum_angular, loop );
    double inertia[6] = { 0 }, momentum[3] = { 0 };
    for ( int b = 0; b < blocks; ++b )
    {
        add( inertia, loop->sums[b].inertia, 6 );
        add( momentum, loop->sums[b].momentum, 3 );
    }
    solve_inertia( inertia, momentum, m->angular );
}

// ---- damping ----

static bool has_triangle( const wisp_fabric* f, int slot )
{
    int first = f->ring_begin[slot / 8];
    return first < f->ring_begin[slot / 8 + 1] && f->ring4[first][slot % 8] != 4 * slot;
}

// A cloth that is pinned is not free to move rigidly: its rigid motion is to rest. A loose vertex is pinned for want
// of mass, but it holds nothing.
static bool is_pinned( const wisp_fabric* f, const float* position )
{
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        if ( position[(size_t)slot * 4 + 3] == 0.0f && has_triangle( f, slot ) )
        {
            return true;
        }
    }
    return false;
}

static void damp_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const damping_loop* loop = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* p = loop->position + (size_t)slot * 4;
        float* v = loop->velocity + (size_t)slot * 4;
        double r[3], turning[3];
        for ( int k = 0; k < 3; ++k )
        {
            r[k] = (double)p[k] - loop->rigid.centre[k];
        }
        cross_product( loop->rigid.angular, r, turning );
        for ( int k = 0; k < 3 && p[3] > 0.0f; ++k )
        {
            double rigid = loop->rigid.velocity[k] + turning[k];
            v[k] = (float)( rigid + loop->keep * ( (double)v[k] - rigid ) );
        }
    }
}

void cloth_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 1024,
    };
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    float rate = *(float*)wisp_frame_column( frame, span->entity, state->damping, 0 );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const int most = ( fabric->vertex_count + MOST_BLOCKS - 1 ) / MOST_BLOCKS;
    block_sums sums[MOST_BLOCKS];
    damping_loop loop = {
        .sums = sums,
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .slot_count = fabric->vertex_count,
        .block = most > LEAST_BLOCK ? most : LEAST_BLOCK,
        .keep = 1.0 / ( 1.0 + (double)rate * (double)wisp_frame_seconds( frame ) ),
    };
    if ( is_pinned( fabric, loop.position ) == false )
    {
        measure( &loop, parallel );
    }
    wisp_parallel_for( parallel, fabric->vertex_count, GRAIN, damp_slots, &loop );
}
