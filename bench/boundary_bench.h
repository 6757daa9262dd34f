/// The case `boundary`: the experiments of the boundary particle paper, and the cost of points.
#pragma once

#include "bench_options.h"
#include "boundary_scene.h"
#include "cells.h"

#define BOUNDARY_SIZES_MAX 8
#define BOUNDARY_WORKERS_MAX 2

/// Sizes and steps. boundary_default_plan() has those of the case; tests have smaller ones.
typedef struct boundary_plan
{
    float spacings[BOUNDARY_SIZES_MAX]; ///< m, of points on the reference sphere
    int spacing_count;
    int segments[BOUNDARY_SIZES_MAX], sphere_count; ///< rising: spheres whose normals are measured
    int pulse_steps;                                ///< of a pulsation that is counted, multiples of LAYER_PERIOD
    int settle_steps;                               ///< of a balloon whose volume is measured
    double hang_seconds;                            ///< simulated, of a balloon that hangs
    double cost_seconds, pulse_seconds, adaptive_seconds; ///< approximate time for the measurements
    int workers[BOUNDARY_WORKERS_MAX], worker_count;
    int picture_side;             ///< pixels, of one of several pictures; a single one has twice as many
    const bench_options* options; ///< for progress and pictures
} boundary_plan;

boundary_plan boundary_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status boundary_bench_run( const boundary_plan* plan, results* out, wisp_error* error );

typedef wisp_status boundary_fn( const boundary_plan* plan, results* out, wisp_error* error );

boundary_fn boundary_inflate;  ///< 1 -> 2 -> 1 with a gust: counts follow lengths, points stay on the surface
boundary_fn boundary_volumes;  ///< the volume that each multiplier reaches, with a soft skin and that of the paper
boundary_fn boundary_counts;   ///< points of an edge, and inside four triangles
boundary_fn boundary_normals;  ///< the angle between a point's normal and its direction, on increasingly fine spheres
boundary_fn boundary_costs;    ///< points, time and memory by spacing; accuracy against cost
boundary_fn boundary_adaptive; ///< uniform spacing compared with spacing by curvature, on the scanned body
boundary_fn boundary_pulses;   ///< a radius that pulsates: elements in case B, time of A against B, hysteresis
boundary_fn boundary_steps;    ///< long steps and strong gravity; the layer changes nothing
boundary_fn boundary_pictures; ///< pictures of layers, if there is a folder for them
