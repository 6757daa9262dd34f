/// Instructions of a row, counted by callgrind in a process of its own.
#pragma once

#include "suite_measure.h"

/// @param suite path, which the process reads again @param number of the row
/// @param out with the passes that ran; receives the instructions of all steps and of each pass
/// @return WISP_IO_ERROR valgrind is missing or counted nothing (the message says why)
wisp_status suite_count_instructions( const char* suite, int number, suite_measurement* out, wisp_error* error );
