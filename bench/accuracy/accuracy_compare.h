/// Comparisons of numbers, without a scene: the Pareto front, observed orders, and the best item within a limit.
#pragma once

#include <stdbool.h>

#define ACCURACY_LEVELS_MAX 6

/// The Pareto front: an item is on it unless another is as accurate and as fast, and better in one of the two. Items
/// that tie in both are on it together. NaN is never on it and excludes nothing.
/// @param on_front [count] receives the result
void accuracy_front( const double* error, const double* ms, int count, bool* on_front );

/// How an error decreases with its parameter.
typedef struct accuracy_order
{
    double slope; ///< of log error over log parameter by least squares; NaN with fewer than two points
    int used;     ///< number of points in the fit
    int count;    ///< number of points with an error above 0
} accuracy_order;

/// The observed order of a series. Where a smaller parameter no longer gives a smaller error, another error
/// dominates: rounding, the model, the reference itself. Points at the fine end are left out if their error falls
/// more slowly than parameter^0.2 below the smallest of all coarser points.
/// @param parameter, error [count], in any order; NaN and 0 are left out
accuracy_order accuracy_observed_order( const double* parameter, const double* error, int count );

/// Round numbers (1, 2 or 5 times a power of ten) that cover the finite values above 0: from the first that is not
/// below the smallest to the first that is not below the largest, ascending, evenly thinned if there are many.
/// @param levels [ACCURACY_LEVELS_MAX] receives @return their number
int accuracy_levels( const double* values, int count, double* levels );

/// The item with the smallest `cost` among those that take part and whose `limited` is not above the limit; ties go
/// to the first. NaN takes no part.
/// @param takes_part [count], null: all @return -1: none
int accuracy_best_within( const double* cost, const double* limited, double limit, const bool* takes_part,
                          int count );
