/// Order statistics, straight lines and a test of ranks: what a benchmark says about its samples.
#pragma once

#include "wisp/wisp.h"

#include <stdbool.h>

enum
{
    STATS_MAX_KEPT = 100, ///< samples that a summary keeps
};

/// What remains of a set of samples. The median is not moved by the few steps that another process disturbed.
typedef struct stats_summary
{
    int count;
    double median, p10, p90, minimum, maximum, mean; ///< NaN without samples
    double cpu_fraction;                             ///< processor time over wall time; NaN: not measured
    double kept[STATS_MAX_KEPT]; ///< [kept_count] samples at equal distances, in the order of measurement
    int kept_count;
} stats_summary;

/// Sorts the samples in place.
stats_summary stats_summarise( double* samples, int count );

/// The q-quantile of rising values, between neighbours by linear interpolation.
/// @param q in [0, 1]
/// @return NaN if count is 0
double stats_quantile( const double* rising, int count, double q );

/// y = intercept + slope x by least squares.
typedef struct stats_line
{
    double intercept, slope;
    double r_squared; ///< share of the variance of y that the line explains, 1 when all points lie on it
} stats_line;

/// @param x, y [count]
/// @return all NaN with fewer than two different x
stats_line stats_fit_line( const double* x, const double* y, int count );

/// Whether two sets of samples are of one distribution: the rank sum test of Mann and Whitney (1947), by its normal approximation
/// with a correction for ties.
/// @param a [a_count], b [b_count]
/// @return the two-sided p value, 1 with fewer than four samples on a side
double stats_rank_sum( const double* a, int a_count, const double* b, int b_count );

/// Which of several tests reject at a level that all of them share (Holm 1979): the smallest p has to be at most the level over
/// their number, the next one at most that over one less, and so on until one is not.
/// @param p [count] p values; NaN takes no part
/// @param tests number that the level is divided by at first
/// @param is_rejected [count] receives the verdicts
void stats_holm( const double* p, int count, int tests, double level, bool* is_rejected );

// ---- the profile of a world gathered over many steps: a median per pass instead of the value of the last step ----

typedef struct profile_pass
{
    char name[64];
    int items;       ///< of the last step that ran it
    double* seconds; ///< [count]
    int count, capacity;
} profile_pass;

/// Zero-initialised means nothing gathered yet.
typedef struct profile_samples
{
    profile_pass* passes; ///< in the order of their first occurrence: plan order unless the plan changed
    int pass_count, pass_capacity;
} profile_samples;

/// Add the last step's lines. @return WISP_NO_MEMORY
wisp_status profile_samples_add( profile_samples* samples, wisp_profile profile );

/// Median time of a pass over the steps in which it ran, s. Sorts that pass's samples.
double profile_samples_median( profile_samples* samples, int pass );

void profile_samples_free( profile_samples* samples );
