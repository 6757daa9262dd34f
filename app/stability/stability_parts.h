/// Shared by the files that measure a body, and private to them.
#pragma once

#include "stability_trace.h"

#include "wisp/module/module.h"

#include <math.h>

/// The vertices of a body: those of a surface by slots of its fabric, those of strands in the user's order.
struct stability_reader
{
    int body, count;
    wisp_entity entity;
    const wisp_fabric* fabric;               ///< null: strands
    const wisp_strand_topology* strands;     ///< null: a surface
    const wisp_scene_surface* surface;       ///< its entry; null: strands
    const wisp_scene_strands* hair;          ///< likewise
    wisp_vec3 *rest, *now, *before, *motion; ///< [count] m; before: the last time; motion: m/s
    double* weight;                          ///< [count] 1/kg, 0: held
    int32_t* edges;                          ///< [edge_count][2]
    int edge_count;
    bool moves; ///< by itself: else only `now` counts
};
