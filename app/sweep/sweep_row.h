/// Rows of a sweep: what is kept of an item, which is a row of a suite. A line of JSON each. Every row says of which sweep it is and where it ran, so
/// lines of any machines can be in one file.
#pragma once

#include "machine.h"
#include "suite_measure.h"
#include "wisp/base.h"

enum
{
    SWEEP_MAX_SHARDS = 9999,
    SWEEP_MAX_LINE = 1 << 16, ///< bytes
    SWEEP_VALUE_COUNT = 19,
    SWEEP_LATE_HEIGHT = 6, ///< number of the value, which rows have whose motion parts
};

/// What is kept of a measurement, in the order of columns.
typedef struct sweep_value
{
    const char *title, *name; ///< of tables; of rows for programs, and of a line
    size_t offset;            ///< of the number in a suite_measurement
    double scale;             ///< from there to the unit of the title
    bool is_error;            ///< below the doubt of the reference it says nothing
    bool hides_zeros;         ///< left out of a table where all are 0
} sweep_value;

extern const sweep_value sweep_values[SWEEP_VALUE_COUNT];

/// Times of the steps of an item, ms. NaN: not timed.
typedef struct sweep_time
{
    double median, p10, p90;
} sweep_time;

/// Items, shards and their numbers count from 1. Texts are empty and numbers 0 or NaN where there are none.
typedef struct sweep_row
{
    char suite[160]; ///< its title, or its name
    uint64_t sweep;  ///< hash of all items, and of what their errors are measured against
    int items, shards;
    char reference[200];

    int shard, share; ///< the share that ran it, and how many items that has

    machine_info machine; ///< without what differs from run to run

    int item; ///< number of the row in the suite; 0: no row
    char name[SUITE_MAX_NAME], variant[SUITE_MAX_VARIANT];
    char series[192], along[SUITE_MAX_NAME]; ///< as in a row of a suite
    double along_value, order;
    int steps, strands, vertices, substeps;
    double doubt, until; ///< m; s: of the reference, and how long motion is compared with it
    uint64_t hash;
    double values[SWEEP_VALUE_COUNT];
    char verdict[32];  ///< of a row with checks: "holds", "refused" or the check that breaks
    bool is_known;     ///< that verdict is the one that is expected
    char failure[500]; ///< why it could not be run

    int workers;                ///< 0: it was not timed
    sweep_time alone, together; ///< with one worker; with `workers`, if those are more
} sweep_row;

/// @return the line without its end, for free(); null without memory
char* sweep_row_write( const sweep_row* row );
/// @return false: the line is no row
bool sweep_row_read( const char* line, size_t size, sweep_row* out );

/// @return what differs so that two rows are not of one sweep, such as "suite"; null: nothing
const char* sweep_row_difference( const sweep_row* a, const sweep_row* b );
/// Copy times, and the machine that they are of.
void sweep_row_take_times( sweep_row* to, const sweep_row* from );
/// Put "several", or 0, in place of what is true of one machine and not of another.
void sweep_row_join_machines( sweep_row* all, const sweep_row* row );
