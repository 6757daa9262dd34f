/// Shared by the stages that make a coarse level.
#pragma once

#include "fabric_geodesic.h"

/// Coarse vertices that a vertex remembers, the nearest ones within reach: six to eleven where the mesh is flat.
#define LEVEL_NEAR 16
/// In spacings. Edges of a Delaunay triangulation of a subset that cannot be extended are no longer than two; a
/// little more keeps triangles whole at seams.
#define LEVEL_REACH 2.4

/// In which turn vertices are chosen.
enum
{
    LEVEL_ATTACHED,
    LEVEL_CORNER, ///< of a border
    LEVEL_BORDER,
    LEVEL_INSIDE,
    LEVEL_TURNS,
};

/// A coarse vertex nearby.
typedef struct level_near
{
    int32_t rank; ///< its place in the finer level
    float distance;
} level_near;

/// One level in the making. Ranks number the vertices of the finer level that take part, by rising slot.
typedef struct level_maker
{
    const wisp_fabric* fabric;
    double spacing;      ///< m, between vertices of the coarse level
    double reach;        ///< m, nearer ones know each other and are linked
    double margin;       ///< m, that marches go beyond the reach
    int fine_count;      ///< ranks
    const int32_t* fine; ///< [fine_count] slots, rising
    bool* chosen;        ///< [fine_count] in the coarse level, and takes part in it
    bool* covered;       ///< [fine_count] nearer than the spacing to a chosen one
    level_near* near;    ///< [fine_count][LEVEL_NEAR] by rising distance; never the vertex itself
    uint8_t* near_count; ///< [fine_count]
    uint8_t* turn;       ///< [vertex_count] by slot
    bool* idle;          ///< [vertex_count] by slot: in every level, without a part in it
} level_maker;

/// Let chosen vertices know each other both ways or not at all, so that nobody has more neighbours than it remembers,
/// and agree on the shorter distance.
void level_agree( level_maker* maker );

/// The distance between two chosen vertices that agreed, endless when they do not know each other.
double level_distance( const level_maker* maker, int32_t rank_a, int32_t rank_b );

/// Links between chosen vertices that know each other.
/// @param slots, rest receive links; null to count only
/// @param linked receives how many vertices have one
/// @return how many links
int level_list_links( const level_maker* maker, int32_t* slots, float* rest, int* linked );

/// @param count of links
/// @return false without memory
bool level_make_links( const level_maker* maker, int count, fabric_pool* keep, wisp_fabric_level* out );

/// The chosen vertices as a net.
/// @param slots [count] of the chosen vertices, rising
/// @return false without memory
bool level_make_net( const level_maker* maker, const int32_t* slots, int count, fabric_pool* pool,
                     geodesic_net* out );

/// How the vertices that are not chosen follow those that are.
/// @return false without memory
bool level_make_children( const level_maker* maker, fabric_pool* keep, wisp_fabric_level* out );
