// Counts and places of boundary particles on their double-precision oracle. Numbers of sections are those
// of the boundary particle paper (docs/methods.md).
#include "boundary_oracle_fixture.h"

// ---- the reference mesh ----

static int compare_lengths( const void* a, const void* b )
{
    const double d = *(const double*)a - *(const double*)b;
    return ( d > 0.0 ) - ( d < 0.0 );
}

static void the_reference_sphere_is_that_of_the_program( void** state )
{
    (void)state;
    balloon_mesh mesh = reference_sphere();
    balloon_mesh_topology topology;
    assert_true( balloon_mesh_build_topology( &mesh, &topology ) );
    assert_int_equal( mesh.vertex_count, 872 );
    assert_int_equal( mesh.triangle_count, 1740 );
    assert_int_equal( topology.edge_count, 2610 );
    assert_int_equal( topology.border_count + topology.crossed_count + topology.crowded_count, 0 );
    double length[2610];
    for ( int e = 0; e < 2610; ++e )
    {
        length[e] = double3_distance( mesh.positions[topology.edges[e].a], mesh.positions[topology.edges[e].b] );
    }
    qsort( length, 2610, sizeof( double ), compare_lengths );
    // the specification prints three decimals of lengths and two of the volume
    assert_close( length[0], 0.055, 0.0005 );
    assert_close( length[2609], 0.583, 0.0005 );
    assert_close( 0.5 * ( length[1304] + length[1305] ), 0.293, 0.0005 );
    assert_close( constraint_oracle_volume( mesh.positions, mesh.triangles, mesh.triangle_count ), 64.79, 0.005 );
    balloon_mesh_destroy_topology( &topology );
    balloon_mesh_destroy( &mesh );
}

static void each_edge_stands_once_lower_vertex_first_rising( void** state )
{
    (void)state;
    balloon_mesh mesh = reference_sphere();
    const boundary_oracle_options options = boundary_oracle_default_options();
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    for ( int e = 0; e < layer.edge_count; ++e )
    {
        const balloon_mesh_edge* edge = layer.topology.edges + e;
        assert_true( edge->a < edge->b );
        assert_true( e == 0 || edge[-1].a < edge->a || ( edge[-1].a == edge->a && edge[-1].b < edge->b ) );
    }
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

// ---- Section 2.1: counts of an edge ----

static void an_edge_has_the_counts_of_the_table( void** state )
{
    (void)state;
    const double ratio[] = { 0.3, 1.0, 1.5, 2.0, 3.7 };
    const int even[] = { 0, 0, 0, 1, 2 }, exact[] = { 0, 0, 1, 1, 3 };
    for ( int n = 0; n < 5; ++n )
    {
        const int a =
            boundary_oracle_points_of_length( ratio[n] * 0.25, 0.25, BOUNDARY_ORACLE_EVEN, BOUNDARY_ORACLE_DOWN );
        const int b =
            boundary_oracle_points_of_length( ratio[n] * 0.25, 0.25, BOUNDARY_ORACLE_EXACT, BOUNDARY_ORACLE_DOWN );
        assert_int_equal( a, even[n] );
        assert_int_equal( b, exact[n] );
    }
}

static void each_rounding_counts_by_its_own_rule( void** state )
{
    (void)state;
    const double ratio[] = { 0.0, 0.4, 0.5, 1.0, 1.49, 1.5, 2.0, 2.01 };
    const int count[3][8] = { { 0, 0, 0, 1, 1, 1, 2, 2 }, { 0, 0, 1, 1, 1, 2, 2, 2 }, { 0, 1, 1, 1, 2, 2, 2, 3 } };
    for ( int r = 0; r < BOUNDARY_ORACLE_ROUNDING_COUNT; ++r )
    {
        for ( int n = 0; n < 8; ++n )
        {
            assert_int_equal( boundary_oracle_count( ratio[n], 1.0, (boundary_oracle_rounding)r ), count[r][n] );
        }
    }
}

static void exact_points_do_not_depend_on_the_rounding( void** state )
{
    (void)state;
    for ( int n = 0; n < 500; ++n )
    {
        const double length = random_between( n, 0, 0.0, 9.0 );
        const int down = boundary_oracle_points_of_length( length, 1.0, BOUNDARY_ORACLE_EXACT, BOUNDARY_ORACLE_DOWN );
        const int near =
            boundary_oracle_points_of_length( length, 1.0, BOUNDARY_ORACLE_EXACT, BOUNDARY_ORACLE_NEAREST );
        const int up = boundary_oracle_points_of_length( length, 1.0, BOUNDARY_ORACLE_EXACT, BOUNDARY_ORACLE_UP );
        assert_int_equal( down, (int)length );
        assert_int_equal( near, down );
        assert_int_equal( up, down );
    }
}

// ---- Section 2.2: places on an edge ----

// The largest and smallest distance between neighbours on a segment, its ends among them.
static void gaps_of( double length, boundary_oracle_policy policy, boundary_oracle_rounding rounding, double* least,
                     double* most )
{
    const int n = boundary_oracle_count( length, 1.0, rounding );
    const int points = boundary_oracle_points( n, length, 1.0, policy );
    double last = 0.0;
    *least = INFINITY;
    *most = 0.0;
    for ( int i = 1; i <= points + 1; ++i )
    {
        const double here = i <= points ? length * boundary_oracle_fraction( i, n, length, 1.0, policy ) : length;
        *least = fmin( *least, here - last );
        *most = fmax( *most, here - last );
        last = here;
    }
}

static void gaps_keep_their_bounds_and_no_point_stands_on_a_vertex( void** state )
{
    (void)state;
    const double rounding_error = 1e-12; // a few roundings of lengths below 20
    for ( int n = 0; n < 2000; ++n )
    {
        const double length = n % 4 == 0 ? n / 100 : random_between( n, 0, 1.0, 20.0 );
        double least, most;
        if ( length < 1.0 )
        {
            continue;
        }
        gaps_of( length, BOUNDARY_ORACLE_EVEN, BOUNDARY_ORACLE_DOWN, &least, &most );
        assert_true( least >= 1.0 - rounding_error && most < 2.0 );
        gaps_of( length, BOUNDARY_ORACLE_EVEN, BOUNDARY_ORACLE_NEAREST, &least, &most );
        assert_true( least >= 2.0 / 3.0 - rounding_error && most < 1.5 + rounding_error );
        gaps_of( length, BOUNDARY_ORACLE_EVEN, BOUNDARY_ORACLE_UP, &least, &most );
        assert_true( least > 0.5 && most <= 1.0 + rounding_error );
        gaps_of( length, BOUNDARY_ORACLE_EXACT, BOUNDARY_ORACLE_DOWN, &least, &most );
        assert_true( least > 1e-6 - rounding_error && most <= 1.0 + 1e-6 + rounding_error );
    }
}

static void even_points_are_the_same_from_either_end_and_exact_ones_are_not( void** state )
{
    (void)state;
    const double length = 3.7;
    const int n = boundary_oracle_count( length, 1.0, BOUNDARY_ORACLE_DOWN );
    for ( int i = 1; i < n; ++i )
    {
        const double here = boundary_oracle_fraction( i, n, length, 1.0, BOUNDARY_ORACLE_EVEN );
        assert_close( here, 1.0 - boundary_oracle_fraction( n - i, n, length, 1.0, BOUNDARY_ORACLE_EVEN ), 1e-15 );
        const double there = boundary_oracle_fraction( n - i, n, length, 1.0, BOUNDARY_ORACLE_EXACT );
        assert_true( fabs( boundary_oracle_fraction( i, n, length, 1.0, BOUNDARY_ORACLE_EXACT ) + there - 1.0 ) >
                     0.1 );
    }
}

// ---- Sections 3.1 and 3.2: axis and height ----

static void the_axis_is_the_shortest_edge_and_the_lowest_of_equals( void** state )
{
    (void)state;
    const struct
    {
        double3 corner[3];
        int edge;
    } cases[] = {
        { { { 0, 0, 0 }, { 5, 0.05, 0 }, { 5, -0.05, 0 } }, 1 }, // needle
        { { { 0, 3, 0 }, { 0, 0, 0 }, { 4, 0, 0 } }, 0 },        // right
        { { { 4, 0, 0 }, { 0, 3, 0 }, { 0, 0, 0 } }, 1 },        // the same, turned
        { { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 3, 0 } }, 2 },        // and again
        { { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, 0 },        // two legs are equal
        { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 } }, 1 },        // they are 1 and 2
        { { { 0, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 } }, 0 },        // no length
        { { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 } }, 0 },        // equilateral
    };
    for ( int n = 0; n < WISP_COUNT( cases ); ++n )
    {
        assert_int_equal( boundary_oracle_axis_of( cases[n].corner ).edge, cases[n].edge );
    }
    const boundary_oracle_axis axis =
        boundary_oracle_axis_of( ( const double3[3] ){ { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1.5, 0 } } );
    assert_close( axis.height, 1.5, 1e-15 );
    assert_close( double3_distance( axis.foot, double3_make( 0.5, 0, 0 ) ), 0.0, 1e-15 );
    assert_close( double3_distance( axis.upward, double3_make( 0, 1, 0 ) ), 0.0, 1e-15 );
}

static void height_times_base_is_twice_the_area( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        const double3 corner[3] = { random_vector( n, 0 ), random_vector( n, 1 ), random_vector( n, 2 ) };
        const boundary_oracle_axis axis = boundary_oracle_axis_of( corner );
        const double slender = axis.base / axis.height; // a sliver loses as many digits as its aspect ratio has
        assert_close( axis.height * axis.base / doubled_area( corner ), 1.0, 1e-12 * fmax( 1.0, slender ) );
        assert_close( double3_dot( axis.upward, axis.along ), 0.0, 1e-12 * fmax( 1.0, slender ) );
    }
}

static void the_height_ignores_a_translation_and_the_printed_one_does_not( void** state )
{
    (void)state;
    const double3 far = { 1e3, -1e3, 1e3 };
    int wrong = 0;
    for ( int n = 0; n < 200; ++n )
    {
        const double3 corner[3] = { random_vector( n, 0 ), random_vector( n, 1 ), random_vector( n, 2 ) };
        const double3 moved[3] = { double3_add( corner[0], far ), double3_add( corner[1], far ),
                                   double3_add( corner[2], far ) };
        const boundary_oracle_axis here = boundary_oracle_axis_of( corner ), there = boundary_oracle_axis_of( moved );
        // coordinates of 1e3 are rounded to 1e-13, which turns a short base by as much as that over its length
        assert_close( there.height, here.height, 1e-11 * fmax( 1.0, 1.0 / here.base ) );
        const double printed = boundary_oracle_height_printed( &here, corner );
        const double printed_there = boundary_oracle_height_printed( &there, moved );
        wrong += fabs( printed_there - printed ) > 1.0 || printed < 0.0 ? 1 : 0;
    }
    assert_true( wrong > 190 );
}

// ---- Sections 3.3 and 3.4: lines and points on them ----

static void a_triangle_has_the_lines_and_points_of_a_count_by_hand( void** state )
{
    (void)state;
    // base 3, height 4.5. Even: 4 parts, lines at shares 1/4, 2/4, 3/4 of lengths 2.25, 1.5, 0.75: 1, 0, 0 points.
    // Exact: lines at 1, 2, 3, 4 of lengths 2.333, 1.667, 1, 0.333: 2, 1, 0, 0 points.
    balloon_mesh mesh = one_triangle( double3_make( 0, 0, 0 ), double3_make( 3, 0, 0 ), double3_make( 1, 4.5, 0 ) );
    for ( int policy = 0; policy < BOUNDARY_ORACLE_POLICY_COUNT; ++policy )
    {
        const bool even = policy == BOUNDARY_ORACLE_EVEN;
        boundary_oracle_options options = { .spacing = 1.0, .cap = 1e6, .policy = (boundary_oracle_policy)policy };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        const boundary_oracle_memory* memory = layer.memory + layer.edge_count;
        assert_int_equal( memory->line_count, 4 );
        assert_int_equal( memory->points[0], even ? 1 : 2 );
        assert_int_equal( memory->points[1], even ? 0 : 1 );
        assert_int_equal( memory->points[2] + memory->points[3], 0 );
        const double3 first = layer.points[layer.edge_point_count].y;
        // even: half way on the line at 1/4; exact: 1 m from the side a-c on the line at 1 m
        const double3 requested =
            even ? double3_make( 0.25 + 1.125, 1.125, 0.0 ) : double3_make( 1.0 / 4.5 + 1.0, 1.0, 0.0 );
        assert_close( double3_distance( first, requested ), 0.0, 1e-14 );
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

static void a_triangle_lower_than_the_spacing_or_too_narrow_has_no_inner_points( void** state )
{
    (void)state;
    static const double3 LOW[3] = { { 0, 0, 0 }, { 1.1, 0, 0 }, { 0.55, 0.95, 0 } }, // h is 0.95
        NEEDLE[3] = { { 0, 0, 0 }, { 9, 0.45, 0 }, { 9, -0.45, 0 } };                // 9, and its lines are below 0.9
    for ( int n = 0; n < 12; ++n )
    {
        const double3* c = n < 6 ? LOW : NEEDLE;
        balloon_mesh mesh = one_triangle( c[0], c[1], c[2] );
        const boundary_oracle_options options = { .spacing = 1.0,
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)( n % 2 ),
                                                  .rounding = (boundary_oracle_rounding)( n / 2 % 3 ) };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        const double height = boundary_oracle_axis_of( c ).height;
        assert_true( n < 6 ? height < 1.0 : height > 8.0 );
        assert_int_equal( inner_points( &layer ), 0 );
        boundary_oracle_destroy( &layer );
        balloon_mesh_destroy( &mesh );
    }
}

static void table_b5_holds_for_both_policies( void** state )
{
    (void)state;
    const double d[4] = { 0.2, 0.1, 0.05, 0.025 };
    const int requested[2][4][2] = { { { 930, 0 }, { 5160, 300 }, { 14730, 11640 }, { 32670, 79320 } },
                                     { { 3360, 0 }, { 7710, 3480 }, { 17340, 21360 }, { 35280, 103560 } } };
    balloon_mesh mesh = reference_sphere();
    for ( int n = 0; n < 8; ++n )
    {
        const boundary_oracle_options options = { .spacing = d[n % 4],
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)( n / 4 ) };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        print_message( "d %g policy %d: %d on edges, %d inside\n", options.spacing, options.policy,
                       layer.edge_point_count, inner_points( &layer ) );
        assert_int_equal( layer.edge_point_count, requested[n / 4][n % 4][0] );
        assert_int_equal( inner_points( &layer ), requested[n / 4][n % 4][1] );
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

static void inner_points_fill_the_area_from_below_as_the_spacing_falls( void** state )
{
    (void)state;
    balloon_mesh mesh = reference_sphere();
    double area = 0.0, density[4];
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        const int* v = mesh.triangles + 3 * t;
        area += 0.5 * doubled_area(
                          ( const double3[3] ){ mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]] } );
    }
    for ( int n = 0; n < 4; ++n )
    {
        const double d = 0.05 / ( 1 << n );
        const boundary_oracle_options options = { .spacing = d, .cap = 2e7 };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        density[n] = inner_points( &layer ) * d * d / area;
        print_message( "d %g: %.3f of Area / d^2\n", d, density[n] );
        assert_true( density[n] < 1.0 && ( n == 0 || density[n] > density[n - 1] ) );
        boundary_oracle_destroy( &layer );
    }
    // two decimals of the specification
    assert_close( density[0], 0.37, 0.005 );
    assert_close( density[1], 0.63, 0.005 );
    assert_true( density[3] > 0.85 );
    balloon_mesh_destroy( &mesh );
}

// ---- properties of every point ----

static void assert_order( const boundary_oracle_point* a, const boundary_oracle_point* b )
{
    const bool rises = a->element != b->element ? a->element < b->element
                       : a->line != b->line     ? a->line < b->line
                                                : a->step < b->step;
    assert_true( rises );
}

static void every_point_is_on_its_one_parent_with_weights_and_a_unit_normal( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_pear( &mesh, 3, 1.0 ) );
    for ( int n = 0; n < 12; ++n )
    {
        const boundary_oracle_options options = { .spacing = 0.03,
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)( n % 2 ),
                                                  .rounding = (boundary_oracle_rounding)( n / 2 % 3 ),
                                                  .normals = (boundary_oracle_normals)( n / 6 ) };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        assert_true( layer.edge_point_count > 1000 && inner_points( &layer ) > 1000 );
        for ( int m = 0; m < layer.point_count; ++m )
        {
            const boundary_oracle_point* p = layer.points + m;
            assert_int_equal( p->element < layer.edge_count, m < layer.edge_point_count );
            assert_int_equal( p->element < layer.edge_count, p->line == 0 );
            assert_on_its_parents( &layer, mesh.positions, p );
            if ( m > 0 )
            {
                assert_order( p - 1, p );
            }
        }
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

static void edge_points_are_the_sum_of_the_count_law( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_pear( &mesh, 3, 1.0 ) );
    for ( int policy = 0; policy < BOUNDARY_ORACLE_POLICY_COUNT; ++policy )
    {
        const boundary_oracle_options options = { .spacing = 0.017,
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)policy };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        int sum = 0;
        for ( int e = 0; e < layer.edge_count; ++e )
        {
            const balloon_mesh_edge* edge = layer.topology.edges + e;
            const double length = double3_distance( mesh.positions[edge->a], mesh.positions[edge->b] );
            const int n = (int)floor( length / 0.017 );
            sum += policy == BOUNDARY_ORACLE_EVEN ? ( n > 0 ? n - 1 : 0 ) : n; // no length here is a multiple
        }
        assert_int_equal( layer.edge_point_count, sum );
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

static void no_two_points_of_different_elements_coincide( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, 1, 1.0 ) );
    const boundary_oracle_options options = { .spacing = 0.06, .cap = 1e6 };
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    double least = INFINITY;
    for ( int n = 0; n < layer.point_count; ++n )
    {
        for ( int m = 0; m < n; ++m )
        {
            least = layer.points[n].element != layer.points[m].element
                        ? fmin( least, double3_distance( layer.points[n].y, layer.points[m].y ) )
                        : least;
        }
        for ( int i = 0; i < mesh.vertex_count; ++i )
        {
            least = fmin( least, double3_distance( layer.points[n].y, mesh.positions[i] ) );
        }
    }
    assert_true( layer.point_count > 1000 && least > 1e-6 * options.spacing );
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

static void rows_are_parallel_to_the_axis_and_inside_before_and_after_a_translation( void** state )
{
    (void)state;
    const double3 far = { 1e3, 1e3, -1e3 };
    for ( int n = 0; n < 80; ++n )
    {
        double3 corner[3] = { { 0, 0, 0 }, { 2, 0, 0 }, { 1, sqrt( 3.0 ), 0 } }; // equilateral
        corner[1].x = n % 4 == 1 ? 1.0 : n % 4 == 2 ? 0.3 : corner[1].x;         // isosceles, needle
        corner[2].x = n % 4 == 3 ? 0.0 : 0.5 * corner[1].x;                      // right
        const double3 axis = boundary_oracle_unit( random_vector( n, 0 ) ),
                      other = boundary_oracle_unit( random_vector( n, 1 ) );
        for ( int k = 0; k < 3; ++k )
        {
            // two reflections are a rotation
            corner[k] = double3_sub( corner[k], double3_scale( 2.0 * double3_dot( corner[k], axis ), axis ) );
            corner[k] = double3_sub( corner[k], double3_scale( 2.0 * double3_dot( corner[k], other ), other ) );
        }
        balloon_mesh mesh = one_triangle( corner[0], corner[1], corner[2] );
        const double d = random_between( n, 9, 0.04, 0.2 );
        const boundary_oracle_options options = { .spacing = d,
                                                  .cap = 1e6,
                                                  .policy = (boundary_oracle_policy)( n / 4 % 2 ) };
        boundary_oracle_layer layer = layer_on( &mesh, &options );
        const boundary_oracle_axis base = boundary_oracle_axis_of( corner );
        for ( int m = layer.edge_point_count; m < layer.point_count; ++m )
        {
            const boundary_oracle_point* p = layer.points + m;
            const double upper = double3_dot( double3_sub( p->y, corner[base.a] ), base.upward );
            const double requested = boundary_oracle_fraction( p->line, layer.memory[layer.edge_count].line_count,
                                                               base.height, d, options.policy ) *
                                     base.height;
            assert_close( upper, requested, 1e-12 );
            assert_true( p->weight[0] > 0.0 && p->weight[1] > 0.0 && p->weight[2] > 0.0 );
        }
        // equal sides may give another axis when coordinates are rounded far from the origin: counts of those agree
        for ( int k = 0; k < 3; ++k )
        {
            mesh.positions[k] = double3_add( corner[k], far );
        }
        boundary_oracle_layer moved = layer_on( &mesh, &options );
        assert_int_equal( moved.point_count, layer.point_count );
        for ( int m = 0; m < layer.point_count && moved.memory[3].axis == layer.memory[3].axis; ++m )
        {
            const double3 back = double3_sub( moved.points[m].y, far );
            assert_close( double3_distance( back, layer.points[m].y ), 0.0, 1e-11 );
        }
        boundary_oracle_destroy( &moved );
        boundary_oracle_destroy( &layer );
        balloon_mesh_destroy( &mesh );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( the_reference_sphere_is_that_of_the_program ),
        cmocka_unit_test( each_edge_stands_once_lower_vertex_first_rising ),
        cmocka_unit_test( an_edge_has_the_counts_of_the_table ),
        cmocka_unit_test( each_rounding_counts_by_its_own_rule ),
        cmocka_unit_test( exact_points_do_not_depend_on_the_rounding ),
        cmocka_unit_test( gaps_keep_their_bounds_and_no_point_stands_on_a_vertex ),
        cmocka_unit_test( even_points_are_the_same_from_either_end_and_exact_ones_are_not ),
        cmocka_unit_test( the_axis_is_the_shortest_edge_and_the_lowest_of_equals ),
        cmocka_unit_test( height_times_base_is_twice_the_area ),
        cmocka_unit_test( the_height_ignores_a_translation_and_the_printed_one_does_not ),
        cmocka_unit_test( a_triangle_has_the_lines_and_points_of_a_count_by_hand ),
        cmocka_unit_test( a_triangle_lower_than_the_spacing_or_too_narrow_has_no_inner_points ),
        cmocka_unit_test( table_b5_holds_for_both_policies ),
        cmocka_unit_test( inner_points_fill_the_area_from_below_as_the_spacing_falls ),
        cmocka_unit_test( every_point_is_on_its_one_parent_with_weights_and_a_unit_normal ),
        cmocka_unit_test( edge_points_are_the_sum_of_the_count_law ),
        cmocka_unit_test( no_two_points_of_different_elements_coincide ),
        cmocka_unit_test( rows_are_parallel_to_the_axis_and_inside_before_and_after_a_translation ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
