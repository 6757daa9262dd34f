/// The profile of a world gathered over many steps: a median per pass instead of the value of the last step.
#pragma once

#include "wisp/wisp.h"

typedef struct profile_pass
{
    char name[64];
    int items;       ///< of the last step that ran it
    double* seconds; ///< [count]
    int count, capacity;
} profile_pass;

/// Zero-initialised means nothing gathered yet.
typedef struct profile_samples
{
    profile_pass* passes; ///< in the order of their first occurrence: plan order unless the plan changed
    int pass_count, pass_capacity;
} profile_samples;

/// Add the last step's lines. @return WISP_NO_MEMORY
wisp_status profile_samples_add( profile_samples* samples, wisp_profile profile );

/// Median time of a pass over the steps in which it ran, s. Sorts that pass's samples.
double profile_samples_median( profile_samples* samples, int pass );

void profile_samples_free( profile_samples* samples );
