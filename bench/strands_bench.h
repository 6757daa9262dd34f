/// The case `strands`: its sizes, its settings, and the tables it is made of.
#pragma once

#include "bench_options.h"
#include "cells.h"
#include "strands_setting.h"

#define STRANDS_SIZES_MAX 8
#define STRANDS_WORKERS_MAX 2

/// Sizes and steps. strands_default_plan() has those of the case; tests have smaller ones.
typedef struct strands_plan
{
    int sizes[STRANDS_SIZES_MAX], size_count; ///< strands in the race
    int scenario_steps;       ///< of the race before times are taken, at least STRANDS_REFERENCE_STEPS
    int scenario_strands;     ///< more strands than these stop at STRANDS_REFERENCE_STEPS
    int few_settings_strands; ///< more strands than these race with the first few settings only
    int few_settings;
    double comparison_seconds; ///< of all sizes together
    int suite_count;           ///< of the suites, the largest one last
    double suite_seconds;      ///< of all suites
    int workers[STRANDS_WORKERS_MAX], worker_count;
    const bench_options* options; ///< for progress
} strands_plan;

/// Chaotic motion tells nothing about a solver: distances to the reference are taken after a quarter of a second.
#define STRANDS_REFERENCE_STEPS 15
#define STRANDS_REFERENCE_SUBSTEPS 160
/// Strands do not touch, so this many first ones represent all of them.
#define STRANDS_REFERENCE_STRANDS 512

strands_plan strands_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status strands_bench_run( const strands_plan* plan, results* out, wisp_error* error );

// ---- the tables ----

/// Solvers by size, beside other engines; then the kernels alone.
wisp_status strands_comparison( const strands_plan* plan, results* out, wisp_error* error );
/// The suites in data/suites/strands: stretch and energy of falling chains, guides and ghosts against full simulation (extension, not in
/// Park and Kim 2024).
wisp_status strands_suites( const strands_plan* plan, results* out, wisp_error* error );
/// Say whether a million vertices take as little time as is claimed. @param first_row of the suites
void strands_claim_million( int first_row, results* out );
