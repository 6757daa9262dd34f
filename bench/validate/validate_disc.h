/// A round specimen of cloth, held between discs in its middle, and its shadow.
#pragma once

#include "mesh.h"

/// A ring of cloth in y = 0 between a clamp and a border, cut into cells of one size on circles. Its vertices come circle by circle, the
/// two circles of the clamp first: one cell inside it, and its edge.
/// @param cells from the clamp to the border, at most 32
/// @param turn of the mesh in cells: each circle is turned by another part of it, so that another turn is another mesh
/// @param pin_count receives the number of vertices on the two circles of the clamp
/// @return WISP_NO_MEMORY
wisp_status disc_mesh( double clamp, double border, int cells, double turn, wisp_mesh* out, int* pin_count,
                       wisp_error* error );

/// Area of the shadow under a light from above, outside of a disc about the y axis, m^2: what several layers cover counts once.
/// @param points [mesh->vertex_count] within twice `border` of the axis
/// @return below 0: no memory
double disc_shadow( const wisp_mesh* mesh, const wisp_vec3* points, double disc, double border );
