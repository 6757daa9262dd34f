/// The parts of the driver: runs, and the tables and charts of their results.
#pragma once

#include "accuracy.h"
#include "stats.h"

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

/// Run each setting once sampled, then timed in turns with every worker count, as long as there is time, at least
/// once. A hash that differs from that of the sampled run is a failure in the results.
/// @param fraction of the case's progress: where the scene begins and its length
/// @param stats [setting_count] receives the results
wisp_status accuracy_run_settings( const accuracy_report* report, double seconds, const bench_options* options,
                                   const double fraction[2], accuracy_stats* stats, results* out, wisp_error* error );

/// Tables and charts: all settings with the front, equal error, equal time, orders, notes.
void accuracy_add_table( const accuracy_report* report, results* out );
/// What is measured of contact, if a scene has it.
void accuracy_add_contact( const accuracy_report* report, results* out );
/// Medians, means and longest times.
void accuracy_add_times( const accuracy_report* report, results* out );
/// How two workers scale, and times and bytes per vertex, where a scene says what a step is made of.
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
