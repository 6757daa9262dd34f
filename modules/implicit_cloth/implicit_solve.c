// Filtered conjugate gradients (Baraff and Witkin 1998, with the filter of Ascher and Boxerman) over rows
// of springs. Loops are cut at the same places for any number of workers, and sums are added in order, so the bits are the same.
#include "implicit_internal.h"

// A repeated solve ends at this fraction of its own residual at the latest: the next one starts from it.
static const double REPEAT = 0.1;
// Very stiff links store what a solve leaves, so they get a tolerance of this at least.
static const double TIGHT = 1e-4;

typedef struct slice_loop
{
    implicit_system* system;
    float step, fraction;
} slice_loop;

static double add_up( const implicit_system* system )
{
    double sum = 0.0;
    for ( int block = 0; block < system->block_count; ++block )
    {
        sum += system->sums[block];
    }
    return sum;
}

static void multiply( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_system* s = context;
    s->sums[begin / s->grain] = s->kernels->spring_product( &s->conjugate, begin, end );
}

static void advance_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const slice_loop* loop = context;
    implicit_system* s = loop->system;
    s->sums[begin / s->grain] = s->kernels->conjugate_advance( &s->conjugate, loop->step, begin, end );
}

static void turn_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const slice_loop* loop = context;
    loop->system->kernels->conjugate_update( &loop->system->conjugate, loop->step, loop->fraction, begin, end );
}

static double product( implicit_system* s )
{
    wisp_parallel_for( s->parallel, s->links->slice_count, s->grain, multiply, s );
    return add_up( s );
}

static double advance( implicit_system* s, float step )
{
    slice_loop loop = { .system = s, .step = step };
    wisp_parallel_for( s->parallel, s->links->slice_count, s->grain, advance_slices, &loop );
    return add_up( s );
}

static void turn( implicit_system* s, float step, float fraction )
{
    slice_loop loop = { .system = s, .step = step, .fraction = fraction };
    wisp_parallel_for( s->parallel, s->links->slice_count, s->grain, turn_slices, &loop );
}

// Residual relative to that of zero velocity change; the initial guess may have reduced it already.
static implicit_outcome end_at( int iterations, double delta, double delta_0 )
{
    return ( implicit_outcome ){
        .iterations = iterations,
        .residual = delta_0 > 0.0 && delta > 0.0 ? (float)sqrt( delta / delta_0 ) : 0.0f,
    };
}

implicit_outcome implicit_solve( implicit_system* s )
{
    // zero change has ( S b )' P ( S b ), the guess r' S P S r
    double delta_0 = advance( s, 0.0f ), delta = delta_0;
    if ( s->guessed )
    {
        product( s );
        delta = advance( s, 1.0f );
        delta_0 = delta_0 > 0.0 ? delta_0 : delta;
    }
    // a repeat ends where the first solve did, and at a tenth of its own residual if that is less
    const double queried = (double)s->material->tolerance,
                 tolerance = fmin( queried, fmax( queried * sqrt( s->looseness ), TIGHT ) ),
                 own = tolerance * tolerance * delta_0;
    s->first = s->spring.is_repeat ? s->first : own;
    const double repeat = s->spring.is_repeat ? s->looseness * fmin( s->first, REPEAT * REPEAT * delta_0 ) : 0.0;
    const double least = fmax( fmax( own, repeat ), s->floor );
    turn( s, s->guessed ? 1.0f : 0.0f, 0.0f );

    int iteration = 0;
    while ( delta > least && iteration < s->limit )
    {
        const double curvature = product( s );
        if ( !( curvature > 0.0 ) )
        {
            implicit_outcome outcome = end_at( iteration, delta, delta_0 );
            outcome.indefinite = true;
            return outcome;
        }
        const float step = (float)( delta / curvature );
        const double next = advance( s, step );
        turn( s, step, (float)( next / delta ) );
        delta = next;
        ++iteration;
    }
    implicit_outcome outcome = end_at( iteration, delta, delta_0 );
    outcome.indefinite = !( delta >= 0.0 ); // of the preconditioner
    outcome.unsolved = iteration == s->limit && delta > least;
    return outcome;
}
