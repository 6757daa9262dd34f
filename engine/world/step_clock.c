// Cuts steps into substeps of constant length.
#include "step_clock.h"

#include <math.h>

static bool agree( float a, float b, float factor )
{
    return a < factor * b && b < factor * a;
}

static float unlikeliness( float dt )
{
    return dt < STEP_CLOCK_LIKELY ? STEP_CLOCK_LIKELY / dt : dt / STEP_CLOCK_LIKELY;
}

static const float AGREEMENT = 1.2f;

// The first step sets the usual length, unless it is a load screen, or the next ones show that it was another exception.
static void begin( step_clock* clock, float dt )
{
    const bool is_believed = dt <= STEP_CLOCK_LONGEST_FIRST || agree( dt, clock->candidate, AGREEMENT );
    const bool is_likelier = 3.0f * unlikeliness( dt ) < unlikeliness( clock->usual_dt );
    const bool is_repeated = agree( dt, clock->candidate, AGREEMENT ) && clock->votes >= 1.0f &&
                             agree( dt, clock->usual_dt, 1.5f ) == false;
    if ( clock->step_count == 0 || ( clock->step_count < STEP_CLOCK_TRIALS && ( is_likelier || is_repeated ) ) )
    {
        clock->usual_dt = is_believed ? dt : STEP_CLOCK_LIKELY;
        clock->candidate = dt;
        clock->substep = clock->remainder = 0.0;
        clock->votes = 0.0f;
        clock->reached = 1.0f;
    }
    clock->step_count += is_believed && clock->step_count < STEP_CLOCK_TRIALS ? 1 : 0;
}

// Follow the step length if it has changed for good: steps of another length have a majority (Boyer and Moore 1991, "MJRTY").
// Short steps have a share of a vote, so that any number of tiny ones takes the time of the usual ones to change it; hitches have one.
static void follow( step_clock* clock, float dt )
{
    const float vote = clock->step_count < STEP_CLOCK_TRIALS ? 1.0f : fminf( dt / clock->usual_dt, 1.0f );
    if ( agree( dt, clock->candidate, AGREEMENT ) )
    {
        clock->votes = fminf( clock->votes + vote, STEP_CLOCK_MAJORITY );
    }
    else if ( clock->votes < vote )
    {
        clock->candidate = dt;
        clock->votes = vote;
    }
    else
    {
        clock->votes -= vote;
    }
    const bool is_new =
        clock->votes >= STEP_CLOCK_MAJORITY && agree( clock->candidate, clock->usual_dt, AGREEMENT ) == false;
    clock->usual_dt = is_new ? clock->candidate : clock->usual_dt;
}

// Length of a substep. A shorter substep makes projections stiffer, which adds energy to what they hold unless it comes
// gradually; a longer one takes energy away. A usual step has at least one.
static double substep_length( const step_clock* clock, int substeps )
{
    const double usual = (double)( clock->usual_dt / (float)substeps );
    return fmin( (double)clock->usual_dt, fmax( usual, STEP_CLOCK_SHRINK * clock->substep ) );
}

double step_clock_advance( step_clock* clock, float dt, int substeps, int longest, bool must_run, wisp_frame* frame )
{
    begin( clock, dt );
    follow( clock, dt );
    frame->reached = clock->reached;
    double substep = substep_length( clock, substeps );
    clock->substep = substep;
    if ( dt == clock->usual_dt && clock->remainder == 0.0 && substep == (double)( dt / (float)substeps ) )
    {
        frame->substeps = substeps;
        frame->seconds = dt / (float)substeps;
        frame->even = dt;
        frame->progress = 0.0f;
        clock->reached = 1.0f;
        return 0.0;
    }
    const double asked = clock->remainder + (double)dt, most = longest * substep * substeps;
    const double time = asked > most + substep ? most : asked;
    const double rounding = 1e-5 + 2e-7 * time / substep; // of a substep
    double count = floor( time / substep + rounding );
    if ( count < 1.0 && must_run )
    {
        count = 1.0;
        substep = time;
    }
    frame->even = 0.0f;
    frame->substeps = (int)count;
    frame->seconds = (float)substep;
    clock->remainder = time - count * substep;
    clock->remainder = fabs( clock->remainder ) < rounding * substep ? 0.0 : clock->remainder;
    frame->progress = clock->remainder == 0.0 ? 0.0f : (float)( substep / time );
    if ( count > 0.0 )
    {
        clock->reached = frame->progress == 0.0f ? 1.0f : fminf( 1.0f, (float)count * frame->progress );
    }
    return asked - time;
}

static bool is_time( double time )
{
    return time >= 0.0 && time <= 1e6;
}

bool step_clock_check( const step_clock* clock )
{
    return is_time( (double)clock->usual_dt ) && is_time( (double)clock->candidate ) && is_time( clock->substep ) &&
           is_time( clock->remainder ) && is_time( clock->pending ) && clock->votes >= 0.0f &&
           clock->votes <= STEP_CLOCK_MAJORITY && clock->reached >= 0.0f && clock->reached <= 1.0f &&
           clock->step_count >= 0 && clock->step_count <= STEP_CLOCK_TRIALS;
}
