/// The ways to solve one cloth that are compared.
#pragma once

#include "bench_options.h"
#include "compare_reference.h"

#define COMPARE_VARIANTS_MAX 64
#define COMPARE_WORKERS_MAX 2

typedef enum compare_method
{
    COMPARE_PBD,
    COMPARE_XPBD,
    COMPARE_IMPLICIT,
    COMPARE_METHOD_COUNT,
} compare_method;

extern const char* const compare_method_names[COMPARE_METHOD_COUNT];

/// A way to solve it.
typedef struct compare_variant
{
    char name[48];
    compare_method method;
    int substeps;    ///< pbd, xpbd: of a frame
    float stiffness; ///< pbd: of the edges, in (0, 1]
    int rate;        ///< implicit: steps a second
    float tolerance; ///< implicit: of a linear solve
    int repeats;     ///< implicit: linear solves a step
    bool bdf2;       ///< implicit
    bool is_limit;   ///< enough substeps that the remaining error is the model's: left out of the summaries
    bool has_rest;   ///< goes on until the scene is at rest
} compare_variant;

typedef struct compare_plan
{
    compare_scenario scenarios[COMPARE_SCENARIO_COUNT];
    int scenario_count;
    compare_variant variants[COMPARE_VARIANTS_MAX];
    int variant_count;
    int workers[COMPARE_WORKERS_MAX], worker_count;
    int rounds_max;               ///< of the window, each from the start; one is made in any case
    double seconds;               ///< of all scenarios together: no new round after this
    const char* folder;           ///< of the reference files
    const bench_options* options; ///< for progress
} compare_plan;

compare_plan compare_default_plan( const bench_options* options );
/// Add a way to solve it; more than COMPARE_VARIANTS_MAX is an assert. The name is filled in.
void compare_add_variant( compare_plan* plan, compare_variant variant );
