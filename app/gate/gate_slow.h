/// Slow the steps of a row down by a known amount, to see whether the gate finds it.
#pragma once

#include "world_from_scene.h"

typedef struct gate_slow
{
    long loops;        ///< of wasted work after each step; 0: nothing is slowed down
    volatile long sum; ///< of the wasted work, so that it is not left out
} gate_slow;

/// Find how much work must be wasted after each step for steps to take twice as long.
wisp_status gate_slow_find( const wisp_scene* scene, int steps, const char* isa, gate_slow* out, wisp_error* error );

/// Waste the work of one step. Counted by its name, as steps are.
void gate_slow_waste( gate_slow* slow );

/// Processor time of this thread, s.
double gate_seconds_used( void );
