/// One run of a comparison's scene in double precision, with its samples.
#pragma once

#include "compare_reference.h"

typedef struct reference_plan
{
    triangle_oracle_integrator integrator;
    double rate;      ///< steps per second in the window
    double rest_rate; ///< after it, until the last sample
    bool has_rest;    ///< otherwise the last sample is left at 0
} reference_plan;

/// @param points [observation_count][vertex_count][3] in double; the last sample is the one at rest. The caller frees it
/// @return WISP_CONFLICT a step did not converge
wisp_status reference_run( const compare_scene* scene, const reference_plan* plan, compare_reference* out,
                           double** points, wisp_error* error );

/// Root mean square distance of two samples, m.
double reference_distance( const double* a, const double* b, int vertex_count );
