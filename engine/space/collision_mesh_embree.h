/// Search by an Embree tree. In a library built without Embree none can be created.
#pragma once

#include "mesh_search.h"

typedef struct embree_tree embree_tree;

/// @param surface must not move in memory while the tree exists
wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** tree,
                                wisp_error* error );
/// Null is allowed.
void embree_tree_release( embree_tree* tree );

/// Update the tree after the points of the surface have changed, by a refit, or a rebuild if it has decayed.
wisp_status embree_tree_update( embree_tree* tree, wisp_error* error );
/// After a failed update the surface has its old points again. If even that needs memory that is not available,
/// queries fail until an update succeeds.
void embree_tree_return( embree_tree* tree );

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search );
/// @return false if the path is not a valid query
bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* search );

/// Test whether the tree matches the surface.
bool embree_tree_answers( const embree_tree* tree );
/// Return the cost of closest-point queries, which shows decay of the tree. Thread-safe.
void embree_tree_note( embree_tree* tree, uint64_t queried, uint64_t tested );

size_t embree_tree_bytes( const embree_tree* tree );
/// Bytes of those that are Embree's.
size_t embree_tree_outside_bytes( const embree_tree* tree );
/// Return the number of builds and refits.
void embree_tree_counts( const embree_tree* tree, int* build_count, int* refit_count );
