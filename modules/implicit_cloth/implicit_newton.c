// Linear solves of a substep, once or until a stiff one gains little. Equations: docs/methods.md.
#include "implicit_substep.h"

#include <float.h>
#include <math.h>
#include <string.h>

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

void implicit_iterate( wisp_frame* frame, implicit_substep* s, implicit_tally* total )
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
