/// What a sweep keeps of an item: a line of JSON in a part file.
#pragma once

#include "suite_measure.h"

#include <jansson.h>

enum
{
    SWEEP_MAX_LINE = 1 << 16, ///< bytes
    SWEEP_MAX_TIMES = 2,      ///< with one worker, and with several
};

/// Times of the steps of an item.
typedef struct sweep_time
{
    int workers, steps;
    double median, p10, p90; ///< ms
} sweep_time;

typedef struct sweep_record
{
    int item;     ///< number of the row in the suite
    uint64_t key; ///< hash of its settings: sweep_key()
    uint64_t hash;
    char name[SUITE_MAX_NAME], variant[SUITE_MAX_VARIANT];
    char series[192], along[SUITE_MAX_NAME]; ///< as in a row of a suite
    double along_value, order;
    int steps;
    double values[SUITE_MEASURE_COUNT]; ///< NaN: not measured
    suite_comparison compared;          ///< its distance is the error among the values
    char verdict[32];  ///< of a row with checks: "holds", "refused" or the check that breaks; else empty
    bool is_known;     ///< that verdict is the one that is expected
    char failure[300]; ///< why it could not be run; empty: it was
    sweep_time times[SWEEP_MAX_TIMES];
    int time_count;
    int vertices, substeps; ///< where there are times
} sweep_record;

/// @return the line without its end, for free(); null without memory
char* sweep_record_write( const sweep_record* record );
/// @return false: the line is no record
bool sweep_record_read( const char* line, size_t size, sweep_record* out );

/// A number of JSON, with infinity as "inf" and NaN as null.
json_t* sweep_number( double value );
/// @return NaN: it is none
double sweep_number_of( const json_t* value );
/// @return -1: it is no whole number in the range
int sweep_whole_of( const json_t* value, int least, int most );
/// A hash of JSON, sixteen hexadecimal digits. @return false: it is none
bool sweep_hash_of( const json_t* value, uint64_t* out );
json_t* sweep_hash( uint64_t hash );
/// Copy a text. @return false: it is none, or too long
bool sweep_text_of( const json_t* value, char* out, size_t size );
