/// The case `boundary`: how densely a layer of boundary particles covers its surface.
#pragma once

#include "surfaces.h"

#include "boundary/boundary.h"

#define LAYER_RADIUS 2.5f ///< m, of the paper's sphere

/// How densely a layer covers its surface.
typedef struct layer_cover
{
    double gap; ///< m, the largest between neighbours along an edge, its ends included
    /// m, the largest distance of a sampled position of a triangle from the points and corners on it
    double reach;
} layer_cover;

/// @param mesh the user's, at the positions of the layer
wisp_status layer_find_cover( const wisp_boundary_view* view, const wisp_mesh* mesh, layer_cover* out,
                              wisp_error* error );
