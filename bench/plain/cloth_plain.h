/// Cloth by links in scalar C: arrays of float3, links in the order of the mesh, one after another on one thread. The
/// engine is compared with this on the same scene.
#pragma once

#include "wisp/base.h"

typedef struct plain_link
{
    int a, b;
    float rest;      ///< m
    float stiffness; ///< in [0, 1]
} plain_link;

typedef struct plain_cloth
{
    int vertex_count, link_count;
    wisp_vec3* position; ///< m
    wisp_vec3* previous;
    wisp_vec3* velocity; ///< m/s
    float* inverse_mass; ///< 1/kg, 0 is pinned
    plain_link*
        links; ///< structural edges, then opposite vertices of interior edges, both in the order of the triangles
    int edge_count;    ///< this many first links are edges
    wisp_vec3 gravity; ///< m/s^2
    int substeps, passes;
} plain_cloth;

/// @param triangles [triangle_count][3] @param bend_stiffness of the links across edges
/// @return false without memory
bool plain_cloth_create( plain_cloth* cloth, const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                         int triangle_count, float mass, float bend_stiffness );
void plain_cloth_destroy( plain_cloth* cloth );
void plain_cloth_pin( plain_cloth* cloth, int vertex );

/// One pass over all links.
void plain_cloth_project( plain_cloth* cloth );
/// One step of substeps, each with passes.
void plain_cloth_step( plain_cloth* cloth, float seconds );
