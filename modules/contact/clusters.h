// Clusters: eight triangles, or eight segments of a strand, that are culled together.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/primitives.h"

/// Primitives that lie together at rest. Each primitive of the contact mesh is in one cluster.
typedef struct contact_cluster
{
    int32_t participant;
    int32_t first_point,
        point_count; // in `points`: all points of its primitives; the last repeats to a multiple of eight
    int32_t kind_row[3], rows[3]; // first row in `packs`, and how many packs of eight, of points, edges and triangles
} contact_cluster;

/// A cluster at its intersection-free positions.
typedef struct contact_placed
{
    wisp_aabb box;
    float normal[3];            // sum of the unit normals of its triangles
    wisp_primitive_pack* packs; // given, with room for CONTACT_CLUSTER_MOST
} contact_placed;

enum
{
    CONTACT_CLUSTER_MOST = 2 * WISP_PRIMITIVE_PACKS + 1, // packs: of points, of edges, and one of triangles
};

enum
{
    CONTACT_CLUSTER_ITEMS,
    CONTACT_CLUSTER_POINTS,
    CONTACT_CLUSTER_OF_POINT,
    CONTACT_CLUSTER_OWNERS_BEGIN,
    CONTACT_CLUSTER_OWNERS,
    CONTACT_CLUSTER_PACKS,
    CONTACT_CLUSTER_TRIANGLE_OWNS,
    CONTACT_CLUSTER_EDGE_OWNS,
    CONTACT_CLUSTER_ARRAY_COUNT,
};

enum
{
    CONTACT_HAS_TRIANGLE = 4, // of `edge_owns`
};

typedef struct contact_clusters
{
    int count;
    contact_cluster* items;
    int32_t* points;       // points times 4
    int32_t* of_point;     // [point] the cluster that counts it among its primitives
    int32_t* owners_begin; // [point + 1] first in `owners`
    int32_t* owners;       // of each point, all clusters that have it as a corner
    /// [row] of each pack its primitives, -1: none; of edges and triangles also their points times 4, corner by corner
    int32_t ( *packs )[WISP_SLICE];
    uint8_t* triangle_owns; // [triangle] bit k: the edge across from corner k; bit 3 + k: corner k
    uint8_t* edge_owns;     // [edge] bit k: end k; CONTACT_HAS_TRIANGLE
    wisp_buffer buffers[CONTACT_CLUSTER_ARRAY_COUNT];
} contact_clusters;

/// Cut the contact mesh into clusters.
/// @return false without memory
bool contact_make_clusters( const contact_work* work );

/// Compute the box around the intersection-free positions of a cluster.
wisp_aabb contact_box_around( const contact_work* work, const contact_cluster* cluster );

/// Place a cluster at its intersection-free positions.
void contact_place_cluster( const contact_work* work, int cluster, contact_placed* to );

/// Return the number of rows of a pack of one kind.
static inline int contact_pack_rows( int kind )
{
    return kind == 0 ? 1 : kind + 2;
}

/// Return the packs of one kind of a cluster.
static inline const wisp_primitive_pack* contact_packs_of( const contact_placed* placed,
                                                           const contact_cluster* cluster, int kind )
{
    return placed->packs + ( kind > 0 ? cluster->rows[0] : 0 ) + ( kind > 1 ? cluster->rows[1] : 0 );
}

/// Return whether two clusters, or a cluster and itself, are kept apart.
bool contact_clusters_may_meet( const contact_work* work, int a, int b );
