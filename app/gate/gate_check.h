/// Compare the rows of a suite with a base: which became worse by more than their budgets.
#pragma once

#include "gate_base.h"

#include "results.h"

typedef enum gate_state
{
    GATE_SAME,  ///< the same bits and no value worse
    GATE_MOVED, ///< other bits, no value worse than its budget
    GATE_WORSE, ///< a value is worse than its budget
    GATE_NEW,   ///< the base does not have the row: nothing is known
    GATE_STATE_COUNT,
} gate_state;

extern const char* const gate_state_names[GATE_STATE_COUNT];

/// What all rows say together.
typedef enum gate_verdict
{
    GATE_PASS,
    GATE_INCONCLUSIVE, ///< no row is worse, and the base does not have one
    GATE_REGRESSION,   ///< a row is worse
    GATE_VERDICT_COUNT,
} gate_verdict;

extern const char* const gate_verdict_names[GATE_VERDICT_COUNT];

/// A row compared.
typedef struct gate_row_check
{
    gate_state state;
    suite_measurement now;
    const gate_base_row* base;       ///< null: new
    bool worse[SUITE_MEASURE_COUNT]; ///< which values
    char message[500];               ///< a sentence about them; empty if none is
} gate_row_check;

/// Whether instructions can be compared: both programs have one compiler and its flags.
bool gate_counts_are_comparable( const gate_base* base );

/// @param compares_counts instructions too
void gate_check_row( const suite_row* row, const gate_base* base, bool compares_counts, const suite_measurement* now,
                     gate_row_check* out );

/// Rows of the base that the suite does not have.
int gate_count_missing( const gate_base* base, const suite_row* rows, int row_count );

gate_verdict gate_verdict_of( const wisp_suite* suite, const gate_row_check* checks );

/// @return instructions of a pass; 0: it did not run or was not counted
double gate_pass_instructions( const suite_measurement* m, const char* name );

/// The name and the settings of a row, as reports have them.
void gate_row_label( const suite_row* row, char* out, size_t size );

/// A line for each row, what is worse, and the verdict last.
void gate_report( const wisp_suite* suite, const gate_row_check* checks, results* out );

/// JUnit's XML: a test case for each row. @return WISP_IO_ERROR
wisp_status gate_write_junit( const wisp_suite* suite, const gate_row_check* checks, const char* path,
                              wisp_error* error );

/// GitHub's annotations, one for each row that is worse or new, to standard output.
/// @param path of the suite, which they point to
void gate_print_annotations( const wisp_suite* suite, const gate_row_check* checks, const char* path );
