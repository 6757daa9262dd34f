/// Variants that are timed turn by turn in one run.
#pragma once

#include "stats.h"
#include "wisp/base.h"

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
