// State of the module: the surfaces that tear, and what their rows hold.
#pragma once

#include "tearing.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

enum
{
    TEARING_MAX_SPLITS = 1000000,
};

typedef struct tearing_settings
{
    int32_t max_splits;
    int32_t split_count;
} tearing_settings;

/// Of the last step.
typedef struct tearing_result
{
    int32_t over_count;
    float max_load;
    float inverse_dt2; // 1/s^2, of the last substep
    int32_t is_new;    // 1: no split was made for it; the pass leaves halted and sleeping surfaces as they are
} tearing_result;

/// The components, a row each: X( member, "name", table, columns ).
#define TEARING_COMPONENTS( X )                                                                                      \
    X( settings, "tearing.settings", ENTITY, WISP_COLUMN( tearing_settings, settings, 1 ) )                          \
    X( strength, "tearing.strength", EDGE, WISP_COLUMN( float, strength, 1 ),                                        \
       /* N/m */ WISP_COLUMN( float, width, 1 ) /* m, that the edge stands for */ )                                  \
    X( limit, "tearing.limit", LINK, WISP_COLUMN( float, limit, 1 ) ) /* N; infinite: no edge */                     \
    X( result, "tearing.result", ENTITY, WISP_COLUMN( tearing_result, result, 1 ) )

typedef struct tearing_state
{
    TEARING_COMPONENTS( WISP_COMPONENT_MEMBER )
    const wisp_registry* registry;
} tearing_state;

/// The pass: compare links with their limits. (tearing_mesh.c)
void tearing_measure( wisp_frame* frame, const wisp_span* span, void* user );

/// Fill the limits of links from the strengths of edges. (tearing_mesh.c)
void tearing_fill_limits( wisp_world* world, const tearing_state* state, wisp_entity surface );

/// An edge above its strength.
typedef struct tearing_edge
{
    float load;          // tension by strength
    int32_t vertices[2]; // the user's order, the lower one first
    int32_t slots[2];    // of them
} tearing_edge;

/// List the edges above their strength, the largest load first. (tearing_mesh.c)
/// @param out [over_count of the result]
/// @return how many
int tearing_list_edges( wisp_world* world, const tearing_state* state, wisp_entity surface, tearing_edge* out );

/// Split vertices of a surface at the end of a step. (tearing_split.c)
wisp_status tearing_split( wisp_world* world, const tearing_state* state, wisp_entity surface );

// ---- tearing mesh ----

/// A mesh whose vertices split: triangles by slot, and which corners are at each vertex.

typedef struct tearing_mesh
{
    const wisp_fabric* fabric;
    int32_t* triangles;   ///< [triangle_count][3] slots
    int32_t* parents;     ///< [slot_count] of which slot of the fabric a vertex is a copy; itself
    int32_t *begin, *end; ///< [slot_count] corners of a vertex
    int32_t* corner;  ///< [3 triangle_count] 3 times triangle, and which corner; of a vertex in the order of its fans
    uint8_t* touched; ///< [slot_count] 1: near a split
    int spare_begin;  ///< vertices of the user below this one are in use
    void* memory;
    size_t bytes;
} tearing_mesh;

/// Consecutive corners of a vertex: corner i spans from spoke i to spoke i + 1.
typedef struct tearing_fan
{
    int32_t begin, end; ///< among the corners of the mesh
    bool is_closed;     ///< the last spoke is the first one
} tearing_fan;

/// @return false without memory
bool tearing_mesh_create( const wisp_fabric* fabric, const wisp_allocator* allocator, tearing_mesh* out );
void tearing_mesh_release( tearing_mesh* mesh, const wisp_allocator* allocator );

/// Put the corners of a vertex from `begin` on in the order of their next fan, and return that: open fans first, those with the lowest
/// triangle first.
tearing_fan tearing_next_fan( const tearing_mesh* mesh, int32_t vertex, int32_t begin );
/// @return the vertex at spoke `i` of a fan, 0 .. its triangles
int32_t tearing_spoke( const tearing_mesh* mesh, tearing_fan fan, int i );
/// @return how many fans the triangles of a vertex are
int tearing_count_fans( const tearing_mesh* mesh, int32_t vertex );

/// @return how many vertices are in no triangle
int tearing_count_spares( const tearing_mesh* mesh );
/// Move corners [begin, end) of a vertex to a new one, of which there is one left. They are at one end of its corners.
/// @return the new vertex
int32_t tearing_move_corners( tearing_mesh* mesh, int32_t vertex, int32_t begin, int32_t end );
