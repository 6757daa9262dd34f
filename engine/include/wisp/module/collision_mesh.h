/// For modules: triangle meshes to collide with, the closest point within a radius, with a signed distance, and the first triangle that a
/// path crosses. Results are a pure function of mesh and query: they depend neither on the search structure and its
/// history nor on the thread.
///
///     wisp_collision_mesh_def def = { .points = points, .point_count = n, .triangles = triangles, .triangle_count = m };
///     wisp_collision_mesh* mesh;
///     wisp_error error = { 0 };
///     if ( wisp_collision_mesh_create( &def, NULL, &mesh, &error ) == WISP_OK )
///     {
///         const wisp_mesh_query query = { .point = p, .radius = 0.1f };
///         wisp_mesh_nearest nearest;
///         wisp_collision_mesh_closest( mesh, &query, 1, &nearest, NULL );
///         wisp_collision_mesh_release( mesh );
///     }
#pragma once

#include "wisp/module/jobs.h"
#include "wisp/module/kernels.h"
#include "wisp/module/shapes.h"

WISP_BEGIN_C

/// Largest coordinate of a mesh or a query, m.
#define WISP_COLLISION_MESH_REACH 1e9f

/// Opaque: a mesh and its search structure.
typedef struct wisp_collision_mesh wisp_collision_mesh;

/// A mesh. Copied; need not outlive the call. A surface is closed where its triangles share indices; coincident points
/// are different points.
typedef struct wisp_collision_mesh_def
{
    const wisp_vec3* points;  ///< [point_count] m, finite, within WISP_COLLISION_MESH_REACH
    const int32_t* triangles; ///< [triangle_count][3] indices into points, counter-clockwise seen from outside
    int point_count;
    int triangle_count; ///< >= 1. Triangles without area are allowed: they are found by distance, but no path crosses them
    bool
        deforms; ///< points will move against each other; without it the mesh moves as a rigid body, if at all. The tree of a
                 ///< rigid mesh is Embree's where the library has it, with the same results
    size_t memory_limit; ///< bytes that Embree may take beside the host's allocator; 0: no limit
} wisp_collision_mesh_def;

/// Build a collision mesh. A rigid mesh is queried in its own frame (wisp_transform_to_local()) and never changes.
/// @param allocator may be null; copied. Embree takes its nodes elsewhere: see memory_limit and wisp_collision_mesh_bytes()
/// @param mesh receives the collision mesh, null on failure
/// @param error may be null
/// @return WISP_BAD_INPUT a point or an index is wrong (the message names the first); WISP_NO_MEMORY; WISP_CONFLICT Embree
///         lacks what is needed
WISP_API wisp_status wisp_collision_mesh_create( const wisp_collision_mesh_def* def, const wisp_allocator* allocator,
                                                 wisp_collision_mesh** mesh, wisp_error* error );

/// Null is allowed.
WISP_API void wisp_collision_mesh_release( wisp_collision_mesh* mesh );

/// Move the points of a mesh that deforms along straight lines. The tree is refitted to the whole motion.
/// Queries have times in [0, 1] of the motion.
/// @param start [point_count] m; null: the mesh is at `end` all the time
/// @param end [point_count] m. All points are checked first: a wrong one leaves everything as it was
/// @param parallel for the refit; null: the calling thread
/// @return WISP_BAD_INPUT a point is not finite or out of reach; WISP_CONFLICT the mesh is rigid
/// @note Not while queries run.
WISP_API wisp_status wisp_collision_mesh_update( wisp_collision_mesh* mesh, const wisp_vec3* start,
                                                 const wisp_vec3* end, const wisp_parallel* parallel,
                                                 wisp_error* error );

/// A place on a mesh that deforms.
typedef struct wisp_mesh_place
{
    wisp_vec3 point;  ///< m
    wisp_vec3 normal; ///< unit, of the triangle; zero where it has no area
} wisp_mesh_place;

/// Follow a point of a triangle to a time in [0, 1] of the motion.
/// @param weights barycentric, as of a query
WISP_API wisp_mesh_place wisp_collision_mesh_place( const wisp_collision_mesh* mesh, int32_t triangle,
                                                    const float weights[3], float time );

/// @return bytes of the tree, Embree's included
WISP_API size_t wisp_collision_mesh_bytes( const wisp_collision_mesh* mesh );
/// @return bytes of those that are Embree's, and not of the allocator
WISP_API size_t wisp_collision_mesh_outside_bytes( const wisp_collision_mesh* mesh );

/// Statistics of a mesh and its search structure.
typedef struct wisp_collision_mesh_stats
{
    int open_edge_count; ///< edges without exactly two triangles that run along them in opposite directions: with none
                         ///< the mesh is closed and has an inside
    int flat_triangle_count; ///< triangles without area
    int triangle_count;
    int refit_count;
} wisp_collision_mesh_stats;

WISP_API wisp_collision_mesh_stats wisp_collision_mesh_get_stats( const wisp_collision_mesh* mesh );

/// Sums over queries. Zero-initialise, and pass to any number of calls.
typedef struct wisp_collision_mesh_query_stats
{
    uint64_t queried;
    uint64_t answered; ///< queries that found a point or a triangle
    uint64_t refused;  ///< queries that were not finite or out of reach: no result
    uint64_t tested;   ///< triangles tested
} wisp_collision_mesh_query_stats;

/// A closest-point query.
typedef struct wisp_mesh_query
{
    wisp_vec3 point; ///< m
    float radius;    ///< m, >= 0, may be infinite: the search ignores what is farther
    float time;      ///< in [0, 1], when in the motion of a mesh that deforms; not read for a rigid one
} wisp_mesh_query;

/// Result of a closest-point query. All zero with triangle -1 if nothing is within the radius.
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

/// Return the displacement of a point of a triangle between two times in [0, 1] of the motion, m.
WISP_API wisp_vec3 wisp_collision_mesh_motion( const wisp_collision_mesh* mesh, int32_t triangle,
                                               const float weights[3], float begin, float end );

/// Find the closest points of the surface (signs: Baerentzen and Aanaes 2005, "Signed distance computation using the
/// angle weighted pseudonormal").
/// @param queries, nearest [count]
/// @param work may be null
/// @note Thread-safe with other queries.
WISP_API void wisp_collision_mesh_closest( wisp_collision_mesh* mesh, const wisp_mesh_query* queries, int count,
                                           wisp_mesh_nearest* nearest, wisp_collision_mesh_query_stats* work );

/// Fill a grid of cells with what is outside during the whole motion, after wisp_collision_mesh_update(). It takes about 0.1
/// microseconds a triangle, and pays where about half as many points ask. A mesh that has not been updated has its cells.
/// @param parallel null: the calling thread
WISP_API void wisp_collision_mesh_fill_cells( wisp_collision_mesh* mesh, const wisp_parallel* parallel );

/// Ask the grid of cells about a point.
/// @param near m, >= 0
/// @return `near` if the point is outside and the surface stays farther than that in the whole motion; 0 if it is outside all
///         the time; -1 if that is not known, as without
///         wisp_collision_mesh_fill_cells()
/// @note Thread-safe with queries.
WISP_API float wisp_collision_mesh_clearance( const wisp_collision_mesh* mesh, wisp_vec3 point, float near );

/// A closest-point query of a point that stays for a while.
typedef struct wisp_mesh_approach
{
    wisp_mesh_query query;
    float near; ///< m, >= 0: triangles that stay farther than this in the whole motion may be left out
    int32_t
        seed; ///< a triangle that may be near; out of range: none. It makes the search faster and does not change its result
} wisp_mesh_approach;

/// Find closest triangles as wisp_collision_mesh_closest() does, and for how long they are enough.
/// @param triangles [count] receives them, -1 where none is within the radius; wisp_collision_mesh_track() describes the points
/// @param clearance [count] receives lower bounds of the distance from the surface, from the time of the query to the end of
///        the motion, m; at most `near`, and negative where a triangle may pass the point
/// @note Thread-safe with other queries.
WISP_API void wisp_collision_mesh_approach( const wisp_collision_mesh* mesh, const wisp_mesh_approach* approaches,
                                            int count, int32_t* triangles, float* clearance );

/// Track closest points (after Lin and Canny 1991): go from a triangle near the result to neighbours that are closer, until none
/// is. It gives what wisp_collision_mesh_closest() gives where the distance has one minimum between the two, at a fifth of
/// the time.
/// @param kernels points above the inside of their triangle are answered by them, within the rounding of the coordinates to single
///        precision; null: all one after another, in double precision
/// @param triangles [count] where to begin, each in range
/// @note Thread-safe with other queries.
WISP_API void wisp_collision_mesh_track( const wisp_collision_mesh* mesh, const wisp_kernels* kernels,
                                         const wisp_mesh_query* queries, const int32_t* triangles, int count,
                                         wisp_mesh_nearest* nearest );

/// A straight path, in the frame of the mesh. For a rigid body that moves, `from` is taken into the body by the old pose
/// and `to` by the new one.
typedef struct wisp_mesh_path
{
    wisp_vec3 from, to; ///< m
    float begin_time,
        end_time; ///< in [0, 1], in ascending order: the part of the motion of a mesh that deforms during which
                  ///< the point moves; equal: the mesh as it is then
} wisp_mesh_path;

/// First intersection of a path. All zero with triangle -1 if there is none.
typedef struct wisp_mesh_hit
{
    int32_t triangle; ///< -1: none; of triangles crossed at the same time the lowest
    float time;       ///< in [0, 1], fraction of the path
    float side; ///< 1: the path comes from the front, which the normal of the triangle points to; -1: from behind
    wisp_vec3 point;  ///< m, where it crosses
    wisp_vec3 normal; ///< unit, of the triangle, towards the side the path comes from
    float weights[3]; ///< barycentric, of the triangle's corners
} wisp_mesh_hit;

/// Cast each path and find its first intersection. A point that lies exactly in a triangle's plane counts as in front of it, so
/// that of two paths that meet end to end on a face just one crosses. Paths without length cross nothing, and neither does one that runs
/// within a plane: call wisp_collision_mesh_closest() after a cast to find contacts that only touch.
/// @param paths, hits [count]
/// @param work may be null
/// @note Thread-safe with other queries.
WISP_API void wisp_collision_mesh_cast( wisp_collision_mesh* mesh, const wisp_mesh_path* paths, int count,
                                        wisp_mesh_hit* hits, wisp_collision_mesh_query_stats* work );

/// The ends of an edge at two times of the motion, m; of a corner twice the same.
typedef struct wisp_mesh_feature
{
    wisp_vec3 from[2], to[2];
} wisp_mesh_feature;

/// What the faces around an edge or a corner are like.
typedef struct wisp_mesh_sides
{
    wisp_vec3 normal; ///< unit, the mean of their normals; zero if they have none
    bool in_front,
        behind; ///< an edge is a ridge as seen from the side of its normal, or from the other one; both of an open edge and
                ///< of a corner, none where the faces lie in one plane
} wisp_mesh_sides;

/// Find out which edges and corners of a mesh stick out, and build what finds them. Nothing happens if that was done before.
/// @return WISP_NO_MEMORY: the mesh is as it was
/// @note Not while queries run.
WISP_API wisp_status wisp_collision_mesh_prepare_features( wisp_collision_mesh* mesh, wisp_error* error );

/// Find edges or corners of the triangles whose boxes, over the whole motion, overlap a box. Each is found once. Of a mesh that is
/// rigid, what does not stick out on either side is left out.
/// @param lower, upper [3] m
/// @param features [capacity] receives numbers for wisp_collision_mesh_feature(); what is more is left out
/// @return how many; 0 of a mesh that was not prepared
/// @note Thread-safe with other queries.
WISP_API int wisp_collision_mesh_find_features( const wisp_collision_mesh* mesh, const float lower[3],
                                                const float upper[3], bool corners, int32_t* features, int capacity );

/// Place an edge or a corner that was found. @param begin, end times in [0, 1] of the motion
WISP_API wisp_mesh_feature wisp_collision_mesh_feature( const wisp_collision_mesh* mesh, int32_t feature,
                                                        bool is_corner, float begin, float end );
/// Describe its sides at a time of the motion.
WISP_API wisp_mesh_sides wisp_collision_mesh_sides( const wisp_collision_mesh* mesh, int32_t feature, bool is_corner,
                                                    float time );

/// The same of a height field, whose features are those within its border and have one side, the upper one.
/// @note Thread-safe.
WISP_API int wisp_height_field_find_features( const wisp_height_field* field, const float lower[3],
                                              const float upper[3], bool corners, int32_t* features, int capacity );
WISP_API wisp_mesh_feature wisp_height_field_feature( const wisp_height_field* field, int32_t feature );
WISP_API wisp_mesh_sides wisp_height_field_sides( const wisp_height_field* field, int32_t feature );

WISP_END_C
