/// Shared by the stages of cooking: memory, the mesh in slots, and the builder of schedules.
#pragma once

#include "wisp/fabric.h"

typedef struct fabric_block fabric_block;

/// Arrays that are released together. Zero-initialise with the allocator.
typedef struct fabric_pool
{
    const wisp_allocator* allocator; ///< null: the C library
    fabric_block* last;
    size_t bytes; ///< of all blocks, as they were asked for
} fabric_pool;

/// An array of the pool, 64-byte aligned, not initialised. An array of no elements is a valid address too.
/// @return null without memory, or when the product overflows
void* fabric_pool_push( fabric_pool* pool, size_t count, size_t element_size );
/// The same, all bytes 0.
void* fabric_pool_push_zeroed( fabric_pool* pool, size_t count, size_t element_size );
/// Give all arrays back; the pool is empty and may be used again.
void fabric_pool_release( fabric_pool* pool );

/// Neighbours of vertices, in slots. Unreferenced vertices have no neighbours and no corners.
typedef struct fabric_mesh
{
    int vertex_count, triangle_count;
    const int32_t* neighbour_begin; ///< [vertex_count + 1]
    const int32_t* neighbour;       ///< rising at each vertex, each neighbour once
    const float* neighbour_length;  ///< m, beside neighbour; null when neither tethers nor levels are asked for
    const int32_t* corner_begin;    ///< [vertex_count + 1]
    const int32_t* corner;          ///< triangle * 3 + place of the vertex in it, rising at each vertex
    /// [triangle_count][3] the triangle across the edge from place k to place k + 1 (modulo 3); -1 at borders and wild
    /// edges; null when neither tethers nor levels are asked for
    const int32_t* across;
} fabric_mesh;

/// What a part gets to work with. The fabric's counts, maps, rest, area, triangles, edges, hinges and attachments are
/// in place when tethers and levels are cooked.
typedef struct fabric_parts
{
    const fabric_mesh* mesh;
    fabric_pool* keep;               ///< the fabric's own arrays
    const wisp_allocator* allocator; ///< for scratch memory, best in a pool of one's own
} fabric_parts;

/// Constraints to bring into the order of projection.
typedef struct fabric_constraints
{
    const int32_t* slots; ///< [count][arity], each a vertex below vertex_count, of which one may stand twice in a row
    int count, arity;     ///< arity 2 or 4
    int vertex_count;
    /// Slots a tile; a constraint belongs to the tile of its smallest slot. 0: no tiles; then each colour is a tile of
    /// its own in which no two constraints share a vertex, so that it may be cut between any two groups.
    int tile_size;
    wisp_solve_order solve_order; ///< within tiles; ignored without tiles
    int last_slots; ///< sweep by colour: what touches one of the first so many slots comes last in its tile
} fabric_constraints;

/// Every constraint once, in groups of WISP_FABRIC_LANES that share no vertex; -1 pads, never a tile's first slot.
/// @param keep receives the arrays of the schedule
/// @param out without constraints: no tiles, no colours, and arrays that say so
/// @return false without memory
bool fabric_schedule_build( const fabric_constraints* constraints, fabric_pool* keep, wisp_schedule* out );

/// Links in the order of their schedule, ready for lanes.
typedef struct fabric_links
{
    const int32_t *a_x4,
        *b_x4;         ///< [schedule.slot_count]; pads are the dummy of the tile, without tiles the first dummy
    const float* rest; ///< [schedule.slot_count] pads are 0
} fabric_links;

/// @param constraints as the schedule was built from, arity 2
/// @param rest [constraints->count] m
/// @return false without memory
bool fabric_schedule_links( const wisp_schedule* schedule, const fabric_constraints* constraints, const float* rest,
                            fabric_pool* keep, fabric_links* out );

/// Fill tether_count, tether4 and tether_rest; tether_count 0 (and arrays of no elements) without attachments.
/// @return false without memory
bool fabric_cook_tethers( const fabric_parts* parts, wisp_fabric* fabric );

/// Fill level_count and levels, at most `limit` of them, 1 .. WISP_FABRIC_MAX_LEVELS.
/// @param finest the first one's vertices are about 2^finest edges apart
/// @return false without memory
bool fabric_cook_levels( const fabric_parts* parts, int finest, int limit, wisp_fabric* fabric );
