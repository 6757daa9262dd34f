/// Declarations shared by the stages that build a coarse level.
#pragma once

#include "fabric_geodesic.h"

/// Maximum number of coarse vertices stored per vertex, the nearest within reach: a flat mesh has six to eleven.
#define LEVEL_NEAR 16
/// Reach in spacings. Delaunay edges of a maximal subset are at most two spacings long; the margin keeps triangles
/// complete at seams.
#define LEVEL_REACH 2.4

/// Order in which vertices are selected.
enum
{
    LEVEL_ATTACHED,
    LEVEL_CORNER, ///< of an open edge
    LEVEL_BORDER,
    LEVEL_INSIDE,
    LEVEL_TURNS,
};

/// A coarse vertex nearby.
typedef struct level_near
{
    int32_t rank; ///< rank in the finer level
    float distance;
} level_near;

/// A level under construction. Ranks number the vertices of the finer level that are in a triangle, by increasing slot.
typedef struct level_maker
{
    const wisp_fabric* fabric;
    const fabric_mesh* mesh;
    double spacing;      ///< m, minimum distance between vertices of the coarse level
    double reach;        ///< m, closer vertices become neighbours and may be linked
    double margin;       ///< m, by which marches exceed the reach
    int fine_count;      ///< number of ranks
    const int32_t* fine; ///< [fine_count] slots, in increasing order
    bool* chosen;        ///< [fine_count] in the coarse level
    int32_t* members;    ///< [member_count] slots of the chosen ones
    int member_count;
    int32_t* row;                   ///< [fine_count] row in the coarse level, -1 if not chosen
    bool* covered;                  ///< [fine_count] closer than the spacing to a chosen vertex
    level_near* near;               ///< [fine_count][LEVEL_NEAR] by increasing distance, without the vertex itself
    uint8_t* near_count;            ///< [fine_count]
    uint8_t* turn;                  ///< [vertex_count] by slot, order of selection
    const wisp_vec3* normal;        ///< [vertex_count] by slot, of the rest shape, not of unit length
    const wisp_fabric_level* finer; ///< null: the mesh
} level_maker;

/// Make neighbour lists symmetric, so that no vertex has more neighbours than it stores, and set both distances to
/// the shorter one.
void level_agree( level_maker* maker );

/// Return the distance between two vertices. At a seam they may be too far apart to be neighbours though both are near a third
/// one; then it is the Euclidean distance.
double level_distance_or_straight( const level_maker* maker, int32_t rank_a, int32_t rank_b );

/// A link between chosen vertices.
typedef struct level_link
{
    int32_t a, b;   ///< ranks, a < b
    float rest;     ///< m
    float fraction; ///< of a link's stiffness
} level_link;

/// List links between chosen neighbours.
/// @param out room for half of the entries of their lists
/// @return number of links
int level_list_links( const level_maker* maker, level_link* out );

/// Schedule the links and find their chains.
/// @param links [count]
/// @return false if out of memory
bool level_make_links( const level_maker* maker, const level_link* links, int count, fabric_pool* keep,
                       wisp_fabric_level* out );

/// Build the net of the chosen vertices, whose slots it shares.
/// @return false if out of memory
bool level_make_net( const level_maker* maker, fabric_pool* pool, geodesic_net* out );
