/// Collision meshes, and brute force results for closest points and crossings.
#pragma once

#include "support.h"

#include "mesh_triangle.h"

#include "wisp/module/collision_mesh.h"

/// For locals that point to a mesh of collision.
static inline void tree_local( wisp_collision_mesh** local )
{
    wisp_collision_mesh_release( *local );
}

typedef struct test_mesh
{
    int point_count, triangle_count;
    wisp_vec3* points;
    int32_t* triangles;
} test_mesh;

static inline test_mesh test_mesh_reserve( int points, int triangles )
{
    test_mesh m = { .points = calloc( (size_t)points, sizeof( wisp_vec3 ) ),
                    .triangles = calloc( 3 * (size_t)triangles, sizeof( int32_t ) ) };
    assert_non_null( m.points );
    assert_non_null( m.triangles );
    return m;
}

static inline void test_mesh_free( test_mesh* m )
{
    free( m->points );
    free( m->triangles );
    *m = ( test_mesh ){ 0 };
}

static inline void test_mesh_add_triangle( test_mesh* m, int32_t a, int32_t b, int32_t c )
{
    int32_t* t = m->triangles + 3 * (size_t)m->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static inline wisp_collision_mesh_def test_mesh_def( const test_mesh* m, bool deforms )
{
    return ( wisp_collision_mesh_def ){ .points = m->points,
                                        .triangles = m->triangles,
                                        .point_count = m->point_count,
                                        .triangle_count = m->triangle_count,
                                        .deforms = deforms };
}

static inline wisp_collision_mesh* test_collision_mesh( const test_mesh* m, bool deforms )
{
    wisp_collision_mesh_def def = test_mesh_def( m, deforms );
    wisp_collision_mesh* tree = NULL;
    wisp_error error = { 0 };
    assert_ok( wisp_collision_mesh_create( &def, NULL, &tree, &error ), error );
    return tree;
}

// ---- shapes ----

/// A closed ball: a cube's faces of n x n squares, pushed out to radius 1, or left a cube of half extent 1.
static inline test_mesh test_mesh_ball( int n, bool is_cube )
{
    test_mesh m = test_mesh_reserve( 6 * ( n + 1 ) * ( n + 1 ), 12 * n * n );
    int side = n + 1, lattice = side * side * side;
    SCOPED( free_local ) int32_t* number = checked_malloc( (size_t)lattice * sizeof( int32_t ) );
    memset( number, -1, (size_t)lattice * sizeof( int32_t ) );
    for ( int face = 0; face < 6; ++face )
    {
        int axis = face / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
        for ( int i = 0; i < n * n; ++i )
        {
            int32_t corner[4];
            for ( int k = 0; k < 4; ++k )
            {
                int at[3];
                at[axis] = face % 2 * n;
                at[u] = i % n + ( k == 1 || k == 2 ? 1 : 0 );
                at[v] = i / n + ( k >= 2 ? 1 : 0 );
                int32_t* found = number + ( at[2] * side + at[1] ) * side + at[0];
                if ( *found < 0 )
                {
                    float p[3];
                    for ( int a = 0; a < 3; ++a )
                    {
                        p[a] = 2.0f * (float)at[a] / (float)n - 1.0f;
                    }
                    float length = is_cube ? 1.0f : sqrtf( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] );
                    *found = m.point_count;
                    m.points[m.point_count++] = ( wisp_vec3 ){ p[0] / length, p[1] / length, p[2] / length };
                }
                corner[k] = *found;
            }
            bool is_up = face % 2 == 1;
            test_mesh_add_triangle( &m, corner[0], corner[is_up ? 1 : 2], corner[is_up ? 2 : 1] );
            test_mesh_add_triangle( &m, corner[0], corner[is_up ? 2 : 3], corner[is_up ? 3 : 2] );
        }
    }
    return m;
}

/// The ball with bumps and dents of a fifth of its radius, so sharp that they fold.
static inline test_mesh test_mesh_bumpy( int n )
{
    test_mesh m = test_mesh_ball( n, false );
    for ( int i = 0; i < m.point_count; ++i )
    {
        wisp_vec3* p = m.points + i;
        float r = 1.0f + 0.2f * sinf( 9.0f * p->x + 1.0f ) * sinf( 8.0f * p->y ) * cosf( 7.0f * p->z ) +
                  test_random_float( i, 0, -0.02f, 0.02f );
        *p = ( wisp_vec3 ){ r * p->x, r * p->y, r * p->z };
    }
    return m;
}

/// An open sheet of n x n squares over [-1, 1]^2 that faces +y, with waves of the given height.
static inline test_mesh test_mesh_sheet( int n, float height )
{
    test_mesh m = test_mesh_reserve( ( n + 1 ) * ( n + 1 ), 2 * n * n );
    for ( int i = 0; i < ( n + 1 ) * ( n + 1 ); ++i )
    {
        float x = 2.0f * (float)( i % ( n + 1 ) ) / (float)n - 1.0f,
              z = 2.0f * (float)( i / ( n + 1 ) ) / (float)n - 1.0f;
        m.points[m.point_count++] = ( wisp_vec3 ){ x, height * sinf( 5.0f * x + 2.0f * z ) * cosf( 4.0f * z ), z };
    }
    for ( int i = 0; i < n * n; ++i )
    {
        int32_t a = i / n * ( n + 1 ) + i % n, b = a + 1, c = a + n + 1, d = c + 1;
        test_mesh_add_triangle( &m, a, c, b );
        test_mesh_add_triangle( &m, b, c, d );
    }
    return m;
}

/// Vertices and triangles of a Wavefront file without other statements.
static inline test_mesh test_mesh_read( const char* path )
{
    FILE* file = fopen( path, "r" );
    assert_non_null( file );
    test_mesh m = test_mesh_reserve( 100000, 200000 );
    char line[256];
    while ( fgets( line, sizeof( line ), file ) != NULL )
    {
        wisp_vec3 p;
        int a, b, c;
        if ( sscanf( line, "v %f %f %f", &p.x, &p.y, &p.z ) == 3 && m.point_count < 100000 )
        {
            m.points[m.point_count++] = p;
        }
        else if ( sscanf( line, "f %d%*[^ ] %d%*[^ ] %d", &a, &b, &c ) == 3 ||
                  sscanf( line, "f %d %d %d", &a, &b, &c ) == 3 )
        {
            assert_true( m.triangle_count < 200000 );
            test_mesh_add_triangle( &m, a - 1, b - 1, c - 1 );
        }
    }
    fclose( file );
    return m;
}

// ---- brute force ----

static inline float* test_mesh_quads( const test_mesh* m )
{
    float* xyzw = checked_calloc( 4 * (size_t)m->point_count, sizeof( float ) );
    for ( int i = 0; i < m->point_count; ++i )
    {
        memcpy( xyzw + 4 * (size_t)i, m->points + i, sizeof( wisp_vec3 ) );
    }
    return xyzw;
}

/// The closest triangle of all; ties go to the lowest index.
static inline int32_t naive_closest( const test_mesh* m, const float* xyzw, wisp_vec3 p, triangle_nearest* best )
{
    int32_t found = -1;
    for ( int32_t k = 0; k < m->triangle_count; ++k )
    {
        triangle_corners t = triangle_load( xyzw, m->triangles, k );
        triangle_nearest nearest;
        triangle_find_nearest( &nearest, &t, double3_widen( p ) );
        if ( found < 0 || nearest.squared < best->squared )
        {
            found = k;
            *best = nearest;
        }
    }
    return found;
}

/// The first triangle crossed; ties go to the lowest index; -1: none.
static inline int32_t naive_intersection( const test_mesh* m, const float* xyzw, wisp_vec3 from, wisp_vec3 to,
                                          triangle_intersection* best )
{
    int32_t found = -1;
    for ( int32_t k = 0; k < m->triangle_count; ++k )
    {
        triangle_corners t = triangle_load( xyzw, m->triangles, k );
        triangle_intersection intersection;
        if ( triangle_cross( &t, double3_widen( from ), double3_widen( to ), &intersection ) &&
             ( found < 0 || intersection.time < best->time ) )
        {
            found = k;
            *best = intersection;
        }
    }
    return found;
}

/// The winding number of the surface around a point, by solid angles (Van Oosterom and Strackee 1983): 1 inside a
/// closed mesh, 0 outside.
static inline double winding_number( const test_mesh* m, const float* xyzw, wisp_vec3 point )
{
    double sum = 0.0;
    for ( int32_t k = 0; k < m->triangle_count; ++k )
    {
        triangle_corners t = triangle_load( xyzw, m->triangles, k );
        double3 p = double3_widen( point );
        double3 a = double3_sub( t.at[0], p ), b = double3_sub( t.at[1], p ), c = double3_sub( t.at[2], p );
        double la = sqrt( double3_dot( a, a ) ), lb = sqrt( double3_dot( b, b ) ), lc = sqrt( double3_dot( c, c ) );
        double volume = double3_dot( a, double3_cross( b, c ) );
        double rest = la * lb * lc + double3_dot( a, b ) * lc + double3_dot( b, c ) * la + double3_dot( c, a ) * lb;
        sum += 2.0 * atan2( volume, rest );
    }
    return sum / ( 4.0 * 3.14159265358979323846 );
}

static inline wisp_vec3 test_point( int i, int k, float size )
{
    return ( wisp_vec3 ){ test_random_float( i, 3 * k, -size, size ), test_random_float( i, 3 * k + 1, -size, size ),
                          test_random_float( i, 3 * k + 2, -size, size ) };
}

static inline wisp_vec3 test_along( wisp_vec3 a, float s, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static inline wisp_vec3 test_sum( wisp_vec3 a, wisp_vec3 b )
{
    return test_along( a, 1.0f, b );
}

static inline wisp_mesh_nearest closest( wisp_collision_mesh* tree, wisp_vec3 p, float radius )
{
    wisp_mesh_nearest nearest;
    wisp_collision_mesh_closest( tree, &( wisp_mesh_query ){ .point = p, .radius = radius }, 1, &nearest, NULL );
    return nearest;
}

static inline wisp_mesh_hit sweep( wisp_collision_mesh* tree, wisp_vec3 from, wisp_vec3 to )
{
    wisp_mesh_hit hit;
    wisp_collision_mesh_cast( tree, &( wisp_mesh_path ){ .from = from, .to = to }, 1, &hit, NULL );
    return hit;
}

/// The closest point equals that of brute force, bit for bit. @return it
static inline wisp_mesh_nearest assert_closest_is_naive( const test_mesh* m, const float* xyzw,
                                                         wisp_collision_mesh* tree, wisp_vec3 p, float radius )
{
    triangle_nearest naive = { 0 };
    int32_t expected = naive_closest( m, xyzw, p, &naive );
    wisp_mesh_nearest found = closest( tree, p, radius );
    if ( naive.squared > (double)radius * (double)radius )
    {
        assert_int_equal( found.triangle, -1 );
        return found;
    }
    wisp_vec3 point = double3_narrow( naive.point );
    assert_int_equal( found.triangle, expected );
    assert_memory_equal( &found.point, &point, sizeof( point ) );
    for ( int k = 0; k < 3; ++k )
    {
        assert_true( found.weights[k] == (float)naive.weights[k] );
    }
    assert_true( fabsf( found.distance ) == (float)sqrt( naive.squared ) );
    return found;
}

static inline void crumple( test_mesh* m, const wisp_vec3* rest, int step )
{
    for ( int i = 0; i < m->point_count; ++i )
    {
        m->points[i] = test_sum( rest[i], test_point( i, 60 + step, 0.05f * (float)step ) );
    }
}

/// Refuse every request for memory in turn: each gives a message and leaves nothing behind.
/// @return number of requests of a mesh; *bytes [2] are those that the mesh and that the host counts
static inline int assert_refused_blocks_are_messages( const wisp_collision_mesh_def* def, int64_t bytes[2] )
{
    for ( int n = 1;; ++n )
    {
        test_host host = { 0 };
        wisp_allocator allocator = test_host_allocator( &host );
        wisp_collision_mesh* mesh;
        wisp_error error = { 0 };
        test_host_refuse( &host, n, false );
        wisp_status status = wisp_collision_mesh_create( def, &allocator, &mesh, &error );
        const bool refused = test_host_has_refused( &host );
        assert_int_equal( status, refused ? WISP_NO_MEMORY : WISP_OK );
        assert_true( ( mesh == NULL ) == refused );
        if ( refused )
        {
            assert_one_message( error.message );
        }
        else
        {
            bytes[0] = (int64_t)wisp_collision_mesh_bytes( mesh );
            bytes[1] = atomic_load( &host.bytes );
        }
        wisp_collision_mesh_release( mesh );
        assert_host_memory_is_released( &host );
        if ( !refused )
        {
            return n;
        }
    }
}

// Its middle and half the edge of a cube around it.
static inline wisp_vec3 centre_of( const test_mesh* m, float* size )
{
    wisp_vec3 lower = m->points[0], upper = lower;
    for ( int i = 1; i < m->point_count; ++i )
    {
        wisp_vec3 p = m->points[i];
        lower = ( wisp_vec3 ){ fminf( lower.x, p.x ), fminf( lower.y, p.y ), fminf( lower.z, p.z ) };
        upper = ( wisp_vec3 ){ fmaxf( upper.x, p.x ), fmaxf( upper.y, p.y ), fmaxf( upper.z, p.z ) };
    }
    *size = 0.5f * fmaxf( fmaxf( upper.x - lower.x, 1e-3f ), fmaxf( upper.y - lower.y, upper.z - lower.z ) );
    return ( wisp_vec3 ){ 0.5f * ( lower.x + upper.x ), 0.5f * ( lower.y + upper.y ), 0.5f * ( lower.z + upper.z ) };
}

/// NaN, infinity and points beyond the reach are counted and give no result.
static inline void assert_refuses_bad_numbers( wisp_collision_mesh* tree )
{
    const float bad[] = { NAN, -NAN, INFINITY, -INFINITY, 1.1e9f, 1e18f, 2e18f, -FLT_MAX };
    wisp_collision_mesh_query_stats work = { 0 };
    uint64_t expected = 0;
    for ( int i = 0; i < 3 * WISP_COUNT( bad ); ++i )
    {
        wisp_mesh_query query = { .point = { 0.1f, 0.2f, 0.3f }, .radius = 1.0f };
        wisp_mesh_path to = { .from = query.point, .to = query.point }, from = to;
        ( &query.point.x )[i % 3] = ( &to.to.x )[i % 3] = ( &from.from.x )[i % 3] = bad[i / 3];
        wisp_mesh_nearest nearest;
        wisp_mesh_hit hits[2];
        wisp_collision_mesh_closest( tree, &query, 1, &nearest, &work );
        wisp_collision_mesh_cast( tree, &to, 1, hits, &work );
        wisp_collision_mesh_cast( tree, &from, 1, hits + 1, &work );
        assert_true( nearest.triangle == -1 && hits[0].triangle == -1 && hits[1].triangle == -1 );
        expected += 3;
    }
    const float radii[] = { NAN, -1.0f, -FLT_MIN, -INFINITY };
    for ( int i = 0; i < WISP_COUNT( radii ); ++i )
    {
        wisp_mesh_nearest nearest;
        wisp_collision_mesh_closest( tree, &( wisp_mesh_query ){ .point = { 0, 0, 0 }, .radius = radii[i] }, 1,
                                     &nearest, &work );
        assert_int_equal( nearest.triangle, -1 );
        expected += 1;
    }
    assert_int_equal( work.refused, expected );
    assert_int_equal( work.queried, expected );
    assert_int_equal( work.answered, 0 );
}

/// A ball about the origin is found from the ends of the reach.
static inline void assert_answers_the_ends_of_the_reach( wisp_collision_mesh* tree )
{
    const float r = WISP_COLLISION_MESH_REACH;
    wisp_mesh_nearest far = closest( tree, ( wisp_vec3 ){ r, -r, r }, INFINITY );
    assert_true( far.triangle >= 0 );
    // the diagonal of the reach, to its rounding
    assert_float_equal( far.distance / r, sqrtf( 3.0f ), 4e-7f );
    assert_true( sweep( tree, ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ r, r, r } ).triangle >= 0 );
    assert_true( sweep( tree, ( wisp_vec3 ){ -r, 0.01f, 0.02f }, ( wisp_vec3 ){ r, 0.01f, 0.02f } ).triangle >= 0 );
    assert_int_equal( closest( tree, ( wisp_vec3 ){ FLT_MIN, 1e-45f, 0.0f }, 0.1f ).triangle, -1 );
    assert_int_equal( sweep( tree, ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 1e-45f, 0, 0 } ).triangle, -1 );
}

/// Points on corners and edges, close to the surface, in the box of the mesh, outside it and far away.
static inline wisp_vec3 query_point( const test_mesh* m, int i )
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
