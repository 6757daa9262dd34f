/// Files of results, read: the output of `wisp info` with their defects, and what differs between two of them beyond noise.
#pragma once

#include "results.h"
#include "wisp/base.h"

#include <stdio.h>

/// Whether the first bytes of a file look like a result and not like a scene, which may be JSON too.
bool info_is_results( const char* bytes, size_t size );

/// Check a result file against the schema and print its facts and rows.
/// @return WISP_BAD_INPUT the message names the line, or the row and key; WISP_IO_ERROR
wisp_status info_results( const char* path, FILE* out, wisp_error* error );

/// Compare the rows of two files. Rows are matched by case, variant, workers and the first number of their size; repeated ones in
/// their order. Times differ if a test of ranks (Mann and Whitney 1947) says so at 1 % over all rows (Holm 1979) and if their medians
/// differ by at least `least`. Rows without samples differ by their medians alone. Times of other processors, instruction sets or
/// builds are shown and not judged. Everything else is compared as it stands: bits, errors, sizes.
/// @param before, after paths of files
/// @param least fraction, such as 0.25
/// @param out receives tables, headlines and a row for each pair
/// @return WISP_BAD_INPUT or WISP_IO_ERROR: a file is no result file (the message says where)
wisp_status results_compare( const char* before, const char* after, double least, results* out, wisp_error* error );
