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
    TURN_GRAIN = 2048, // particles a block
};

// rad: projections that seem to turn a body by more have crushed it, and the equation of small turns is not theirs.
static const double TURN_MAX = 0.5;

typedef struct turn_loop
{
    wisp_turn_args args;
    const wisp_kernels* kernels;
} turn_loop;

static double determinant( const double a[3], const double b[3], const double c[3] )
{
    return a[0] * ( b[1] * c[2] - b[2] * c[1] ) + a[1] * ( b[2] * c[0] - b[0] * c[2] ) +
           a[2] * ( b[0] * c[1] - b[1] * c[0] );
}

// Solve sum m ( (x . p) t - p (x . t) ) = turn by Cramer's rule, everything about the centres. On the right is
// sum m x x D = sum m x x p - dt sum m x x v, because x x x is 0.
// @return false where all mass lies on a line, or the turn is not a small one
static bool find_turn( const wisp_moments* m, double dt, double angle[3] )
{
    double column[3][3], trace = 0.0, turn[3];
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        trace += m->mixed[k][k] - m->first[k] * m->previous[k] / m->mass;
        turn[k] = m->mixed[b][a] - m->mixed[a][b] - dt * m->angular_momentum[k];
    }
    for ( int b = 0; b < 3; ++b )
    {
        for ( int a = 0; a < 3; ++a )
        {
            column[b][a] = ( a == b ? trace : 0.0 ) - ( m->mixed[a][b] - m->first[a] * m->previous[b] / m->mass );
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
    return angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2] <= TURN_MAX * TURN_MAX;
}

static void turn_back( void* context, int begin, int end, int worker )
{
    (void)worker;
    const turn_loop* loop = context;
    loop->kernels->turn( &loop->args, begin, end );
}

// Run once a substep, after the last projection of the skin. A body with a pinned vertex is left alone.
void balloon_keep_angular( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    if ( span->iteration < wisp_frame_iterations( frame ) - 1 )
    {
        return;
    }
    const float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_moments m;
    double turn[3];
    if ( balloon_sum_moments( frame, span, previous, &m ) && m.pinned == 0.0 && m.mass > 0.0 &&
         find_turn( &m, (double)wisp_frame_dt( frame, span->entity ), turn ) )
    {
        turn_loop loop = { { .position = position, .rows = position }, wisp_frame_kernels( frame ) };
        for ( int k = 0; k < 3; ++k )
        {
            loop.args.angle[k] = -turn[k];
            loop.args.centre[k] = (double)previous[k] + m.first[k] / m.mass;
        }
        wisp_parallel_for( wisp_frame_parallel( frame, span ), wisp_frame_fabric( frame, span->entity )->vertex_count,
                           TURN_GRAIN, turn_back, &loop );
    }
}
