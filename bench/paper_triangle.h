/// Table 1 of Noh and Jung: measurements of each cloth, and the tables made from them.
#pragma once

#include "bench.h"
#include "bench_output.h"
#include "stats.h"

#define TRIANGLE_ROWS_MAX 12
#define TRIANGLE_WORKERS_MAX 2

/// A cloth that falls onto the ball.
typedef struct triangle_drop
{
    int vertices; ///< of an irregular triangle mesh; 0: the quad mesh of Noh and Jung
    float stretch_stiffness;
    double source_ms; ///< NaN for cloths that are not in Noh and Jung
    int steps;
} triangle_drop;

/// Cloths and steps. triangle_default_plan() has those of the case; tests have smaller ones.
typedef struct triangle_plan
{
    triangle_drop drops[TRIANGLE_ROWS_MAX];
    int drop_count;
    int workers[TRIANGLE_WORKERS_MAX], worker_count;
    const bench_options* options; ///< for progress
} triangle_plan;

triangle_plan triangle_default_plan( const bench_options* options );

/// Measurements of a cloth on the ball. Arrays are by worker count.
typedef struct triangle_line
{
    const triangle_drop* drop;
    int vertices, stretch_links, bend_links;
    stats_summary ms[TRIANGLE_WORKERS_MAX]; ///< per step, over all of them
    double mean_ms[TRIANGLE_WORKERS_MAX];
    double iteration_ns[TRIANGLE_WORKERS_MAX]; ///< of the solver's pass, per vertex and iteration: median over steps
    double pass_ms[TRIANGLE_WORKERS_MAX];      ///< mean of that pass
    double iterations_mean;                    ///< per step
    int max_iterations;
    int contacts; ///< vertices that stick, slide or land in the last step
    uint64_t unsolved, indefinite;
    uint64_t hash;
} triangle_line;

/// All tables of a plan.
wisp_status paper_triangle_run( const triangle_plan* plan, results* out, wisp_error* error );
