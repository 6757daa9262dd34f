/// A search under way. Private to this folder.
#pragma once

#include "wisp/tune.h"

/// A choice that is measured twice, on a machine that others use now and then, may differ by this factor: less decides
/// nothing.
#define TUNE_NOISE 1.25

/// A choice by its number: digits in the mixed base of the value counts, the last parameter counting fastest.
typedef struct tune_setting
{
    int8_t configuration[WISP_TUNE_MAX_PARAMETERS];
    bool is_open; // nothing has ruled it out, and it was not run
    int trial;    // -1: not run
} tune_setting;

typedef struct tune_search
{
    const wisp_tune_def* args;
    tune_setting* settings; // [setting_count]
    int setting_count;
    wisp_tune_trial* trials; // [visit_count], room for setting_count
    double* times;           // [visit][repeats] ms, of the first runs of each
    int trial_count;
    int best; // a visit, -1: none
    int run_count;
    double start;       // s, of the clock
    double seconds;     // no run of the stage begins later after the start
    int reserve;        // runs that are kept for the stages behind
    bool is_stopped;    // the host said so
    bool stopped_early; // a run that the search wanted was not made
} tune_search;

/// @param setting_count receives how many choices there are
wisp_status tune_check_def( const wisp_tune_def* args, int* setting_count, wisp_error* error );

/// Whether another run may begin. To be asked only by who wants to run: a no is taken down as a cut.
/// @param reserve runs that must be left over afterwards
bool tune_may_run( tune_search* s, int reserve );

/// Run a setting, for the first time or once more, and take what it showed down. The best is then what it is.
wisp_status tune_visit( tune_search* s, int setting, wisp_error* error );

/// What was asked for is met.
bool tune_meets( const wisp_tune_def* args, const wisp_tune_sample* sample );
/// Whether one sample is to be preferred. Of two that are equal neither is.
bool tune_is_better( const wisp_tune_def* args, const wisp_tune_sample* a, const wisp_tune_sample* b );

/// Number of the setting with this choice.
int tune_setting_number( const tune_search* s, const int* configuration );

/// Run settings until the order of values has ruled out the others.
wisp_status tune_bisect( tune_search* s, wisp_error* error );
/// Run what lies beside the best, whatever was ruled out, until none of it is better.
wisp_status tune_look_around( tune_search* s, wisp_error* error );
/// Measure in turns whatever the noise of times may have put on the wrong side.
wisp_status tune_measure_again( tune_search* s, wisp_error* error );
/// Sorts the times. @param count >= 1
double tune_median( double* times, int count );
/// Mark the visits that no other visit beats.
void tune_mark_front( tune_search* s );
