/// The case `balloon`: its sizes and tables.
#pragma once

#include "balloon_scene.h"
#include "bench_options.h"
#include "cells.h"

#define BALLOON_SIZES_MAX 8

/// The skin compresses the gas, at fill 1.2 by 2.5 % of its volume; the volume itself must be within 1 %.
#define BALLOON_TOLERATED_VOLUME 0.035

/// balloon_default_plan() has the sizes of the case; tests have smaller ones.
typedef struct balloon_plan
{
    int levels[BALLOON_SIZES_MAX], level_count; ///< of icospheres
    int settle_steps;                           ///< of the pressure table
    int substeps_max;                           ///< rows of the pressure table above this are left out
    double seconds;                             ///< of all sizes together
    int workers[SCENARIO_IMPLEMENTATIONS_MAX], worker_count;
    const bench_options* options;
} balloon_plan;

balloon_plan balloon_default_plan( const bench_options* options );
wisp_status balloon_bench_run( const balloon_plan* plan, results* out, wisp_error* error );

/// ms per step against vertices, with volume and pressure.
wisp_status balloon_sizes( const balloon_plan* plan, results* out, wisp_error* error );
/// Pressure by its three readings against substeps and iterations.
wisp_status balloon_pressures( const balloon_plan* plan, results* out, wisp_error* error );
