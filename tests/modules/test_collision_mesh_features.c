// Edges and corners of meshes and height fields that stick out, and the distances by which they are found. What sheets make of them
// is in tests/claims/features.yaml.
#include "collision_fixture.h"
#include "collision_vectors.h"
#include "primitive_contacts.h"

#include "oracle/contact_oracle.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/module/random.h"

static wisp_vec3 random_point( uint32_t number )
{
    const wisp_random_key key = wisp_random_make_key( 7, 0, 0 );
    return ( wisp_vec3 ){ wisp_random_unit_float( key, number, 0, 0 ), wisp_random_unit_float( key, number, 1, 0 ),
                          wisp_random_unit_float( key, number, 2, 0 ) };
}

static test_mesh new_mesh( const wisp_vec3* points, int point_count, const int32_t* triangles, int triangle_count )
{
    test_mesh m = { calloc( (size_t)point_count, sizeof( wisp_vec3 ) ),
                    calloc( 3 * (size_t)triangle_count, sizeof( int32_t ) ), point_count, triangle_count };
    memcpy( m.points, points, (size_t)point_count * sizeof( wisp_vec3 ) );
    memcpy( m.triangles, triangles, 3 * (size_t)triangle_count * sizeof( int32_t ) );
    return m;
}

// ---- distances ----

TEST( closest_points_are_those_of_the_oracle )
{
    for ( uint32_t n = 0; n < 2000; ++n )
    {
        wisp_vec3 p[5];
        double3 q[5];
        for ( uint32_t k = 0; k < 5; ++k )
        {
            p[k] = random_point( 5 * n + k );
            p[k].y *= n % 4 == 0 ? 0.0f : 1.0f; // in a plane, where they may cross
        }
        p[4] = n % 5 == 0 ? p[3] : p[4]; // a feature without length
        p[1] = n % 7 == 0 ? wisp_v3_mul_add( p[0], 0.5f, wisp_v3_sub( p[4], p[3] ) ) : p[1]; // parallel
        for ( int k = 0; k < 5; ++k )
        {
            q[k] = double3_widen( p[k] );
        }
        float weights[3], along;
        const double edges = collision_closest_feature( p, 2, p + 3, weights, &along );
        const double3 a = double3_blend( q[0], q[1], (double)weights[1] ),
                      b = double3_blend( q[3], q[4], (double)along );
        assert_true( fabs( edges - mesh_gap_oracle_segments( q, q + 3 ) ) < 1e-7 );
        assert_true( fabs( double3_distance( a, b ) - edges ) < 1e-6 );
        const wisp_vec3 point[2] = { p[3], p[3] };
        const double face = collision_closest_feature( p, 3, point, weights, &along );
        double3 c = { 0.0, 0.0, 0.0 };
        for ( int k = 0; k < 3; ++k )
        {
            c = double3_add_scaled( c, (double)weights[k], q[k] );
        }
        assert_true( fabs( face - mesh_gap_oracle_triangle( q, q[3] ) ) < 1e-7 );
        assert_true( fabs( double3_distance( c, q[3] ) - face ) < 1e-6 );
    }
}

// ---- meshes ----

static test_mesh box( wisp_vec3 half )
{
    wisp_vec3 points[8];
    for ( int k = 0; k < 8; ++k )
    {
        points[k] = ( wisp_vec3 ){ k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z };
    }
    const int32_t triangles[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
                                       { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
    return new_mesh( points, 8, &triangles[0][0], 12 );
}

TEST( each_edge_of_a_box_is_found_once_and_no_diagonal_of_its_faces )
{
    SCOPED( test_mesh_free ) test_mesh m = box( ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } );
    const float all[2] = { -9.0f, 9.0f }, lower[3] = { all[0], all[0], all[0] },
                upper[3] = { all[1], all[1], all[1] }, above[3] = { all[0], 1.9f, all[0] };
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        const wisp_collision_mesh_def def = { .points = m.points,
                                              .triangles = m.triangles,
                                              .point_count = m.vertex_count,
                                              .triangle_count = m.triangle_count,
                                              .deforms = deforms == 1 };
        wisp_collision_mesh* mesh;
        int32_t found[64];
        assert_int_equal( wisp_collision_mesh_create( &def, NULL, &mesh, NULL ), WISP_OK );
        if ( deforms )
        {
            assert_int_equal( wisp_collision_mesh_update( mesh, NULL, m.points, NULL, NULL ), WISP_OK );
        }
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, false, found, 64 ), 0 );
        const size_t bytes = wisp_collision_mesh_bytes( mesh );
        assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK );
        assert_true( wisp_collision_mesh_bytes( mesh ) > bytes );
        assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK ); // once is enough
        const int edges = wisp_collision_mesh_find_features( mesh, lower, upper, false, found, 64 );
        assert_int_equal( edges, deforms ? 18 : 12 ); // what deforms may bend
        int ridges = 0;
        for ( int i = 0; i < edges; ++i )
        {
            const wisp_mesh_sides sides = wisp_collision_mesh_sides( mesh, found[i], false, 1.0f );
            assert_false( sides.behind );
            ridges += sides.in_front;
        }
        assert_int_equal( ridges, 12 );
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, true, found, 64 ), 8 );
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, true, found, 5 ), 5 );
        const int upper_edges = wisp_collision_mesh_find_features( mesh, above, upper, false, found, 64 );
        assert_true( upper_edges >= 4 && upper_edges < edges + 1 );
        wisp_collision_mesh_release( mesh );
    }
}

// ---- one edge and a mesh ----

// Meet a mesh with a segment along x at a height, at rest. @return how many meetings
static int meet( const test_mesh* mesh, bool double_sided, float y, float z, collision_meeting* out )
{
    const wisp_collision_mesh_def def = { .points = mesh->points,
                                          .triangles = mesh->triangles,
                                          .point_count = mesh->vertex_count,
                                          .triangle_count = mesh->triangle_count };
    collision_body body = { .double_sided = double_sided };
    const collision_view view = { .body = &body, .thickness = 0.02f };
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &body.tree, NULL ), WISP_OK );
    assert_int_equal( wisp_collision_mesh_prepare_features( body.tree, NULL ), WISP_OK );
    const primitive_path path = { .corner_count = 2,
                                  .from = { { -1, y, z }, { 1, y, z } },
                                  .to = { { -1, y, z }, { 1, y, z } } };
    const int found = collision_meet_features( &view, &path, out );
    wisp_collision_mesh_release( body.tree );
    return found;
}

// Roofs with ridges along z at x = 0, 0.2, 0.4 ... and heights that differ; valleys between them.
static test_mesh roofs( const float* heights, int count )
{
    wisp_vec3 points[32];
    int32_t triangles[64][3];
    for ( int i = 0; i <= 2 * count; ++i )
    {
        const float x = 0.1f * (float)i - 0.1f, y = i % 2 == 1 ? heights[i / 2] : -0.1f;
        points[2 * i] = ( wisp_vec3 ){ x, y, -0.5f };
        points[2 * i + 1] = ( wisp_vec3 ){ x, y, 0.5f };
    }
    for ( int i = 0; i < 2 * count; ++i )
    {
        const int32_t a = 2 * i;
        memcpy( triangles[2 * i], ( int32_t[] ){ a, a + 1, a + 2 }, sizeof triangles[0] );
        memcpy( triangles[2 * i + 1], ( int32_t[] ){ a + 1, a + 3, a + 2 }, sizeof triangles[0] );
    }
    return new_mesh( points, 4 * count + 2, &triangles[0][0], 4 * count );
}

TEST( the_two_nearest_ridges_are_met_and_no_valley )
{
    static const float heights[4] = { 0.011f, 0.018f, 0.005f, 0.014f };
    SCOPED( test_mesh_free ) test_mesh m = roofs( heights, 4 );
    collision_meeting out[COLLISION_PRIMITIVE_CONTACTS];
    assert_int_equal( meet( &m, true, 0.025f, 0.03f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.distance, 0.025f - 0.018f, 1e-6f );
    assert_float_equal( out[1].deepest.surface.distance, 0.025f - 0.014f, 1e-6f );
    assert_float_equal( out[0].deepest.surface.point.x, 0.2f, 1e-6f );
    assert_float_equal( out[0].deepest.surface.normal.y, 1.0f, 1e-6f );
    assert_float_equal( out[0].deepest.weights[1], 0.6f, 1e-6f );
    // above a valley of this side, which is a ridge from below
    assert_int_equal( meet( &m, true, -0.13f, 0.03f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.normal.y, -1.0f, 1e-6f );
    test_mesh_free( &m );
    static const float deep[1] = { -0.3f };
    m = roofs( deep, 1 ); // one valley: its border is met, and the valley is not
    const int found = meet( &m, true, -0.29f, 0.0f, out );
    for ( int i = 0; i < found; ++i )
    {
        assert_true( fabsf( out[i].deepest.surface.point.x ) > 0.05f );
    }
}

TEST( a_closed_mesh_is_met_from_outside_alone )
{
    SCOPED( test_mesh_free ) test_mesh m = box( ( wisp_vec3 ){ 0.3f, 0.1f, 0.1f } );
    collision_meeting out[COLLISION_PRIMITIVE_CONTACTS];
    // across the edges at x = 0.3 and x = -0.3 it would lie in the face: above it both are met, below it none
    assert_int_equal( meet( &m, false, 0.11f, 0.02f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.distance, 0.01f, 1e-6f );
    assert_int_equal( meet( &m, false, 0.09f, 0.02f, out ), 0 );
    assert_int_equal( meet( &m, true, 0.09f, 0.02f, out ), 0 ); // from behind they are valleys
}

// ---- height fields ----

enum
{
    MOST_FIELD_POINTS = 63,
};

// The triangles of a field, which face upwards.
static test_mesh mesh_of_field( const wisp_height_field* f )
{
    const int nx = f->count_x, nz = f->count_z;
    wisp_vec3 points[MOST_FIELD_POINTS];
    int32_t triangles[2 * MOST_FIELD_POINTS][3];
    int count = 0;
    for ( int v = 0; v < nx * nz; ++v )
    {
        points[v] = ( wisp_vec3 ){ f->spacing * ( (float)( v % nx ) - 0.5f * (float)( nx - 1 ) ), f->heights[v],
                                   f->spacing * ( (float)( v / nx ) - 0.5f * (float)( nz - 1 ) ) };
        if ( v % nx + 1 < nx && v / nx + 1 < nz )
        {
            memcpy( triangles[count++], ( int32_t[] ){ v, v + nx, v + nx + 1 }, sizeof triangles[0] );
            memcpy( triangles[count++], ( int32_t[] ){ v, v + nx + 1, v + 1 }, sizeof triangles[0] );
        }
    }
    return new_mesh( points, nx * nz, &triangles[0][0], count );
}

static bool is_same_place( const wisp_mesh_feature* a, const wisp_mesh_feature* b )
{
    const float near = 1e-5f;
    return ( wisp_v3_length( wisp_v3_sub( a->from[0], b->from[0] ) ) < near &&
             wisp_v3_length( wisp_v3_sub( a->from[1], b->from[1] ) ) < near ) ||
           ( wisp_v3_length( wisp_v3_sub( a->from[0], b->from[1] ) ) < near &&
             wisp_v3_length( wisp_v3_sub( a->from[1], b->from[0] ) ) < near );
}

// Within a box, the edges of a field that stick out are those that stick out of the mesh of its triangles, with the same normals.
TEST( a_height_field_has_the_edges_and_corners_of_its_triangles )
{
    float heights[9 * 7];
    for ( uint32_t v = 0; v < 63; ++v )
    {
        heights[v] = v % 5 == 0 ? 0.05f : 0.2f * random_point( v ).x;
    }
    const wisp_height_field field = { heights, 9, 7, 0.1f };
    SCOPED( test_mesh_free ) test_mesh m = mesh_of_field( &field );
    const wisp_collision_mesh_def def = { .points = m.points,
                                          .triangles = m.triangles,
                                          .point_count = m.vertex_count,
                                          .triangle_count = m.triangle_count };
    wisp_collision_mesh* mesh = NULL;
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &mesh, NULL ), WISP_OK );
    assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK );
    const float lower[3] = { -0.25f, 0.06f, -0.15f }, upper[3] = { 0.2f, 0.15f, 0.18f };
    for ( int corners = 0; corners < 2; ++corners )
    {
        int32_t own[400], others[400];
        const int count = wisp_height_field_find_features( &field, lower, upper, corners == 1, own, 400 );
        const int other_count = wisp_collision_mesh_find_features( mesh, lower, upper, corners == 1, others, 400 );
        int matched = 0, expected = 0;
        for ( int k = 0; k < other_count; ++k )
        {
            const wisp_mesh_feature g = wisp_collision_mesh_feature( mesh, others[k], corners == 1, 0.0f, 1.0f );
            const wisp_mesh_sides sides = wisp_collision_mesh_sides( mesh, others[k], corners == 1, 1.0f );
            // the mesh looks at boxes of triangles, and keeps corners with a valley alone
            const bool is_near =
                fminf( g.from[0].x, g.from[1].x ) <= upper[0] && fmaxf( g.from[0].x, g.from[1].x ) >= lower[0] &&
                fminf( g.from[0].y, g.from[1].y ) <= upper[1] && fmaxf( g.from[0].y, g.from[1].y ) >= lower[1] &&
                fminf( g.from[0].z, g.from[1].z ) <= upper[2] && fmaxf( g.from[0].z, g.from[1].z ) >= lower[2];
            expected += is_near && sides.in_front && corners == 0 ? 1 : 0;
            for ( int i = 0; i < count; ++i )
            {
                const wisp_mesh_feature f = wisp_height_field_feature( &field, own[i] );
                const wisp_mesh_sides mine = wisp_height_field_sides( &field, own[i] );
                if ( is_same_place( &f, &g ) )
                {
                    matched += 1;
                    assert_true( is_near && sides.in_front && mine.in_front && mine.behind == false );
                    // corners are weighted by angles there, and not here
                    assert_true( wisp_v3_dot( mine.normal, sides.normal ) > ( corners == 1 ? 0.8f : 0.999999f ) );
                }
            }
        }
        assert_int_equal( matched, count );
        assert_true( count > 5 && ( corners == 1 || count == expected ) );
        assert_int_equal( wisp_height_field_find_features( &field, lower, upper, corners == 1, own, 3 ), 3 );
    }
    wisp_collision_mesh_release( mesh );
}

// ---- the rest ----

static const float DT = 1.0f / 60.0f;

TEST( without_memory_for_edges_nothing_changes )
{
    SCOPED( close_local ) hosted* h = new_colliding( 10, 1, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = box( ( wisp_vec3 ){ 0.06f, 0.05f, 0.06f } );
    wisp_collider_def body = mesh_body( &mesh );
    body.pose.translation.y = -0.06f;
    add_collider( h->world, &body );
    const wisp_entity sheet = add_cloth( h->world, 21, 0.4f, ( wisp_vec3 ){ 0.003f, 0.0f, 0.0045f }, 0.0f );
    run_for( h->world, DT, 1 );
    const int passes = wisp_world_plan_passes( h->world );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.features = WISP_COLLISION_ALL;
    bool done = false;
    for ( int n = 1; done == false && n < 100; ++n )
    {
        test_host_refuse( &h->host, n, true );
        done = wisp_set_collision( h->world, sheet, &collision ) == WISP_OK;
        test_host_refuse( &h->host, 0, false );
        assert_int_equal( wisp_world_plan_passes( h->world ), done ? passes + 2 : passes );
        run_for( h->world, DT, 1 );
    }
    assert_true( done );
    const int64_t queried = atomic_load( &h->host.queried );
    run_for( h->world, DT, 5 );
    assert_int_equal( atomic_load( &h->host.queried ), queried );
    // without the option there is no pass again
    SET_DEFAULT( h->world, sheet, collision );
    assert_int_equal( wisp_world_plan_passes( h->world ), passes );
}
