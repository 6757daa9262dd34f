/// How densely a layer covers its surface.
#pragma once

#include "boundary_scene.h"

typedef struct layer_cover
{
    double gap; ///< m, the largest between neighbours along an edge, its ends included
    /// m, the largest distance of a sampled position of a triangle from the points and corners on it
    double reach;
} layer_cover;

/// @param mesh the user's, at the positions of the layer
wisp_status layer_find_cover( const wisp_boundary_view* view, const wisp_mesh* mesh, layer_cover* out,
                              wisp_error* error );

/// The edge of two of the user's vertices.
int layer_find_edge( const wisp_boundary_view* view, int32_t a, int32_t b );
