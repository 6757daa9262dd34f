/// Cuts steps into substeps of constant length. A projection that is not converged is as stiff as its substep is short, so
/// cloth at rest would tremble, and gain energy, if substeps followed every change of the step.
#pragma once

#include "plan.h"

/// A substep is at least this fraction of the one before.
#define STEP_CLOCK_SHRINK 0.998

enum
{
    // The substep follows the step length after this many steps in a row that agree with each other.
    STEP_CLOCK_WINDOW = 60,
    // Among so many first steps a far shorter one is a trial step, which does not set the usual length.
    STEP_CLOCK_TRIALS = 4,
    // A step longer than this many usual ones makes substeps longer, so that its cost is bounded.
    STEP_CLOCK_MAX_RATIO = 8,
};

/// Zero-initialised before the first step. Plain data, saved in snapshots.
typedef struct step_clock
{
    float usual_dt;          // s, of the step that `substeps` substeps make up; 0: no step yet
    float shortest, longest; // s, of the last steps that agree with each other
    int32_t step_count;      // so far, at most STEP_CLOCK_TRIALS
    int32_t agreeing;        // their number
    float reached;           // fraction of the way to the targets that the last step went
    double substep;          // s, length of the last substep
    double pending;          // s, of wisp_world_advance(), less than one of its steps
    double remainder;        // s, time of steps that no substep has covered yet; less than one substep
} step_clock;

/// Set substeps, their length and the progress of kinematic targets of the next step.
/// @param substeps of a step of usual length
/// @param must_run at least one substep, which may be shorter than others
void step_clock_advance( step_clock* clock, float dt, int substeps, bool must_run, wisp_frame* frame );

/// @return whether a clock of unknown origin is one that steps could have left
bool step_clock_check( const step_clock* clock );
