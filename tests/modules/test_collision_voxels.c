// Mesh bodies searched by voxels: the same contacts and the same bits as with the tree and as with a single voxel,
// which is brute force. In a library without Embree, voxels are compared with brute force alone.
#include "collision_fixture.h"

static const float DT = 1.0f / 60.0f;

enum
{
    STEPS = 60,
};

// How a run searches the mesh of its body.
typedef struct search
{
    wisp_mesh_search kind;
    float voxel_size;
} search;

static const search TREE = { WISP_MESH_SEARCH_TREE, 0.0f };
static const search VOXELS = { WISP_MESH_SEARCH_VOXELS, 0.0f };
static const search FINE_VOXELS = { WISP_MESH_SEARCH_VOXELS, 0.01f };
static const search BRUTE_FORCE = { WISP_MESH_SEARCH_VOXELS, 10.0f }; // all triangles in the list of one voxel

static wisp_collider_def searched_body( const test_mesh* mesh, search how )
{
    wisp_collider_def def = mesh_body( mesh );
    def.search = how.kind;
    def.voxel_size = how.voxel_size;
    return def;
}

// A ball of radius 0.3 with bumps, so that its nearest faces differ.
static test_mesh make_bumpy_ball( void )
{
    test_mesh mesh = test_ball( 3 );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        wisp_vec3* p = mesh.points + v;
        const float r = 0.3f + 0.02f * sinf( 20.0f * p->x ) * sinf( 17.0f * p->z );
        *p = ( wisp_vec3 ){ r * p->x, r * p->y, r * p->z };
    }
    return mesh;
}

// Results of a run: the contacts after each step, and the bits of the cloth at the end.
typedef struct trace
{
    wisp_collision_stats stats[STEPS];
    wisp_vec3 points[21 * 21];
} trace;

// Cloth falls on a body that moves and turns.
static trace* run( search how, bool double_sided, int workers )
{
    trace* t = checked_calloc( 1, sizeof( trace ) );
    hosted* h = new_colliding( 2, 2, workers );
    test_mesh ball = make_bumpy_ball();
    wisp_collider_def body = searched_body( &ball, how );
    body.double_sided = double_sided;
    wisp_entity collider = add_collider( h->world, &body );
    test_mesh_free( &ball );

    test_mesh mesh = test_plane( 21, 0.04f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.4f, 0.36f, -0.38f } );
    wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity e = add_colliding( h->world, &mesh, &collision );
    test_mesh_free( &mesh );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_int_equal( wisp_set_cloth( h->world, e, &cloth ), WISP_OK );
    give_gravity( h->world, e, 9.8f );

    for ( int n = 0; n < STEPS; ++n )
    {
        const wisp_transform pose = { about_z( 0.02 * n ), { 0.002f * (float)n, 0.001f * (float)n, 0.0f } };
        assert_int_equal( wisp_move_collider( h->world, collider, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        t->stats[n] = collision_of( h->world, e );
    }
    const wisp_view view = view_of( h->world, e, WISP_SURFACE_POINTS );
    assert_int_equal( view.count, WISP_COUNT( t->points ) );
    memcpy( t->points, view.data, sizeof( t->points ) );
    free_colliding( h );
    return t;
}

static void assert_same( const trace* expected, trace* found )
{
    assert_true( expected->stats[STEPS - 1].contacts > 50 );
    for ( int n = 0; n < STEPS; ++n )
    {
        assert_int_equal( found->stats[n].contacts, expected->stats[n].contacts );
        assert_int_equal( found->stats[n].vertex, expected->stats[n].vertex );
        assert_true( found->stats[n].penetration == expected->stats[n].penetration );
        assert_int_equal( found->stats[n].dropped, expected->stats[n].dropped );
    }
    assert_memory_equal( found->points, expected->points, sizeof( found->points ) );
    free( found );
}

TEST( cloth_on_voxels_has_the_contacts_and_the_bits_of_brute_force )
{
    for ( int double_sided = 0; double_sided < 2; ++double_sided )
    {
        trace* expected = run( BRUTE_FORCE, double_sided == 1, 1 );
        assert_same( expected, run( VOXELS, double_sided == 1, 1 ) );
        assert_same( expected, run( FINE_VOXELS, double_sided == 1, 1 ) );
        free( expected );
    }
}

TEST( cloth_on_voxels_has_the_contacts_and_the_bits_of_the_tree_with_any_workers )
{
    if ( !has_meshes() )
    {
        SKIP( "the library is built without Embree" );
    }
    const int workers[] = { 1, 2, 3, 5 };
    trace* expected = run( TREE, false, 1 );
    for ( int k = 0; k < WISP_COUNT( workers ); ++k )
    {
        assert_same( expected, run( VOXELS, false, workers[k] ) );
    }
    free( expected );
    expected = run( TREE, true, 2 );
    assert_same( expected, run( VOXELS, true, 3 ) );
    free( expected );
}

COLLISION_TEST( voxels_go_with_their_bodies_and_are_the_worlds_memory )
{
    hosted* h = *state;
    test_mesh ball = make_bumpy_ball();
    wisp_collider_def coarse = searched_body( &ball, BRUTE_FORCE ), fine = searched_body( &ball, VOXELS );
    wisp_entity first = add_collider( h->world, &coarse );
    assert_int_equal( wisp_remove( h->world, first ), WISP_OK );
    const size_t before = wisp_world_memory( h->world );
    wisp_entity body = add_collider( h->world, &coarse );
    const size_t with_one = wisp_world_memory( h->world );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_memory( h->world ), before );
    body = add_collider( h->world, &fine );
    assert_true( wisp_world_memory( h->world ) > with_one );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_memory( h->world ), before );
    test_mesh_free( &ball );
}

COLLISION_TEST( a_wrong_search_is_refused )
{
    hosted* h = *state;
    test_mesh ball = make_bumpy_ball();
    const struct
    {
        search how;
        const char* word;
    } wrong[] = {
        { { WISP_MESH_SEARCH_COUNT, 0.0f }, "search is 2" },
        { { WISP_MESH_SEARCH_VOXELS, -0.5f }, "voxel_size is -0.5" },
        { { WISP_MESH_SEARCH_VOXELS, NAN }, "voxel_size is" },
        { { WISP_MESH_SEARCH_VOXELS, 2e6f }, "voxel_size is 2e+06" },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_collider_def def = searched_body( &ball, wrong[i].how );
        wisp_entity e;
        assert_int_equal( wisp_add_collider( h->world, &def, &e ), WISP_BAD_INPUT );
        assert_contains( wisp_world_message( h->world ), wrong[i].word );
    }
    test_mesh_free( &ball );
}
