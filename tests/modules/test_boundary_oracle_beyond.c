// Extensions of the paper in double precision: local spacing, and contact that boundary particles pass on to their
// parents.
#include "boundary_oracle_fixture.h"

#include "oracle/contact_oracle.h"

static const boundary_oracle_criteria OFF = { .least = 1e-3, .most = 1e3 };

// ---- local spacing ----

static void without_a_criterion_the_spacing_is_the_one_that_was_queried_for( void** state )
{
    (void)state;
    assert_true( boundary_oracle_local_spacing( &OFF, 0.1, zero, zero, zero, zero, 0.0 ) == 0.1 );
    const boundary_oracle_criteria narrow = { .least = 0.2, .most = 0.4 }, lower = { .least = 0.01, .most = 0.05 };
    assert_true( boundary_oracle_local_spacing( &narrow, 0.1, zero, zero, zero, zero, 0.0 ) == 0.2 );
    assert_true( boundary_oracle_local_spacing( &lower, 0.1, zero, zero, zero, zero, 0.0 ) == 0.05 );
}

static void curvature_strain_and_screen_have_their_closed_forms( void** state )
{
    (void)state;
    const double3 x = { 1, 0, 0 }, y = { 0, 1, 0 };
    assert_close( boundary_oracle_spacing_by_curvature( 0.1, 2.0, x, y ), 0.1 / ( 1.0 + acos( -1.0 ) ), 1e-15 );
    assert_true( boundary_oracle_spacing_by_curvature( 0.1, 2.0, x, x ) == 0.1 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, 4.0, 1.25, 1.0 ), 0.05, 1e-15 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, 4.0, 0.75, 1.0 ), 0.05, 1e-15 );
    assert_close( boundary_oracle_spacing_by_strain( 0.1, -4.0, 1.25, 1.0 ), 0.2, 1e-15 );
    assert_true( boundary_oracle_spacing_by_strain( 0.1, 4.0, 1.0, 0.0 ) == 0.1 );
    assert_close( boundary_oracle_spacing_by_screen( zero, double3_make( 0, 0, 50 ), 0.001, 4.0 ), 0.2, 1e-15 );
}

static void the_least_that_a_criterion_asks_for_counts_within_the_limits( void** state )
{
    (void)state;
    boundary_oracle_criteria all = { .least = 0.01,
                                     .most = 0.3,
                                     .curvature_gain = 1.0,
                                     .strain_gain = 1.0,
                                     .by_screen = true,
                                     .pixel_angle = 0.001,
                                     .pixels = 3.0 };
    const double3 p0 = { 0, 0, 10 }, p1 = { 1, 0, 10 }, x = { 1, 0, 0 }, y = { 0, 1, 0 };
    const double middle = sqrt( 100.25 );
    assert_close( boundary_oracle_local_spacing( &all, 0.1, p0, p1, x, y, 0.5 ), 0.003 * middle, 1e-15 );
    all.pixels = 100.0;
    assert_close( boundary_oracle_local_spacing( &all, 0.1, p0, p1, x, y, 0.5 ), 0.1 / ( 1.0 + acos( 0.0 ) ), 1e-15 );
    assert_close( boundary_oracle_local_spacing( &all, 0.1, p0, p1, x, x, 0.5 ), 0.05, 1e-15 );
    all.curvature_gain = all.strain_gain = 0.0;
    assert_true( boundary_oracle_local_spacing( &all, 0.1, p0, p1, x, x, 0.5 ) == 0.3 );
    all.pixels = 0.5;
    assert_true( boundary_oracle_local_spacing( &all, 0.1, p0, p1, x, x, 0.5 ) == 0.01 );
}

// One value per edge, from data of both its ends, and a layer with these values.
static boundary_oracle_layer adapted( const balloon_mesh* mesh, const double3* rest, double d,
                                      const boundary_oracle_criteria* criteria, double* edge, double* triangle )
{
    const boundary_oracle_options uniform = { .spacing = d, .cap = 1e6 };
    boundary_oracle_layer layer = layer_on( mesh, &uniform );
    for ( int e = 0; e < layer.edge_count; ++e )
    {
        const int a = layer.topology.edges[e].a, b = layer.topology.edges[e].b;
        const double3 *x = mesh->positions, *n = layer.vertex_normal;
        const double length = double3_distance( rest[a], rest[b] );
        edge[e] = boundary_oracle_local_spacing( criteria, d, x[a], x[b], n[a], n[b], length );
        // the same from the other end
        const double back = boundary_oracle_local_spacing( criteria, d, x[b], x[a], n[b], n[a], length );
        assert_close( back, edge[e], 1e-15 );
        assert_true( edge[e] >= criteria->least && edge[e] <= criteria->most );
    }
    for ( int t = 0; t < layer.triangle_count; ++t )
    {
        const int* e = layer.topology.triangle_edge + 3 * t;
        triangle[t] = boundary_oracle_triangle_spacing( ( const double[3] ){ edge[e[0]], edge[e[1]], edge[e[2]] } );
    }
    layer.options.edge_spacing = edge;
    layer.options.triangle_spacing = triangle;
    must_update( &layer, mesh->positions );
    return layer;
}

static void there_are_more_points_where_curvature_is_high( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, 3, 1.0 ) );
    // drawn out along x: sharp at its tips, flat at its waist
    for ( int i = 0; i < mesh.vertex_count; ++i )
    {
        mesh.positions[i].x *= 4.0;
    }
    static double edge[1920], triangle[1280];
    boundary_oracle_criteria criteria = { .least = 0.005, .most = 0.4, .curvature_gain = 10.0 };
    boundary_oracle_layer layer = adapted( &mesh, mesh.positions, 0.1, &criteria, edge, triangle );
    double tip = 0.0, waist = 0.0;
    int tips = 0, waists = 0;
    for ( int e = 0; e < layer.edge_count; ++e )
    {
        const double x = fabs( mesh.positions[layer.topology.edges[e].a].x );
        tip += x > 3.9 ? edge[e] : 0.0;
        tips += x > 3.9 ? 1 : 0;
        waist += x < 0.5 ? edge[e] : 0.0;
        waists += x < 0.5 ? 1 : 0;
    }
    print_message( "spacing %.4f at the tips, %.4f at the waist, %d points\n", tip / tips, waist / waists,
                   layer.point_count );
    assert_true( tips > 10 && waists > 10 && tip / tips < 0.7 * waist / waists );
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

static void strain_makes_spacing_finer_or_coarser_as_the_gain_says( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, 2, 1.0 ) );
    double3 rest[162];
    memcpy( rest, mesh.positions, sizeof( rest ) );
    scale_all( mesh.positions, rest, mesh.vertex_count, 1.5 );
    static double edge[480], triangle[320];
    int points[3];
    for ( int n = 0; n < 3; ++n )
    {
        boundary_oracle_criteria criteria = { .least = 0.01, .most = 0.5, .strain_gain = 2.0 * ( 1 - n ) };
        boundary_oracle_layer layer = adapted( &mesh, rest, 0.1, &criteria, edge, triangle );
        // every edge is half as long again, so the factor is 2
        assert_close( edge[0], n == 0 ? 0.05 : n == 1 ? 0.1 : 0.2, 1e-12 );
        points[n] = layer.point_count;
        boundary_oracle_destroy( &layer );
    }
    assert_true( points[0] > 2 * points[1] && points[1] > 2 * points[2] );
    balloon_mesh_destroy( &mesh );
}

static void points_grow_fewer_with_distance_and_both_sides_of_an_edge_agree( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, 2, 1.0 ) );
    static double edge[480], triangle[320];
    int last = INT32_MAX;
    for ( int n = 0; n < 4; ++n )
    {
        boundary_oracle_criteria criteria = { .least = 0.005,
                                              .most = 1.0,
                                              .by_screen = true,
                                              .pixel_angle = 0.001,
                                              .pixels = 4.0,
                                              .eye = double3_make( 0, 0, 5 << n ) };
        boundary_oracle_layer layer = adapted( &mesh, mesh.positions, 0.1, &criteria, edge, triangle );
        assert_true( layer.point_count < last );
        last = layer.point_count;
        // an edge's points are one set, whichever of its triangles is considered
        for ( int m = 1; m < layer.edge_point_count; ++m )
        {
            assert_true( layer.points[m].element != layer.points[m - 1].element ||
                         layer.points[m].step == layer.points[m - 1].step + 1 );
        }
        boundary_oracle_destroy( &layer );
    }
    balloon_mesh_destroy( &mesh );
}

// ---- contact ----

typedef struct touching
{
    double3 x[3], before[3], normal;
    double w[3], b[3], offset;
} touching;

static double gap_of( const touching* t )
{
    double gap = -t->offset;
    for ( int k = 0; k < 3; ++k )
    {
        gap += t->b[k] * double3_dot( t->x[k], t->normal );
    }
    return gap;
}

// Masses, weights and a plane of any kind, the point a hundredth below it.
static touching touching_of( int n )
{
    touching t = { .normal = boundary_oracle_unit( random_vector( n, 9 ) ) };
    double sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        t.x[k] = t.before[k] = random_vector( n, k );
        t.w[k] = random_between( n, 50 + k, 0.5, 4.0 );
        t.b[k] = random_between( n, 60 + k, 0.05, 1.0 );
        sum += t.b[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        t.b[k] /= sum;
    }
    t.offset = gap_of( &t ) + 0.01;
    return t;
}

static void a_point_below_a_plane_comes_to_stand_on_it_by_its_parents( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        touching t = touching_of( n );
        assert_true( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, 0.0, NULL ) );
        assert_close( gap_of( &t ), 0.0, 1e-14 );
        const double first = double3_dot( double3_sub( t.x[0], t.before[0] ), t.normal );
        for ( int k = 1; k < 3; ++k )
        {
            // parents move along n, in proportion to w b
            const double3 move = double3_sub( t.x[k], t.before[k] );
            const double along = double3_dot( move, t.normal );
            assert_close( double3_length( move ), along, 1e-14 );
            assert_close( along * t.w[0] * t.b[0], first * t.w[k] * t.b[k], 1e-14 );
        }
        // once it has moved, nothing is left to do; above the plane there was nothing to do
        t.offset -= 1e-3;
        assert_false( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, 0.0, NULL ) );
    }
}

static void contact_keeps_momentum_and_its_moment( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        touching t = touching_of( n );
        const double plane_w = 0.5 + n / 50.0;
        double plane_move;
        assert_true( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, plane_w, &plane_move ) );
        double3 sum = double3_scale( plane_move / plane_w, t.normal ), moment = zero, y = zero;
        for ( int k = 0; k < 3; ++k )
        {
            const double3 m_dx = double3_scale( 1.0 / t.w[k], double3_sub( t.x[k], t.before[k] ) );
            sum = double3_add( sum, m_dx );
            moment = double3_add( moment, double3_cross( t.before[k], m_dx ) );
            y = double3_add( y, double3_scale( t.b[k], t.before[k] ) );
        }
        // the plane receives the rest of the sum, at the position of the point
        assert_close( double3_length( sum ), 0.0, 1e-14 );
        const double3 on_plane = double3_cross( y, double3_scale( plane_move / plane_w, t.normal ) );
        assert_close( double3_length( double3_add( moment, on_plane ) ), 0.0, 1e-14 );
        assert_close( gap_of( &t ), plane_move, 1e-14 );
    }
}

// The plane as a separate side: a fourth vertex that carries it.
static void it_is_the_law_of_two_weighted_points_with_a_plane_for_the_second( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        touching t = touching_of( n );
        const double plane_w = n % 2 == 0 ? 0.0 : 0.7;
        double3 x[4] = { t.x[0], t.x[1], t.x[2], double3_scale( t.offset, t.normal ) };
        const double3 plane = x[3];
        const double w[4] = { t.w[0], t.w[1], t.w[2], plane_w };
        contact_oracle_contact contact = { .a = { 3, { 0, 1, 2 }, { t.b[0], t.b[1], t.b[2] } },
                                           .b = { 1, { 3 }, { 1.0 } },
                                           .normal = t.normal };
        double plane_move;
        contact_oracle_push( &contact, w, x );
        assert_true( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, plane_w, &plane_move ) );
        for ( int k = 0; k < 3; ++k )
        {
            assert_close( double3_distance( t.x[k], x[k] ), 0.0, 1e-14 );
        }
        assert_close( double3_dot( double3_sub( x[3], plane ), t.normal ), plane_move, 1e-14 );
    }
}

static void a_pinned_parent_stays_and_the_others_do_its_part( void** state )
{
    (void)state;
    touching t = touching_of( 3 );
    t.w[1] = 0.0;
    assert_true( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, 0.0, NULL ) );
    assert_memory_equal( &t.x[1], &t.before[1], sizeof( t.x[1] ) );
    assert_close( gap_of( &t ), 0.0, 1e-14 );
    t = touching_of( 4 );
    t.w[0] = t.w[1] = t.w[2] = 0.0;
    assert_false( boundary_oracle_contact( 3, t.x, t.w, t.b, t.normal, t.offset, 0.0, NULL ) );
    assert_memory_equal( t.x, t.before, sizeof( t.x ) );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( without_a_criterion_the_spacing_is_the_one_that_was_queried_for ),
        cmocka_unit_test( curvature_strain_and_screen_have_their_closed_forms ),
        cmocka_unit_test( the_least_that_a_criterion_asks_for_counts_within_the_limits ),
        cmocka_unit_test( there_are_more_points_where_curvature_is_high ),
        cmocka_unit_test( strain_makes_spacing_finer_or_coarser_as_the_gain_says ),
        cmocka_unit_test( points_grow_fewer_with_distance_and_both_sides_of_an_edge_agree ),
        cmocka_unit_test( a_point_below_a_plane_comes_to_stand_on_it_by_its_parents ),
        cmocka_unit_test( contact_keeps_momentum_and_its_moment ),
        cmocka_unit_test( it_is_the_law_of_two_weighted_points_with_a_plane_for_the_second ),
        cmocka_unit_test( a_pinned_parent_stays_and_the_others_do_its_part ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
