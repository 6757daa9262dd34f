/// Measure a row of a suite: what is the same in every run on any machine.
#pragma once

#include "suite.h"

/// How rows are measured.
typedef struct gate_measure_options
{
    const char* isa;        ///< of kernels; bits are the same for all of them
    bool counts;            ///< count instructions, with valgrind
    const char* suite_path; ///< that the measured program reads again
} gate_measure_options;

typedef struct gate_measurement
{
    uint64_t hash;                      ///< of the states after all steps
    double values[SUITE_MEASURE_COUNT]; ///< NaN: not measured
    int steps;
    char isa[16]; ///< instruction set that the kernels used
} gate_measurement;

/// Run a row in this process. Instructions are not counted.
wisp_status gate_run_row( const suite_row* row, const char* isa, gate_measurement* out, wisp_error* error );

/// The same, with its instructions if the options ask for them.
/// @param number of the row
/// @return WISP_IO_ERROR valgrind is missing or counted nothing (the message says why)
wisp_status gate_measure_row( const gate_suite* suite, int number, const gate_measure_options* options,
                              gate_measurement* out, wisp_error* error );
