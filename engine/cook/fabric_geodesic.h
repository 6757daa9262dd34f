/// Distances along a mesh from single points, by marching outwards triangle by triangle.
#pragma once

#include "fabric_parts.h"

/// A triangle (v, a, b) seen from its node v. Where a equals b there is no triangle, only the edge to a.
typedef struct geodesic_corner
{
    int32_t a, b;
    float va, vb; ///< m, lengths of the edges from v
    float dot;    ///< m^2, (a - v) . (b - v) in the triangle's plane
    float area;   ///< m^2, of the parallelogram, twice the triangle's
} geodesic_corner;

/// Points with known distances to their neighbours: the mesh itself, or a coarse picture of it.
typedef struct geodesic_net
{
    int count;
    const wisp_vec3* point;        ///< [count] a distance is never below the straight one
    const int32_t* slot;           ///< [count] rising; null: node and slot are the same number
    const int32_t* begin;          ///< [count + 1]
    const geodesic_corner* corner; ///< [begin[count]]
} geodesic_net;

/// The whole mesh as a net.
/// @return false without memory
bool geodesic_net_of_mesh( const fabric_parts* parts, const wisp_fabric* fabric, fabric_pool* pool,
                           geodesic_net* out );

/// A corner of a triangle known by its three sides.
geodesic_corner geodesic_corner_of_sides( int32_t a, int32_t b, double va, double vb, double ab );

/// What a march knows of a node.
typedef struct geodesic_node
{
    double distance; ///< m, from the source
    double straight; ///< m, through space
    int32_t march;   ///< number of the march that wrote this
    int32_t place;   ///< in the heap, -1 outside
    int32_t visits;  ///< how often it left the heap
} geodesic_node;

/// Room for one march after another. Init once a net.
typedef struct geodesic_march
{
    const geodesic_net* net;
    geodesic_node* node; ///< [net->count]
    int32_t* heap;       ///< [net->count]
    int32_t* reached;    ///< [reached_count] nodes that the last march reached, the source first
    int reached_count;
    int heap_count;
    int32_t number; ///< of the last march
    int32_t source;
    double radius;
    const float* bound;
} geodesic_march;

/// @return false without memory
bool geodesic_march_init( geodesic_march* march, const geodesic_net* net, fabric_pool* pool );

/// Distances from a source to all nodes within a radius, in march->node[march->reached[..]].distance.
///
/// Where a triangle knows the distances of two corners, the source is unfolded into its plane, and the third corner
/// is as far as the straight line, if that crosses the edge between the two; if not, the way goes along an edge.
/// Nodes are corrected when a better way turns up later, as it does at obtuse corners, a number of times at most.
/// Distances are exact where the straight way over the unfolded mesh is free; behind holes they come from above, on a
/// sphere of forty rings they are up to a percent short, and never below the straight line through space.
/// @param radius m
/// @param bound [net->count] m, nodes farther than that are left out; may be null
void geodesic_march_run( geodesic_march* march, int32_t source, double radius, const float* bound );

/// The smallest float that is not below a distance, so that rounding never makes a rest length too short.
float geodesic_round_up( double distance );
