/// Cloth of Noh and Jung without a ball: it hangs, and its shape after a time is compared.
#pragma once

#include "figures_drape.h"

/// Where it is held.
typedef enum hang_form
{
    HANG_SIDE,    ///< along the side of least z
    HANG_CORNERS, ///< by that side's two ends
    HANG_ROUND,   ///< along all four sides
} hang_form;

typedef struct hang_plan
{
    hang_form form;
    bool is_upright; ///< hangs straight down at the start; else it is level, and swings
    wisp_implicit_cloth_def cloth;
    float seconds; ///< a step
    int steps;
} hang_plan;

typedef struct hang_result
{
    wisp_vec3* points;     ///< [vertex_count] at the end, the caller's to free
    double iterations, ms; ///< of all steps together
} hang_result;

wisp_status hang_run( const triangle_scene* scene, const hang_plan* plan, hang_result* out, wisp_error* error );
