/// The case `cloth`: its sizes and tables.
#pragma once

#include "bench_options.h"
#include "cells.h"
#include "cloth_scene.h"

#define CLOTH_SIZES_MAX 8

/// Allowed error of float relative to double in one step of ten substeps, in roundings (FLT_EPSILON) of the farthest
/// coordinate. The engine stays below three.
#define CLOTH_TOLERATED_ROUNDINGS 16.0

/// Sizes and steps. cloth_default_plan() has those of the case; tests have smaller ones.
typedef struct cloth_plan
{
    int comparison_sizes[CLOTH_SIZES_MAX], comparison_count; ///< against scalar C
    scenario_plan scenario;
    int oracle_vertices_max;   ///< no double precision step beyond this many
    double comparison_seconds; ///< of all sizes together
    int workers[SCENARIO_IMPLEMENTATIONS_MAX], worker_count;
    const bench_options* options; ///< for progress
} cloth_plan;

cloth_plan cloth_default_plan( const bench_options* options );

/// All tables of a plan; the case has those of data/suites/cloth too.
wisp_status cloth_bench_run( const cloth_plan* plan, results* out, wisp_error* error );

// ---- the tables ----

/// ns per constraint and pass compared with scalar C in mesh order, with checks.
wisp_status cloth_comparison( const cloth_plan* plan, results* out, wisp_error* error );
/// A failure unless error <= tolerance; a NaN fails.
void cloth_check_error( double error, double tolerance, const char* what, results* out );
