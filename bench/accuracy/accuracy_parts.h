/// The parts of the driver: runs, and the tables and charts that are made of them.
#pragma once

#include "accuracy.h"
#include "stats.h"

/// What a setting showed.
typedef struct accuracy_stats
{
    accuracy_run seen;                      ///< the looked-at run, whose times are not used
    stats_summary ms[ACCURACY_WORKERS_MAX]; ///< of the runs that are not sampled; NaN if it was halted
} accuracy_stats;

/// A scene with all that was seen of it.
typedef struct accuracy_report
{
    const accuracy_entry* entry;
    const accuracy_scene* scene;
    const int* numbers; ///< [setting_count] by which run() knows the settings: a quick run has not all of them
    int left_out;       ///< settings that it has not
    const accuracy_stats* stats; ///< [setting_count]
    int workers[ACCURACY_WORKERS_MAX], worker_count;
    // by setting, of `stats`: the columns that are compared
    double* error; ///< NaN: halted
    double* ms[ACCURACY_WORKERS_MAX];
    double* min_ms; ///< of its worker counts the faster one: who has two cores may leave one idle
    bool* on_front; ///< of error and min_ms
} accuracy_report;

/// Keep what a quick run has: settings of no series, of each series the coarsest and the one in the middle, of the
/// first series the finest too. Fine ends take most of the time.
/// @param numbers [setting_count] receives for each setting that is kept where it stood
void accuracy_thin( accuracy_scene* scene, int* numbers );

/// Each setting once looked at, then rounds in turns, each setting with every worker count, while there is time, and
/// at least one. A hash that differs from that of the looked-at run is a failure in the results.
/// @param share of the case's progress, where the scene begins and how much it is
/// @param figures [setting_count] receives
wisp_status accuracy_run_settings( const accuracy_report* report, double seconds, const bench_options* options,
                                   const double fraction[2], accuracy_stats* stats, results* out, wisp_error* error );

/// Who is nearer to the reference than who, by time: the front, at equal error, at equal time, how fast errors fall.
void accuracy_add_table( const accuracy_report* report, results* out );
void accuracy_add_rows( const accuracy_report* report, results* out );
void accuracy_add_equal_error( const accuracy_report* report, results* out );
void accuracy_add_equal_time( const accuracy_report* report, results* out );
void accuracy_add_orders( const accuracy_report* report, results* out );
void accuracy_add_notes( const accuracy_report* report, results* out );
void accuracy_add_charts( const accuracy_report* report, results* out );
