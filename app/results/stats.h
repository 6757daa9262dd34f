/// Order statistics and straight lines: what a benchmark says about its samples.
#pragma once

/// What remains of a set of samples. The median is not moved by the few steps that another process disturbed.
typedef struct stats_summary
{
    int count;
    double median, p10, p90, minimum; ///< NaN without samples
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
