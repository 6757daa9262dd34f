// Cuts steps into substeps of constant length.
#include "step_clock.h"

#include <math.h>

// The first step sets the usual length, unless it turns out to be a trial step, far shorter than the next ones.
static void begin( step_clock* clock, float dt )
{
    if ( clock->step_count == 0 ||
         ( clock->step_count < STEP_CLOCK_TRIALS && dt > STEP_CLOCK_MAX_RATIO * clock->usual_dt ) )
    {
        clock->usual_dt = clock->shortest = clock->longest = dt;
        clock->substep = clock->remainder = 0.0;
        clock->agreeing = 0;
        clock->reached = 1.0f;
    }
    clock->step_count += clock->step_count < STEP_CLOCK_TRIALS ? 1 : 0;
}

// Follow the step length if it has changed for good: a window of steps agree with each other, and not with the usual length.
static void follow( step_clock* clock, float dt )
{
    const float AGREEMENT = 1.2f;
    clock->shortest = fminf( clock->shortest, dt );
    clock->longest = fmaxf( clock->longest, dt );
    clock->agreeing += 1;
    if ( clock->longest > AGREEMENT * clock->shortest )
    {
        clock->shortest = clock->longest = dt;
        clock->agreeing = 1;
    }
    const bool is_usual = dt < AGREEMENT * clock->usual_dt && clock->usual_dt < AGREEMENT * dt;
    if ( clock->agreeing >= STEP_CLOCK_WINDOW )
    {
        clock->agreeing = 0;
        clock->usual_dt = is_usual ? clock->usual_dt : dt;
    }
}

// Length of a substep. A shorter substep makes projections stiffer, which adds energy to what they hold unless it comes
// gradually; a longer one takes energy away. A step that would cost too much makes substeps longer for good, since the next
// such step may come soon.
static double substep_length( step_clock* clock, double time, int substeps )
{
    clock->usual_dt = fmaxf( clock->usual_dt, (float)( time / STEP_CLOCK_MAX_RATIO ) );
    return fmax( (double)clock->usual_dt / substeps, STEP_CLOCK_SHRINK * clock->substep );
}

void step_clock_advance( step_clock* clock, float dt, int substeps, bool must_run, wisp_frame* frame )
{
    const double ROUNDING = 1e-5; // of a substep
    begin( clock, dt );
    follow( clock, dt );
    frame->reached = clock->reached;
    const double time = clock->remainder + (double)dt;
    double substep = substep_length( clock, time, substeps );
    clock->substep = substep;
    if ( dt == clock->usual_dt && clock->remainder == 0.0 && substep == (double)dt / substeps )
    {
        frame->substeps = substeps;
        frame->seconds = dt / (float)substeps;
        frame->even = dt;
        frame->progress = 0.0f;
        clock->reached = 1.0f;
        return;
    }
    double count = floor( time / substep + ROUNDING );
    if ( count < 1.0 && must_run )
    {
        count = 1.0;
        substep = time;
    }
    frame->even = 0.0f;
    frame->substeps = (int)count;
    frame->seconds = (float)substep;
    clock->remainder = time - count * substep;
    clock->remainder = fabs( clock->remainder ) < ROUNDING * substep ? 0.0 : clock->remainder;
    frame->progress = clock->remainder == 0.0 ? 0.0f : (float)( substep / time );
    if ( count > 0.0 )
    {
        clock->reached = frame->progress == 0.0f ? 1.0f : fminf( 1.0f, (float)count * frame->progress );
    }
}

static bool is_time( double time )
{
    return time >= 0.0 && time <= 1e6;
}

bool step_clock_check( const step_clock* clock )
{
    return is_time( (double)clock->usual_dt ) && is_time( (double)clock->shortest ) &&
           is_time( (double)clock->longest ) && is_time( clock->substep ) && is_time( clock->remainder ) &&
           is_time( clock->pending ) && clock->reached >= 0.0f && clock->reached <= 1.0f && clock->step_count >= 0 &&
           clock->step_count <= STEP_CLOCK_TRIALS && clock->agreeing >= 0 && clock->agreeing <= STEP_CLOCK_WINDOW;
}
