// Meshes searched by voxels: every result equals that of brute force, and that of the tree if there is one, to the
// last bit, for any size of the voxels.
#include "mesh_fixture.h"

enum
{
    QUERIES = 600,
    NO_SIZE = 1, // of voxels: the mean edge
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
    test_mesh sheet = test_mesh_sheet( 30, 0.1f );
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
    test_mesh_free( &sheet );
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

// Points on corners and edges, close to the surface, in the box of the mesh, outside it and far away.
static wisp_vec3 query_point( const test_mesh* m, int i )
{
    float size;
    wisp_vec3 middle = centre_of( m, &size );
    const int32_t* t = m->triangles + 3 * (size_t)test_random( i, 50, m->triangle_count );
    wisp_vec3 a = m->points[t[0]], b = m->points[t[1]];
    switch ( i % 7 )
    {
        case 0:
            return a;
        case 1:
            return ( wisp_vec3 ){ 0.5f * ( a.x + b.x ), 0.5f * ( a.y + b.y ), 0.5f * ( a.z + b.z ) };
        case 2:
            return test_sum( a, test_point( i, 7, 1e-3f * size ) );
        case 3:
            return test_sum( a, test_point( i, 7, 0.1f * size ) );
        case 4:
            return test_sum( middle, test_point( i, 7, size ) );
        case 5:
            return test_sum( middle, test_point( i, 7, 4.0f * size ) );
        default:
            return test_sum( middle, test_point( i, 7, 100.0f * size ) );
    }
}

// Long paths, steps of a particle close to the surface, and paths along an axis, which run within sides of voxels.
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

// ---- voxels ----

static wisp_collision_mesh* make_voxels( const test_mesh* m, bool deforms, float size )
{
    wisp_collision_mesh_def def = test_mesh_def( m, deforms );
    def.search = WISP_MESH_SEARCH_VOXELS;
    def.voxel_size = size;
    wisp_collision_mesh* tree = NULL;
    wisp_error error = { 0 };
    assert_ok( wisp_collision_mesh_create( &def, NULL, &tree, &error ), error );
    assert_int_equal( wisp_collision_mesh_get_stats( tree ).search, WISP_MESH_SEARCH_VOXELS );
    return tree;
}

// The tree to compare with; null in a library without Embree.
static wisp_collision_mesh* make_tree_if_any( const test_mesh* m, bool deforms )
{
    wisp_collision_mesh_def def = test_mesh_def( m, deforms );
    wisp_collision_mesh* tree = NULL;
    wisp_status status = wisp_collision_mesh_create( &def, NULL, &tree, NULL );
    assert_true( status == WISP_OK || status == WISP_CONFLICT );
    return tree;
}

static void assert_same_nearest( wisp_collision_mesh* tree, wisp_vec3 p, float radius,
                                 const wisp_mesh_nearest* found )
{
    if ( tree != NULL )
    {
        wisp_mesh_nearest other = closest( tree, p, radius );
        assert_memory_equal( found, &other, sizeof( other ) );
    }
}

static void assert_closest( const test_mesh* m, const float* xyzw, wisp_collision_mesh* voxels,
                            wisp_collision_mesh* tree, wisp_vec3 p, float radius )
{
    const wisp_mesh_nearest found = assert_closest_is_naive( m, xyzw, voxels, p, radius );
    assert_same_nearest( tree, p, radius, &found );
}

static bool assert_intersection( const test_mesh* m, const float* xyzw, wisp_collision_mesh* voxels,
                                 wisp_collision_mesh* tree, const wisp_mesh_path* path )
{
    triangle_intersection naive = { 0 };
    int32_t expected = naive_intersection( m, xyzw, path->from, path->to, &naive );
    wisp_mesh_hit hit = sweep( voxels, path->from, path->to );
    if ( tree != NULL )
    {
        wisp_mesh_hit other = sweep( tree, path->from, path->to );
        assert_memory_equal( &hit, &other, sizeof( hit ) );
    }
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

// ---- answers ----

static void ask_all( const test_mesh* m, wisp_collision_mesh* voxels, wisp_collision_mesh* tree, int queries,
                     int* answered, int* crossed )
{
    float* xyzw = test_mesh_quads( m );
    float size;
    centre_of( m, &size );
    const float radii[] = { INFINITY, 0.1f * size, 1e-3f * size, 0.0f, 2.0f * size };
    for ( int i = 0; i < queries; ++i )
    {
        wisp_vec3 p = query_point( m, i );
        wisp_mesh_path path = query_path( m, i );
        assert_closest( m, xyzw, voxels, tree, p, radii[i % WISP_COUNT( radii )] );
        *answered += closest( voxels, p, radii[i % WISP_COUNT( radii )] ).triangle >= 0 ? 1 : 0;
        *crossed += assert_intersection( m, xyzw, voxels, tree, &path ) ? 1 : 0;
    }
    free( xyzw );
}

TEST( answers_are_those_of_brute_force_and_of_the_tree_bit_for_bit )
{
    for ( int which = 0; which < MESHES; ++which )
    {
        test_mesh m = make_mesh( which );
        float size;
        centre_of( &m, &size );
        // of the mean edge, far smaller than possible, and as large as the mesh
        const float sizes[] = { 0.0f, 1e-3f * size, 3.0f * size };
        wisp_collision_mesh* tree = make_tree_if_any( &m, false );
        int answered = 0, crossed = 0, queries = which == BUNNY ? QUERIES / 8 : QUERIES;
        for ( int k = 0; k < ( which == BUNNY ? NO_SIZE : WISP_COUNT( sizes ) ); ++k )
        {
            for ( int deforms = 0; deforms < 2; ++deforms )
            {
                wisp_collision_mesh* voxels = make_voxels( &m, deforms == 1, sizes[k] );
                ask_all( &m, voxels, tree, queries, &answered, &crossed );
                wisp_collision_mesh_release( voxels );
            }
        }
        assert_true( answered > queries / 2 );
        assert_true( crossed > 10 || which == POINT_LIKE );
        wisp_collision_mesh_release( tree );
        test_mesh_free( &m );
    }
}

TEST( meshes_of_any_scale_are_answered_alike )
{
    const float scales[] = { 1e-6f, 1e-3f, 1e5f, 3e8f };
    for ( int k = 0; k < WISP_COUNT( scales ); ++k )
    {
        test_mesh m = move_mesh( test_mesh_bumpy( 8 ), scales[k], ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        wisp_collision_mesh *voxels = make_voxels( &m, false, 0.0f ), *tree = make_tree_if_any( &m, false );
        float* xyzw = test_mesh_quads( &m );
        int answered = 0;
        for ( int i = 0; i < QUERIES; ++i )
        {
            wisp_vec3 p = query_point( &m, 7 * i + i % 5 ); // within the reach
            wisp_mesh_path path = { .from = p, .to = query_point( &m, 7 * i + 4 ) };
            assert_closest( &m, xyzw, voxels, tree, p, i % 2 == 0 ? INFINITY : 0.05f * scales[k] );
            answered += assert_intersection( &m, xyzw, voxels, tree, &path ) ? 1 : 0;
        }
        assert_true( answered > QUERIES / 10 );
        free( xyzw );
        wisp_collision_mesh_release( voxels );
        wisp_collision_mesh_release( tree );
        test_mesh_free( &m );
    }
}

TEST( the_middle_of_a_ball_finds_the_lowest_of_what_is_equally_far )
{
    test_mesh m = test_mesh_ball( 16, false );
    float* xyzw = test_mesh_quads( &m );
    wisp_collision_mesh* voxels = make_voxels( &m, false, 0.0f );
    assert_true( wisp_collision_mesh_get_stats( voxels ).voxel_count > 15 * 15 * 15 ); // blocks are searched
    for ( int i = 0; i < 200; ++i )
    {
        wisp_vec3 p = test_point( i, 3, i < 100 ? 1e-3f : 0.5f );
        assert_closest( &m, xyzw, voxels, NULL, p, INFINITY );
        assert_true( closest( voxels, p, INFINITY ).distance < 0.0f );
        assert_closest( &m, xyzw, voxels, NULL, p, 0.9f );
    }
    assert_closest( &m, xyzw, voxels, NULL, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, INFINITY );
    wisp_collision_mesh_release( voxels );
    free( xyzw );
    test_mesh_free( &m );
}

TEST( few_triangles_are_looked_at_near_the_surface )
{
    test_mesh m = test_mesh_ball( 40, false ); // 19 200 triangles
    wisp_collision_mesh* voxels = make_voxels( &m, false, 0.0f );
    wisp_collision_mesh_query_stats work = { 0 };
    for ( int i = 0; i < 1000; ++i )
    {
        wisp_vec3 p = test_sum( m.points[test_random( i, 1, m.point_count )], test_point( i, 2, 0.01f ) );
        wisp_mesh_query query = { .point = p, .radius = 0.02f };
        wisp_mesh_path path = { .from = p, .to = test_sum( p, test_point( i, 4, 0.02f ) ) };
        wisp_mesh_nearest nearest;
        wisp_mesh_hit hit;
        wisp_collision_mesh_closest( voxels, &query, 1, &nearest, &work );
        wisp_collision_mesh_cast( voxels, &path, 1, &hit, &work );
    }
    // a voxel of a mean edge is touched by about 8 triangles, and 8 voxels are within reach
    assert_true( work.tested < 40 * work.queried );
    assert_int_equal( work.queried, 2000 );
    assert_int_equal( work.refused, 0 );
    wisp_collision_mesh_release( voxels );
    test_mesh_free( &m );
}

TEST( numbers_that_are_none_are_refused )
{
    test_mesh m = test_mesh_ball( 4, false );
    wisp_collision_mesh* voxels = make_voxels( &m, true, 0.0f );
    assert_refuses_bad_numbers( voxels );
    wisp_collision_mesh_release( voxels );
    test_mesh_free( &m );
}

TEST( the_ends_of_the_reach_are_answered )
{
    test_mesh m = test_mesh_ball( 4, false );
    wisp_collision_mesh* voxels = make_voxels( &m, false, 1e-6f );
    assert_answers_the_ends_of_the_reach( voxels );
    wisp_collision_mesh_release( voxels );
    test_mesh_free( &m );
}

// ---- meshes that deform ----

static wisp_vec3* copy_points( const test_mesh* m )
{
    wisp_vec3* points = checked_malloc( (size_t)m->point_count * sizeof( wisp_vec3 ) );
    memcpy( points, m->points, (size_t)m->point_count * sizeof( wisp_vec3 ) );
    return points;
}

TEST( voxels_of_a_mesh_that_deforms_are_built_again )
{
    test_mesh m = test_mesh_sheet( 24, 0.1f );
    wisp_vec3* rest = copy_points( &m );
    wisp_collision_mesh *voxels = make_voxels( &m, true, 0.0f ), *tree = make_tree_if_any( &m, true );
    for ( int step = 0; step < 8; ++step )
    {
        crumple( &m, rest, step );
        assert_int_equal( wisp_collision_mesh_update( voxels, NULL, m.points, NULL, NULL ), WISP_OK );
        assert_true( tree == NULL || wisp_collision_mesh_update( tree, NULL, m.points, NULL, NULL ) == WISP_OK );
        int answered = 0, crossed = 0;
        ask_all( &m, voxels, tree, 200, &answered, &crossed );
        assert_true( answered > 100 && crossed > 10 );
    }
    wisp_collision_mesh_stats info = wisp_collision_mesh_get_stats( voxels );
    assert_int_equal( info.build_count, 9 );
    assert_int_equal( info.refit_count, 0 );
    wisp_collision_mesh_release( voxels );
    wisp_collision_mesh_release( tree );
    free( rest );
    test_mesh_free( &m );
}

TEST( an_update_that_fails_leaves_everything_as_it_was )
{
    test_mesh m = test_mesh_sheet( 12, 0.1f );
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    wisp_collision_mesh_def def = test_mesh_def( &m, true );
    def.search = WISP_MESH_SEARCH_VOXELS;
    wisp_collision_mesh* voxels;
    assert_int_equal( wisp_collision_mesh_create( &def, &allocator, &voxels, NULL ), WISP_OK );
    wisp_vec3* moved = copy_points( &m );
    int answered = 0, crossed = 0;

    moved[3].y = 0.5f; // valid, but not to be used either
    moved[77].z = NAN;
    wisp_error error = { 0 };
    assert_int_equal( wisp_collision_mesh_update( voxels, NULL, moved, NULL, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "point 77: got " ) );
    assert_one_message( error.message );
    ask_all( &m, voxels, NULL, 200, &answered, &crossed );

    // Crumpled, the flat sheet needs far more voxels; each block that is refused on the way leaves it flat.
    crumple( &m, m.points, 4 );
    memcpy( moved, m.points, (size_t)m.point_count * sizeof( wisp_vec3 ) );
    test_mesh flat = test_mesh_sheet( 12, 0.1f );
    bool refused = true;
    int n = 1;
    for ( ; refused; ++n )
    {
        test_host_refuse( &host, n, false );
        wisp_status status = wisp_collision_mesh_update( voxels, NULL, moved, NULL, &error );
        refused = test_host_has_refused( &host );
        test_host_refuse( &host, 0, false );
        assert_int_equal( status, refused ? WISP_NO_MEMORY : WISP_OK );
        ask_all( refused ? &flat : &m, voxels, NULL, 200, &answered, &crossed );
    }
    assert_true( n > 2 );
    assert_true( answered > 100 && crossed > 10 );
    wisp_collision_mesh_release( voxels );
    assert_host_memory_is_released( &host );
    free( moved );
    test_mesh_free( &flat );
    test_mesh_free( &m );
}

TEST( a_rigid_mesh_cannot_be_updated )
{
    test_mesh m = test_mesh_sheet( 2, 0.0f );
    wisp_collision_mesh* voxels = make_voxels( &m, false, 0.0f );
    wisp_error error = { 0 };
    assert_int_equal( wisp_collision_mesh_update( voxels, NULL, m.points, NULL, &error ), WISP_CONFLICT );
    assert_one_message( error.message );
    wisp_collision_mesh_release( voxels );
    test_mesh_free( &m );
}

// ---- limits ----

TEST( voxels_are_no_more_than_there_may_be )
{
    for ( int which = 0; which < POINT_LIKE; ++which )
    {
        test_mesh m = make_mesh( which );
        wisp_collision_mesh* wide = make_voxels( &m, false, 1e6f );
        wisp_collision_mesh_stats info = wisp_collision_mesh_get_stats( wide );
        assert_true( info.voxel_count == 1 && info.voxel_size == 1e6f && !info.coarse );

        wisp_collision_mesh* fine = make_voxels( &m, false, 1e-8f );
        info = wisp_collision_mesh_get_stats( fine );
        assert_true( info.voxel_count >= 1 && info.voxel_count <= 16 * m.triangle_count );
        assert_true( info.coarse && info.voxel_size > 1e-8f );
        // 4 bytes per voxel, 8 per block of at least one, 64 places of 4 bytes per triangle; once it grows by half
        // more
        size_t most = 3 * (size_t)m.triangle_count * ( 16 * ( 4 + 8 ) + 64 * 4 ) / 2 + 4096;
        assert_true( wisp_collision_mesh_bytes( fine ) - wisp_collision_mesh_bytes( wide ) <= most );
        wisp_collision_mesh_release( wide );
        wisp_collision_mesh_release( fine );
        test_mesh_free( &m );
    }
}

TEST( voxels_are_as_large_as_queried_for )
{
    test_mesh m = test_mesh_ball( 20, false );
    wisp_collision_mesh* queried = make_voxels( &m, false, 0.125f );
    wisp_collision_mesh_stats info = wisp_collision_mesh_get_stats( queried );
    assert_true( info.voxel_size == 0.125f && !info.coarse );
    assert_int_equal( info.voxel_count, 17 * 17 * 17 ); // 16 over the diameter, and the effect of rounding
    wisp_collision_mesh* own = make_voxels( &m, false, 0.0f );
    info = wisp_collision_mesh_get_stats( own );
    // a quarter of a circle's length, cut into 20, and its diagonal in every third edge
    assert_true( info.voxel_size > 0.07f && info.voxel_size < 0.12f && !info.coarse );
    wisp_collision_mesh_release( queried );
    wisp_collision_mesh_release( own );
    test_mesh_free( &m );
}

TEST( a_limit_of_memory_makes_voxels_larger )
{
    test_mesh m = test_mesh_bumpy( 20 );
    wisp_collision_mesh_def def = test_mesh_def( &m, false );
    def.search = WISP_MESH_SEARCH_VOXELS;
    wisp_collision_mesh *free_one, *limited, *none;
    wisp_error error = { 0 };
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &free_one, NULL ), WISP_OK );
    def.memory_limit = 100000; // of some 160 000
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &limited, &error ), WISP_OK );
    wisp_collision_mesh_stats info = wisp_collision_mesh_get_stats( limited );
    assert_true( info.coarse && info.voxel_count < wisp_collision_mesh_get_stats( free_one ).voxel_count );
    assert_true( wisp_collision_mesh_bytes( limited ) < wisp_collision_mesh_bytes( free_one ) );
    for ( int i = 0; i < 200; ++i )
    {
        wisp_vec3 p = query_point( &m, i );
        wisp_mesh_nearest a = closest( limited, p, INFINITY );
        assert_same_nearest( free_one, p, INFINITY, &a );
    }
    def.memory_limit = 100; // not even one list of all triangles
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &none, &error ), WISP_NO_MEMORY );
    assert_null( none );
    assert_one_message( error.message );
    wisp_collision_mesh_release( free_one );
    wisp_collision_mesh_release( limited );
    test_mesh_free( &m );
}

TEST( every_refused_block_is_a_message_and_leaves_nothing )
{
    test_mesh m = test_mesh_ball( 4, false );
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        wisp_collision_mesh_def def = test_mesh_def( &m, deforms == 1 );
        def.search = WISP_MESH_SEARCH_VOXELS;
        int64_t bytes[2];
        assert_true( assert_refused_blocks_are_messages( &def, bytes ) > 8 );
        assert_true( bytes[0] == bytes[1] );
    }
    test_mesh_free( &m );
}

TEST( a_wrong_search_is_refused )
{
    test_mesh m = test_mesh_ball( 2, false );
    const struct
    {
        int search;
        float size;
        const char* word;
    } wrong[] = {
        { WISP_MESH_SEARCH_COUNT, 0.0f, "search 2" },   { -1, 0.0f, "search -1" },
        { WISP_MESH_SEARCH_VOXELS, -1.0f, "-1 m" },     { WISP_MESH_SEARCH_VOXELS, NAN, "nan m" },
        { WISP_MESH_SEARCH_VOXELS, INFINITY, "inf m" },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_collision_mesh_def def = test_mesh_def( &m, false );
        def.search = (wisp_mesh_search)wrong[i].search;
        def.voxel_size = wrong[i].size;
        wisp_collision_mesh* tree = (wisp_collision_mesh*)1;
        wisp_error error = { 0 };
        assert_int_equal( wisp_collision_mesh_create( &def, NULL, &tree, &error ), WISP_BAD_INPUT );
        assert_null( tree );
        assert_one_message( error.message );
        assert_non_null( strstr( error.message, wrong[i].word ) );
    }
    test_mesh_free( &m );
}
