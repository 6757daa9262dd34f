/// Cuts steps into substeps of constant length. A projection that is not converged is as stiff as its substep is short, so
/// cloth at rest would tremble, and gain energy, if substeps followed every change of the step.
#pragma once

#include "plan.h"

/// A substep is at least this fraction of the one before.
#define STEP_CLOCK_SHRINK 0.998
/// s, a longer first step is a load screen, unless the second is as long.
#define STEP_CLOCK_LONGEST_FIRST 0.25f
/// s, the usual length until a step is believed; far from it a step is less likely to be a usual one.
#define STEP_CLOCK_LIKELY ( 1.0f / 60.0f )

enum
{
    // The usual length changes when steps of another length outnumber all others by this many,
    STEP_CLOCK_MAJORITY = 30,
    // or by two among so many first ones, or at once if one of those is far likelier.
    STEP_CLOCK_TRIALS = 10,
};

/// Zero-initialised before the first step. Plain data, saved in snapshots.
typedef struct step_clock
{
    float usual_dt;     // s, of the step that `substeps` substeps make up; 0: no step yet
    float candidate;    // s, the length that most of the last steps agree with, if any has a majority
    float votes;        // steps that agree with it less those that do not, 0 to STEP_CLOCK_MAJORITY
    int32_t step_count; // that were believed, at most STEP_CLOCK_TRIALS
    float reached;      // fraction of the way to the targets that the last step went
    double substep;     // s, length of the last substep
    double pending;     // s, of wisp_world_advance(), less than one of its steps
    double remainder;   // s, time of steps that no substep has covered yet; less than one substep
} step_clock;

/// Set substeps, their length and the progress of kinematic targets of the next step.
/// @param substeps of a step of usual length
/// @param longest step that is simulated as a whole, usual steps
/// @param must_run at least one substep, which may be shorter than others
/// @return s, what was cut from the step, 0 for most
double step_clock_advance( step_clock* clock, float dt, int substeps, int longest, bool must_run, wisp_frame* frame );

/// @return whether a clock of unknown origin is one that steps could have left
bool step_clock_check( const step_clock* clock );
