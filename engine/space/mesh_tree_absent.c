// Mesh colliders of a library that was built without Embree: none can be made, so none can be asked.
#include "embree_compat.h"

#include "wisp/mesh_tree.h"

#if !WISP_HAS_EMBREE

wisp_status wisp_mesh_tree_create( const wisp_mesh_tree_def* def, const wisp_allocator* allocator,
                                   wisp_mesh_tree** tree, wisp_error* error )
{
    (void)def;
    (void)allocator;
    *tree = NULL;
    return wisp_fail( error, WISP_CONFLICT, "mesh colliders need Embree, and this library was built without it" );
}

void wisp_mesh_tree_release( wisp_mesh_tree* tree )
{
    WISP_ASSERT( tree == NULL );
    (void)tree;
}

wisp_status wisp_mesh_tree_update( wisp_mesh_tree* tree, const wisp_vec3* points, wisp_error* error )
{
    (void)tree;
    (void)points;
    return wisp_fail( error, WISP_CONFLICT, "mesh colliders need Embree, and this library was built without it" );
}

size_t wisp_mesh_tree_bytes( const wisp_mesh_tree* tree )
{
    (void)tree;
    return 0;
}

wisp_mesh_tree_facts wisp_mesh_tree_get_facts( const wisp_mesh_tree* tree )
{
    (void)tree;
    return ( wisp_mesh_tree_facts ){ 0 };
}

// Queries of nothing are answered with nothing, and counted as refused.
static void refuse( int count, wisp_mesh_work* work )
{
    if ( work != NULL && count > 0 )
    {
        work->asked += (uint64_t)count;
        work->refused += (uint64_t)count;
    }
}

void wisp_mesh_tree_closest( wisp_mesh_tree* tree, const wisp_mesh_query* queries, int count,
                             wisp_mesh_nearest* nearest, wisp_mesh_work* work )
{
    (void)tree;
    (void)queries;
    for ( int i = 0; i < count; ++i )
    {
        nearest[i] = ( wisp_mesh_nearest ){ .triangle = -1 };
    }
    refuse( count, work );
}

void wisp_mesh_tree_sweep( wisp_mesh_tree* tree, const wisp_mesh_path* paths, int count, wisp_mesh_hit* hits,
                           wisp_mesh_work* work )
{
    (void)tree;
    (void)paths;
    for ( int i = 0; i < count; ++i )
    {
        hits[i] = ( wisp_mesh_hit ){ .triangle = -1 };
    }
    refuse( count, work );
}

#endif
