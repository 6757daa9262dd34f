/// A search under way. Private to this folder.
#pragma once

#include "wisp/tune.h"

/// Two measurements of one configuration, on a machine with occasional other load, may differ by this factor: smaller
/// differences decide nothing.
#define TUNE_NOISE 1.25

/// A configuration by its number: digits in the mixed base of the value counts, the last parameter counting fastest.
typedef struct tune_setting
{
    int8_t configuration[WISP_TUNE_MAX_PARAMETERS];
    bool is_open; // not ruled out, and not run
    int trial;    // -1: not run
} tune_setting;

typedef struct tune_search
{
    const wisp_tune_def* args;
    tune_setting* settings; // [setting_count]
    int setting_count;
    wisp_tune_trial* trials; // [visit_count], capacity setting_count
    double* times;           // [visit][repeats] ms, of the first runs of each
    int trial_count;
    int best; // a visit, -1: none
    int run_count;
    double start;       // s, of the clock
    double seconds;     // no run of the stage begins later after the start
    int reserve;        // runs reserved for later stages
    bool is_stopped;    // the host has stopped the search
    bool stopped_early; // a run of the search was refused
} tune_search;

/// @param setting_count receives the number of configurations
wisp_status tune_check_def( const wisp_tune_def* args, int* setting_count, wisp_error* error );

/// Whether another run may begin. Call only if a run is intended: false is recorded as an early stop.
/// @param reserve runs that must be left over afterwards
bool tune_may_run( tune_search* s, int reserve );

/// Run a configuration, for the first time or again, record its result and update the best.
wisp_status tune_visit( tune_search* s, int setting, wisp_error* error );

/// Whether the sample meets the target.
bool tune_meets( const wisp_tune_def* args, const wisp_tune_sample* sample );
/// Whether sample a is better than b; false for equal ones.
bool tune_is_better( const wisp_tune_def* args, const wisp_tune_sample* a, const wisp_tune_sample* b );

/// Number of the setting with this configuration.
int tune_setting_number( const tune_search* s, const int* configuration );

/// Run settings until the order of values has ruled out the others.
wisp_status tune_bisect( tune_search* s, wisp_error* error );
/// Run neighbours of the best, even if ruled out, until none of them is better.
wisp_status tune_search_around( tune_search* s, wisp_error* error );
/// Measure in turns all configurations whose rank may be due to noise.
wisp_status tune_measure_again( tune_search* s, wisp_error* error );
/// Sorts the times. @param count >= 1
double tune_median( double* times, int count );
/// Mark the undominated visits.
void tune_mark_front( tune_search* s );
