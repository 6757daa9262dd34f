/// The benchmark: what a case is told, the table of cases, and variants that are timed in turns.
#pragma once

#include "results.h"
#include "stats.h"

#include "wisp/base.h"

typedef struct bench_options
{
    bool quick; ///< fewer samples and settings, shorter runs, without the largest sizes; notes say what is left out
    double seconds; ///< about how long a case may take; 0: 85, or 18 when quick, so that 90 and 20 are kept
    int workers;    ///< of the parallel variant
    bool longest;   ///< the case `stability`: a million steps at rest as well
    /// Told what is running and how much of the case is done, in [0, 1]; may be null.
    void ( *progress )( void* user, double fraction, const char* what );
    void* progress_user;
} bench_options;

/// Default options of the program.
bench_options bench_default_options( void );
/// The case's time in seconds after its defaults.
double bench_seconds( const bench_options* options );
/// "worker" or "workers".
const char* bench_workers_word( int workers );
void bench_progress( const bench_options* options, double fraction, const char* what );

typedef wisp_status bench_case_fn( const bench_options* options, results* out, wisp_error* error );

// ---- cases ----

typedef struct bench_case
{
    const char* name;
    const char* purpose; ///< one line
    bench_case_fn* run;
} bench_case;

/// The cases of cases.inc in their order.
const bench_case* bench_cases( int* count );

// ---- variants that are timed in turns ----

/// One of several ways to do the same work.
typedef struct bench_variant
{
    const char* name;
    wisp_status ( *step )( void* context, wisp_error* error ); ///< what is timed
    wisp_status ( *after )( void* context );                   ///< after each timed step, untimed; may be null
    void* context;
    double* samples; ///< [sample_count] ms, filled by bench_interleave(); bench_free_samples() releases them
    int sample_count;
    double wall_seconds, cpu_seconds; ///< of all samples; processor time is that of all threads
    double warm_ms;                   ///< what a step costs; above 0 if the caller has warmed it up and knows already
    int turn_steps;                   ///< timed steps a turn, chosen by that cost
} bench_variant;

typedef struct bench_effort
{
    double seconds;  ///< stop after the first round that ends past this time ...
    int rounds_min;  ///< ... but not before this many
    int samples_max; ///< stop early when every variant has this many
} bench_effort;

/// Time variants in turns A B C A B C ..., so that whatever slows the machine down for a while slows all of them. A
/// turn of short steps has several, after one that warms the caches and is not counted. Each variant is warmed up
/// first. The samples are to be freed also after a failure.
wisp_status bench_interleave( bench_variant* variants, int count, const bench_effort* effort, wisp_error* error );

/// What remains of the samples of a variant. Sorts them.
stats_summary bench_summarise( bench_variant* variant );

void bench_free_samples( bench_variant* variants, int count );
