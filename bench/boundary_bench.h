/// The case `boundary`: the figures of the boundary particle source (BND section 9) as experiments, and what points
/// cost.
#pragma once

#include "bench.h"
#include "boundary_scene.h"
#include "cells.h"

#define BOUNDARY_SIZES_MAX 8
#define BOUNDARY_WORKERS_MAX 2

/// Sizes and steps. boundary_default_plan() has those of the case; tests have smaller ones.
typedef struct boundary_plan
{
    float spacings[BOUNDARY_SIZES_MAX]; ///< m, of points on the reference sphere
    int spacing_count;
    int segments[BOUNDARY_SIZES_MAX], sphere_count; ///< rising: spheres whose normals are looked at
    int pulse_steps;                                ///< of a pulsation that is counted, multiples of LAYER_PERIOD
    int settle_steps;                               ///< of a balloon whose volume is read
    double hang_seconds;                            ///< simulated, of a balloon that hangs
    double cost_seconds, pulse_seconds, adaptive_seconds; ///< about how long times are taken
    int workers[BOUNDARY_WORKERS_MAX], worker_count;
    int picture_side;             ///< pixels, of one of several pictures; a single one has twice as many
    const bench_options* options; ///< for progress and pictures
} boundary_plan;

boundary_plan boundary_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status boundary_bench_run( const boundary_plan* plan, results* out, wisp_error* error );

typedef wisp_status boundary_fn( const boundary_plan* plan, results* out, wisp_error* error );

boundary_fn boundary_inflate; ///< B1: 1 -> 2 -> 1 with a gust: counts follow lengths, points stay on the surface
boundary_fn boundary_volumes; ///< BND-01: the volume that a multiplier comes to, with a soft skin and the source's
boundary_fn boundary_counts;  ///< B2, B3: points of an edge, and inside four triangles
boundary_fn
    boundary_normals;       ///< B4: the angle between a point's normal and its direction, on finer and finer spheres
boundary_fn boundary_costs; ///< B5: points, time and memory by spacing; accuracy against cost
boundary_fn boundary_adaptive; ///< B5: uniform spacing beside spacing by curvature, on the scanned body
boundary_fn boundary_pulses;   ///< B6: a radius that pulsates: elements in case B, time of A against B, hysteresis
boundary_fn boundary_steps;    ///< B7: long steps and strong gravity; the layer changes nothing
boundary_fn boundary_pictures; ///< what layers look like, if there is a folder for it
