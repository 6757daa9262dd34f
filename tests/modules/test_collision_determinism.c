// Mesh bodies by trees: a library without Embree has the same bits as one with it. Cloth on a mesh whose tree is Embree's has the
// contacts and the bits of cloth on the engine's own tree, and both have those of data/golden/collision.hash. WISP_GOLDEN=write in
// the environment rewrites that file. That both trees answer as brute force does is in engine/test_mesh_trees.c.
#include "collision_fixture.h"
#include "golden_file.h"

#include "collision_state.h"

static const float DT = 1.0f / 60.0f;

enum
{
    STEPS = 60,
};

typedef struct setting
{
    const char* name;
    bool is_own, double_sided, tracks;
    wisp_collision_features features;
    int workers;
} setting;

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
    uint64_t hash;
} trace;

// Put the engine's own tree, that of a mesh that deforms, in the place of the one that the body has.
static void replace_tree( wisp_world* world, const test_mesh* mesh )
{
    collision_state* state = wisp_world_module_state( world, "collision" );
    const wisp_collision_mesh_def def = { .points = mesh->points,
                                          .triangles = mesh->triangles,
                                          .point_count = mesh->vertex_count,
                                          .triangle_count = mesh->triangle_count,
                                          .deforms = true };
    wisp_collision_mesh_release( state->bodies[0].tree );
    assert_int_equal( wisp_collision_mesh_create( &def, wisp_world_allocator( world ), &state->bodies[0].tree, NULL ),
                      WISP_OK );
}

// Cloth falls on a body that moves and turns.
static trace* run( setting how )
{
    trace* t = checked_calloc( 1, sizeof( trace ) );
    SCOPED( close_local ) hosted* h = new_colliding( 2, 2, how.workers );
    test_mesh ball = make_bumpy_ball();
    wisp_collider_def body = mesh_body( &ball );
    body.double_sided = how.double_sided;
    body.tracks = how.tracks;
    wisp_entity collider = add_collider( h->world, &body );
    if ( how.is_own )
    {
        replace_tree( h->world, &ball );
    }
    test_mesh_free( &ball );

    test_mesh mesh = test_plane( 21, 0.04f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.4f, 0.36f, -0.38f } );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.features = how.features;
    wisp_entity e = add_colliding( h->world, &mesh, &collision );
    test_mesh_free( &mesh );
    SET( h->world, e, cloth, d.internal_damping = 0.0f );
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
    assert_int_equal( wisp_world_hash_column( h->world, e, WISP_SURFACE_POINTS, &t->hash ), WISP_OK );
    return t;
}

static void assert_same( const trace* expected, trace* found )
{
    assert_true( expected->stats[STEPS - 1].contacts > 20 );
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

// What is tracked knows how long a vertex of a rigid mesh stays clear by other bounds than of one that deforms.
TEST( cloth_on_the_engines_own_tree_has_the_contacts_and_the_bits_of_embrees )
{
    for ( int variant = 0; variant < 3; ++variant )
    {
        setting how = { .double_sided = variant == 1, .workers = 1 };
        how.tracks = variant == 2;
        how.features = variant == 2 ? WISP_COLLISION_ALL : WISP_COLLISION_VERTICES;
        SCOPED( free_local ) trace* expected = run( how );
        for ( how.workers = 1; how.workers < 6; how.workers += 2 )
        {
            how.is_own = false;
            assert_same( expected, run( how ) );
            how.is_own = variant < 2; // edges are cooked with the tree
            assert_same( expected, run( how ) );
        }
    }
}

static golden_hash run_case( int number, const void* context )
{
    static const setting cases[] = {
        { "solid", .tracks = true, .workers = 2 },
        { "sheet", .tracks = true, .double_sided = true, .workers = 2 },
        { "searched", .workers = 2 },
        { "features", .tracks = true, .features = WISP_COLLISION_ALL, .workers = 2 },
    };
    (void)context;
    SCOPED( free_local ) trace* t = run( cases[number] );
    return ( golden_hash ){ cases[number].name, t->hash };
}

TEST( cloth_on_meshes_has_the_bits_on_record_with_embree_and_without )
{
    golden_check( WISP_SOURCE_ROOT "/data/golden/collision.hash", 4, false, run_case, NULL );
}
