// Keeps the angular momentum of the skin. Ordered projections turn a body a little, and always the same way, because their order
// is always the same. A stiff skin under pressure moves far in each substep, so the turns add up. Without this pass a ball of 258
// vertices at 1.8 times its volume spins with 40 rad/s after five seconds (10 substeps of 2 iterations), and faster with
// more substeps.
//
// With x the positions before the substep, p* the predicted ones and p = p* + D those after all projections, the angular
// momentum of v = (p - x) / dt about the centre is that of the prediction plus sum m (x - c) x D / dt. Turning p by the
// rotation -t with sum m (x - c) x (t x (p - c)) = sum m (x - c) x D removes exactly that.
#include "balloon_internal.h"

#include <math.h>

enum
{
    TURN_GRAIN = 2048, // particles a block: the unit of every sum
};

/// Moments about the previous position of the first particle.
typedef struct turn_moments
{
    double mass, pinned;
    double x[3], p[3];  // sum m x, sum m p
    double turn[3];     // sum m x x D
    double mixed[3][3]; // sum m p_a x_b
} turn_moments;

typedef struct turn_loop
{
    const float *previous, *velocity;
    float* position;
    double dt;
    turn_moments* blocks;
    int count;
    double angle[3], centre[3];
} turn_loop;

static void add_particle( const turn_loop* loop, int slot, turn_moments* m )
{
    const float *p = loop->position + (size_t)slot * 4, *q = loop->previous + (size_t)slot * 4;
    const float* v = loop->velocity + (size_t)slot * 4;
    double mass = p[3] > 0.0f ? 1.0 / (double)p[3] : 0.0, x[3], now[3], moved[3];
    for ( int k = 0; k < 3; ++k )
    {
        x[k] = (double)q[k] - (double)loop->previous[k];
        now[k] = (double)p[k] - (double)loop->previous[k];
        moved[k] = mass * ( now[k] - x[k] - loop->dt * (double)v[k] );
        m->x[k] += mass * x[k];
        m->p[k] += mass * now[k];
    }
    m->mass += mass;
    m->pinned += p[3] > 0.0f ? 0.0 : 1.0;
    m->turn[0] += x[1] * moved[2] - x[2] * moved[1];
    m->turn[1] += x[2] * moved[0] - x[0] * moved[2];
    m->turn[2] += x[0] * moved[1] - x[1] * moved[0];
    for ( int a = 0; a < 3; ++a )
    {
        for ( int b = 0; b < 3; ++b )
        {
            m->mixed[a][b] += mass * now[a] * x[b];
        }
    }
}

static void sum_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    const turn_loop* loop = context;
    for ( int block = begin; block < end; ++block )
    {
        int last = ( block + 1 ) * TURN_GRAIN < loop->count ? ( block + 1 ) * TURN_GRAIN : loop->count;
        turn_moments m = { 0 };
        for ( int slot = block * TURN_GRAIN; slot < last; ++slot )
        {
            add_particle( loop, slot, &m );
        }
        loop->blocks[block] = m;
    }
}

static turn_moments add_blocks( const turn_moments* blocks, int count )
{
    turn_moments sum = { 0 };
    for ( int block = 0; block < count; ++block )
    {
        const double* from = &blocks[block].mass;
        double* to = &sum.mass;
        for ( size_t i = 0; i < sizeof( turn_moments ) / sizeof( double ); ++i )
        {
            to[i] += from[i];
        }
    }
    return sum;
}

static double determinant( const double a[3], const double b[3], const double c[3] )
{
    return a[0] * ( b[1] * c[2] - b[2] * c[1] ) + a[1] * ( b[2] * c[0] - b[0] * c[2] ) +
           a[2] * ( b[0] * c[1] - b[1] * c[0] );
}

// Solve sum m ( (x . p) t - p (x . t) ) = turn by Cramer's rule, everything about the centres.
// @return false where all mass lies on a line
static bool find_turn( const turn_moments* m, double angle[3] )
{
    double column[3][3], trace = 0.0, turn[3];
    for ( int k = 0; k < 3; ++k )
    {
        trace += m->mixed[k][k] - m->p[k] * m->x[k] / m->mass;
        turn[k] = m->turn[k];
    }
    for ( int b = 0; b < 3; ++b )
    {
        for ( int a = 0; a < 3; ++a )
        {
            column[b][a] = ( a == b ? trace : 0.0 ) - ( m->mixed[a][b] - m->p[a] * m->x[b] / m->mass );
        }
    }
    double bottom = determinant( column[0], column[1], column[2] );
    if ( !( fabs( bottom ) > 1e-12 * fabs( trace * trace * trace ) ) )
    {
        return false;
    }
    angle[0] = determinant( turn, column[1], column[2] ) / bottom;
    angle[1] = determinant( column[0], turn, column[2] ) / bottom;
    angle[2] = determinant( column[0], column[1], turn ) / bottom;
    return true;
}

static void turn_back( void* context, int begin, int end, int worker )
{
    (void)worker;
    const turn_loop* loop = context;
    const double* t = loop->angle;
    for ( int slot = begin; slot < end; ++slot )
    {
        float* p = loop->position + (size_t)slot * 4;
        double r[3] = { (double)p[0] - loop->centre[0], (double)p[1] - loop->centre[1],
                        (double)p[2] - loop->centre[2] };
        p[0] = (float)( (double)p[0] - ( t[1] * r[2] - t[2] * r[1] ) );
        p[1] = (float)( (double)p[1] - ( t[2] * r[0] - t[0] * r[2] ) );
        p[2] = (float)( (double)p[2] - ( t[0] * r[1] - t[1] * r[0] ) );
    }
}

// Run once a substep, after the last projection of the skin. A body with a pinned vertex is left alone.
void balloon_keep_angular( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    if ( span->iteration < wisp_frame_iterations( frame ) - 1 )
    {
        return;
    }
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    int blocks = ( fabric->vertex_count + TURN_GRAIN - 1 ) / TURN_GRAIN;
    turn_loop loop = {
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .dt = (double)wisp_frame_dt( frame, span->entity ),
        .blocks = wisp_parallel_scratch( parallel, span->worker, (size_t)blocks * sizeof( turn_moments ) ),
        .count = fabric->vertex_count,
    };
    if ( loop.blocks == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the angular momentum of %d vertices", loop.count );
        return;
    }
    wisp_parallel_for( parallel, blocks, 1, sum_blocks, &loop );
    const turn_moments m = add_blocks( loop.blocks, blocks );
    if ( m.pinned == 0.0 && m.mass > 0.0 && find_turn( &m, loop.angle ) )
    {
        for ( int k = 0; k < 3; ++k )
        {
            loop.centre[k] = (double)loop.previous[k] + m.p[k] / m.mass;
        }
        wisp_parallel_for( parallel, loop.count, TURN_GRAIN, turn_back, &loop );
    }
}
