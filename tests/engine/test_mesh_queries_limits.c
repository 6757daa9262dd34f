// Trees of meshes at their limits: invalid queries, invalid meshes, lack of memory.
#include "mesh_fixture.h"

#include "collision_mesh_embree.h"

// ---- inputs without a result ----

TEST( numbers_that_are_none_are_counted_and_answered_with_nothing )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_ball( 4, false );
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, deforms == 1 );
        assert_refuses_bad_numbers( tree );
    }
}

TEST( the_ends_of_the_reach_are_answered )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_ball( 4, false );
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, deforms == 1 );
        assert_answers_the_ends_of_the_reach( tree );
    }
}

TEST( a_wrong_mesh_is_refused_with_its_first_fault )
{
    static const wisp_vec3 good[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    static const wisp_vec3 bad[] = { { 0, 0, 0 }, { 1, NAN, 0 }, { 0, 1, 0 } };
    static const int32_t triangle[] = { 0, 1, 2 }, lower[] = { 0, -1, 2 }, upper[] = { 0, 1, 3 };
    const struct
    {
        wisp_collision_mesh_def def;
        const char* word;
    } wrong[] = {
        { { .points = good, .triangles = lower, .point_count = 3, .triangle_count = 1 }, "corner 1 of triangle 0" },
        { { .points = good, .triangles = upper, .point_count = 3, .triangle_count = 1 }, "corner 2 of triangle 0" },
        { { .points = bad, .triangles = triangle, .point_count = 3, .triangle_count = 1 }, "point 1: got " },
        { { .points = good, .triangles = triangle, .point_count = 3 }, "0 triangles" },
        { { .points = good, .triangles = triangle, .triangle_count = 1 }, "0 points" },
        { { .points = good, .triangles = triangle, .point_count = -4, .triangle_count = 1 }, "-4 points" },
        { { .points = good, .triangles = triangle, .point_count = 3, .triangle_count = INT32_MAX }, "too large" },
        { { .triangles = triangle, .point_count = 3, .triangle_count = 1 }, "0 points" },
        { { .points = good, .point_count = 3, .triangle_count = 1 }, "0 triangles" },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_collision_mesh* tree = (wisp_collision_mesh*)1;
        wisp_error error = { 0 };
        assert_int_equal( wisp_collision_mesh_create( &wrong[i].def, NULL, &tree, &error ), WISP_BAD_INPUT );
        assert_null( tree );
        assert_one_message( error.message );
        assert_non_null( strstr( error.message, wrong[i].word ) );
    }
    wisp_collision_mesh_release( NULL );
}

// ---- memory ----

TEST( every_refused_block_is_a_message_and_leaves_nothing )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_ball( 4, false );
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        wisp_collision_mesh_def def = test_mesh_def( &m, deforms == 1 );
        int64_t bytes[2];
        assert_true( assert_refused_blocks_are_messages( &def, bytes ) > 5 );
        const bool is_own = deforms == 1 || embree_tree_exists() == false;
        assert_true( is_own ? bytes[0] == bytes[1] : bytes[0] > bytes[1] ); // Embree has memory of its own
    }
}

TEST( a_limit_of_memory_is_kept_by_embree )
{
    if ( embree_tree_exists() == false )
    {
        skip();
    }
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_bumpy( 40 );
    wisp_collision_mesh_def def = test_mesh_def( &m, false );
    SCOPED( tree_local ) wisp_collision_mesh* tree;
    wisp_error error = { 0 };
    def.memory_limit = 20000; // of about 50 bytes per triangle
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &tree, &error ), WISP_NO_MEMORY );
    assert_null( tree );
    assert_one_message( error.message );
    def.memory_limit = (size_t)1 << 30;
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &tree, &error ), WISP_OK );
}

TEST( denormal_numbers_keep_their_meaning_for_the_host )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_ball( 4, false );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, true );
    assert_int_equal( wisp_collision_mesh_update( tree, NULL, m.points, NULL, NULL ), WISP_OK );
    closest( tree, m.points[0], 1.0f );
    sweep( tree, m.points[0], m.points[1] );
    volatile float least = FLT_MIN;
    volatile float half = 0.5f * least; // zero where a library has changed the processor's mode
    assert_true( half > 0.0f );
}
