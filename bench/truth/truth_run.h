/// One run of a comparison's scene in double precision, with its looks.
#pragma once

#include "compare_truth.h"

typedef struct truth_plan
{
    triangle_oracle_integrator integrator;
    double rate;      ///< steps a second in the window
    double rest_rate; ///< and after it, until the scene is looked at once more
    bool has_rest;    ///< else the last look is left at 0
} truth_plan;

/// @param points [look_count][vertex_count][3] in double; the last look is the one at rest. The caller frees it
/// @return WISP_CONFLICT a step did not converge
wisp_status truth_run( const compare_scene* scene, const truth_plan* plan, compare_truth* out, double** points,
                       wisp_error* error );

/// Root mean square distance of two looks, m.
double truth_distance( const double* a, const double* b, int vertex_count );
