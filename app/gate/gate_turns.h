/// Programs that run a row by turns: each is a process that waits for its turn, on one processor for all, and may be slowed down by a
/// known amount, to see whether the gate finds it.
#pragma once

#include "suite.h"
#include "world_from_scene.h"

#include <sys/types.h>

// ---- slow-downs by a known amount ----

typedef struct gate_slow
{
    long loops;        ///< of wasted work after each step; 0: nothing is slowed down
    volatile long sum; ///< of the wasted work, so that it is not left out
} gate_slow;

/// Find how much work must be wasted after each step for steps to take twice as long.
wisp_status gate_slow_find( const wisp_scene* scene, const char* isa, gate_slow* out, wisp_error* error );

/// Waste the work of one step. Counted by its name, as steps are.
void gate_slow_waste( gate_slow* slow );

// ---- turns ----

/// A program, and by how much it is slowed down.
typedef struct gate_program
{
    const char* path;
    long loops; ///< of work that is wasted after each step
} gate_program;

/// A process of it that runs one row.
typedef struct gate_process
{
    const gate_program* program;
    pid_t child; ///< 0: none
    int to, from;
} gate_process;

/// What all processes of a comparison are told.
typedef struct gate_turns
{
    const char *suite, *isa;
    int row;
    double patience; ///< s that a turn may take, until the program is given up
} gate_turns;

/// What a process did in a turn.
typedef struct gate_turn
{
    double ns; ///< of processor time
    int steps; ///< that were made in it
} gate_turn;

/// Start a process, which waits for its first turn. @param out to be ended, also after a failure
wisp_status gate_process_begin( const gate_program* program, const gate_turns* turns, gate_process* out,
                                wisp_error* error );
/// Let a process make its next steps. The row begins again after its last step, behind which no turn goes.
/// @param steps at most
/// @return WISP_BAD_INPUT it is no Wisp that can do this, it gave no time, or it took too long
wisp_status gate_process_turn( gate_process* process, const gate_turns* turns, int steps, gate_turn* out,
                               wisp_error* error );
void gate_process_end( gate_process* process );

/// Be such a process: each line of standard input is a number of steps, of which time and number are printed. Ends with the input.
/// @param slow by how much it is slowed down
wisp_status gate_answer_turns( const suite_row* row, gate_slow* slow, const char* isa, wisp_error* error );
