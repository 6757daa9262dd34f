/// Search by a bounding volume hierarchy with eight children a node: of meshes that deform, and of rigid ones in a library without
/// Embree. Built once, by splits at the median of the rest shape, then refitted to the motion of each step. It allocates nothing
/// after the build.
///
/// Nodes have no pointers: triangles are in an order in which each run of 8 is a leaf, each run of 8 leaves a node, and so on.
/// So the bounds of the children of one node are one group of eight lanes (Ernst and Greiner 2008, "Multi bounding volume
/// hierarchies").
#pragma once

#include "mesh_search.h"

enum
{
    MESH_BVH_WIDTH = 8,
    MESH_BVH_MAX_LEVELS = 11, // 8^11 triangles are more than an int can count
};

/// Boxes of the children of one node. Empty where there is no child: lower is above upper.
typedef struct mesh_bvh_group
{
    float lower[3][MESH_BVH_WIDTH], upper[3][MESH_BVH_WIDTH]; ///< m
} mesh_bvh_group;

/// The triangles of a leaf over the motion.
typedef struct mesh_bvh_leaf
{
    float start[9][MESH_BVH_WIDTH],
        displacement[9][MESH_BVH_WIDTH]; ///< m, [3 corner + axis] where it starts, and how far it goes
    float shift[MESH_BVH_WIDTH];         ///< m, the longest way of a corner
} mesh_bvh_leaf;

typedef struct mesh_bvh
{
    const mesh_surface* surface;
    int32_t* triangle;      ///< [leaves][8], -1 behind the last
    mesh_bvh_leaf* leaves;  ///< [leaves]
    mesh_bvh_group* groups; ///< [group_count] leaves first, the root last
    int level_count;
    int first[MESH_BVH_MAX_LEVELS + 1]; ///< first group of each level; leaves are level 0
    int refit_count;
} mesh_bvh;

/// @param surface must not move in memory while the hierarchy exists
wisp_status mesh_bvh_build( mesh_bvh* bvh, const mesh_surface* surface, wisp_error* error );
/// A zero hierarchy is allowed.
void mesh_bvh_release( mesh_bvh* bvh );
size_t mesh_bvh_bytes( const mesh_bvh* bvh );

/// Fit all boxes to the points of the surface, from start to end of its motion.
/// @param parallel null: the calling thread
void mesh_bvh_refit( mesh_bvh* bvh, const wisp_parallel* parallel );

void mesh_bvh_find_closest( const mesh_bvh* bvh, mesh_closest* search );
/// The same, but boxes that are farther than `near` may be left out. Boxes hold the whole motion.
/// @return a lower bound of the distance from the search's time to the end of the motion, at most `near`, m
float mesh_bvh_find_approach( const mesh_bvh* bvh, mesh_closest* search, float near );
void mesh_bvh_find_intersection( const mesh_bvh* bvh, mesh_cast* search );

/// Where a search for overlaps is.
typedef struct mesh_bvh_overlap
{
    int32_t group[MESH_BVH_WIDTH * MESH_BVH_MAX_LEVELS]; ///< of its level
    int16_t level[MESH_BVH_WIDTH * MESH_BVH_MAX_LEVELS];
    int count; ///< 0: the search is over
} mesh_bvh_overlap;

static inline mesh_bvh_overlap mesh_bvh_overlap_begin( const mesh_bvh* bvh )
{
    mesh_bvh_overlap search;
    search.group[0] = 0;
    search.level[0] = (int16_t)( bvh->level_count - 1 );
    search.count = 1;
    return search;
}

/// Find triangles whose boxes, over the whole motion, overlap a box; call until search->count is 0.
/// @param most at least MESH_BVH_WIDTH
int mesh_bvh_next_overlaps( const mesh_bvh* bvh, mesh_bvh_overlap* search, const float lower[3], const float upper[3],
                            int32_t* triangles, int most );

// ---- edges and corners of a mesh that stick out, and their search by boxes ----

/// Sine of the angle between the normals of two faces up to which they count as one plane.
#define MESH_FEATURES_PLANE 0.01

typedef struct mesh_features
{
    mesh_bvh boxes; ///< of a mesh whose search has none; else zero
    uint8_t*
        candidates; ///< [triangle_count] bits 0 .. 2: edges, 3 .. 5: corners that the triangle stands for; null: not built
} mesh_features;

/// @param needs_boxes build a hierarchy of boxes too
/// @param surface must not move in memory while the features exist
wisp_status mesh_features_build( mesh_features* features, const mesh_surface* surface, bool needs_boxes,
                                 wisp_error* error );
void mesh_features_release( mesh_features* features, const mesh_surface* surface );
size_t mesh_features_bytes( const mesh_features* features, const mesh_surface* surface );

/// As wisp_collision_mesh_find_features().
int mesh_features_find( const mesh_features* features, const mesh_bvh* boxes, const float lower[3],
                        const float upper[3], bool corners, int32_t* out, int capacity );

/// As wisp_collision_mesh_feature() and wisp_collision_mesh_sides().
wisp_mesh_feature mesh_features_place( const mesh_surface* surface, int32_t feature, bool is_corner, float begin,
                                       float end );
wisp_mesh_sides mesh_features_sides( const mesh_surface* surface, int32_t feature, bool is_corner, double time );
