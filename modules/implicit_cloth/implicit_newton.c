// Linear solves of a substep, once or until a stiff one gains little. Equations: docs/methods.md.

#include "implicit_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

// ---- energy ----

// Whether a substep gained energy: kinetic and potential, less the work of gravity and of contacts. Sums have a fixed order.

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

// ---- conjugate gradients ----

// Filtered conjugate gradients (Baraff and Witkin 1998, with the filter of Ascher and Boxerman) over rows
// of springs. Loops are cut at the same places for any number of workers, and sums are added in order, so the bits are the same.

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

// Solve for the change of velocity. Reads the right side from conjugate.residual and the first guess from
// conjugate.direction; the answer is in conjugate.solution, and the remaining right side, the impulse of contact,
// in conjugate.residual.
static implicit_outcome implicit_solve( implicit_system* s )
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

// ---- newton ----

enum
{
    SHORTENINGS = 12, // of a solve's answer, at most
    FEW_SOLVES = 3,   // substeps of more are counted
};

// Of a stiff substep, by the same case. REACH: a link this fraction shorter than its rest length still counts as stiff. At 0, slack
// links are found stretched by the next solve, in turns; at 1, slack cloth hardly moves. SETTLED: the repeats end when a solve
// gains less than this fraction of the motion; LOOSELY where links are less stiff. PAST: a step ends where the slope is at most this
// fraction of that at its start.
static const float REACH = 0.01f;
static const double SETTLED = 1e-4, LOOSELY_SETTLED = 1e-3, PAST = 0.5;

// ---- a solve ----

static void assemble_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    const implicit_system* y = &s->system;
    s->undirected[begin / y->grain] = y->kernels->spring_assemble( &y->spring, begin, end );
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        for ( int k = 0; k < 3; ++k )
        {
            y->conjugate.residual[row / WISP_SLICE][k][row % WISP_SLICE] += y->rubbing[(size_t)row * 4 + (size_t)k];
        }
    }
}

// Initial guess: (I - S)( goal - v ) of a held row and S times the solution of the last substep.
static bool guess_row( implicit_substep* s, int row )
{
    const implicit_system* system = &s->system;
    const int slot = system->links->row_slot[row], lane = row % WISP_SLICE;
    const bool warm = system->spring.is_repeat == false && slot >= 0;
    const float *goal = system->goal + (size_t)row * 4, *v = s->velocity + (size_t)row * 4;
    float free[3] = { 0.0f }, held[3] = { 0.0f };
    for ( int k = 0; k < 3; ++k )
    {
        free[k] = warm ? s->columns.change[(size_t)slot * 3 + (size_t)k] : 0.0f;
        held[k] = goal[3] != 0.0f ? goal[k] - v[k] : 0.0f;
    }
    float* guess = system->conjugate.direction + (size_t)row * 4;
    if ( system->filtered[row / WISP_SLICE] != 0 )
    {
        const float* f = system->filter_floats + (size_t)( row / WISP_SLICE ) * 6 * WISP_SLICE + lane;
        const float d[3] = { free[0] - held[0], free[1] - held[1], free[2] - held[2] };
        free[0] = held[0] + f[0] * d[0] + f[WISP_SLICE] * d[1] + f[2 * WISP_SLICE] * d[2];
        free[1] = held[1] + f[WISP_SLICE] * d[0] + f[3 * WISP_SLICE] * d[1] + f[4 * WISP_SLICE] * d[2];
        free[2] = held[2] + f[2 * WISP_SLICE] * d[0] + f[4 * WISP_SLICE] * d[1] + f[5 * WISP_SLICE] * d[2];
    }
    memcpy( guess, free, sizeof( free ) );
    guess[3] = s->point[(size_t)row * 4 + 3];
    return free[0] != 0.0f || free[1] != 0.0f || free[2] != 0.0f;
}

static void prepare_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    bool guessed = false;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        guessed = guess_row( s, row ) || guessed;
    }
    s->guesses[begin / s->system.grain] = guessed;
    const size_t slices = (size_t)( end - begin );
    memset( s->system.conjugate.solution[begin], 0, slices * sizeof( s->system.conjugate.solution[0] ) );
    memset( s->system.conjugate.product[begin], 0, slices * sizeof( s->system.conjugate.product[0] ) );
}

// Move to v_k plus a fraction of dv, and to x^ plus h times that.
static void move_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    const float h = s->system.spring.dt;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        const float* place = s->system.place + (size_t)row * 4;
        float *v = s->velocity + (size_t)row * 4, *x = s->point + (size_t)row * 4;
        for ( int k = 0; k < 3; ++k )
        {
            v[k] += s->moved * s->system.conjugate.solution[row / WISP_SLICE][k][row % WISP_SLICE];
            x[k] = place[k] + h * v[k];
        }
    }
}

static void move( implicit_substep* s, double fraction )
{
    s->moved = (float)fraction;
    implicit_for_slices( s, move_slices );
}

static void count_outcome( wisp_frame* frame, const implicit_outcome* outcome )
{
    if ( outcome->unsolved )
    {
        wisp_frame_count( frame, WISP_COUNT_NOT_CONVERGED, 1 );
    }
    if ( outcome->indefinite )
    {
        wisp_frame_count( frame, WISP_COUNT_INDEFINITE, 1 );
    }
}

int implicit_assemble( implicit_substep* s, bool repeat )
{
    s->system.spring.is_repeat = repeat;
    s->system.spring.compression_margin = s->stiff ? REACH : 0.0f;
    s->system.spring.base_position = repeat && s->stiff ? s->system.place : NULL;
    implicit_for_slices( s, assemble_slices );
    int undirected = 0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        undirected += s->undirected[block];
    }
    return undirected / 2; // each link is counted at both ends
}

// Lower bound of the residual: rounding of the initial velocities leaves a right side that a solve cannot reduce.
static double find_floor( const implicit_substep* s )
{
    double motion = (double)FLT_MIN;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        motion += s->motion[block];
    }
    const double rounding = 2.0 * (double)FLT_EPSILON;
    return rounding * rounding * motion;
}

// ---- stiff substeps ----

// A link that is slack where forces are evaluated does not resist, and may be stretched in the next substep: it then stores
// k h^2 / m times the energy that moved. But a substep is the minimum of a convex sum, 1/2 m |v - v^|^2 plus the energies of links.
// So a stiff substep is solved until a solve gains little, and a step beyond the minimum is shortened.

typedef struct slope_loop
{
    const implicit_substep* s;
    float ( *right )[3][WISP_SLICE];
} slope_loop;

static void slope_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const slope_loop* loop = context;
    const implicit_system* y = &loop->s->system;
    double sum = 0.0;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        for ( int k = 0; k < 3; ++k )
        {
            sum += (double)loop->right[row / WISP_SLICE][k][row % WISP_SLICE] *
                   (double)y->conjugate.solution[row / WISP_SLICE][k][row % WISP_SLICE];
        }
    }
    y->sums[begin / y->grain] = sum;
}

// Slope of that sum along the last step, J.
static double add_slopes( implicit_substep* s, float ( *right )[3][WISP_SLICE] )
{
    slope_loop loop = { s, right };
    wisp_parallel_for( s->system.parallel, s->system.links->slice_count, s->system.grain, slope_slices, &loop );
    double sum = 0.0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        sum += s->system.sums[block];
    }
    return sum;
}

// Of a step that was cut by more than half, the slope says nothing of what the next may gain.
static bool is_settled( const implicit_substep* s, double slope, double fraction )
{
    double motion = 0.0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        motion += s->motion[block];
    }
    return fraction > PAST && !( slope > ( s->system.looseness > 0.5 ? LOOSELY_SETTLED : SETTLED ) * motion );
}

// Shorten the last step to where the slope is small, between a place before the minimum and one past it. A link that turns stiff on
// the way bends the slope, so whichever place stays twice gets half the weight (Illinois). Forces at the end are known.
// @param undirected links without direction, of the last assembly @return the fraction that is left
static double shorten( implicit_substep* s, double slope, int* undirected )
{
    double from = 0.0, past = 1.0, fraction = 1.0, before = slope, after = 0.0;
    int side = 0;
    for ( int i = 0; i < SHORTENINGS; ++i )
    {
        const double end = add_slopes( s, s->system.spring.rhs );
        if ( end < -PAST * slope )
        {
            before *= side < 0 ? 0.5 : 1.0;
            past = fraction;
            after = end;
            side = -1;
        }
        else if ( i > 0 && end > PAST * slope )
        {
            after *= side > 0 ? 0.5 : 1.0;
            from = fraction;
            before = end;
            side = 1;
        }
        else
        {
            break;
        }
        const double nearer = from + ( past - from ) * before / ( before - after );
        move( s, nearer - fraction );
        fraction = nearer;
        *undirected = implicit_assemble( s, true );
    }
    return fraction;
}

// Solve what has been assembled.
static implicit_outcome solve_linear( implicit_substep* s )
{
    implicit_for_slices( s, prepare_slices );
    s->system.guessed = false;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        s->system.guessed = s->system.guessed || s->guesses[block];
    }
    if ( s->stiff )
    {
        memcpy( s->system.requested, s->system.conjugate.residual,
                (size_t)s->system.links->slice_count * sizeof( s->system.requested[0] ) );
    }
    return implicit_solve( &s->system );
}

void implicit_iterate( wisp_frame* frame, implicit_substep* s, implicit_counts* total )
{
    s->system.floor = find_floor( s );
    const int queried = s->system.material->newton_iterations;
    const int stiff = s->system.material->max_newton_iterations, most = s->stiff && queried < stiff ? stiff : queried;
    const int least = s->stiff && queried < 2 ? 2 : queried; // the first one also moves pins to their targets
    double slope = 0.0, fraction = 1.0;
    int undirected = implicit_assemble( s, false );
    for ( int k = 0; k < least || ( k < most && is_settled( s, slope, fraction ) == false ); ++k )
    {
        const implicit_outcome outcome = solve_linear( s );
        count_outcome( frame, &outcome );
        total->iterations += outcome.iterations;
        slope = s->stiff ? add_slopes( s, s->system.requested ) : 0.0;
        move( s, 1.0 );
        total->residual = outcome.residual;
        total->repeats += 1;
        if ( s->stiff || k + 1 < least )
        {
            undirected = implicit_assemble( s, true );
        }
        if ( s->stiff && k > 0 )
        {
            fraction = shorten( s, slope, &undirected );
        }
    }
    wisp_frame_count( frame, WISP_COUNT_MANY_SOLVES,
                      total->repeats > queried && total->repeats > FEW_SOLVES ? 1 : 0 );
    wisp_frame_count( frame, WISP_COUNT_DEGENERATE_LINK, s->is_second ? 0 : (uint64_t)undirected );
}
