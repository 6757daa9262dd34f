/// Table 1 of Noh and Jung: measurements of each cloth, and the tables made from them.
#pragma once

#include "bench_options.h"
#include "cells.h"
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
    bool is_timed; ///< otherwise only its iterations are used
    bool grows;    ///< a row of the table of growth
} triangle_drop;

/// Cloths and steps. triangle_default_plan() has those of the case; tests have smaller ones.
typedef struct triangle_plan
{
    triangle_drop drops[TRIANGLE_ROWS_MAX];
    int drop_count;
    int touch_step;   ///< growth is counted from this step on, when the smallest cloth hits the ball ...
    int growth_steps; ///< ... for this many, which every row of growth has
    struct
    {
        int vertices, steps;
    } hangs[TRIANGLE_ROWS_MAX]; ///< against scalar C
    int hang_count;
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
    double growth_mean; ///< iterations per step over the steps of growth
    int contacts;       ///< vertices that stick, slide or land in the last step
    uint64_t unsolved, indefinite;
    uint64_t hash;
} triangle_line;

/// A hanging cloth compared with scalar C, one worker each.
typedef struct triangle_hang
{
    int vertices, links, steps;
    stats_summary plain_ms, ms;
    double plain_mean_ms, mean_ms;
    double plain_iterations, iterations; ///< per step
    int64_t plain_unsolved;              ///< steps of scalar C that did not end at their tolerance
    uint64_t unsolved, indefinite;
    double max_distance, distance_rms; ///< m, between both at the end
    uint64_t hash;
} triangle_hang;

/// All tables of a plan.
wisp_status paper_triangle_run( const triangle_plan* plan, results* out, wisp_error* error );
/// The plan of the case.
wisp_status paper_triangle_cloth( const bench_options* options, results* out, wisp_error* error );

/// Run the falling cloths. @param lines [drop_count]
wisp_status triangle_drop_all( const triangle_plan* plan, triangle_line* lines, results* out, wisp_error* error );
/// Run the hanging cloths against scalar C. @param hangs [hang_count]
wisp_status triangle_hang_all( const triangle_plan* plan, triangle_hang* hangs, results* out, wisp_error* error );

/// Tables, rows and messages.
void triangle_report( const triangle_plan* plan, const triangle_line* lines, const triangle_hang* hangs,
                      results* out );
