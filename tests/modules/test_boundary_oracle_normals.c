// Normals of boundary particles on their double-precision oracle, and elements without length, area or direction.
#include "boundary_oracle_fixture.h"

// ---- Sections 5.1 and 5.2: normals ----

static void vertex_normals_are_means_of_unit_face_normals( void** state )
{
    (void)state;
    // a floor and a wall, the wall a hundred times as large: both have the same weight
    const double3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, -1 }, { 0, 100, 0 }, { 5, 5, 5 } };
    const int triangles[] = { 0, 1, 2, 0, 3, 1 };
    double3 normal[5];
    boundary_oracle_vertex_normals( points, 5, triangles, 2, normal );
    const double3 floor_normal =
        boundary_oracle_face_normal( ( const double3[3] ){ points[0], points[1], points[2] } );
    const double3 wall_normal =
        boundary_oracle_face_normal( ( const double3[3] ){ points[0], points[3], points[1] } );
    const double3 mean = boundary_oracle_unit( double3_add( floor_normal, wall_normal ) );
    assert_close( double3_distance( normal[0], mean ), 0.0, 1e-15 );
    assert_close( double3_distance( normal[2], floor_normal ), 0.0, 1e-15 );
    assert_true( double3_length( normal[4] ) == 0.0 ); // no faces
}

static void an_edge_normal_is_unit_begins_and_ends_at_the_vertices( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        const double3 a = boundary_oracle_unit( random_vector( n, 0 ) ),
                      b = boundary_oracle_unit( random_vector( n, 1 ) );
        assert_close( double3_distance( boundary_oracle_edge_normal( a, b, 0.0 ), a ), 0.0, 1e-15 );
        assert_close( double3_distance( boundary_oracle_edge_normal( a, b, 1.0 ), b ), 0.0, 1e-15 );
        const double tau = random_between( n, 9, 0.0, 1.0 );
        const double3 c = boundary_oracle_edge_normal( a, b, tau );
        assert_close( double3_length( c ), 1.0, 1e-15 );
        assert_close( double3_dot( c, double3_cross( a, b ) ), 0.0, 1e-12 ); // in the plane of both
    }
}

static void barycentric_normals_are_exact_for_a_linear_field( void** state )
{
    (void)state;
    // N = x / R at corners on a sphere is a linear function with the same length at each corner. Only then is its
    // direction inside exact: unit normals of a function whose length varies have lost that length
    double worst = 0.0;
    for ( int n = 0; n < 100; ++n )
    {
        const double3 corner[3] = { boundary_oracle_unit( random_vector( n, 0 ) ),
                                    boundary_oracle_unit( random_vector( n, 1 ) ),
                                    boundary_oracle_unit( random_vector( n, 2 ) ) };
        const boundary_oracle_axis axis = boundary_oracle_axis_of( corner );
        const double q = random_between( n, 20, 0.0, 0.9 ), r = random_between( n, 21, 0.0, 1.0 );
        double weight[3];
        double3 y = zero;
        boundary_oracle_weights( &axis, q, r, weight );
        for ( int k = 0; k < 3; ++k )
        {
            y = double3_add( y, double3_scale( weight[k], corner[k] ) );
        }
        const double3 exact = boundary_oracle_inner_normal( corner, &axis, q, r, BOUNDARY_ORACLE_BARYCENTRIC );
        assert_close( double3_angle( exact, y ), 0.0, 1e-12 / double3_length( y ) );
        const double3 scanned = boundary_oracle_inner_normal( corner, &axis, q, r, BOUNDARY_ORACLE_SCANLINE );
        worst = fmax( worst, double3_angle( scanned, y ) );
    }
    // the ends of a line are normalised before they are blended: close, but another rule
    assert_true( worst > 1e-3 );
}

static void normals_are_continuous_across_an_edge_in_both_modes( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        const double3 corner[3] = { random_vector( n, 0 ), random_vector( n, 1 ), random_vector( n, 2 ) };
        const double3 normal[3] = { boundary_oracle_unit( random_vector( n, 3 ) ),
                                    boundary_oracle_unit( random_vector( n, 4 ) ),
                                    boundary_oracle_unit( random_vector( n, 5 ) ) };
        const boundary_oracle_axis axis = boundary_oracle_axis_of( corner );
        const double t = random_between( n, 30, 0.05, 0.95 );
        const double3 a = normal[axis.a], b = normal[axis.b], c = normal[axis.c];
        const double3 on_base = boundary_oracle_edge_normal( a, b, t ),
                      on_side = boundary_oracle_edge_normal( a, c, t );
        const double3 on_other = boundary_oracle_edge_normal( b, c, t );
        for ( int mode = 0; mode < 2; ++mode )
        {
            const boundary_oracle_normals m = (boundary_oracle_normals)mode;
            assert_close( double3_distance( boundary_oracle_inner_normal( normal, &axis, 0.0, t, m ), on_base ), 0,
                          1e-12 );
            assert_close( double3_distance( boundary_oracle_inner_normal( normal, &axis, t, 0.0, m ), on_side ), 0,
                          1e-12 );
            assert_close( double3_distance( boundary_oracle_inner_normal( normal, &axis, t, 1.0, m ), on_other ), 0,
                          1e-12 );
        }
    }
}

static void the_angle_to_a_sphere_falls_with_the_size_of_its_triangles( void** state )
{
    (void)state;
    double angle[3];
    for ( int level = 2; level <= 4; ++level )
    {
        balloon_mesh mesh;
        assert_true( balloon_mesh_icosphere( &mesh, level, 1.0 ) );
        const boundary_oracle_options options = { .spacing = 0.015, .cap = 1e6 };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        angle[level - 2] = 0.0;
        assert_true( inner_points( &layer ) > 1000 );
        for ( int n = 0; n < layer.point_count; ++n )
        {
            angle[level - 2] = fmax( angle[level - 2], double3_angle( layer.points[n].normal, layer.points[n].y ) );
        }
        print_message( "level %d: %.5f rad at most\n", level, angle[level - 2] );
        boundary_oracle_destroy( &layer );
        balloon_mesh_destroy( &mesh );
    }
    // a mean of unit normals is of first order in the edge where the fan around a vertex is not regular
    assert_true( angle[0] < 0.02 && angle[1] < 0.75 * angle[0] && angle[2] < 0.75 * angle[1] );
}

// ---- degenerate cases ----

static void a_spacing_or_hysteresis_out_of_range_is_refused_in_a_message( void** state )
{
    (void)state;
    const struct
    {
        boundary_oracle_options options;
        const char* message;
    } bad[] = {
        { { .spacing = 0.0, .cap = 1.0 }, "spacing is 0 m, must be finite and above 0" },
        { { .spacing = -1.0, .cap = 1.0 }, "spacing is -1 m, must be finite and above 0" },
        { { .spacing = (double)INFINITY, .cap = 1.0 }, "spacing is inf m, must be finite and above 0" },
        { { .spacing = 1.0, .cap = 1.0, .hysteresis = 0.6 }, "hysteresis is 0.6, must be in [0, 0.5]" },
        { { .spacing = 1.0, .cap = 0.0 }, "the cap is 0 points, must be above 0" },
    };
    balloon_mesh mesh = reference_sphere();
    for ( int n = 0; n < WISP_COUNT( bad ); ++n )
    {
        boundary_oracle_layer layer;
        wisp_error error = { 0 };
        assert_int_equal( boundary_oracle_create( &mesh, &bad[n].options, &layer, &error ), WISP_BAD_INPUT );
        assert_string_equal( error.message, bad[n].message );
    }
    balloon_mesh_destroy( &mesh );
}

static void what_has_no_length_or_area_has_no_points_there( void** state )
{
    (void)state;
    // a sound triangle, one without area on a line, one that is a point
    const double3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 3, 0, 0 }, { 5, 0, 0 },
                               { 9, 0, 0 }, { 7, 7, 7 }, { 7, 7, 7 }, { 7, 7, 7 } };
    const int triangles[] = { 0, 1, 2, 3, 4, 5, 6, 7, 8 };
    balloon_mesh mesh = mesh_of( points, 9, triangles, 3 );
    for ( int n = 0; n < 6; ++n )
    {
        const boundary_oracle_options options = { .spacing = 0.1,
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)( n % 2 ),
                                                  .rounding = (boundary_oracle_rounding)( n / 2 ) };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        assert_true( inner_points( &layer ) > 30 );
        for ( int m = 0; m < layer.point_count; ++m )
        {
            const boundary_oracle_point* p = layer.points + m;
            assert_true( isfinite( double3_length( p->y ) ) && isfinite( double3_length( p->normal ) ) );
            assert_true( p->element < layer.edge_count || p->element == layer.edge_count );
            assert_true( p->parent[0] < 6 );
            assert_true( double3_length( p->normal ) == 0.0 ? p->parent[0] >= 3 : p->parent[0] < 3 );
        }
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

static void normals_that_cancel_give_way_to_the_face_and_then_to_the_last_step( void** state )
{
    (void)state;
    // two triangles, one the reverse of the other: every vertex normal cancels, edges too, faces do not
    const double3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    const int triangles[] = { 0, 1, 2, 0, 2, 1 };
    balloon_mesh mesh = mesh_of( points, 3, triangles, 2 );
    const boundary_oracle_options options = { .spacing = 0.2, .cap = 1e6 };
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    assert_true( inner_points( &layer ) > 0 && layer.fallback_normals == layer.point_count );
    for ( int n = 0; n < layer.point_count; ++n )
    {
        const double requested = layer.points[n].element < layer.edge_count    ? 0.0
                                 : layer.points[n].element == layer.edge_count ? 1.0
                                                                               : -1.0;
        assert_true( layer.points[n].normal.z == requested );
    }
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );

    // an edge whose triangle loses its area keeps its counts and its normals
    mesh = one_triangle( double3_make( 0, 0, 0 ), double3_make( 1, 0, 0 ), double3_make( 0, 1, 0 ) );
    layer = layer_on( &mesh, &options );
    const double3 flat[3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 0 } };
    must_update( &layer, flat );
    assert_true( layer.point_count >= 4 && layer.points[0].normal.z == 1.0 );
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

static void an_element_with_a_corner_that_is_not_finite_is_skipped_and_comes_back( void** state )
{
    (void)state;
    balloon_mesh mesh = reference_sphere();
    const boundary_oracle_options options = boundary_oracle_default_options();
    boundary_oracle_layer layer = layer_on( &mesh, &options ), whole = layer_on( &mesh, &options );
    const double3 place = mesh.positions[300];
    mesh.positions[300].y = (double)NAN;
    must_update( &layer, mesh.positions );
    // a vertex inside the net has six edges and six triangles
    assert_int_equal( layer.skipped_elements, 12 );
    assert_true( layer.point_count < whole.point_count );
    for ( int n = 0; n < layer.point_count; ++n )
    {
        assert_true( isfinite( double3_length( layer.points[n].y ) ) );
        assert_close( double3_length( layer.points[n].normal ), 1.0, 1e-12 );
    }
    mesh.positions[300] = place;
    must_update( &layer, mesh.positions );
    assert_int_equal( layer.changed_elements, 12 );
    assert_same_points( &layer, &whole );
    boundary_oracle_destroy( &whole );
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

static void an_edge_of_three_triangles_is_sampled_once_and_an_open_mesh_is_sampled( void** state )
{
    (void)state;
    const double3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1, 0 }, { 0.5, 0, 1 }, { 0.5, -1, 0 } };
    const int triangles[] = { 0, 1, 2, 0, 1, 3, 0, 1, 4 };
    balloon_mesh mesh = mesh_of( points, 5, triangles, 3 );
    const boundary_oracle_options options = { .spacing = 0.26, .cap = 1e6 };
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    int on_common = 0;
    for ( int n = 0; n < layer.edge_point_count; ++n )
    {
        on_common += layer.points[n].element == 0 ? 1 : 0;
    }
    assert_int_equal( layer.edge_count, 7 );
    assert_int_equal( on_common, 2 );
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

static void too_many_points_are_refused_and_the_ones_there_are_still_follow( void** state )
{
    (void)state;
    balloon_mesh mesh = reference_sphere();
    boundary_oracle_options options = boundary_oracle_default_options();
    options.policy = BOUNDARY_ORACLE_EXACT; // whose weights would move with the lengths
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    const int points = layer.point_count;
    double area = 0.0, length = 0.0;
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        const int* v = mesh.triangles + 3 * t;
        area += 0.5 * doubled_area(
                          ( const double3[3] ){ mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]] } );
    }
    for ( int e = 0; e < layer.edge_count; ++e )
    {
        const balloon_mesh_edge* edge = layer.topology.edges + e;
        length += double3_distance( mesh.positions[edge->a], mesh.positions[edge->b] );
    }
    assert_close( layer.requested / ( length / 0.1 + area / 0.01 ), 1.0, 1e-12 );
    const boundary_oracle_point first = layer.points[0];
    layer.options.spacing = 1e-4;
    scale_all( mesh.positions, mesh.positions, mesh.vertex_count, 2.0 );
    must_update( &layer, mesh.positions );
    assert_true( layer.refused && layer.requested > layer.options.cap );
    assert_int_equal( layer.point_count, points );
    assert_int_equal( layer.changed_elements, 0 );
    assert_memory_equal( layer.points[0].weight, first.weight, sizeof( first.weight ) );
    assert_close( double3_distance( layer.points[0].y, double3_scale( 2.0, first.y ) ), 0.0, 1e-14 );
    for ( int n = 0; n < layer.point_count; ++n )
    {
        assert_on_its_parents( &layer, mesh.positions, layer.points + n );
    }
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( vertex_normals_are_means_of_unit_face_normals ),
        cmocka_unit_test( an_edge_normal_is_unit_begins_and_ends_at_the_vertices ),
        cmocka_unit_test( barycentric_normals_are_exact_for_a_linear_field ),
        cmocka_unit_test( normals_are_continuous_across_an_edge_in_both_modes ),
        cmocka_unit_test( the_angle_to_a_sphere_falls_with_the_size_of_its_triangles ),
        cmocka_unit_test( a_spacing_or_hysteresis_out_of_range_is_refused_in_a_message ),
        cmocka_unit_test( what_has_no_length_or_area_has_no_points_there ),
        cmocka_unit_test( normals_that_cancel_give_way_to_the_face_and_then_to_the_last_step ),
        cmocka_unit_test( an_element_with_a_corner_that_is_not_finite_is_skipped_and_comes_back ),
        cmocka_unit_test( an_edge_of_three_triangles_is_sampled_once_and_an_open_mesh_is_sampled ),
        cmocka_unit_test( too_many_points_are_refused_and_the_ones_there_are_still_follow ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
