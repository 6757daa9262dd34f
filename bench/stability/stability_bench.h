/// The case `stability`: hard cases of every solver.
#pragma once

#include "bench.h"
#include "results.h"
#include "suite_judge.h"

bench_case_fn stability_bench;

// ---- suites with checks ----

// Suites whose rows have checks: a line per row, and a failure for each that breaks one, or is known to and holds.

/// Rows so far. Zero-initialised is empty.
typedef struct stability_counts
{
    int rows, held, recovered, refused, known, failed, not_finite, without_limit;
} stability_counts;

/// Run the rows that are due: with `quick` those that the suite lists, with `longest` the long ones as well.
wisp_status stability_bench_suite( const wisp_suite* suite, const bench_options* options, stability_counts* tally,
                                   results* out, wisp_error* error );
/// A line that says how many hold.
void stability_note( const stability_counts* tally, const char* name, results* out );

/// A table of outcomes. @return its number
int stability_begin_table( const char* title, results* out );
/// Add an outcome to a table, to the rows of results, and to the counts. @param known check that it is known to break; -1: it must hold
void stability_add( int table, const char* label, const suite_outcome* outcome, int known, stability_counts* tally,
                    results* out );
