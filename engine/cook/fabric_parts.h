/// Declarations shared by the stages of cooking: memory, the mesh by slot, and schedules.
#pragma once

#include "wisp/fabric.h"

typedef struct fabric_block fabric_block;

/// Arrays that are released together. Zero-initialise, then set the allocator.
typedef struct fabric_pool
{
    const wisp_allocator* allocator; ///< null: the C library
    fabric_block* last;
    size_t bytes; ///< total requested size of all blocks
} fabric_pool;

/// Allocate an array, 64-byte aligned, not initialised. An empty array has a valid address too.
/// @return null if out of memory, or if the product overflows
void* fabric_pool_push( fabric_pool* pool, size_t count, size_t element_size );
/// Allocate an array filled with zeros.
void* fabric_pool_push_zeroed( fabric_pool* pool, size_t count, size_t element_size );
/// Release all arrays; the pool is empty and can be reused.
void fabric_pool_release( fabric_pool* pool );

/// Neighbours of vertices, by slot. Unreferenced vertices have no neighbours and no corners.
typedef struct fabric_mesh
{
    int vertex_count, triangle_count;
    const int32_t* neighbour_begin; ///< [vertex_count + 1]
    const int32_t* neighbour;       ///< neighbours of each vertex in increasing order, without duplicates
    const float* neighbour_length;  ///< m, parallel to neighbour; null if neither tethers nor levels are cooked
    const int32_t* corner_begin;    ///< [vertex_count + 1]
    const int32_t* corner;          ///< triangle * 3 + index of the vertex in it, in increasing order at each vertex
    /// [triangle_count][3] the triangle across the edge from corner k to corner k + 1 (modulo 3); -1 at open and
    /// nonmanifold edges; null if neither tethers nor levels are cooked
    const int32_t* across;
} fabric_mesh;

/// Input of a stage. The fabric's counts, maps, rest, area, triangles, edges, hinges and attachments are complete
/// when tethers and levels are cooked.
typedef struct fabric_parts
{
    const fabric_mesh* mesh;
    fabric_pool* keep;               ///< arrays of the fabric
    const wisp_allocator* allocator; ///< for scratch memory, preferably through a separate pool
    int workers;
} fabric_parts;

/// Constraints to be scheduled.
typedef struct fabric_constraints
{
    const int32_t* slots; ///< [count][arity], each a vertex below vertex_count; one may occur twice in a row of slots
    int count, arity;     ///< arity 2 to 4
    int vertex_count;
    /// Slots per tile; a constraint belongs to the tile of its smallest slot. 0: no tiles; then each colour is one
    /// tile without shared vertices, so it may be split between any two groups.
    int tile_size;
    wisp_solve_order solve_order; ///< within tiles; ignored without tiles
    int last_slots;               ///< sweep by colour: constraints with a slot below this come last in their tile
} fabric_constraints;

/// @return the triangles of a fabric as constraints, in the order of colours
static inline fabric_constraints fabric_triangle_constraints( const wisp_fabric* f )
{
    return ( fabric_constraints ){ .slots = f->triangles,
                                   .count = f->triangle_count,
                                   .arity = 3,
                                   .vertex_count = f->vertex_count,
                                   .tile_size = f->tile_size };
}

/// Schedule every constraint once, in groups of WISP_FABRIC_LANES that share no vertex. Padding is -1, never in a
/// tile's first slot.
/// @param keep, numbers allocate the arrays of the schedule: those of tiles and colours, and the numbers of constraints
/// @param out without constraints: no tiles, no colours, and valid arrays
/// @return false if out of memory
bool fabric_schedule_build( const fabric_constraints* constraints, fabric_pool* keep, fabric_pool* numbers,
                            wisp_schedule* out );

/// Links in schedule order, in the layout of kernels.
typedef struct fabric_links
{
    const int32_t *a_x4,
        *b_x4;         ///< [schedule.slot_count]; padding is the dummy of the tile, or the first dummy without tiles
    const float* rest; ///< [schedule.slot_count] m, padding is 0
} fabric_links;

/// @param constraints from which the schedule was built, arity 2
/// @param rest [constraints->count] m
/// @return false if out of memory
bool fabric_schedule_links( const wisp_schedule* schedule, const fabric_constraints* constraints, const float* rest,
                            fabric_pool* keep, fabric_links* out );

/// Compute tether_count and the tether arrays; without attachments tether_count is 0 and the arrays are empty.
/// @return false if out of memory
bool fabric_cook_tethers( const fabric_parts* parts, wisp_fabric* fabric );

/// Compute level_count and levels.
/// @return false if out of memory
bool fabric_cook_levels( const fabric_parts* parts, wisp_fabric* fabric );

// ---- fabric triangles ----

/// Fabrics whose triangles change while vertices keep their slots.

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
