/// Instructions of a row, counted by callgrind in a process of its own.
#pragma once

#include "suite_measure.h"

typedef struct suite_count_options
{
    bool has_cycles;  ///< simulate caches too, which takes three times as long
    const char* step; ///< option of `gate step` that the row is run with; null: none
} suite_count_options;

/// @param suite path, which the process reads again @param number of the row
/// @param out with the passes that ran; receives the instructions of all steps and of each pass, and the cycles
/// @return WISP_IO_ERROR valgrind is missing or counted nothing (the message says why)
wisp_status suite_count_instructions( const char* suite, int number, const suite_count_options* options,
                                      suite_measurement* out, wisp_error* error );
