/// The drawn form of strands.
#pragma once

#include "trace.h"

/// Straight pieces that a segment is drawn with: several for hair.
int curves_pieces( const render_curves* curves );

/// Points of the pieces. Vertex v is point v * pieces, and the points between it and the next vertex follow it.
/// @param points [vertex count * pieces][4]: x, y, z, radius
void curves_fill( const render_curves* curves, const trace_widening* widening, float* points );
