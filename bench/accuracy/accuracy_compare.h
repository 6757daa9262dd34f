/// What is cheaper, what is nearer, and how fast errors fall: comparisons of numbers, without a scene.
#pragma once

#include <stdbool.h>

#define ACCURACY_LEVELS_MAX 6

/// The Pareto front: an item is on it unless another is as near and as fast and better in one of the two. Items that
/// tie in both are on it together. NaN is never on it and excludes nothing.
/// @param on_front [count] receives
void accuracy_front( const double* error, const double* ms, int count, bool* on_front );

/// How an error falls with its parameter.
typedef struct accuracy_order
{
    double slope; ///< of log error over log parameter by least squares; NaN with fewer than two points
    int used;     ///< points behind it
    int count;    ///< points that have an error above 0
} accuracy_order;

/// The observed order of a series. Where a smaller parameter no longer brings a smaller error, something else is
/// left: rounding, the model, the reference itself. Such points at the fine end, whose error falls more slowly than
/// parameter^0.2 below the least of all coarser points, are left out.
/// @param parameter, error [count], in any order; NaN and 0 are left out
accuracy_order accuracy_observed_order( const double* parameter, const double* error, int count );

/// Round numbers (1, 2 or 5 times a power of ten) from the first that is not below the least of the finite values
/// above 0 to the first that is not below the greatest, rising, evenly picked if there are many.
/// @param levels [ACCURACY_LEVELS_MAX] receives @return how many
int accuracy_levels( const double* values, int count, double* levels );

/// The item with the least `cost` among those that take part and whose `limited` is not above the limit; the first of
/// equal ones. NaN takes no part.
/// @param takes_part [count], null: all @return -1: there is none
int accuracy_best_within( const double* cost, const double* limited, double limit, const bool* takes_part,
                          int count );
