// Meshes whose points move along straight lines: closest points at a time, paths swept against the motion, tracking.
#include "kernel_tables.h"
#include "mesh_fixture.h"

#include "wisp/module/vec.h"

enum
{
    QUERIES = 300,
};

// A closed ball that bulges and shifts: no rigid motion.
typedef struct motion
{
    test_mesh mesh;
    wisp_vec3 *start, *end;
    wisp_collision_mesh* tree;
} motion;

static motion new_motion( float shift, float bulge )
{
    motion m = { .mesh = test_mesh_ball( 12, false ) };
    const size_t bytes = (size_t)m.mesh.point_count * sizeof( wisp_vec3 );
    m.start = checked_malloc( bytes );
    m.end = checked_malloc( bytes );
    for ( int v = 0; v < m.mesh.point_count; ++v )
    {
        const wisp_vec3 p = m.mesh.points[v];
        const float size = 1.0f + bulge * p.x * p.y;
        m.start[v] = p;
        m.end[v] = ( wisp_vec3 ){ size * p.x + shift, size * p.y - 0.5f * shift, size * p.z };
    }
    m.tree = test_collision_mesh( &m.mesh, true );
    assert_int_equal( wisp_collision_mesh_update( m.tree, m.start, m.end, NULL, NULL ), WISP_OK );
    return m;
}

static void free_motion( motion* m )
{
    wisp_collision_mesh_release( m->tree );
    free( m->start );
    free( m->end );
    test_mesh_free( &m->mesh );
}

// The mesh as it is at a time, as one that rests.
static wisp_collision_mesh* frozen_at( const motion* m, float time )
{
    test_mesh now = m->mesh;
    now.points = checked_malloc( (size_t)now.point_count * sizeof( wisp_vec3 ) );
    for ( int v = 0; v < now.point_count; ++v )
    {
        const wisp_vec3 a = m->start[v], b = m->end[v];
        const double s = (double)time;
        now.points[v] = ( wisp_vec3 ){ (float)( (double)a.x * ( 1.0 - s ) + (double)b.x * s ),
                                       (float)( (double)a.y * ( 1.0 - s ) + (double)b.y * s ),
                                       (float)( (double)a.z * ( 1.0 - s ) + (double)b.z * s ) };
    }
    wisp_collision_mesh* tree = test_collision_mesh( &now, true );
    free( now.points );
    return tree;
}

static wisp_mesh_nearest closest_at( wisp_collision_mesh* tree, wisp_vec3 p, float time )
{
    wisp_mesh_nearest nearest;
    const wisp_mesh_query query = { .point = p, .radius = INFINITY, .time = time };
    wisp_collision_mesh_closest( tree, &query, 1, &nearest, NULL );
    return nearest;
}

TEST( closest_points_at_a_time_are_those_of_the_mesh_as_it_is_then )
{
    SCOPED( free_motion ) motion m = new_motion( 0.4f, 0.3f );
    for ( int k = 0; k <= 4; ++k )
    {
        const float time = 0.25f * (float)k;
        SCOPED( tree_local ) wisp_collision_mesh* frozen = frozen_at( &m, time );
        for ( int i = 0; i < QUERIES; ++i )
        {
            const wisp_vec3 p = test_point( i, k, 1.6f );
            const wisp_mesh_nearest a = closest_at( m.tree, p, time ), b = closest_at( frozen, p, 0.0f );
            // corners of the one at rest are rounded to float
            assert_true( fabsf( a.distance - b.distance ) < 1e-6f );
        }
    }
}

// Without a deformation the path against the motion is the relative path against the mesh at rest.
TEST( a_path_against_a_translation_is_the_relative_path )
{
    SCOPED( free_motion ) motion m = new_motion( 0.4f, 0.0f );
    int hits = 0;
    for ( int i = 0; i < 4 * QUERIES; ++i )
    {
        const wisp_vec3 from = test_point( i, 0, 1.5f ), to = test_point( i, 7, 1.5f );
        const wisp_mesh_path path = { .from = from, .to = to, .begin_time = 0.25f, .end_time = 0.75f };
        const wisp_mesh_path still = { .from = { from.x - 0.1f, from.y + 0.05f, from.z },
                                       .to = { to.x - 0.3f, to.y + 0.15f, to.z } };
        wisp_mesh_hit a, b;
        wisp_collision_mesh_cast( m.tree, &path, 1, &a, NULL );
        wisp_collision_mesh_cast( m.tree, &still, 1, &b, NULL );
        assert_int_equal( a.triangle, b.triangle );
        assert_true( fabsf( a.time - b.time ) < 1e-5f );
        assert_true( a.side == b.side );
        hits += a.triangle >= 0 ? 1 : 0;
    }
    assert_true( hits > QUERIES );
}

// Who is outside at the start and inside at the end has entered somewhere: rounding opens no gap between triangles.
TEST( whoever_gets_in_has_crossed )
{
    SCOPED( free_motion ) motion m = new_motion( 0.5f, 0.4f );
    int entered = 0;
    for ( int i = 0; i < 20 * QUERIES; ++i )
    {
        const wisp_vec3 from = test_point( i, 0, 1.4f ), to = test_point( i, 7, 1.4f );
        const float begin = 0.1f, end = 0.9f;
        if ( closest_at( m.tree, from, begin ).distance > 1e-5f && closest_at( m.tree, to, end ).distance < -1e-5f )
        {
            const wisp_mesh_path path = { .from = from, .to = to, .begin_time = begin, .end_time = end };
            wisp_mesh_hit hit;
            wisp_collision_mesh_cast( m.tree, &path, 1, &hit, NULL );
            assert_true( hit.triangle >= 0 && hit.side > 0.0f );
            ++entered;
        }
    }
    assert_true( entered > QUERIES );
}

// Aimed at the corners of triangles, where two planes meet.
TEST( paths_to_corners_do_not_slip_through )
{
    SCOPED( free_motion ) motion m = new_motion( 0.3f, 0.2f );
    for ( int v = 0; v < m.mesh.point_count; ++v )
    {
        const wisp_vec3 a = m.start[v], b = m.end[v];
        const wisp_vec3 middle = { 0.5f * ( a.x + b.x ), 0.5f * ( a.y + b.y ), 0.5f * ( a.z + b.z ) };
        // through where the corner is at half the time
        const wisp_vec3 from = { 1.5f * middle.x, 1.5f * middle.y, 1.5f * middle.z },
                        to = { 0.5f * middle.x, 0.5f * middle.y, 0.5f * middle.z };
        const wisp_mesh_path path = { .from = from, .to = to, .begin_time = 0.0f, .end_time = 1.0f };
        wisp_mesh_hit hit;
        wisp_collision_mesh_cast( m.tree, &path, 1, &hit, NULL );
        assert_true( hit.triangle >= 0 );
        assert_true( fabsf( hit.time - 0.5f ) < 0.05f );
    }
}

TEST( a_point_of_a_triangle_goes_where_its_corners_go )
{
    SCOPED( free_motion ) motion m = new_motion( 0.4f, 0.3f );
    for ( int i = 0; i < QUERIES; ++i )
    {
        const wisp_mesh_nearest n = closest_at( m.tree, test_point( i, 0, 1.2f ), 0.3f );
        const wisp_mesh_place at = wisp_collision_mesh_place( m.tree, n.triangle, n.weights, 0.3f ),
                              then = wisp_collision_mesh_place( m.tree, n.triangle, n.weights, 0.8f );
        const wisp_vec3 way = wisp_collision_mesh_motion( m.tree, n.triangle, n.weights, 0.3f, 0.8f );
        assert_true( fabsf( at.point.x - n.point.x ) < 1e-6f && fabsf( at.point.y - n.point.y ) < 1e-6f );
        assert_true( fabsf( then.point.x - at.point.x - way.x ) < 1e-6f );
        assert_true( fabsf( then.point.z - at.point.z - way.z ) < 1e-6f );
        const wisp_vec3 u = then.normal;
        assert_true( fabsf( u.x * u.x + u.y * u.y + u.z * u.z - 1.0f ) < 1e-5f );
    }
}

// Above the inside of a triangle a track is in single precision, with coordinates below 2 m.
static bool is_alike( const wisp_mesh_nearest* a, const wisp_mesh_nearest* b )
{
    const wisp_vec3 apart = wisp_v3_sub( a->point, b->point ), turn = wisp_v3_sub( a->normal, b->normal );
    return a->triangle == b->triangle && fabsf( a->distance - b->distance ) < 1e-6f &&
           wisp_v3_length( apart ) < 1e-6f && wisp_v3_length( turn ) < 2e-5f &&
           fabsf( a->weights[0] - b->weights[0] ) < 1e-4f && fabsf( a->weights[1] - b->weights[1] ) < 1e-4f;
}

// From where the point was 0.1 m before, as from one substep to the next.
TEST( tracking_follows_the_closest_point_along_a_round_mesh )
{
    SCOPED( free_motion ) motion m = new_motion( 0.4f, 0.1f );
    const wisp_kernels* kernels = kernels_select( "baseline", NULL );
    int moved = 0, same = 0, count = 0;
    for ( int i = 0; i < QUERIES; ++i )
    {
        const wisp_vec3 before = test_point( i, 0, 1.6f ), p = test_sum( before, test_point( i, 9, 0.1f ) );
        const wisp_mesh_query query = { .point = p, .radius = INFINITY, .time = 0.5f };
        const wisp_mesh_nearest exact = closest_at( m.tree, p, 0.5f );
        if ( exact.distance > 0.0f ) // inside there are several minima
        {
            const int32_t begin = closest_at( m.tree, before, 0.4f ).triangle;
            wisp_mesh_nearest tracked;
            wisp_collision_mesh_track( m.tree, kernels, &query, &begin, 1, &tracked );
            // quads fold inwards along one of their diagonals, so some have two minima, nearly equally far
            assert_true( tracked.distance > exact.distance - 1e-6f && tracked.distance < exact.distance + 1e-3f );
            same += is_alike( &tracked, &exact ) ? 1 : 0;
            count += 1;
            moved += begin != tracked.triangle ? 1 : 0;
        }
    }
    assert_true( moved > QUERIES / 4 );
    assert_true( same > 0.95 * count );
}

// The smallest distance from the surface from a time to the end of the motion, with its sign.
static float least_distance( wisp_collision_mesh* tree, wisp_vec3 p, float begin )
{
    const int samples = 24;
    float least = INFINITY;
    for ( int k = 0; k <= samples; ++k )
    {
        const float distance = closest_at( tree, p, begin + ( 1.0f - begin ) * (float)k / (float)samples ).distance;
        least = fabsf( distance ) < fabsf( least ) ? distance : least;
    }
    return least;
}

// Points all around, and points just above the surface as it is at the start or at the end.
TEST( cells_know_who_stays_outside_and_at_what_distance )
{
    SCOPED( free_motion ) motion m = new_motion( 0.3f, 0.2f );
    int outside = 0, apart = 0, inside = 0;
    const wisp_vec3 far = { 4.0f, 0.0f, 0.0f };
    assert_true( wisp_collision_mesh_clearance( m.tree, far, 0.1f ) == -1.0f );
    wisp_collision_mesh_fill_cells( m.tree, NULL );
    assert_true( wisp_collision_mesh_clearance( m.tree, far, 0.1f ) == 0.1f );
    for ( int i = 0; i < 20 * QUERIES; ++i )
    {
        const wisp_vec3 corner = ( i % 4 == 0 ? m.start : m.end )[i % m.mesh.point_count];
        const wisp_vec3 around = test_point( i, 0, 1.8f ), beside = test_sum( corner, test_point( i, 1, 0.15f ) ),
                        p = i % 2 == 0 ? beside : around;
        const float near = 0.04f * (float)( i % 7 ), clear = wisp_collision_mesh_clearance( m.tree, p, near ),
                    least = least_distance( m.tree, p, 0.0f );
        assert_true( clear == -1.0f || ( ( clear == 0.0f || clear == near ) && clear <= least ) );
        outside += clear >= 0.0f ? 1 : 0;
        apart += clear > 0.0f ? 1 : 0;
        inside += least < 0.0f ? 1 : 0;
        // all that is far outside is known
        assert_true( least < 0.2f || clear >= 0.0f );
        assert_true( least < 0.2f + near || near > 0.1f || clear == near );
    }
    assert_true( outside > 4 * QUERIES && apart > QUERIES && inside > QUERIES );
}

// Nothing comes nearer than the clearance for the rest of the motion, whatever triangle the search begins at.
TEST( an_approach_finds_the_closest_point_and_how_long_it_is_enough )
{
    SCOPED( free_motion ) motion m = new_motion( 0.3f, 0.2f );
    int found = 0, clear_count = 0;
    for ( int i = 0; i < 10 * QUERIES; ++i )
    {
        const wisp_vec3 p = test_point( i, 0, 1.6f );
        const float time = 0.25f * (float)( i % 5 ), near = i % 2 == 0 ? INFINITY : 0.3f;
        const wisp_mesh_nearest exact = closest_at( m.tree, p, time );
        wisp_mesh_approach approach = { { p, near, time }, near, -1 };
        for ( int k = 0; k < 3; ++k )
        {
            int32_t nearest;
            float clearance;
            wisp_collision_mesh_approach( m.tree, &approach, 1, &nearest, &clearance );
            const bool is_near = fabsf( exact.distance ) <= near;
            assert_int_equal( nearest, is_near ? exact.triangle : -1 );
            assert_true( clearance <= near && clearance <= fabsf( least_distance( m.tree, p, time ) ) );
            found += is_near ? 1 : 0;
            clear_count += clearance > 0.0f ? 1 : 0;
            approach.seed = ( 31 * i + 7 * k ) % m.mesh.triangle_count;
        }
    }
    assert_true( found > 10 * QUERIES && clear_count > 10 * QUERIES );
}

TEST( an_approach_to_a_point_that_is_not_finite_finds_nothing )
{
    SCOPED( free_motion ) motion m = new_motion( 0.3f, 0.2f );
    const wisp_vec3 p = { NAN, 0.0f, 0.0f };
    const wisp_mesh_approach approach = { { p, INFINITY, 1.0f }, INFINITY, 0 };
    int32_t nearest;
    float clearance;
    wisp_collision_mesh_approach( m.tree, &approach, 1, &nearest, &clearance );
    assert_int_equal( nearest, -1 );
    assert_true( clearance == 0.0f );
    assert_true( wisp_collision_mesh_clearance( m.tree, p, 0.1f ) == -1.0f );
}
