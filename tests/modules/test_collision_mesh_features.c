// Edges and triangles of surfaces against meshes and surfaces as colliders: needles, blades, box edges, moving surfaces, and the
// distances by which they are found.
#include "collision_sheet_fixture.h"
#include "feature_contacts.h"

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

// A bar along y from -length to 0, with three sides, that ends in a tip or in an edge across.
static test_mesh spike( float radius, float length )
{
    wisp_vec3 points[7];
    for ( int k = 0; k < 3; ++k )
    {
        const float angle = 2.0943951f * (float)k + 0.3f;
        points[k] = ( wisp_vec3 ){ radius * cosf( angle ), -length, radius * sinf( angle ) };
        points[3 + k] = ( wisp_vec3 ){ points[k].x, -2.0f * radius, points[k].z };
    }
    points[6] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const int32_t triangles[10][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 4 }, { 1, 4, 2 }, { 2, 4, 5 },
                                       { 2, 5, 0 }, { 0, 5, 3 }, { 3, 6, 4 }, { 4, 6, 5 }, { 5, 6, 3 } };
    return new_mesh( points, 7, &triangles[0][0], 10 );
}

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

// Two triangles in the plane z = 0, below y = 0.
static test_mesh blade( float half, float depth )
{
    const wisp_vec3 points[4] = { { -half, -depth, 0 }, { half, -depth, 0 }, { half, 0, 0 }, { -half, 0, 0 } };
    const int32_t triangles[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
    return new_mesh( points, 4, &triangles[0][0], 2 );
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

// ---- a sheet and a mesh ----

static double spike_gap( setting with, float speed, float by )
{
    const float from = speed < 1.0f ? -0.02f : -0.1f;
    SCOPED( free_sheet ) sheet s = new_sheet( spike( 0.001f, 0.3f ), from, with );
    return rise( &s, from, by, speed, 10 );
}

TEST( a_spike_of_a_millimetre_does_not_pass_a_held_sheet_under_load )
{
    const setting with = { WISP_COLLISION_ALL, .is_held = true, .gravity = 10.0f * GRAVITY, .rotation = TURNED };
    const double gap = spike_gap( with, 0.06f, 0.04f );

    assert_true( gap > 0.7 * (double)THICKNESS );
    setting vertices = with;
    vertices.features = WISP_COLLISION_VERTICES;
    assert_true( spike_gap( vertices, 0.06f, 0.04f ) < 0.0 );
}

TEST( a_spike_that_moves_does_not_pass_at_any_speed )
{
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL, .rotation = TURNED };
        const double gap = spike_gap( with, speeds[k], k == 0 ? 0.06f : k == 1 ? 0.2f : 0.34f );

        assert_true( gap > 0.5 * (double)THICKNESS );
    }
}

// A lying bar: its edges meet those of the sheet. Turned from y to z.
TEST( a_bar_of_a_millimetre_does_not_pass_at_any_speed )
{
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL,
                               .rotation = { 0.69f, 0.08f, 0.12f, 0.709f } }; // about x, and a bit about the others
        setting scaled = with;
        const wisp_quat q = with.rotation;
        const float length = sqrtf( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w );
        scaled.rotation = ( wisp_quat ){ q.x / length, q.y / length, q.z / length, q.w / length };
        const float from = -0.1f;
        SCOPED( free_sheet ) sheet s = new_sheet( spike( 0.001f, 0.15f ), from, scaled );
        const double gap = rise( &s, from, k == 0 ? 0.14f : k == 1 ? 0.2f : 0.34f, speeds[k], 10 );

        assert_true( gap > 0.5 * (double)THICKNESS );
    }
}

TEST( a_blade_with_two_sides_does_not_cut )
{
    const setting with = { WISP_COLLISION_ALL, .is_held = true, .double_sided = true, .gravity = 10.0f * GRAVITY,
                           .rotation = TURNED };
    SCOPED( free_sheet ) sheet s = new_sheet( blade( 0.055f, 0.1f ), -0.02f, with );
    const double gap = rise( &s, -0.02f, 0.04f, 0.06f, 10 );

    assert_true( gap > 0.5 * (double)THICKNESS );
}

static double drape( wisp_collision_features features )
{
    const setting with = { features, .gravity = GRAVITY, .rotation = { 0.0f, 0.149438f, 0.0f, 0.988771f } };
    SCOPED( free_sheet ) sheet s = new_sheet( box( ( wisp_vec3 ){ 0.1f, 0.05f, 0.08f } ), -0.06f, with );
    assert_int_equal( wisp_set_damping( s.h->world, s.surface, 2.0f ), WISP_OK );
    double least = INFINITY;
    for ( int n = 1; n <= 60; ++n )
    {
        run_for( s.h->world, DT, 1 );
        least = n > 20 && n % 10 == 0 ? fmin( least, gap_of( &s ) ) : least;
    }
    return least;
}

TEST( no_edge_of_a_box_of_triangles_shows_through_a_draped_sheet )
{
    const double gap = drape( WISP_COLLISION_ALL );

    assert_true( gap > 0.8 * (double)THICKNESS );
    assert_true( drape( WISP_COLLISION_VERTICES ) < 0.0 );
}

// The same spike as a surface whose vertices are moved: its points move along lines within a step.
TEST( a_surface_that_is_moved_does_not_pass )
{
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL, .follows = true, .rotation = TURNED };
        const double gap = spike_gap( with, speeds[k], k == 0 ? 0.06f : k == 1 ? 0.2f : 0.34f );

        assert_true( gap > 0.5 * (double)THICKNESS );
    }
    const setting held = { WISP_COLLISION_ALL, .is_held = true, .follows = true, .gravity = 10.0f * GRAVITY,
                           .rotation = TURNED };
    const double gap = spike_gap( held, 0.06f, 0.04f );

    assert_true( gap > 0.7 * (double)THICKNESS );
}

// A blade that rises at 0.5 m/s and goes aside at 0.25 m/s: friction of its edge gives the sheet half as much momentum aside. A rigid one
// and one whose points move do the same.
TEST( the_edge_of_a_blade_drags_a_sheet_along )
{
    for ( int follows = 0; follows < 2; ++follows )
    {
        const setting with = { WISP_COLLISION_ALL, .double_sided = true, .follows = follows == 1,
                               .rotation = TURNED };
        SCOPED( free_sheet ) sheet s = new_sheet( blade( 0.15f, 0.1f ), -0.02f, with );
        for ( int n = 1; n <= 12; ++n )
        {
            s.place.x += 0.25f * DT;
            move_to( &s, -0.02f + 0.5f * DT * (float)n );
            run_for( s.h->world, DT, 1 );
        }
        const wisp_motion_stats q = motion_stats_of( s.h->world, s.surface );
        assert_true( q.momentum[1] > 0.0 );
        assert_true( q.momentum[0] > 0.3 * q.momentum[1] && q.momentum[0] < 0.6 * q.momentum[1] );
    }
}

// ---- the rest ----

TEST( without_memory_for_edges_nothing_changes )
{
    const setting with = { WISP_COLLISION_VERTICES, .rotation = TURNED };
    SCOPED( free_sheet ) sheet s = new_sheet( box( ( wisp_vec3 ){ 0.06f, 0.05f, 0.06f } ), -0.06f, with );
    run_for( s.h->world, DT, 1 );
    const int passes = wisp_world_plan_passes( s.h->world );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = WISP_COLLISION_ALL;
    bool done = false;
    for ( int n = 1; done == false && n < 100; ++n )
    {
        test_host_refuse( &s.h->host, n, true );
        done = wisp_set_collision( s.h->world, s.surface, &collision ) == WISP_OK;
        test_host_refuse( &s.h->host, 0, false );
        assert_int_equal( wisp_world_plan_passes( s.h->world ), done ? passes + 2 : passes );
        run_for( s.h->world, DT, 1 );
    }
    assert_true( done );
    const int64_t queried = atomic_load( &s.h->host.queried );
    run_for( s.h->world, DT, 5 );
    assert_int_equal( atomic_load( &s.h->host.queried ), queried );
}
