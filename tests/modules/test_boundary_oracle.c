// The oracle of boundary particles is sound: places, normals and spacing by closed forms. Numbers of sections are those of the boundary particle paper (docs/methods.md).
#include "boundary_oracle_fixture.h"

static double doubled_area( const double3 c[3] )
{
    return double3_length( double3_cross( double3_sub( c[1], c[0] ), double3_sub( c[2], c[0] ) ) );
}

// Section 3.2. The printed height depends on where the origin is.
TEST( the_height_is_that_of_the_area_wherever_a_triangle_is )
{
    const double3 far = { 1e3, -1e3, 1e3 };
    int wrong = 0;
    for ( int n = 0; n < 200; ++n )
    {
        const double3 corner[3] = { random_vector( n, 0 ), random_vector( n, 1 ), random_vector( n, 2 ) };
        const double3 moved[3] = { double3_add( corner[0], far ), double3_add( corner[1], far ),
                                   double3_add( corner[2], far ) };
        const boundary_oracle_axis here = boundary_oracle_axis_of( corner ), there = boundary_oracle_axis_of( moved );
        const double slender = fmax( 1.0, here.base / here.height ); // a sliver loses as many digits as that has
        assert_ratio( here.height * here.base, doubled_area( corner ), 1e-12 * slender );
        // coordinates of 1e3 are rounded to 1e-13, which turns a short base by as much as that over its length
        assert_close( there.height, here.height, 1e-11 * fmax( 1.0, 1.0 / here.base ) );
        const double printed = boundary_oracle_height_printed( &here, corner );
        wrong += fabs( boundary_oracle_height_printed( &there, moved ) - printed ) > 1.0 || printed < 0.0 ? 1 : 0;
    }
    assert_true( wrong > 190 );
}

// Sections 3.3 and 3.4

TEST( a_triangle_has_the_lines_and_points_of_a_count_by_hand )
{
    // base 3, height 4.5. Even: 4 parts, lines at shares 1/4, 2/4, 3/4 of lengths 2.25, 1.5, 0.75: 1, 0, 0 points.
    // Exact: lines at 1, 2, 3, 4 of lengths 2.333, 1.667, 1, 0.333: 2, 1, 0, 0 points.
    SCOPED( balloon_mesh_destroy )
    balloon_mesh mesh = one_triangle( double3_make( 0, 0, 0 ), double3_make( 3, 0, 0 ), double3_make( 1, 4.5, 0 ) );
    for ( int policy = 0; policy < BOUNDARY_ORACLE_POLICY_COUNT; ++policy )
    {
        const bool even = policy == BOUNDARY_ORACLE_EVEN;
        boundary_oracle_options options = { .spacing = 1.0, .cap = 1e6, .policy = (boundary_oracle_policy)policy };
        SCOPED( boundary_oracle_destroy ) boundary_oracle_layer layer = layer_on( &mesh, &options );
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
    }
}

// Section 5.2
TEST( barycentric_normals_are_exact_for_a_linear_field )
{
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
        // the printed weights are areas; a sliver loses digits
        double by_area[3];
        assert_true( boundary_oracle_weights_by_area( corner, y, by_area ) );
        for ( int k = 0; k < 3; ++k )
        {
            assert_close( by_area[k], weight[k], 1e-12 / doubled_area( corner ) );
        }
        const double3 scanned = boundary_oracle_inner_normal( corner, &axis, q, r, BOUNDARY_ORACLE_SCANLINE );
        worst = fmax( worst, double3_angle( scanned, y ) );
    }
    // the ends of a line are normalised before they are blended: close, but another rule
    assert_true( worst > 1e-3 );
}

TEST( curvature_strain_and_distance_have_their_closed_forms )
{
    const double3 x = { 1, 0, 0 }, y = { 0, 1, 0 };
    assert_close( boundary_oracle_spacing_by_curvature( 0.1, 2.0, x, y ), 0.1 / ( 1.0 + acos( -1.0 ) ), 1e-15 );
    assert_true( boundary_oracle_spacing_by_curvature( 0.1, 2.0, x, x ) == 0.1 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, 4.0, 1.25, 1.0 ), 0.05, 1e-15 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, 4.0, 0.75, 1.0 ), 0.05, 1e-15 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, -4.0, 1.25, 1.0 ), 0.2, 1e-15 );
    assert_true( boundary_oracle_spacing_by_strain( 0.1, 4.0, 1.0, 0.0 ) == 0.1 );
    assert_close( boundary_oracle_spacing_by_distance( zero, double3_make( 0, 0, 50 ), 0.004 ), 0.2, 1e-15 );
}
