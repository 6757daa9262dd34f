// Collision meshes: every result against brute force, after any changes of the tree; signs against solid angles.
#include "mesh_fixture.h"

#include <pthread.h>

enum
{
    MESHES = 6,
    QUERIES = 1500,
};

static test_mesh make_mesh( int which )
{
    switch ( which )
    {
        case 0:
            return test_mesh_ball( 12, false );
        case 1:
            return test_mesh_bumpy( 14 );
        case 2:
            return test_mesh_sheet( 20, 0.3f );
        case 3:
            return test_mesh_ball( 3, true );
        case 4:
            return test_mesh_sheet( 8, 0.0f );
        default:
            return test_mesh_read( WISP_SOURCE_ROOT "/data/bunny.obj" );
    }
}

static float length_of( wisp_vec3 v )
{
    return sqrtf( v.x * v.x + v.y * v.y + v.z * v.z );
}

// ---- closest points ----

static void assert_closest( const test_mesh* m, const float* xyzw, wisp_collision_mesh* tree, wisp_vec3 p,
                            float radius )
{
    const wisp_mesh_nearest found = assert_closest_is_naive( m, xyzw, tree, p, radius );
    if ( found.triangle >= 0 )
    {
        assert_float_equal( length_of( found.normal ), 1.0f, 4e-7f ); // three roundings
    }
}

TEST( triangles_that_share_what_is_nearest_answer_with_the_lowest )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_bumpy( 10 );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    int outer = 0;
    for ( int v = 0; v < m.point_count; ++v )
    {
        int32_t lowest = -1;
        for ( int32_t k = 3 * m.triangle_count - 1; k >= 0; --k )
        {
            lowest = m.triangles[k] == v ? k / 3 : lowest;
        }
        wisp_mesh_nearest on = closest( tree, m.points[v], 1.0f );
        assert_int_equal( on.triangle, lowest );
        assert_memory_equal( &on.point, m.points + v, sizeof( wisp_vec3 ) );

        // above a convex corner it stays the corner, with equal distances to all its triangles
        wisp_mesh_nearest above = closest( tree, test_along( m.points[v], 0.003f, on.normal ), 1.0f );
        bool is_corner = memcmp( &above.point, m.points + v, sizeof( wisp_vec3 ) ) == 0;
        assert_true( !is_corner || above.triangle == lowest );
        outer += is_corner ? 1 : 0;
    }
    assert_true( outer > m.point_count / 10 );
}

TEST( a_range_of_queries_is_answered_like_each_alone )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_bumpy( 10 );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    wisp_mesh_query queries[100];
    wisp_mesh_nearest nearest[100];
    wisp_collision_mesh_query_stats work = { 0 };
    int near = 0;
    for ( int i = 0; i < 100; ++i )
    {
        queries[i] = ( wisp_mesh_query ){ .point = query_point( &m, i ), .radius = 0.2f };
    }
    wisp_collision_mesh_closest( tree, queries, 100, nearest, &work );
    for ( int i = 0; i < 100; ++i )
    {
        wisp_mesh_nearest alone = closest( tree, queries[i].point, 0.2f );
        assert_memory_equal( nearest + i, &alone, sizeof( alone ) );
        near += alone.triangle >= 0 ? 1 : 0;
    }
    assert_true( near > 50 && near < 100 );
    assert_int_equal( work.queried, 100 );
    assert_int_equal( work.answered, near );
    assert_int_equal( work.refused, 0 );
    assert_true( work.tested >= (uint64_t)near );
}

// ---- signs ----

TEST( the_sign_tells_inside_from_outside )
{
    const int closed[] = { 0, 1, 3 };
    for ( int c = 0; c < WISP_COUNT( closed ); ++c )
    {
        SCOPED( test_mesh_free ) test_mesh m = make_mesh( closed[c] );
        SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
        SCOPED( tree_local )
        wisp_collision_mesh *rigid = test_collision_mesh( &m, false ), *soft = test_collision_mesh( &m, true );
        assert_int_equal( wisp_collision_mesh_get_stats( rigid ).open_edge_count, 0 );
        int inside = 0;
        for ( int i = 0; i < QUERIES; ++i )
        {
            wisp_vec3 p = query_point( &m, i );
            wisp_mesh_nearest a = closest( rigid, p, INFINITY ), b = closest( soft, p, INFINITY );
            assert_memory_equal( &a, &b, sizeof( a ) );
            if ( fabsf( a.distance ) > 1e-6f )
            {
                bool is_inside = winding_number( &m, xyzw, p ) > 0.5;
                assert_true( is_inside == ( a.distance < 0.0f ) );
                inside += is_inside ? 1 : 0;
            }
        }
        assert_true( inside > QUERIES / 20 );
    }
}

// A slender spike: next to its edges and its tip the nearest face alone would give the wrong side.
TEST( signs_hold_next_to_sharp_edges_and_tips )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_reserve( 4, 4 );
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0.05f, 0, 0 }, { 0.02f, 0, 0.03f }, { 0.3f, 2.0f, 0.1f } };
    memcpy( m.points, points, sizeof( points ) );
    m.point_count = 4;
    test_mesh_add_triangle( &m, 0, 1, 2 );
    test_mesh_add_triangle( &m, 1, 0, 3 );
    test_mesh_add_triangle( &m, 2, 1, 3 );
    test_mesh_add_triangle( &m, 0, 2, 3 );
    SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
    bool faces_out = winding_number( &m, xyzw, ( wisp_vec3 ){ 0.03f, 0.05f, 0.012f } ) > 0.5;
    assert_true( faces_out );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    int corners = 0, edges = 0, inside = 0;
    for ( int i = 0; i < 6000; ++i )
    {
        float at = test_random_float( i, 0, 0.0f, 1.0f );
        wisp_vec3 tip = points[i % 4], other = points[( i + 1 + i / 4 % 3 ) % 4];
        wisp_vec3 on = test_along( tip, i % 8 < 4 ? at : 0.0f, test_along( other, -1.0f, tip ) );
        wisp_vec3 p = test_sum( on, test_point( i, 4, ldexpf( 0.1f, -( i % 12 ) ) ) );
        wisp_mesh_nearest found = closest( tree, p, INFINITY );
        int zeros = ( found.weights[0] == 0.0f ) + ( found.weights[1] == 0.0f ) + ( found.weights[2] == 0.0f );
        corners += zeros == 2 ? 1 : 0;
        edges += zeros == 1 ? 1 : 0;
        if ( fabsf( found.distance ) > 1e-6f )
        {
            bool is_inside = winding_number( &m, xyzw, p ) > 0.5;
            assert_true( is_inside == ( found.distance < 0.0f ) );
            inside += is_inside ? 1 : 0;
        }
    }
    assert_true( corners > 300 && edges > 300 && inside > 100 );
}

TEST( an_open_sheet_is_signed_by_the_side_it_faces )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 8, 0.0f );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    assert_int_equal( wisp_collision_mesh_get_stats( tree ).open_edge_count, 4 * 8 );
    for ( int i = 0; i < QUERIES; ++i )
    {
        wisp_vec3 p = test_point( i, 0, 1.5f ); // also beyond the rim
        wisp_mesh_nearest found = closest( tree, p, INFINITY );
        assert_true( ( found.distance < 0.0f ) == ( p.y < 0.0f ) );
        // the sum of two products of up to 2, each rounded
        wisp_vec3 back = test_along( found.point, found.distance, found.normal );
        assert_true( length_of( test_along( back, -1.0f, p ) ) <= 1e-6f );
    }
}

TEST( the_normal_is_the_gradient_of_the_distance )
{
    test_mesh m = test_mesh_bumpy( 10 );
    wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    const float step = 1e-3f;
    int compared = 0;
    for ( int i = 0; i < QUERIES; ++i )
    {
        wisp_vec3 p = query_point( &m, 7 * ( i / 5 ) + i % 5 );
        wisp_mesh_nearest at = closest( tree, p, INFINITY );
        if ( fabsf( at.distance ) < 2.0f * step )
        {
            continue;
        }
        // on the way to the closest point it stays the closest, so the whole step counts: positions of up to 2 are
        // rounded
        float inward = at.distance > 0.0f ? -step : step;
        wisp_mesh_nearest then = closest( tree, test_along( p, inward, at.normal ), INFINITY );
        assert_float_equal( then.distance - at.distance, inward, 6e-7f );
        ++compared;
    }
    assert_true( compared > QUERIES / 5 );
    wisp_collision_mesh_release( tree );
    test_mesh_free( &m );
}

// ---- paths ----

// Paths that aim exactly at corners and edges, at any speed, cross the sheet; of two successive paths through it, one
// crosses.
TEST( nothing_tunnels_through_a_thin_sheet )
{
    for ( int waves = 0; waves < 2; ++waves )
    {
        SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 40, waves == 0 ? 0.0f : 0.2f );
        SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, true );
        for ( int i = 0; i < 4 * QUERIES; ++i )
        {
            wisp_vec3 aim = test_point( i, 0, 0.9f );
            int32_t v = ( 1 + test_random( i, 9, 39 ) ) * 41 + 1 + test_random( i, 10, 39 );
            aim = i % 3 == 0 ? m.points[v] : aim;
            aim = i % 3 == 1 ? test_along( m.points[v], test_random_float( i, 30, 0.0f, 1.0f ),
                                           test_along( m.points[v - 1], -1.0f, m.points[v] ) )
                             : aim;
            float up = ldexpf( 1.0f, test_random( i, 11, 14 ) - 1 ); // up to 4 km per step
            float slope = i % 2 == 0 ? 0.0f : 0.01f;
            wisp_vec3 from = { aim.x + slope * aim.z, up, aim.z };
            wisp_vec3 to = { aim.x - slope * aim.z, -up, aim.z };
            wisp_mesh_hit down = sweep( tree, from, to ), back = sweep( tree, to, from );
            assert_true( down.triangle >= 0 && down.side == 1.0f );
            assert_true( back.triangle >= 0 && back.side == -1.0f );

            // a stop on the way: exactly one of the halves crosses
            wisp_vec3 stop = down.point;
            int crossed = ( sweep( tree, from, stop ).triangle >= 0 ) + ( sweep( tree, stop, to ).triangle >= 0 );
            assert_true( crossed == 1 || ( waves == 1 && crossed == 2 ) );
        }
    }
}

TEST( steps_of_single_roundings_cross_just_once )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 8, 0.0f );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    for ( int i = 0; i < 200; ++i )
    {
        wisp_vec3 p = test_point( i, 0, 0.9f );
        int intersections = 0;
        for ( float y = 4.0f * FLT_MIN; y >= -4.0f * FLT_MIN; y -= FLT_MIN )
        {
            wisp_vec3 from = { p.x, y, p.z }, to = { p.x, y - FLT_MIN, p.z };
            intersections += sweep( tree, from, to ).triangle >= 0 ? 1 : 0;
        }
        assert_int_equal( intersections, 1 );
        assert_int_equal( sweep( tree, p, p ).triangle, -1 );
    }
}

// ---- meshes that deform ----

TEST( refitted_trees_answer_like_new_ones )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 30, 0.1f );
    SCOPED( free_local ) wisp_vec3* rest = checked_malloc( (size_t)m.point_count * sizeof( wisp_vec3 ) );
    memcpy( rest, m.points, (size_t)m.point_count * sizeof( wisp_vec3 ) );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, true );
    for ( int step = 0; step < 12; ++step )
    {
        crumple( &m, rest, step );
        assert_int_equal( wisp_collision_mesh_update( tree, NULL, m.points, NULL, NULL ), WISP_OK );
        SCOPED( tree_local ) wisp_collision_mesh* fresh = test_collision_mesh( &m, true );
        for ( int i = 0; i < 400; ++i )
        {
            wisp_vec3 p = query_point( &m, i ), to = test_sum( p, test_point( i, 30, 1.0f ) );
            wisp_mesh_nearest a = closest( tree, p, 1.0f ), b = closest( fresh, p, 1.0f );
            wisp_mesh_hit c = sweep( tree, p, to ), d = sweep( fresh, p, to );
            assert_memory_equal( &a, &b, sizeof( a ) );
            assert_memory_equal( &c, &d, sizeof( c ) );
        }
    }
    wisp_collision_mesh_stats info = wisp_collision_mesh_get_stats( tree );
    assert_int_equal( info.refit_count, 12 );
}

TEST( a_wrong_point_is_refused_and_its_neighbours_stay )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 12, 0.1f );
    SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, true );
    const float bad[] = { NAN, INFINITY, -INFINITY, 2e9f };
    SCOPED( free_local ) wisp_vec3* points = checked_malloc( (size_t)m.point_count * sizeof( wisp_vec3 ) );
    for ( int k = 0; k < WISP_COUNT( bad ); ++k )
    {
        memcpy( points, m.points, (size_t)m.point_count * sizeof( wisp_vec3 ) );
        points[3].y = 0.5f; // valid, but not to be used either
        points[77].z = bad[k];
        wisp_error error = { 0 };
        assert_int_equal( wisp_collision_mesh_update( tree, NULL, points, NULL, &error ), WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, "point 77: got " ) );
        assert_one_message( error.message );
        for ( int i = 0; i < 200; ++i )
        {
            assert_closest( &m, xyzw, tree, query_point( &m, i ), INFINITY );
        }
    }
}

TEST( a_rigid_mesh_cannot_be_updated )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_sheet( 2, 0.0f );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    wisp_error error = { 0 };
    assert_int_equal( wisp_collision_mesh_update( tree, NULL, m.points, NULL, &error ), WISP_CONFLICT );
    assert_one_message( error.message );
}

// ---- triangles without area ----

TEST( triangles_without_area_are_found_and_never_crossed )
{
    static wisp_vec3 points[] = { { 0, 0, 0 }, { 2, 0, 0 }, { 1, 0, 0 }, { 5, 5, 5 } };
    static int32_t triangles[] = { 0, 2, 1, 3, 3, 3, 0, 0, 1 };
    test_mesh m = { 4, 3, points, triangles };
    SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
    SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, false );
    assert_int_equal( wisp_collision_mesh_get_stats( tree ).flat_triangle_count, 3 );
    for ( int i = 0; i < 500; ++i )
    {
        wisp_vec3 p = test_point( i, 0, 6.0f );
        assert_closest( &m, xyzw, tree, p, INFINITY );
        assert_true( closest( tree, p, INFINITY ).distance >= 0.0f );
        assert_int_equal( sweep( tree, p, ( wisp_vec3 ){ 2.0f - p.x, -p.y, -p.z } ).triangle, -1 );
    }
    wisp_mesh_nearest on = closest( tree, points[3], 0.1f );
    assert_int_equal( on.triangle, 1 );
    assert_float_equal( on.normal.y, 1.0f, 0.0f );
}

// ---- threads ----

typedef struct query
{
    const test_mesh* mesh;
    wisp_collision_mesh* tree;
    int begin, end;
    wisp_mesh_query* queries;
    wisp_mesh_nearest* nearest;
    wisp_mesh_path* paths;
    wisp_mesh_hit* hits;
    wisp_collision_mesh_query_stats work;
} query;

static void* ask( void* context )
{
    query* a = context;
    for ( int i = a->begin; i < a->end; i += 50 )
    {
        wisp_collision_mesh_closest( a->tree, a->queries + i, 50, a->nearest + i, &a->work );
        wisp_collision_mesh_cast( a->tree, a->paths + i, 50, a->hits + i, &a->work );
    }
    return NULL;
}

TEST( two_threads_get_the_answers_of_one )
{
    enum
    {
        COUNT = 4000
    };
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_bumpy( 20 );
    query whole = { .mesh = &m, .tree = test_collision_mesh( &m, true ), .end = COUNT };
    whole.queries = calloc( COUNT, sizeof( wisp_mesh_query ) );
    whole.paths = calloc( COUNT, sizeof( wisp_mesh_path ) );
    whole.nearest = calloc( 2 * COUNT, sizeof( wisp_mesh_nearest ) );
    whole.hits = calloc( 2 * COUNT, sizeof( wisp_mesh_hit ) );
    assert_true( whole.queries && whole.paths && whole.nearest && whole.hits );
    for ( int i = 0; i < COUNT; ++i )
    {
        whole.queries[i] = ( wisp_mesh_query ){ .point = query_point( &m, i ), .radius = 0.5f };
        whole.paths[i].from = query_point( &m, i );
        whole.paths[i].to = test_sum( whole.paths[i].from, test_point( i, 20, 1.0f ) );
    }
    ask( &whole );

    query half[2];
    pthread_t threads[2];
    for ( int k = 0; k < 2; ++k )
    {
        half[k] = whole;
        half[k].work = ( wisp_collision_mesh_query_stats ){ 0 };
        half[k].nearest += COUNT;
        half[k].hits += COUNT;
        half[k].begin = k * COUNT / 2;
        half[k].end = ( k + 1 ) * COUNT / 2;
        assert_int_equal( pthread_create( threads + k, NULL, ask, half + k ), 0 );
    }
    assert_int_equal( pthread_join( threads[0], NULL ), 0 );
    assert_int_equal( pthread_join( threads[1], NULL ), 0 );
    assert_memory_equal( whole.nearest, whole.nearest + COUNT, COUNT * sizeof( wisp_mesh_nearest ) );
    assert_memory_equal( whole.hits, whole.hits + COUNT, COUNT * sizeof( wisp_mesh_hit ) );
    assert_int_equal( half[0].work.queried + half[1].work.queried, whole.work.queried );
    assert_int_equal( half[0].work.answered + half[1].work.answered, whole.work.answered );
    assert_int_equal( half[0].work.tested + half[1].work.tested, whole.work.tested );
    wisp_collision_mesh_release( whole.tree );
    free( whole.queries );
    free( whole.paths );
    free( whole.nearest );
    free( whole.hits );
}
