/// Fabrics whose triangles change while vertices keep their slots.
#pragma once

#include "wisp/fabric.h"

/// Cook a fabric again with other triangles. Vertices keep their slots, so columns of particles stay as they are. Tethers and coarse
/// sheets are not made.
/// @param triangles [from->triangle_count][3] slots, three different ones each
/// @param parents [from->vertex_count] slot whose rest point each slot has from now on; itself where it keeps its own
/// @return WISP_NO_MEMORY
wisp_status fabric_change_triangles( const wisp_fabric* from, const int32_t* triangles, const int32_t* parents,
                                     const wisp_allocator* allocator, wisp_fabric** out, wisp_error* error );

/// For each edge, slot of links and slot of hinges of a fabric, the one of an earlier fabric that it comes from; -1 pads.
typedef struct fabric_origins
{
    int32_t *edges, *links, *hinges; ///< [edge_count], [link_order.slot_count], [hinge_order.slot_count]
    size_t bytes;                    ///< of the one block that `edges` begins
} fabric_origins;

/// Find them. Both fabrics have their edges. @return false without memory
bool fabric_find_origins( const wisp_fabric* from, const wisp_fabric* to, const int32_t* parents,
                          const wisp_allocator* allocator, fabric_origins* out );
void fabric_release_origins( fabric_origins* origins, const wisp_allocator* allocator );
