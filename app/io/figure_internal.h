/// Private to the figure: its body as a field, and the mesh of a field. Heights are 1.
#pragma once

#include "figure.h"
#include "mesh_internal.h"

/// Signed distance, about, and its gradient.
typedef struct figure_sample
{
    double distance; ///< negative inside
    mesh_vector gradient;
} figure_sample;

/// @param context of figure_mesh()
typedef figure_sample figure_field( const void* context, mesh_vector p );

/// Mesh the zero level of a field by dual marching cubes and even it out.
/// @param cell edge length of the cubes
/// @return WISP_NO_MEMORY
wisp_status figure_mesh( figure_field* field, const void* context, mesh_vector lower, mesh_vector upper, double cell,
                         wisp_mesh* out, wisp_error* error );

/// The whole body. @param context const double*: the least radius of a part
figure_sample figure_body( const void* context, mesh_vector p );

/// Skeleton of height 1, and how a point of the surface follows it: at most four weights above 0, sum 1.
void figure_weights( mesh_vector p, int32_t joints[4], float weights[4] );
