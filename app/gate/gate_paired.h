/// Times of two programs, compared in pairs: both run a row by turns, so that what slows one down slows the other down too.
#pragma once

#include "suite.h"

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

/// Time a row in this process.
/// @param slow fraction of each step's time that is wasted after it, to see whether that is found
/// @param out ns of processor time of all steps, the 10th percentile of repeated runs
wisp_status gate_time_row( const suite_row* row, const char* isa, double slow, double* out, wisp_error* error );

/// Compare all rows. @param old_program a Wisp that knows `gate step --times`
/// @param out [row_count]
/// @param bar that shows how far it is
/// @return WISP_BAD_INPUT the other program cannot time a row of this suite
wisp_status gate_compare_programs( const wisp_suite* suite, const char* suite_path, const char* old_program,
                                   const char* isa, progress* bar, gate_pair_check* out, wisp_error* error );

void gate_report_pairs( const wisp_suite* suite, const gate_pair_check* checks, results* out );

/// Compare this program with itself, slowed down by 0, 2, 3 and 5 %, and report how often that was found.
/// @param trials of each
wisp_status gate_self_test( const wisp_suite* suite, const char* suite_path, int number, const char* isa, int trials,
                            progress* bar, results* out, wisp_error* error );

/// Probability of a mean at least as large if each value had a random sign, exactly for up to 16 values.
double gate_sign_flip( const double* values, int count );
