// Whether a substep gained energy: kinetic and potential, less the work of gravity and of contacts. Sums have a fixed order.
#include "implicit_internal.h"

#include <float.h>

static const double FORGOTTEN = 1.0 / 1024.0; // of the gain, per substep; a thousand substeps are what is judged
static const double GAIN_ALLOWED = 0.004;     // of the energy: less than a hundredth, with what one substep may add

static double square( const float v[3] )
{
    return (double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2];
}

// Work of contact, of pins and of friction on a row: their impulse times the way in the time of the equations.
static double work_on_row( const implicit_motion* m, int row, bool pinned )
{
    const implicit_system* y = m->system;
    const float *v = m->velocity + (size_t)row * 4, *start = y->start + (size_t)row * 4;
    const float* rubbing = y->rubbing + (size_t)row * 4;
    const wisp_vec3 impulse = implicit_impulse( y, row );
    const float j[3] = { impulse.x, impulse.y, impulse.z };
    double sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        // a pinned row has a mass only in the equations
        const double inertia = pinned ? (double)v[k] - (double)start[k] : 0.0;
        sum += ( (double)j[k] + (double)rubbing[k] - inertia ) * (double)v[k];
    }
    return sum * (double)( m->seconds / y->spring.dt );
}

typedef struct gain_loop
{
    const implicit_motion* motion;
    implicit_gain* sums; // [block]
} gain_loop;

static void add_row( const implicit_motion* m, int row, implicit_gain* sum )
{
    const implicit_system* y = m->system;
    const int slot = y->links->row_slot[row];
    if ( slot < 0 )
    {
        return;
    }
    const float *x = m->point + (size_t)row * 4, *from = m->from + (size_t)row * 4;
    const float *v = m->velocity + (size_t)row * 4, *before = m->before + (size_t)slot * 4;
    const bool pinned = m->weight[(size_t)slot * 4 + 3] == 0.0f;
    if ( pinned == false )
    {
        const double mass = (double)y->place[(size_t)row * 4 + 3];
        const double fall = (double)m->gravity.x * ( (double)x[0] - (double)from[0] ) +
                            (double)m->gravity.y * ( (double)x[1] - (double)from[1] ) +
                            (double)m->gravity.z * ( (double)x[2] - (double)from[2] );
        sum->gain += mass * ( 0.5 * ( square( v ) - square( before ) ) - fall );
        sum->energy += 0.5 * mass * square( v );
    }
    sum->rounding += square( x );
    if ( y->goal[(size_t)row * 4 + 3] != 0.0f )
    {
        sum->gain -= work_on_row( m, row, pinned );
    }
}

static void gain_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const gain_loop* loop = context;
    const implicit_motion* m = loop->motion;
    wisp_spring_args spring = m->system->spring;
    spring.position = m->point;
    spring.base_position = m->from;
    const wisp_spring_gain links = m->system->kernels->spring_gain( &spring, begin, end );
    implicit_gain sum = { .gain = links.gain, .energy = links.stored };
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        add_row( m, row, &sum );
    }
    loop->sums[begin / m->system->grain] = sum;
}

implicit_gain implicit_find_gain( const implicit_motion* motion, implicit_gain* sums )
{
    const implicit_system* y = motion->system;
    gain_loop loop = { motion, sums };
    wisp_parallel_for( y->parallel, y->links->slice_count, y->grain, gain_slices, &loop );
    implicit_gain all = { 0.0, 0.0, 0.0 };
    for ( int block = 0; block < y->block_count; ++block )
    {
        all.gain += sums[block].gain;
        all.energy += sums[block].energy;
        all.rounding += sums[block].rounding;
    }
    // positions are rounded, and so is the length of a slack link at rest
    all.rounding *= 4.0 * (double)FLT_EPSILON * (double)FLT_EPSILON * (double)y->links->stiffest;
    return all;
}

double implicit_add_gain( double gained, const implicit_gain* gain )
{
    return fmax( 0.0, gained - FORGOTTEN * gained + gain->gain );
}

bool implicit_gains( double gained, const implicit_gain* gain )
{
    return gain->gain > 0.0 && gained > GAIN_ALLOWED * gain->energy + gain->rounding;
}
