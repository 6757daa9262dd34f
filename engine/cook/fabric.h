/// Stages of cooking a fabric, in the order in which they run, and the list of its arrays.
#pragma once

#include "fabric_parts.h"

#include <stdatomic.h>

/// Maximum counts. Slots times 4, three corners per triangle, and groups of eight with a single constraint all stay
/// below 2^31.
#define FABRIC_MAX_VERTICES ( 1 << 26 )
#define FABRIC_MAX_TRIANGLES ( 1 << 25 )
/// m, maximum magnitude of a coordinate
#define FABRIC_MAX_COORDINATE 1e6f

#define FABRIC_MIN_TILE 64
#define FABRIC_MAX_TILE 65536

/// A fabric with its reference count and its memory.
typedef struct cook_fabric
{
    wisp_fabric fabric; // first, so that both have the same address
    fabric_pool keep;
    fabric_pool edges, hinges, rings, spans, strips; // arrays on request
    atomic_flag is_making;                           // a thread makes them
    atomic_uint made;                                // wisp_fabric_arrays that are there
    atomic_int owners;
} cook_fabric;

/// Round a count up to whole groups of lanes.
static inline int fabric_padded( int count )
{
    return ( count + WISP_FABRIC_LANES - 1 ) / WISP_FABRIC_LANES * WISP_FABRIC_LANES;
}

/// Return the number of tiles of a size that hold a number of vertices.
static inline int fabric_tiles( int vertex_count, int tile_size )
{
    return vertex_count / tile_size + ( vertex_count % tile_size != 0 ? 1 : 0 );
}

// ---- fabric.c ----

/// Cook a checked definition.
/// @param like null: the order is found; else it is that of this fabric, which has the same vertices
wisp_status fabric_cook_checked( const wisp_fabric_def* def, const wisp_fabric* like, const wisp_allocator* allocator,
                                 wisp_fabric** out, wisp_error* error );

// ---- fabric_mesh.c ----

/// Neighbours of vertices, without duplicates.
typedef struct fabric_graph
{
    int count;
    const int32_t* begin;     ///< [count + 1]
    const int32_t* neighbour; ///< [begin[count]]
} fabric_graph;

/// Build the graph of vertices that share a triangle. Lists are in no particular order.
/// @param triangles [triangle_count][3], checked
bool fabric_graph_make( fabric_pool* pool, const int32_t* triangles, int triangle_count, int vertex_count,
                        fabric_graph* out );

/// Renumber a graph and sort its lists in the order of `sequence`. Uses no comparisons, so a vertex with a million
/// neighbours costs as much as a million vertices.
/// @param sequence [count] permutation of the vertices; null: they keep their numbers
/// @param name [count] new index of every vertex; null likewise
bool fabric_graph_relist( fabric_pool* pool, const fabric_graph* graph, const int32_t* sequence, const int32_t* name,
                          fabric_graph* out );

/// Build edges and hinges, and count open and nonmanifold edges.
/// @param graph by slot, lists in increasing order
/// @param across whether to compute lengths of edges to neighbours and triangles across edges
bool fabric_mesh_connect( const fabric_graph* graph, bool across, fabric_pool* scratch, cook_fabric* cooked,
                          fabric_mesh* out );

/// List the triangles at every vertex of a checked fabric, in the user's order: corner_begin and corner of the
/// mesh.
bool fabric_mesh_list_corners( const wisp_fabric* fabric, fabric_pool* scratch, fabric_mesh* mesh );

/// Compute the area of each vertex: a third of the areas of its triangles.
bool fabric_mesh_measure_areas( const fabric_mesh* mesh, fabric_pool* scratch, cook_fabric* cooked );

/// Triangles around every vertex as fans, see wisp_fabric.
typedef struct fabric_rings
{
    const int32_t* begin;                          ///< [slice + 1]
    const int32_t ( *ring_x4 )[WISP_FABRIC_LANES]; ///< [begin[last]]
} fabric_rings;

/// Build the fans in linear time, even if one vertex has all triangles.
/// @param fabric provides counts and triangles
/// @param mesh provides corners
/// @param keep allocates the rings
bool fabric_rings_list( const wisp_fabric* fabric, const fabric_mesh* mesh, fabric_pool* scratch, fabric_pool* keep,
                        fabric_rings* out );

// ---- fabric_order.c ----

/// Compute the Cuthill-McKee order: breadth first from the attachments, neighbours by degree, then by index.
/// Components follow each other, those with attachments first; unreferenced vertices are last.
/// @param attachments vertices, duplicates allowed
/// @param vertex_slot, slot_vertex [graph->count] output
bool fabric_order_vertices( const wisp_allocator* allocator, const fabric_graph* graph, const int32_t* attachments,
                            int attachment_count, int32_t* vertex_slot, int32_t* slot_vertex );

/// Return the default tile size for a number of vertices.
int fabric_choose_tile_size( int vertex_count );

// ---- fabric_schedule.c ----

/// Walk the triangles of every tile in strips.
/// @param keep allocates the strips
bool fabric_strips_build( const wisp_fabric* fabric, fabric_pool* keep, wisp_strips* out );

/// List slots of constraints in schedule order: [schedule->slot_count / 8][arity][8]; padding is the dummy of the tile.
bool fabric_schedule_corners( const wisp_schedule* schedule, const fabric_constraints* constraints, fabric_pool* keep,
                              const int32_t** out );
