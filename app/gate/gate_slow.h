/// Slow one pass of a row down by a known amount, to see whether the gate finds it.
#pragma once

#include "world_from_scene.h"

typedef struct gate_slow
{
    char pass[64];     ///< name of the pass or fusion; empty: nothing is slowed down
    long loops;        ///< of wasted work after each of its calls
    double calls;      ///< in the run that was counted
    volatile long sum; ///< of the wasted work, so that it is not left out
} gate_slow;

/// Find how much work each call of a pass must waste for steps to take twice as long.
/// @param pass null: the pass that takes most time
/// @return WISP_BAD_INPUT the scene does not run that pass
wisp_status gate_slow_find( const wisp_scene* scene, int steps, const char* isa, const char* pass, gate_slow* out,
                            wisp_error* error );

/// Slow a world of that scene down. Does nothing if `slow` is empty. @param slow must live as long as the world
wisp_status gate_slow_apply( gate_slow* slow, wisp_world* world, wisp_error* error );

/// Processor time of this thread, s.
double gate_seconds_used( void );
