/// The parts of the driver: runs, and the tables and charts of their results.
#pragma once

#include "accuracy/accuracy.h"
#include "bench_output.h"
#include "stats.h"

#include <stdbool.h>

/// Results of a setting.
typedef struct accuracy_stats
{
    accuracy_run seen;                             ///< the sampled run, whose times are not used
    accuracy_work work;                            ///< of the runs that are not sampled
    stats_summary ms[ACCURACY_WORKERS_MAX];        ///< of the runs that are not sampled; NaN if it was halted
    profile_samples profile[ACCURACY_WORKERS_MAX]; ///< of the first one with each; empty: not gathered
} accuracy_stats;

/// A scene with the results of all its settings.
typedef struct accuracy_report
{
    const accuracy_entry* entry;
    const accuracy_scene* scene;
    const int* numbers;          ///< [setting_count] number of each setting in run(): a quick run leaves some out
    int left_out;                ///< number of settings left out
    const accuracy_stats* stats; ///< [setting_count]
    int workers[ACCURACY_WORKERS_MAX], worker_count;
    // by setting, of `stats`: the columns that are compared
    double* error;   ///< NaN: halted, or below the doubt of the reference
    double* bounded; ///< the same, and the doubt where it is below; NaN: halted
    double* ms[ACCURACY_WORKERS_MAX];
    double* min_ms; ///< the fastest worker count: with two cores, one may stay idle
    bool* on_front; ///< of error and min_ms
} accuracy_report;

/// Keep the settings of a quick run: those that the suite names as quick, else those outside any series, the coarsest and the middle one of each series, and
/// the finest of the first series. Fine settings take most of the time.
/// @param suite whose rows the settings are; null: none
/// @param numbers [setting_count] receives the original index of each setting that is kept
void accuracy_thin( accuracy_scene* scene, const wisp_suite* suite, int* numbers );

/// Whether a suite says which rows are quick. Null: it does not.
bool accuracy_names_quick( const wisp_suite* suite );

/// Tables and charts: all settings with the front, equal error, equal time, orders, notes.
void accuracy_add_table( const accuracy_report* report, results* out );
/// What is measured of contact, if a scene has it.
void accuracy_add_contact( const accuracy_report* report, results* out );
/// What is measured, how large it is, and time beside error.
void accuracy_add_counts( const accuracy_report* report, results* out );
/// How two workers scale, times and bytes per vertex, where a scene says what a step is made of, and longest times.
void accuracy_add_costs( const accuracy_report* report, results* out );
void accuracy_add_rows( const accuracy_report* report, results* out );
/// Passes by their time, where profiles were gathered.
void accuracy_add_passes( const accuracy_report* report, results* out );
void accuracy_add_equal_error( const accuracy_report* report, results* out );
void accuracy_add_equal_time( const accuracy_report* report, results* out );
void accuracy_add_orders( const accuracy_report* report, results* out );
void accuracy_add_headline( const accuracy_report* report, results* out );
void accuracy_add_notes( const accuracy_report* report, results* out );
void accuracy_add_charts( const accuracy_report* report, results* out );

// ---- comparisons of numbers ----

// Comparisons of numbers, without a scene: the Pareto front, observed orders, and the best item within a limit.

#define ACCURACY_LEVELS_MAX 6

/// The Pareto front: an item is on it unless another is as accurate and as fast, and better in one of the two. Items
/// that tie in both are on it together. NaN is never on it and excludes nothing.
/// @param settings [count] of several groups, in which items exclude each other; null: all do
/// @param on_front [count] receives the result
void accuracy_front( const double* error, const double* ms, const accuracy_setting* settings, int count,
                     bool* on_front );

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

// ---- labels ----

// What tables and charts share: names of times, errors and worker counts, digits, and which settings belong together.

/// What a time is of: "step", "frame of 1/60 s".
/// "Accuracy", or "Suite" where errors are not measured.
const char* accuracy_kind( const accuracy_scene* scene );
/// "distance to the reference, mm"
void accuracy_error_label( const accuracy_scene* scene, char* text, int size );
/// Format a number with the given significant digits, without an exponent as long as that is readable; "-" if it is
/// not finite.
void accuracy_put_digits( results_cells* row, double value, int digits );
/// The doubt of a setting's reference, and that of one of its measures.
double accuracy_doubt( const accuracy_scene* scene, int setting );
double accuracy_measure_doubt( const accuracy_scene* scene, int setting, int measure );
/// Whether an error is below the doubt of its reference, so that its value says nothing. 0: there is no doubt
bool accuracy_is_below( double error, double doubt );
/// The same for an error: the word `below` where it is.
void accuracy_put_error( results_cells* row, double error, double doubt, int digits );
/// Settings that are one candidate: their method, or series, or name.
const char* accuracy_method_of( const accuracy_setting* setting );
/// The first setting of its series; false for one of no series.
bool accuracy_begins_series( const accuracy_scene* scene, int setting );
