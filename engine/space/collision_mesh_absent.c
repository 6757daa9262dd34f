// Replacement for Embree trees in a library built without Embree: creation fails. Voxels still work.
#include "collision_mesh_embree.h"

#include "embree_compat.h"

#if !WISP_HAS_EMBREE

wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** tree,
                                wisp_error* error )
{
    (void)surface;
    (void)def;
    *tree = NULL;
    return wisp_fail(
        error, WISP_CONFLICT,
        "mesh collider: search by tree needs Embree, without which this library was built; expected search "
        "by voxels" );
}

void embree_tree_release( embree_tree* tree )
{
    WISP_ASSERT( tree == NULL );
    (void)tree;
}

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search )
{
    (void)tree;
    (void)search;
}

bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* search )
{
    (void)tree;
    (void)search;
    return false;
}

size_t embree_tree_bytes( const embree_tree* tree )
{
    (void)tree;
    return 0;
}

size_t embree_tree_outside_bytes( const embree_tree* tree )
{
    (void)tree;
    return 0;
}

#endif
