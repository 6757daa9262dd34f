// Trees of meshes: every result of a rigid mesh, whose tree is Embree's if there is one, and of one that deforms, whose tree is the
// engine's own, equals that of brute force to the last bit, on meshes of any kind and size.
#include "mesh_fixture.h"

enum
{
    QUERIES = 600,
};

// ---- meshes ----

// Long triangles, the slenderest of which is as wide as a hundred-thousandth of its length. More slender ones still
// have a face in double precision, but the nearest point on it is rounding.
static test_mesh make_needles( int count )
{
    test_mesh m = test_mesh_reserve( 3 * count, count );
    for ( int i = 0; i < count; ++i )
    {
        wisp_vec3 a = test_point( i, 70, 1.0f ), way = test_point( i, 71, 0.7f ), aside = test_point( i, 72, 1.0f );
        float width = powf( 10.0f, -(float)( i % 5 ) - 1.0f );
        m.points[3 * i] = a;
        m.points[3 * i + 1] = test_sum( a, way );
        m.points[3 * i + 2] = test_along( test_along( a, 0.6f, way ), width, aside );
        m.point_count += 3;
        test_mesh_add_triangle( &m, 3 * i, 3 * i + 1, 3 * i + 2 );
    }
    return m;
}

// Points and lines among triangles: coincident corners, collinear corners, the same corner twice.
static test_mesh make_degenerate( void )
{
    test_mesh m = test_mesh_ball( 6, false );
    for ( int k = 0; k < m.triangle_count; k += 3 )
    {
        int32_t* t = m.triangles + 3 * (size_t)k;
        if ( k % 2 == 0 )
        {
            t[2] = t[1];
        }
        else
        {
            t[0] = t[1] = t[2];
        }
    }
    for ( int i = 0; i < m.point_count; i += 7 )
    {
        m.points[i] = m.points[( i + 1 ) % m.point_count];
    }
    return m;
}

// A few triangles through the whole mesh among many small ones.
static test_mesh make_mixed( void )
{
    SCOPED( test_mesh_free ) test_mesh sheet = test_mesh_sheet( 30, 0.1f );
    test_mesh m = test_mesh_reserve( sheet.point_count + 30, sheet.triangle_count + 10 );
    memcpy( m.points, sheet.points, (size_t)sheet.point_count * sizeof( wisp_vec3 ) );
    memcpy( m.triangles, sheet.triangles, 3 * (size_t)sheet.triangle_count * sizeof( int32_t ) );
    m.point_count = sheet.point_count;
    m.triangle_count = sheet.triangle_count;
    for ( int i = 0; i < 10; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            m.points[m.point_count++] = test_point( 3 * i + k, 73, 3.0f );
        }
        test_mesh_add_triangle( &m, m.point_count - 3, m.point_count - 2, m.point_count - 1 );
    }
    return m;
}

static test_mesh move_mesh( test_mesh m, float scale, wisp_vec3 by )
{
    for ( int i = 0; i < m.point_count; ++i )
    {
        m.points[i] = test_along( by, scale, m.points[i] );
    }
    return m;
}

static test_mesh make_point_like( void )
{
    test_mesh m = test_mesh_reserve( 3, 2 );
    m.point_count = 3;
    m.points[0] = m.points[1] = m.points[2] = ( wisp_vec3 ){ 3.0f, -2.0f, 1.0f };
    test_mesh_add_triangle( &m, 0, 1, 2 );
    test_mesh_add_triangle( &m, 2, 1, 0 );
    return m;
}

enum
{
    POINT_LIKE = 9,
    BUNNY = 10,
    MESHES,
};

static test_mesh make_mesh( int which )
{
    switch ( which )
    {
        case 0:
            return test_mesh_ball( 12, false );
        case 1:
            return test_mesh_ball( 3, true );
        case 2:
            return test_mesh_bumpy( 14 );
        case 3:
            return test_mesh_sheet( 20, 0.3f );
        case 4:
            return test_mesh_sheet( 8, 0.0f );
        case 5:
            return make_needles( 300 );
        case 6:
            return make_degenerate();
        case 7:
            return make_mixed();
        case 8: // far from the origin, where a rounding of a coordinate is a hundredth of an edge
            return move_mesh( test_mesh_bumpy( 8 ), 1.0f, ( wisp_vec3 ){ 9000.0f, -4000.0f, 12000.0f } );
        case POINT_LIKE:
            return make_point_like();
        case BUNNY:
            return test_mesh_read( WISP_SOURCE_ROOT "/data/bunny.obj" );
    }
    return ( test_mesh ){ 0 };
}

// Long paths, steps of a particle close to the surface, and paths along an axis.
static wisp_mesh_path query_path( const test_mesh* m, int i )
{
    float size;
    centre_of( m, &size );
    wisp_vec3 from = query_point( m, i ), step = test_point( i, 20, i % 2 == 0 ? 3.0f * size : 0.02f * size );
    if ( i % 7 == 6 )
    {
        wisp_vec3 other = query_point( m, i + 1 );
        return ( wisp_mesh_path ){ .from = from, .to = test_along( other, 1.0f, test_along( other, -1.0f, from ) ) };
    }
    float* part = &step.x;
    if ( i % 5 == 0 )
    {
        part[i % 3] = 0.0f;
        part[( i + 1 ) % 3] = i % 10 == 0 ? 0.0f : part[( i + 1 ) % 3];
    }
    return ( wisp_mesh_path ){ .from = from, .to = test_sum( from, step ) };
}

// ---- answers ----

typedef struct tally
{
    int answered, crossed;
} tally;

static bool assert_intersection( const test_mesh* m, const float* xyzw, wisp_collision_mesh* tree,
                                 const wisp_mesh_path* path )
{
    triangle_intersection naive = { 0 };
    int32_t expected = naive_intersection( m, xyzw, path->from, path->to, &naive );
    wisp_mesh_hit hit = sweep( tree, path->from, path->to );
    assert_int_equal( hit.triangle, expected );
    if ( expected < 0 )
    {
        return false;
    }
    assert_true( hit.time == (float)naive.time );
    assert_true( hit.side == ( naive.from_front ? 1.0f : -1.0f ) );
    for ( int k = 0; k < 3; ++k )
    {
        assert_true( hit.weights[k] == (float)naive.weights[k] );
    }
    return true;
}

// Ask both kinds of trees, whose answers are the same bits.
static void ask( const test_mesh* m, const float* xyzw, wisp_collision_mesh* const trees[2], wisp_vec3 p,
                 float radius, const wisp_mesh_path* path, tally* t )
{
    wisp_mesh_nearest nearest[2];
    wisp_mesh_hit hits[2];
    bool crossed = false;
    for ( int k = 0; k < 2; ++k )
    {
        nearest[k] = assert_closest_is_naive( m, xyzw, trees[k], p, radius );
        crossed = assert_intersection( m, xyzw, trees[k], path );
        hits[k] = sweep( trees[k], path->from, path->to );
    }
    assert_memory_equal( nearest, nearest + 1, sizeof( nearest[0] ) );
    assert_memory_equal( hits, hits + 1, sizeof( hits[0] ) );
    t->answered += nearest[0].triangle >= 0 ? 1 : 0;
    t->crossed += crossed ? 1 : 0;
}

TEST( answers_are_those_of_brute_force_by_both_trees_bit_for_bit )
{
    for ( int which = 0; which < MESHES; ++which )
    {
        SCOPED( test_mesh_free ) test_mesh m = make_mesh( which );
        SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
        float size;
        centre_of( &m, &size );
        const float radii[] = { INFINITY, 0.1f * size, 1e-3f * size, 0.0f, 2.0f * size };
        wisp_collision_mesh* trees[2] = { test_collision_mesh( &m, false ), test_collision_mesh( &m, true ) };
        const int queries = which == BUNNY ? QUERIES / 8 : QUERIES;
        tally t = { 0, 0 };
        for ( int i = 0; i < queries; ++i )
        {
            const wisp_mesh_path path = query_path( &m, i );
            ask( &m, xyzw, trees, query_point( &m, i ), radii[i % WISP_COUNT( radii )], &path, &t );
        }
        assert_true( t.answered > queries / 2 );
        assert_true( t.crossed > 10 || which == POINT_LIKE );
        wisp_collision_mesh_release( trees[0] );
        wisp_collision_mesh_release( trees[1] );
    }
}

TEST( meshes_of_any_scale_are_answered_alike )
{
    const float scales[] = { 1e-6f, 1e-3f, 1e5f, 3e8f };
    for ( int k = 0; k < WISP_COUNT( scales ); ++k )
    {
        SCOPED( test_mesh_free )
        test_mesh m = move_mesh( test_mesh_bumpy( 8 ), scales[k], ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        wisp_collision_mesh* trees[2] = { test_collision_mesh( &m, false ), test_collision_mesh( &m, true ) };
        float* xyzw = test_mesh_quads( &m );
        tally t = { 0, 0 };
        for ( int i = 0; i < QUERIES; ++i )
        {
            wisp_vec3 p = query_point( &m, 7 * i + i % 5 ); // within the reach
            wisp_mesh_path path = { .from = p, .to = query_point( &m, 7 * i + 4 ) };
            ask( &m, xyzw, trees, p, i % 2 == 0 ? INFINITY : 0.05f * scales[k], &path, &t );
        }
        assert_true( t.crossed > QUERIES / 10 );
        free( xyzw );
        wisp_collision_mesh_release( trees[0] );
        wisp_collision_mesh_release( trees[1] );
    }
}

// Up to 1e6 m: in single precision where a path begins is rounded by a tenth of the mesh. From farther away double precision no
// longer tells which triangle comes first.
TEST( paths_from_far_away_meet_a_small_mesh )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_bumpy( 8 );
    wisp_collision_mesh* trees[2] = { test_collision_mesh( &m, false ), test_collision_mesh( &m, true ) };
    float* xyzw = test_mesh_quads( &m );
    tally t = { 0, 0 };
    for ( int i = 0; i < QUERIES; ++i )
    {
        const float distance = powf( 10.0f, 2.0f + (float)( i % 5 ) );
        const wisp_vec3 aside = test_point( i, 3, distance );
        const wisp_mesh_path path = { .from = aside, .to = { -aside.x, -aside.y, -aside.z } };
        ask( &m, xyzw, trees, aside, INFINITY, &path, &t );
    }
    assert_int_equal( t.crossed, QUERIES );
    free( xyzw );
    wisp_collision_mesh_release( trees[0] );
    wisp_collision_mesh_release( trees[1] );
}

TEST( the_middle_of_a_ball_finds_the_lowest_of_what_is_equally_far )
{
    SCOPED( test_mesh_free ) test_mesh m = test_mesh_ball( 16, false );
    SCOPED( free_local ) float* xyzw = test_mesh_quads( &m );
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, deforms == 1 );
        for ( int i = 0; i < 200; ++i )
        {
            wisp_vec3 p = test_point( i, 3, i < 100 ? 1e-3f : 0.5f );
            assert_true( assert_closest_is_naive( &m, xyzw, tree, p, INFINITY ).distance < 0.0f );
            assert_closest_is_naive( &m, xyzw, tree, p, 0.9f );
        }
        assert_closest_is_naive( &m, xyzw, tree, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, INFINITY );
    }
}

TEST( few_triangles_are_looked_at_near_the_surface )
{
    test_mesh m = test_mesh_ball( 40, false ); // 19 200 triangles
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        SCOPED( tree_local ) wisp_collision_mesh* tree = test_collision_mesh( &m, deforms == 1 );
        wisp_collision_mesh_query_stats work = { 0 };
        for ( int i = 0; i < 1000; ++i )
        {
            wisp_vec3 p = test_sum( m.points[test_random( i, 1, m.point_count )], test_point( i, 2, 0.01f ) );
            wisp_mesh_query query = { .point = p, .radius = 0.02f };
            wisp_mesh_path path = { .from = p, .to = test_sum( p, test_point( i, 4, 0.02f ) ) };
            wisp_mesh_nearest nearest;
            wisp_mesh_hit hit;
            wisp_collision_mesh_closest( tree, &query, 1, &nearest, &work );
            wisp_collision_mesh_cast( tree, &path, 1, &hit, &work );
        }
        assert_true( work.tested < 40 * work.queried );
        assert_int_equal( work.queried, 2000 );
        assert_int_equal( work.refused, 0 );
    }
    test_mesh_free( &m );
}
