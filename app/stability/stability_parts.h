/// Shared by the files that measure a body, and private to them.
#pragma once

#include "stability_trace.h"

#include "balloon.h"
#include "contact.h"
#include "implicit_cloth.h"
#include "tearing.h"

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

/// What a body is after a step, for measures that must come near a value.
struct stability_seen
{
    const scene_world* world;
    wisp_entity entity;
    scene_body shape;
    const wisp_vec3 *at, *start; ///< [vertex_count] m
    const stability_sample* sample;
    wisp_motion_stats motion;
    wisp_balloon_stats balloon; ///< zero of what is none
    wisp_implicit_cloth_stats implicit;
    wisp_contact_stats contact;
    wisp_tearing_stats tearing;
};
