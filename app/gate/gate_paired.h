/// Times of two programs, compared in pairs: both run a row by turns, so that what slows one down slows the other down too.
#pragma once

#include "gate_turns.h"

#include "progress.h"
#include "results.h"

typedef enum gate_pace
{
    PACE_FINE,           ///< not slower than allowed
    PACE_DOUBT,          ///< not decided after the last round
    PACE_NOT_MEASURABLE, ///< one program differs from itself by too much
    PACE_SLOWER,
    PACE_COUNT,
} gate_pace;

typedef struct gate_pair_check
{
    gate_pace pace;
    int rounds;
    double slower;       ///< mean of log( new / old )
    double lower, upper; ///< its interval of 95 %
    double noise;        ///< standard deviation of log( old / old )
    double p;            ///< of a slow-down beyond what is allowed, by flipping signs
} gate_pair_check;

/// Compare all rows. @param old_program a Wisp that knows `gate step --turns`
/// @param turns its row is that of each turn
/// @param bar that shows how far it is
/// @param out [row_count]
/// @return WISP_BAD_INPUT the other program cannot time a row of this suite
wisp_status gate_compare_programs( wisp_suite* suite, const char* old_program, gate_turns turns, progress* bar,
                                   gate_pair_check* out, wisp_error* error );

void gate_report_pairs( const wisp_suite* suite, const gate_pair_check* checks, results* out );

typedef struct gate_self_test_options
{
    int trials;               ///< gates of each slow-down
    bool counts_instructions; ///< too, with valgrind
} gate_self_test_options;

/// Compare this program with itself, slowed down so that steps take 0, 2, 3 and 5 % longer, and report how often
/// that was found.
wisp_status gate_self_test( const wisp_suite* suite, const gate_turns* turns, const gate_self_test_options* options,
                            progress* bar, results* out, wisp_error* error );

/// Probability of a mean at least as large if each value had a random sign, exactly for up to 24 values.
double gate_sign_flip( const double* values, int count );
