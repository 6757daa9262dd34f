/// Base files, and the rows of a suite compared with one: which became worse by more than their budgets.
#pragma once

#include "results.h"
#include "suite_measure.h"

// ---- base files ----

enum
{
    GATE_VERSION = 4, ///< 2: instructions by pass; 3: errors; 4: cycles, iterations of solvers
    GATE_MAX_REASON = 200,
};

typedef struct gate_base_row
{
    char name[SUITE_MAX_NAME], variant[SUITE_MAX_VARIANT];
    suite_measurement measured;
} gate_base_row;

/// Why a base was replaced.
typedef struct gate_reason
{
    char date[16]; ///< 2026-01-31
    char text[GATE_MAX_REASON];
} gate_reason;

typedef struct gate_base
{
    char suite[SUITE_MAX_NAME];
    char date[16], version[32];
    char compiler[256]; ///< and flags, of the program that measured: instructions depend on them
    gate_base_row* rows;
    int row_count;
    gate_reason* accepted; ///< [accepted_count] the oldest first
    int accepted_count;
} gate_base;

/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT no base file, cut or edited, or of another version; WISP_IO_ERROR
wisp_status gate_base_read( const char* path, gate_base* out, wisp_error* error );
/// The same from a text. @param path that messages name
wisp_status gate_base_parse( const char* text, size_t size, const char* path, gate_base* out, wisp_error* error );

/// Replace the file as a whole, or leave it as it was.
wisp_status gate_base_write( const gate_base* base, const char* path, wisp_error* error );
/// Write a unified diff from the base file to a base, which `git apply` takes in the folder that the path is relative to.
wisp_status gate_write_patch( const gate_base* base, const char* path, const char* patch, wisp_error* error );
void gate_base_release( gate_base* base );

/// Compiler and flags of this program, as a base has them.
void gate_compiler( char* out, size_t size );

/// Today, as gate_reason has it.
void gate_today( char out[16] );

// ---- the comparison ----

typedef enum gate_state
{
    GATE_SAME,  ///< the same bits and no value worse
    GATE_MOVED, ///< other bits, no value worse than its budget
    GATE_WORSE, ///< a value is worse than its budget
    GATE_NEW,   ///< the base does not have the row: nothing is known
    GATE_STATE_COUNT,
} gate_state;

extern const char* const gate_state_names[GATE_STATE_COUNT];

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

/// A line for each row, what is worse, and the verdict last.
void gate_report( const wisp_suite* suite, const gate_row_check* checks, results* out );

/// JUnit's XML: a test case for each row. @return WISP_IO_ERROR
wisp_status gate_write_junit( const wisp_suite* suite, const gate_row_check* checks, const char* path,
                              wisp_error* error );

/// GitHub's annotations, one for each row that is worse or new, to standard output.
/// @param path of the suite, which they point to
void gate_print_annotations( const wisp_suite* suite, const gate_row_check* checks, const char* path );

// ---- the page ----

/// The page: the verdict and what is worse in sentences, charts, tables. It needs no network and no script.
/// @param report of gate_report() for the same checks; charts and headlines are added to it
/// @return WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status gate_write_page( const wisp_suite* suite, const gate_row_check* checks, results* report, const char* path,
                             wisp_error* error );
