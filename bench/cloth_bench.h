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
    int hang_sizes[CLOTH_SIZES_MAX], hang_count;             ///< compared with other engines
    int level_sizes[CLOTH_SIZES_MAX], level_count;           ///< levels and tethers
    int irregular_size;                                      ///< the same on an irregular mesh
    bool has_balloon;                                        ///< and on a balloon
    int sweep_size;                                          ///< residuals of sweeps
    scenario_plan scenario;
    int reference_factor;       ///< ratio of its substeps to those of the first setting
    int reference_vertices_max; ///< no reference beyond this many vertices
    int oracle_vertices_max;    ///< no double precision step beyond this many
    double comparison_seconds;  ///< of all sizes together
    int workers[SCENARIO_IMPLEMENTATIONS_MAX], worker_count;
    const bench_options* options; ///< for progress
} cloth_plan;

cloth_plan cloth_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status cloth_bench_run( const cloth_plan* plan, results* out, wisp_error* error );

// ---- the tables ----

/// ns per constraint and pass compared with scalar C in mesh order, with checks.
wisp_status cloth_comparison( const cloth_plan* plan, results* out, wisp_error* error );
/// A failure unless error <= tolerance; a NaN fails.
void cloth_check_error( double error, double tolerance, const char* what, results* out );
/// ms a step beside other engines.
wisp_status cloth_hang( const cloth_plan* plan, results* out, wisp_error* error );
/// Effect of levels, tethers and the solve order on error and time.
wisp_status cloth_levels( const cloth_plan* plan, results* out, wisp_error* error );
/// The same for a closed skin that is being inflated.
wisp_status cloth_levels_of_balloon( const cloth_plan* plan, results* out, wisp_error* error );
/// Residual after k passes.
wisp_status cloth_sweeps( const cloth_plan* plan, results* out, wisp_error* error );

// ---- shared by the tables ----

/// Time and error of another engine for the same cloth, with ten passes.
typedef struct cloth_peer
{
    double ms;                        ///< per step, one thread of the reference machine
    double stretch_max, stretch_mean; ///< %
} cloth_peer;

/// NvCloth unmodified, on a cloth of n x n. @return false if it was not measured
bool cloth_find_peer( int n, cloth_peer* out );
