/// Search of a rigid mesh by an Embree tree. A library without Embree has none, and searches by a hierarchy of its own (mesh_bvh.h).
#pragma once

#include "mesh_search.h"

typedef struct embree_tree embree_tree;

/// @return false in a library that was built without Embree: nothing else may then be called but the release of null
bool embree_tree_exists( void );

/// @param surface must not move in memory while the tree exists
wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** tree,
                                wisp_error* error );
/// Null is allowed.
void embree_tree_release( embree_tree* tree );

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search );
/// @return false if the path is not a valid query
bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* search );

size_t embree_tree_bytes( const embree_tree* tree );
/// Bytes of those that are Embree's.
size_t embree_tree_outside_bytes( const embree_tree* tree );
