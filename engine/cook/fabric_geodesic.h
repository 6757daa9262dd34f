/// Geodesic distances on a mesh from single points, by fast marching over triangles.
#pragma once

#include "fabric_parts.h"

/// A triangle (v, a, b) at its node v. If a equals b, it stands for the edge to a, without a triangle.
typedef struct geodesic_corner
{
    int32_t a, b;
    float va, vb; ///< m, lengths of the edges from v
    float dot;    ///< m^2, (a - v) . (b - v) in the triangle's plane
    float area;   ///< m^2, of the parallelogram, twice the triangle's
} geodesic_corner;

/// Graph over which distances are computed: the mesh, or a coarse approximation of it.
typedef struct geodesic_net
{
    int count;
    const wisp_vec3* point;        ///< [count] positions; a distance is at least the straight one
    const int32_t* slot;           ///< [count] in increasing order; null: node and slot are equal
    const int32_t* begin;          ///< [count + 1]
    const geodesic_corner* corner; ///< [begin[count]]
} geodesic_net;

/// Build the net of the whole mesh.
/// @return false if out of memory
bool geodesic_net_of_mesh( const fabric_parts* parts, const wisp_fabric* fabric, fabric_pool* pool,
                           geodesic_net* out );

/// Compute a corner from the three sides of a triangle.
geodesic_corner geodesic_corner_of_sides( int32_t a, int32_t b, double va, double vb, double ab );

/// State of a node in a march.
typedef struct geodesic_node
{
    double distance; ///< m, geodesic distance from the source
    double straight; ///< m, Euclidean distance from the source
    int32_t march;   ///< number of the march that wrote this state
    int32_t place;   ///< position in the heap, -1 if outside
    int32_t visits;  ///< number of times it has left the heap
    int32_t settled; ///< number of the last march in which no path can improve it
} geodesic_node;

/// A node in the heap with its distance, which is compared more often than nodes are looked up.
typedef struct geodesic_entry
{
    double distance; ///< m
    int32_t node;
} geodesic_entry;

/// Working memory, reused by all marches over a net. Initialise once per net.
typedef struct geodesic_march
{
    const geodesic_net* net;
    geodesic_node* node;  ///< [net->count]
    geodesic_entry* heap; ///< [net->count]
    int32_t* reached;     ///< [reached_count] nodes that the last march reached, source first
    int reached_count;
    int heap_count;
    int32_t number; ///< number of the last march
    int32_t source;
    double radius;
    const float* bound;
} geodesic_march;

/// @return false if out of memory
bool geodesic_march_init( geodesic_march* march, const geodesic_net* net, fabric_pool* pool );

/// Begin a march, with its source in the heap.
void geodesic_march_begin( geodesic_march* march, int32_t source, double radius );
/// Take the nearest node from the heap, which is not empty.
int32_t geodesic_march_next( geodesic_march* march );
/// Give a node a distance if that is less than what it has. @return whether it is
bool geodesic_march_reach( geodesic_march* march, int32_t node, double distance );

/// Compute distances from a source to all nodes within a radius, in march->node[march->reached[..]].distance.
///
/// Where two corners of a triangle have distances, the source is unfolded into its plane. The third corner gets the
/// straight distance if that line crosses the edge between the two; otherwise the path follows an edge. Nodes are
/// corrected when a shorter path is found later, as at obtuse corners, up to a maximum number of times. Distances
/// are exact if the straight path over the unfolded mesh is not blocked. Behind holes they are too long. On a
/// sphere of forty rings they are up to 1 % too short. They are never below the Euclidean distance.
/// @param radius m
/// @param bound [net->count] m, nodes farther than this are skipped; may be null
void geodesic_march_run( geodesic_march* march, int32_t source, double radius, const float* bound );

/// Round a distance up to a float, so that rounding never makes a rest length too short.
float geodesic_round_up( double distance );
