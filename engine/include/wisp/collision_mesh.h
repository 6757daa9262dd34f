/// Triangle meshes to collide with: the closest point within a radius, with a sign that tells inside from outside, and
/// the first triangle that a path crosses. Answers are a pure function of mesh and query: they do not depend on what
/// searches, on how that was built, refitted, or walked, nor on the thread that asks.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Coordinates of a mesh, and of what is asked about it, may be so large and no larger, m.
#define WISP_COLLISION_MESH_REACH 1e9f

/// Opaque: a mesh and what searches its triangles.
typedef struct wisp_collision_mesh wisp_collision_mesh;

/// What finds the triangles that an answer may depend on. All give the same answers to the last bit.
typedef enum wisp_mesh_search
{
    WISP_MESH_SEARCH_TREE,   ///< a bounding volume tree; needs Embree
    WISP_MESH_SEARCH_VOXELS, ///< a grid of cubes, each with a list of the triangles that touch it (Zhang and Yuen 2000)
    WISP_MESH_SEARCH_COUNT,
} wisp_mesh_search;

/// A mesh. Copied; may die after the call. Points that coincide are different points: a surface is closed where its
/// triangles share indices.
typedef struct wisp_collision_mesh_def
{
    const wisp_vec3* points;  ///< [point_count] m, finite, within WISP_COLLISION_MESH_REACH
    const int32_t* triangles; ///< [triangle_count][3] indices into points, counter-clockwise seen from outside
    int point_count;
    int triangle_count; ///< >= 1. Triangles without area are allowed: they are found by distance, but never crossed
    bool deforms;       ///< points will move against each other; without it the mesh moves as a rigid body, if at all
    size_t memory_limit; ///< bytes that Embree may take beside the host's allocator, or that the voxels may take from
                         ///< it; 0: no limit. Voxels become larger to keep it
    wisp_mesh_search search; ///< default the tree
    float
        voxel_size; ///< m, > 0, the edge of a voxel; 0: the mean edge of the triangles. Voxels are larger where there
                    ///< would be more than 16 of them, or 64 places in their lists, a triangle
} wisp_collision_mesh_def;

/// Build a tree, or voxels. A rigid mesh is queried in its own frame (wisp_transform_to_local()) and its tree never changes.
/// @param allocator may be null; copied. Embree takes its nodes elsewhere: see memory_limit and wisp_collision_mesh_bytes()
/// @param tree receives the tree, null on failure
/// @param error may be null
/// @return WISP_BAD_INPUT a point, an index, the search or the size of voxels is wrong (the message names the first);
///         WISP_NO_MEMORY; WISP_CONFLICT a tree in a library that was built without Embree, or with one that cannot do
///         what is needed
WISP_API wisp_status wisp_collision_mesh_create( const wisp_collision_mesh_def* def, const wisp_allocator* allocator,
                                                 wisp_collision_mesh** tree, wisp_error* error );

/// Null is allowed.
WISP_API void wisp_collision_mesh_release( wisp_collision_mesh* tree );

/// Move the points of a mesh that deforms. The tree is refitted; when the queries since the last update found it to
/// have decayed (half again as many triangles looked at for an answer as when it was new), it is built again. Voxels
/// always are.
/// @param points [point_count] m. All are checked first: a wrong one leaves everything as it was
/// @return WISP_BAD_INPUT a point is not finite or out of reach; WISP_CONFLICT the mesh is rigid; WISP_NO_MEMORY
///         it could not be built again: points are where they were, but should Embree have no memory for their tree
///         either, queries are refused until an update succeeds
/// @note Not while queries run.
WISP_API wisp_status wisp_collision_mesh_update( wisp_collision_mesh* tree, const wisp_vec3* points,
                                                 wisp_error* error );

/// Bytes that the tree or the voxels hold, Embree's included.
WISP_API size_t wisp_collision_mesh_bytes( const wisp_collision_mesh* tree );

/// What is worth telling a user about a mesh and its tree.
typedef struct wisp_collision_mesh_stats
{
    int open_edge_count; ///< edges without exactly two triangles that run along them in opposite directions: with none
                         ///< the mesh is closed and has an inside
    int flat_triangle_count; ///< triangles without area
    int build_count, refit_count;
    wisp_mesh_search search;
    float voxel_size; ///< m, as it came to be; 0: no voxels
    int voxel_count;
    bool coarse; ///< voxels are larger than what was asked for
} wisp_collision_mesh_stats;

WISP_API wisp_collision_mesh_stats wisp_collision_mesh_get_stats( const wisp_collision_mesh* tree );

/// Sums over queries. Zero-initialise, and pass to any number of calls.
typedef struct wisp_collision_mesh_query_stats
{
    uint64_t queried;
    uint64_t answered; ///< had something near, or a triangle in their way
    uint64_t refused;  ///< not finite or out of reach: answered with nothing
    uint64_t tested;   ///< triangles looked at
} wisp_collision_mesh_query_stats;

/// Ask for the surface near a point.
typedef struct wisp_mesh_query
{
    wisp_vec3 point; ///< m
    float radius;    ///< m, >= 0, may be infinite: nothing farther away is looked for
} wisp_mesh_query;

/// The surface near a point. All zero with triangle -1 when there is nothing within the radius.
typedef struct wisp_mesh_nearest
{
    int32_t
        triangle;   ///< -1 for nothing. Of triangles at equal distance the lowest, and an edge or a corner is equally
                    ///< far in all triangles that share it
    float distance; ///< m, negative behind the surface. Closed meshes: inside, right up to edges and corners. Open
                    ///< ones: behind the facing side of what is nearest
    wisp_vec3 point;  ///< m, on the surface
    wisp_vec3 normal; ///< unit: the direction in which the distance grows. On a face its normal
    float weights[3]; ///< barycentric, of the triangle's corners
} wisp_mesh_nearest;

/// Find the closest points of the surface (signs: Baerentzen and Aanaes 2005, "Signed distance computation using the
/// angle weighted pseudonormal").
/// @param queries, nearest [count]
/// @param work may be null
/// @note Thread-safe against other queries: each worker asks for its own range.
WISP_API void wisp_collision_mesh_closest( wisp_collision_mesh* tree, const wisp_mesh_query* queries, int count,
                                           wisp_mesh_nearest* nearest, wisp_collision_mesh_query_stats* work );

/// A straight path, in the frame of the mesh. For a rigid body that moves, `from` is taken into the body by the old pose
/// and `to` by the new one.
typedef struct wisp_mesh_path
{
    wisp_vec3 from, to; ///< m
} wisp_mesh_path;

/// The first intersection of a path. All zero with triangle -1 when there is none.
typedef struct wisp_mesh_hit
{
    int32_t triangle; ///< -1 for nothing; the lowest of those crossed at the same time
    float time;       ///< in [0, 1], fraction of the path
    float side; ///< 1: the path comes from the front, which the normal of the triangle points to; -1: from behind
    wisp_vec3 point;  ///< m, where it crosses
    wisp_vec3 normal; ///< unit, of the triangle, towards the side the path comes from
    float weights[3]; ///< barycentric, of the triangle's corners
} wisp_mesh_hit;

/// Find the first intersection of each path. A point that lies exactly in a triangle's plane counts as in front of it, so
/// that of two paths that meet end to end on a face just one crosses. Paths without length cross nothing, and neither does one that runs
/// within a plane: what touches is found by wisp_collision_mesh_closest(), which belongs behind every sweep as a second net.
/// @param paths, hits [count]
/// @param work may be null
/// @note Thread-safe against other queries.
WISP_API void wisp_collision_mesh_cast( wisp_collision_mesh* tree, const wisp_mesh_path* paths, int count,
                                        wisp_mesh_hit* hits, wisp_collision_mesh_query_stats* work );

WISP_END_C
