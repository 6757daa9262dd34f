/// Search by an Embree tree. In a library built without Embree none can be created.
#pragma once

#include "mesh_search.h"

typedef struct embree_tree embree_tree;

/// @param surface stays where it is as long as the tree lives
wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** tree,
                                wisp_error* error );
/// Null is allowed.
void embree_tree_release( embree_tree* tree );

/// The surface has other points now: refit the tree, or build it again if it has decayed.
wisp_status embree_tree_update( embree_tree* tree, wisp_error* error );
/// After an update that failed the surface has its old points again. Without memory even for that, queries are refused
/// until an update succeeds.
void embree_tree_return( embree_tree* tree );

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search );
/// @return false if the path is not a valid query
bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* search );

/// Is there a tree of the surface as it is?
bool embree_tree_answers( const embree_tree* tree );
/// Cost of queries for closest points, which tells whether the tree has decayed. Thread-safe.
void embree_tree_note( embree_tree* tree, uint64_t queried, uint64_t tested );

size_t embree_tree_bytes( const embree_tree* tree );
/// How often it was built and refitted.
void embree_tree_counts( const embree_tree* tree, int* build_count, int* refit_count );
