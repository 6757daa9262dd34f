/// Measurements in memory: rows for machines, tables and notes for readers. results_write.c writes all formats.
#pragma once

#include "machine.h"
#include "stats.h"
#include "wisp/base.h"

#include <stdio.h>

#define RESULTS_MAX_VALUES 64
#define RESULTS_MAX_HEADLINES 32

typedef struct results_value
{
    char name[64];
    double value;
} results_value;

/// Named numbers in the order in which they were put.
typedef struct results_values
{
    int count;
    results_value items[RESULTS_MAX_VALUES];
} results_values;

/// One measurement.
typedef struct results_row
{
    char name[64]; ///< the case, or the scene's name
    char variant[192];
    results_values size; ///< size of the problem; the first one names the row in google-benchmark's format
    int workers;         ///< 0: unknown
    double ms_median, ms_p10, ms_p90;  ///< NaN: unknown
    int steps;                         ///< number of samples in the times
    double samples_ms[STATS_MAX_KEPT]; ///< [sample_count] of the times, in the order of measurement
    int sample_count;
    double cpu_fraction;       ///< processor time over wall time; NaN: not measured
    results_values stages;     ///< ms, median of each pass
    char error_reference[200]; ///< reference of the error; empty: no error was measured
    results_values error;
    uint64_t hash;
    bool has_hash;
} results_row;

/// A table for readers; a column whose cells all begin like numbers is aligned right.
typedef struct results_table
{
    char title[160]; ///< empty: a list of labels and values, whose header is not written as text
    int column_count, row_count, row_capacity;
    char** cells; ///< [row_count][column_count], row 0 is the header
} results_table;

/// A point of a chart; NaN coordinates are left out where it is drawn.
typedef struct results_point
{
    double x, y;
    bool is_marked;  ///< highlighted, such as a setting on the Pareto front
    char label[192]; ///< text shown when a reader points at it; empty: none
} results_point;

/// Points of one name and colour.
typedef struct results_series
{
    char name[64];
    bool is_joined; ///< a line through the points in their order
    results_point* points;
    int count, capacity;
} results_series;

/// A chart of a table: two axes and some series.
typedef struct results_chart
{
    char title[160];
    char x_label[64], y_label[64]; ///< with their units
    bool x_log, y_log;             ///< points that are not above 0 are left out of a logarithmic axis
    /// Horizontal bars instead: a line for each x = 0, 1, 2, .. of the first series, named by its points' labels, with a
    /// bar of length y from 0 for every series that has a point there (from the axis' low end if y_log).
    bool is_bars;
    char caption[400]; ///< a message or two below it; empty: none
    results_series* series;
    int series_count, series_capacity;
} results_chart;

/// Zero-initialised means empty. Running out of memory is kept and reported once, by results_write().
typedef struct results
{
    char headlines[RESULTS_MAX_HEADLINES][600]; ///< the result of each case in a line
    int headline_count;
    machine_info machine;
    char options[400]; ///< of the command that measured, as words of a command line; empty: not said
    results_row* rows;
    int row_count, row_capacity;
    results_table* tables;
    int table_count, table_capacity;
    results_chart* charts; ///< only the HTML report draws them
    int chart_count, chart_capacity;
    char** notes; ///< messages below the tables
    int note_count, note_capacity;
    bool is_brief;        ///< text has notes and the table without a title alone
    bool is_result_first; ///< text and Markdown end with machine and build instead of beginning with them
    int claim_count, claims_met;
    bool failed; ///< results_add_failure() was called: the run must not count as good
    bool incomplete;
} results;

/// Add a row whose times are NaN until the caller fills them.
/// @return the row, to be filled at once, since the next one may move it; null without memory
results_row* results_add_row( results* all, const char* name, const char* variant );

/// Keep the words of the command that measures.
void results_put_options( results* all, int argc, char* const* argv );

/// Give a row its times.
void results_put_times( results_row* row, const stats_summary* ms );

/// Put a named number into a row's size, stages or error. More than RESULTS_MAX_VALUES is an assert.
void results_put( results_values* values, const char* name, double value );

/// @return number of the table, -1 without memory
int results_add_table( results* all, const char* title, int column_count, const char* const* header );
/// @param header of cells that tabs divide
int results_begin_table( results* all, const char* title, const char* header );
/// @param cells [column_count], copied
void results_add_cells( results* all, int table, const char* const* cells );
/// Add a row of cells that tabs divide. A number that is not finite is "-".
void results_add_line( results* all, int table, const char* format, ... ) __attribute__( ( format( printf, 3, 4 ) ) );

#define CELLS_MAX 32

/// A row of a table, written from left to right.
typedef struct results_cells
{
    char text[CELLS_MAX][192];
    int count;
} results_cells;

/// Put a cell, or several that tabs divide, of at most 191 bytes: longer ones are cut.
void cells_put( results_cells* row, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );
/// A table whose header is this row. @return its number
int cells_begin_table( const results_cells* header, const char* title, results* out );
void cells_end_row( const results_cells* row, int table, results* out );

/// @param row 0: the header @return never null
const char* results_cell( const results_table* table, int row, int column );
/// Whether all cells below the header begin like numbers, and there are some.
bool results_is_numeric_column( const results_table* table, int column );

/// @return number of the chart, -1 without memory
int results_add_chart( results* all, const char* title, const char* x_label, const char* y_label );
/// The chart to set its axes and caption, valid until the next one is added; null if the number is -1.
results_chart* results_chart_at( results* all, int chart );
/// @return number of the series in its chart, -1 without memory or without the chart
int results_add_series( results* all, int chart, const char* name, bool is_joined );
void results_add_point( results* all, int chart, int series, results_point point );

/// A line above all tables. Beyond RESULTS_MAX_HEADLINES is an assert.
/// Append ", 3 slower" to a line, and nothing for 0: what did not happen needs no words.
void results_append_count( char* line, size_t size, int count, const char* what );
void results_add_headline( results* all, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );
void results_add_note( results* all, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );
/// A note that also makes the run a failed one.
void results_add_failure( results* all, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );

/// A note about a claim of speed: met, or not met on this machine. Speed is not correctness, so it never fails the run.
void results_add_claim( results* all, bool meets_target, const char* claim, double measured, const char* unit );

void results_free( results* all );

typedef enum results_format
{
    RESULTS_TEXT,
    RESULTS_MARKDOWN,
    RESULTS_CSV,
    RESULTS_JSON,
    RESULTS_LATEX, ///< tables of booktabs
    RESULTS_FORMAT_COUNT,
} results_format;

/// Names as the command line spells them, [RESULTS_FORMAT_COUNT].
extern const char* const results_format_names[RESULTS_FORMAT_COUNT];

/// @return WISP_IO_ERROR the stream refused a byte; WISP_NO_MEMORY now or while the results were gathered
wisp_status results_write( const results* all, results_format format, FILE* stream, wisp_error* error );
/// @param path null or "-" writes to standard output
wisp_status results_write_file( const results* all, results_format format, const char* path, wisp_error* error );
