/// The race of the case `strands`: what is measured for each size, and its tables.
#pragma once

#include "strands_bench.h"

#define STRANDS_SETTINGS_MAX 8

/// What one way to solve showed at one size.
typedef struct strands_line
{
    stats_summary ms[STRANDS_WORKERS_MAX];
    double stretch_max, stretch_mean; ///< averages over the observations
    double error;                     ///< share of a strand's length, root mean square over vertices
    uint64_t hash;
    uint64_t laid; ///< strands laid out from the root so far
    int halted_at;
} strands_line;

/// Medians of passes, for the table of kernels.
typedef struct strands_kernel_times
{
    int pass_count;
    struct
    {
        char name[64];
        double seconds[STRANDS_WORKERS_MAX];
    } passes[24];
} strands_kernel_times;

typedef struct strands_comparison_size
{
    int strands;
    int setting_count;
    strands_line ours[STRANDS_SETTINGS_MAX];
    strands_kernel_times kernels[STRANDS_SETTINGS_MAX];
} strands_comparison_size;

/// Tables, rows and claims of a race.
void strands_comparison_write( const strands_plan* plan, const strands_comparison_size* sizes, int count,
                               results* out );
