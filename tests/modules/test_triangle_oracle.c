// Links, weights, forces and energies of triangle cloth on its double-precision oracle. Numbers of equations and
// figures are those of Noh and Jung.
#include "triangle_oracle_fixture.h"

// ---- Fig. 2-4, 6, 7: links ----

static void assert_links( const triangle_oracle* cloth, const int* stretch, int stretch_count, const int* bend,
                          int bend_count )
{
    assert_int_equal( cloth->stretch_count, stretch_count );
    assert_int_equal( cloth->bend_count, bend_count );
    for ( int k = 0; k < stretch_count + bend_count; ++k )
    {
        const int* requested = k < stretch_count ? stretch + 2 * k : bend + 2 * ( k - stretch_count );
        assert_int_equal( cloth->link[k].i, requested[0] );
        assert_int_equal( cloth->link[k].j, requested[1] );
        assert_int_equal( cloth->link[k].bends, k >= stretch_count );
    }
}

static void two_triangles_have_five_edges_and_a_diagonal( void** state )
{
    (void)state;
    const int triangles[] = { 0, 1, 2, 2, 1, 3 };
    const int edges[] = { 0, 1, 0, 2, 1, 2, 1, 3, 2, 3 }, diagonals[] = { 0, 3 };
    triangle_oracle cloth = make_mesh( 4, triangles, 2 );
    assert_links( &cloth, edges, 5, diagonals, 1 );
    triangle_oracle_destroy( &cloth );
}

static void an_edge_of_the_border_has_no_diagonal( void** state )
{
    (void)state;
    const int triangles[] = { 2, 0, 1 };
    const int edges[] = { 0, 1, 0, 2, 1, 2 };
    triangle_oracle cloth = make_mesh( 3, triangles, 1 );
    assert_links( &cloth, edges, 3, NULL, 0 );
    triangle_oracle_destroy( &cloth );
}

static void a_fan_has_diagonals_across_its_spokes( void** state )
{
    (void)state;
    const int triangles[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 1 };
    const int edges[] = { 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 1, 2, 1, 5, 2, 3, 3, 4, 4, 5 };
    const int diagonals[] = { 1, 3, 1, 4, 2, 4, 2, 5, 3, 5 };
    triangle_oracle cloth = make_mesh( 6, triangles, 5 );
    assert_links( &cloth, edges, 10, diagonals, 5 );
    for ( int i = 0; i < 6; ++i )
    {
        assert_int_equal( cloth.neighbours[i], 5 );
    }
    triangle_oracle_destroy( &cloth );
}

static void a_pair_that_is_edge_and_diagonal_is_two_links_and_one_neighbour( void** state )
{
    (void)state;
    // a closed tetrahedron: valence 3, every edge lies across from another
    const int triangles[] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3 };
    const int pairs[] = { 0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3 };
    triangle_oracle cloth = make_mesh( 4, triangles, 4 );
    assert_links( &cloth, pairs, 6, pairs, 6 );
    for ( int i = 0; i < 4; ++i )
    {
        assert_int_equal( cloth.neighbours[i], 3 );
    }
    triangle_oracle_destroy( &cloth );
}

static void a_vertex_seen_across_two_edges_is_one_diagonal( void** state )
{
    (void)state;
    // Fig. 6: 0 and 3 see each other across the edges 1 2 and 4 5
    const int triangles[] = { 0, 1, 2, 3, 2, 1, 0, 4, 5, 3, 5, 4 };
    const int diagonals[] = { 0, 3 };
    triangle_oracle cloth = make_mesh( 6, triangles, 4 );
    assert_int_equal( cloth.stretch_count, 10 );
    assert_links( &cloth, ( const int[] ){ 0, 1, 0, 2, 0, 4, 0, 5, 1, 2, 1, 3, 2, 3, 3, 4, 3, 5, 4, 5 }, 10,
                  diagonals, 1 );
    assert_int_equal( cloth.neighbours[0], 5 );
    assert_int_equal( cloth.neighbours[3], 5 );
    triangle_oracle_destroy( &cloth );
}

static void three_triangles_at_an_edge_have_three_diagonals( void** state )
{
    (void)state;
    const int triangles[] = { 0, 1, 4, 1, 0, 2, 0, 1, 3 };
    const int edges[] = { 0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 1, 3, 1, 4 }, diagonals[] = { 2, 3, 2, 4, 3, 4 };
    triangle_oracle cloth = make_mesh( 5, triangles, 3 );
    assert_links( &cloth, edges, 7, diagonals, 3 );
    triangle_oracle_destroy( &cloth );
}

static void pairs_by_hand_take_the_place_of_the_mesh( void** state )
{
    (void)state;
    const double3 points[4] = { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 1.0, 1.0, 0.0 } };
    const double masses[4] = { 1.0, 1.0, 1.0, 1.0 };
    const int triangles[] = { 0, 1, 2, 2, 1, 3 }, stretch[] = { 3, 0 }, bend[] = { 1, 0, 2, 3 };
    triangle_oracle_def def = {
        .count = 4, .points = points, .triangle_count = 2, .triangles = triangles, .masses = masses
    };
    const triangle_oracle_params params = triangle_oracle_default_params();
    def.stretch_pairs = stretch;
    def.stretch_pair_count = 1;
    triangle_oracle cloth = make_cloth( &def, &params );
    assert_links( &cloth, stretch, 1, NULL, 0 );
    triangle_oracle_destroy( &cloth );
    def.bend_pairs = bend;
    def.bend_pair_count = 2;
    cloth = make_cloth( &def, &params );
    assert_links( &cloth, stretch, 1, bend, 2 );
    triangle_oracle_destroy( &cloth );
    def.stretch_pairs = NULL;
    cloth = make_cloth( &def, &params );
    assert_links( &cloth, ( const int[] ){ 0, 1, 0, 2, 1, 2, 1, 3, 2, 3 }, 5, bend, 2 );
    triangle_oracle_destroy( &cloth );
}

static void wrong_data_is_refused_in_a_message( void** state )
{
    (void)state;
    const double3 points[4] = { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 1.0, 0.0, 0.0 } };
    const double3 nowhere[4] = { { NAN, 0.0, 0.0 } };
    const double masses[4] = { 1.0, 1.0, 1.0, 1.0 }, massless[4] = { 1.0, 0.0, 1.0, 1.0 };
    const int triangles[] = { 0, 1, 2 }, beyond[] = { 0, 1, 4 }, twice[] = { 0, 1, 1 }, flat[] = { 1, 3 };
    const triangle_oracle_def good = {
        .count = 4, .points = points, .triangle_count = 1, .triangles = triangles, .masses = masses
    };
    const struct
    {
        triangle_oracle_def def;
        bool sheet;
        double damping;
        const char* message;
    } bad[] = {
        { good, false, -1.0, "damping is -1, must be in [0, 1e+12]" },
        { { .count = 4, .points = nowhere, .masses = masses }, false, 0.0, "vertex 0 is not finite" },
        { { .count = 4, .points = points, .masses = massless },
          false,
          0.0,
          "vertex 1 has the mass 0, must be above 0" },
        { { .count = 0 }, false, 0.0, "there are 0 vertices, must be in [1, 1048576]" },
        { { .count = 4, .points = points, .triangle_count = 1, .triangles = beyond, .masses = masses },
          false,
          0.0,
          "triangle 0 has vertex 4, there are 4" },
        { { .count = 4, .points = points, .triangle_count = 1, .triangles = twice, .masses = masses },
          false,
          0.0,
          "triangle 0 has vertex 1 twice" },
        { { .count = 4, .points = points, .stretch_pair_count = 1, .stretch_pairs = flat, .masses = masses },
          false,
          0.0,
          "the link of the vertices 1 and 3 has no length" },
        { { .count = 4, .points = points, .bend_pair_count = 1, .bend_pairs = triangles, .masses = masses },
          true,
          0.0,
          "a sheet's stiffness needs the mesh's own links, pairs by hand have no area" },
    };
    for ( size_t n = 0; n < sizeof( bad ) / sizeof( bad[0] ); ++n )
    {
        triangle_oracle cloth = { 0 };
        wisp_error error = { 0 };
        triangle_oracle_params params = triangle_oracle_default_params();
        params.damping = bad[n].damping;
        params.stiffness = bad[n].sheet ? TRIANGLE_ORACLE_STIFFNESS_MATERIAL : TRIANGLE_ORACLE_STIFFNESS_LINK;
        assert_int_equal( triangle_oracle_create( &bad[n].def, &params, &cloth, &error ), WISP_BAD_INPUT );
        assert_string_equal( error.message, bad[n].message );
        assert_null( cloth.x );
    }
}

// ---- Eq. 1-4, Fig. 5: weights ----

static void the_weights_of_a_vertex_sum_to_the_most_neighbours( void** state )
{
    (void)state;
    const triangle_oracle_params params = triangle_oracle_default_params();
    triangle_oracle cloth = make_sheet( &params );
    int least = cloth.max_neighbours;
    for ( int i = 0; i < cloth.count; ++i )
    {
        // w_i once for each other vertex that a link leads to
        double sum = 0.0;
        for ( int j = 0; j < cloth.count; ++j )
        {
            bool linked = false;
            for ( int k = 0; k < cloth.link_count; ++k )
            {
                const int a = cloth.link[k].i, b = cloth.link[k].j;
                linked = linked || ( a == i && b == j ) || ( a == j && b == i );
            }
            sum += linked ? cloth.weight[i] : 0.0;
        }
        assert_close( sum, cloth.max_neighbours, 1e-12 );
        least = (int)fmin( least, cloth.neighbours[i] );
    }
    assert_true( least < cloth.max_neighbours / 2 ); // the mesh is irregular, as in Fig. 5
    triangle_oracle_destroy( &cloth );
}

static void the_rewrite_is_equation_3_as_printed( void** state )
{
    (void)state;
    triangle_oracle_params params = triangle_oracle_default_params();
    params.damping_form = TRIANGLE_ORACLE_DAMPING_AXIAL;
    triangle_oracle cloth = make_sheet( &params );
    double3 printed[SHEET_COUNT], force[SHEET_COUNT], damping[SHEET_COUNT];
    crumple( &cloth, 10, 0.01, 1.0 );
    triangle_oracle_printed( &cloth, cloth.x, cloth.v, printed );
    triangle_oracle_forces( &cloth, cloth.x, force );
    triangle_oracle_damping_forces( &cloth, cloth.x, cloth.v, damping );
    for ( int i = 0; i < cloth.count; ++i )
    {
        const double3 a = double3_scale( 1.0 / cloth.true_mass[i], printed[i] );
        const double3 b = double3_scale( 1.0 / cloth.mass[i], double3_add( force[i], damping[i] ) );
        assert_close( double3_distance( a, b ), 0.0, 1e-12 * double3_length( a ) );
        assert_ratio( cloth.mass[i] * cloth.weight[i], cloth.true_mass[i], 1e-15 );
    }
    triangle_oracle_destroy( &cloth );
}

static void a_pair_weighs_as_its_ends_do_on_the_mean( void** state )
{
    (void)state;
    triangle_oracle_params params = triangle_oracle_default_params();
    triangle_oracle plain = make_sheet( &params );
    params.weights = TRIANGLE_ORACLE_WEIGHTS_PAIR;
    triangle_oracle cloth = make_sheet( &params );
    crumple( &plain, 10, 0.01, 0.0 );
    for ( int k = 0; k < cloth.link_count; ++k )
    {
        const triangle_oracle_term a = triangle_oracle_term_at( &cloth, k, plain.x );
        const triangle_oracle_term b = triangle_oracle_term_at( &plain, k, plain.x );
        const double mean = 0.5 * ( cloth.weight[cloth.link[k].i] + cloth.weight[cloth.link[k].j] );
        assert_close( a.force, mean * b.force, 1e-15 * fabs( a.force ) );
        const double e = triangle_oracle_energy_at( &cloth, k, plain.x );
        assert_close( e, mean * triangle_oracle_energy_at( &plain, k, plain.x ), 1e-15 * e );
    }
    for ( int i = 0; i < cloth.count; ++i )
    {
        assert_true( cloth.mass[i] == cloth.true_mass[i] );
    }
    triangle_oracle_destroy( &cloth );
    triangle_oracle_destroy( &plain );
}

static void a_vertex_without_neighbours_keeps_its_mass( void** state )
{
    (void)state;
    const int triangles[] = { 0, 1, 2 };
    triangle_oracle cloth = make_mesh( 4, triangles, 1 );
    assert_int_equal( cloth.neighbours[3], 0 );
    assert_true( cloth.weight[3] == 1.0 && cloth.mass[3] == 1e-3 );
    triangle_oracle_destroy( &cloth );
}

// ---- Eq. 5-8: stretch ----

// Of the whole sheet, so that it holds for sums too: force against the gradient of energy, in units of the largest.
static double worst_force( triangle_oracle* cloth, bool bends )
{
    const double step = 1e-7;
    double3 force[SHEET_COUNT];
    double worst = 0.0, largest = 0.0;
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        cloth->link[k].scale = cloth->link[k].bends == bends ? 1.0 : 0.0;
    }
    triangle_oracle_forces( cloth, cloth->x, force );
    double ( *energy_of )( const triangle_oracle*, const double3* ) =
        bends ? triangle_oracle_bend_energy : triangle_oracle_stretch_energy;
    for ( int n = 0; n < 3 * cloth->count; ++n )
    {
        const double3 x = cloth->x[n / 3];
        cloth->x[n / 3] = double3_add( x, along_axis( n % 3, step ) );
        const double more = energy_of( cloth, cloth->x );
        cloth->x[n / 3] = double3_add( x, along_axis( n % 3, -step ) );
        const double less = energy_of( cloth, cloth->x );
        cloth->x[n / 3] = x;
        const double f = component( force[n / 3], n % 3 );
        worst = fmax( worst, fabs( f + ( more - less ) / ( 2.0 * step ) ) );
        largest = fmax( largest, fabs( f ) );
    }
    return worst / largest;
}

static void stretch_is_the_gradient_of_its_energy( void** state )
{
    (void)state;
    const triangle_oracle_params params = still_params();
    triangle_oracle cloth = make_sheet( &params );
    crumple( &cloth, 10, 0.01, 0.0 );
    assert_true( worst_force( &cloth, false ) < 1e-6 );
    triangle_oracle_destroy( &cloth );
}

static void bending_is_the_gradient_of_its_energy( void** state )
{
    (void)state;
    triangle_oracle_params params = still_params();
    params.bend_stiffness = 3e-4;
    params.compression_stiffness = 150.0; // both branches of (12) are there
    triangle_oracle cloth = make_sheet( &params );
    crumple( &cloth, 10, 0.01, 0.0 );
    int ramps = 0, arcs = 0;
    for ( int k = cloth.stretch_count; k < cloth.link_count; ++k )
    {
        const triangle_oracle_term term = triangle_oracle_term_at( &cloth, k, cloth.x );
        ramps += term.force < 0.0 && term.k1 == 150.0 ? 1 : 0;
        arcs += term.force < 0.0 && term.k1 != 150.0 ? 1 : 0;
    }
    print_message( "%d links on the ramp, %d arcs\n", ramps, arcs );
    assert_true( ramps > 4 && arcs > 4 );
    assert_true( worst_force( &cloth, true ) < 1e-6 );
    triangle_oracle_destroy( &cloth );
}

static void a_stretched_link_pulls_its_ends_together( void** state )
{
    (void)state;
    const triangle_oracle_params params = still_params();
    triangle_oracle cloth = make_pair_of( &params, false, 1.0, 1.0 );
    double3 force[2];
    cloth.x[1].x = 1.25;
    triangle_oracle_forces( &cloth, cloth.x, force );
    assert_close( force[0].x, 50.0, 1e-12 );
    assert_close( force[1].x, -50.0, 1e-12 );
    triangle_oracle_destroy( &cloth );
}

static void a_short_edge_has_no_force_and_the_force_begins_at_zero( void** state )
{
    (void)state;
    const triangle_oracle_params params = still_params();
    triangle_oracle cloth = make_pair_of( &params, false, 1.0, 1.0 );
    const double lengths[] = { 0.0, 0.5, 1.0 - 1e-12, 1.0 };
    for ( int n = 0; n < 4; ++n )
    {
        cloth.x[1].x = lengths[n];
        const triangle_oracle_term term = triangle_oracle_term_at( &cloth, 0, cloth.x );
        assert_true( term.force == 0.0 && term.k1 == 0.0 && term.k2 == 0.0 );
        assert_true( triangle_oracle_energy_at( &cloth, 0, cloth.x ) == 0.0 );
    }
    cloth.x[1].x = 1.0 + 1e-12;
    const triangle_oracle_term term = triangle_oracle_term_at( &cloth, 0, cloth.x );
    assert_close( term.force, 200.0 * 1e-12, 1e-13 ); // an ulp of 1 is 1e-4 of what is stretched here
    triangle_oracle_destroy( &cloth );
}

// What a link's Jacobian differs by from differences of its force, in units of its k1.
static double worst_jacobian( const triangle_oracle* cloth, const double3* x )
{
    const double step = 1e-6;
    const triangle_oracle_term t = triangle_oracle_term_at( cloth, 0, x );
    double worst = 0.0;
    for ( int n = 0; n < 9; ++n )
    {
        double3 moved[2] = { x[0], x[1] }, more[2], less[2];
        moved[1] = double3_add( x[1], along_axis( n % 3, step ) );
        triangle_oracle_forces( cloth, moved, more );
        moved[1] = double3_add( x[1], along_axis( n % 3, -step ) );
        triangle_oracle_forces( cloth, moved, less );
        const double dd = component( t.direction, n / 3 ) * component( t.direction, n % 3 );
        const double unit = n / 3 == n % 3 ? 1.0 : 0.0;
        const double jacobian = t.k1 * dd + t.k2 * ( unit - dd );
        const double difference = component( double3_sub( more[0], less[0] ), n / 3 ) / ( 2.0 * step );
        worst = fmax( worst, fabs( jacobian - difference ) / t.k1 );
    }
    return worst;
}

static void the_jacobian_of_stretch_is_its_derivative( void** state )
{
    (void)state;
    const triangle_oracle_params params = still_params();
    triangle_oracle cloth = make_pair_of( &params, false, 1.0, 1.0 );
    for ( int n = 0; n < 20; ++n )
    {
        const double3 way = random_vector( 20, n );
        cloth.x[1] = double3_scale( random_between( 21, n, 1.01, 3.0 ) / double3_length( way ), way );
        assert_true( worst_jacobian( &cloth, cloth.x ) < 1e-5 );
        const triangle_oracle_term term = triangle_oracle_term_at( &cloth, 0, cloth.x );
        assert_true( term.k1 > 0.0 && term.k2 >= 0.0 ); // semidefinite
    }
    triangle_oracle_destroy( &cloth );
}

// ---- Eq. 9-13: bending ----

static void the_inverse_of_sinc_leaves_no_residual( void** state )
{
    (void)state;
    double worst = 0.0;
    for ( int n = 1; n <= 100000; ++n )
    {
        const double y = n / 100000.0;
        worst = fmax( worst, fabs( triangle_oracle_sinc( triangle_oracle_sinc_inverse( y ) ) - y ) );
    }
    for ( double away = 1e-16; away < 1e-2; away *= 3.0 )
    {
        const double u = triangle_oracle_sinc_inverse( 1.0 - away ), v = triangle_oracle_sinc_inverse( away );
        worst = fmax( worst, fabs( triangle_oracle_sinc( u ) - ( 1.0 - away ) ) );
        worst = fmax( worst, fabs( triangle_oracle_sinc( v ) - away ) );
    }
    print_message( "residual %.2g\n", worst );
    assert_true( worst < 1e-14 );
    assert_true( triangle_oracle_sinc_inverse( 1.0 ) == 0.0 && triangle_oracle_sinc_inverse( 1.5 ) == 0.0 );
    assert_close( triangle_oracle_sinc_inverse( 0.0 ), pi, 0.0 );
}

static void the_load_of_an_arc_has_its_known_values( void** state )
{
    (void)state;
    // section 3 gives two digits behind the point
    assert_close( triangle_oracle_arc_load( 0.9 ), -12.77, 0.005 );
    assert_close( triangle_oracle_arc_load( 0.5 ), -17.55, 0.005 );
    assert_close( triangle_oracle_arc_load( 0.1 ), -30.75, 0.005 );
    // limits, with their first order: 7.2 and 12 pi^2 times the way there
    for ( double away = 1e-3; away > 1e-16; away *= 0.1 )
    {
        assert_close( triangle_oracle_arc_load( 1.0 - away ), -12.0, 7.3 * away + 1e-12 );
        assert_close( triangle_oracle_arc_load( away ), -4.0 * pi * pi, 119.0 * away + 1e-12 );
        assert_close( triangle_oracle_arc_slope( 1.0 - away ), 7.2, 10.0 * away + 1e-12 );
        assert_close( triangle_oracle_arc_slope( away ), 12.0 * pi * pi, 1000.0 * away + 1e-12 );
    }
    assert_close( triangle_oracle_arc_load( 0.0 ), -4.0 * pi * pi, 1e-13 );
    assert_close( triangle_oracle_arc_slope( 0.0 ), 12.0 * pi * pi, 1e-12 );
    assert_close( triangle_oracle_arc_slope( 1.0 ), 7.2, 0.0 );
}

static void load_and_slope_of_an_arc_are_derivatives( void** state )
{
    (void)state;
    const double step = 1e-5;
    for ( int n = 1; n < 200; ++n )
    {
        const double y = n / 200.0;
        const double e = triangle_oracle_arc_energy( y + step ) - triangle_oracle_arc_energy( y - step );
        const double f = triangle_oracle_arc_load( y + step ) - triangle_oracle_arc_load( y - step );
        // 1e-9 and what differences add: a sixth of step^2 times the third derivative
        assert_ratio( e / ( 2.0 * step ), triangle_oracle_arc_load( y ), 1e-8 );
        assert_ratio( f / ( 2.0 * step ), triangle_oracle_arc_slope( y ), 1e-8 );
        assert_true( triangle_oracle_arc_load( y ) < 0.0 && triangle_oracle_arc_slope( y ) > 0.0 );
    }
}

static void a_bent_link_pushes_its_ends_apart( void** state )
{
    (void)state;
    triangle_oracle_params params = still_params();
    params.bend_stiffness = 0.25;
    triangle_oracle cloth = make_pair_of( &params, true, 2.0, 1.0 );
    double3 force[2];
    cloth.x[1].x = 1.0;
    triangle_oracle_forces( &cloth, cloth.x, force );
    assert_close( force[0].x, -17.55 * 0.25 / 4.0, 0.005 * 0.25 / 4.0 );
    assert_true( force[1].x == -force[0].x );
    cloth.x[1].x = 2.0;
    triangle_oracle_forces( &cloth, cloth.x, force );
    assert_true( force[0].x == 0.0 );
    cloth.x[1].x = 2.5;
    triangle_oracle_forces( &cloth, cloth.x, force );
    assert_true( force[0].x == 0.0 );
    triangle_oracle_destroy( &cloth );
}

// Ramps that are never left, that are met twice, and that are met once.
static const double ramps[] = { 0.0, 10.0, 33.0, 35.0, 38.0, 40.0, 200.0, 1e5 };
enum
{
    RAMPS = sizeof( ramps ) / sizeof( ramps[0] ),
};

static void the_ramped_load_is_continuous_and_never_below_the_arc( void** state )
{
    (void)state;
    for ( int k = 0; k < RAMPS; ++k )
    {
        double before = triangle_oracle_ramped_load( 1.0, ramps[k] );
        assert_true( before == 0.0 );
        const double step = 1e-4, steepest = fmax( ramps[k], 12.0 * pi * pi );
        for ( int n = 1; n <= 10000; ++n )
        {
            const double y = 1.0 - n * step, load = triangle_oracle_ramped_load( y, ramps[k] );
            assert_true( load >= triangle_oracle_arc_load( y ) && load <= 0.0 );
            assert_true( fabs( load - before ) <= 1.001 * steepest * step );
            before = load;
        }
        assert_close( triangle_oracle_ramped_slope( 1.0 - 1e-9, ramps[k] ), ramps[k], 0.0 );
    }
}

static void the_ramped_energy_is_the_integral_of_the_load( void** state )
{
    (void)state;
    for ( int k = 0; k < RAMPS; ++k )
    {
        // Simpson over pieces so small that the kinks cost below 1e-8 of the slopes there
        const int primitives = 20000;
        double sum = 0.0, y = 1.0, largest = triangle_oracle_ramped_energy( 0.0, ramps[k] ) + 1e-300;
        for ( int n = 0; n < primitives; ++n )
        {
            const double next = 1.0 - ( n + 1.0 ) / primitives, middle = 0.5 * ( y + next );
            sum -=
                ( triangle_oracle_ramped_load( y, ramps[k] ) + 4.0 * triangle_oracle_ramped_load( middle, ramps[k] ) +
                  triangle_oracle_ramped_load( next, ramps[k] ) ) /
                ( 6.0 * primitives );
            y = next;
            const double e = n % 100 == 99 ? triangle_oracle_ramped_energy( y, ramps[k] ) : sum;
            assert_true( e >= 0.0 );
            assert_close( e, sum, 1e-6 * largest );
        }
    }
}

static void the_jacobian_of_bending_is_its_derivative_and_drops_one_term( void** state )
{
    (void)state;
    triangle_oracle_params params = still_params();
    params.bend_stiffness = 1.0;
    triangle_oracle dropped = make_pair_of( &params, true, 1.0, 1.0 );
    params.jacobian = TRIANGLE_ORACLE_JACOBIAN_FULL;
    triangle_oracle full = make_pair_of( &params, true, 1.0, 1.0 );
    for ( int n = 0; n < 40; ++n )
    {
        const double3 way = random_vector( 20, n );
        const double3 x[2] = { zero,
                               double3_scale( random_between( 21, n, 0.1, 0.99 ) / double3_length( way ), way ) };
        assert_true( worst_jacobian( &full, x ) < 1e-5 );
        const triangle_oracle_term a = triangle_oracle_term_at( &full, 0, x );
        const triangle_oracle_term b = triangle_oracle_term_at( &dropped, 0, x );
        assert_true( b.k2 == 0.0 && a.k1 == b.k1 && a.force == b.force );
        assert_close( a.k2, a.force / a.length, 0.0 );
    }
    triangle_oracle_destroy( &full );
    triangle_oracle_destroy( &dropped );
}

static void coincident_ends_have_no_force( void** state )
{
    (void)state;
    triangle_oracle_params params = triangle_oracle_default_params();
    triangle_oracle cloth = make_pair_of( &params, true, 1.0, 1.0 );
    double3 force[2];
    cloth.x[1] = cloth.x[0];
    cloth.v[1] = up;
    triangle_oracle_forces( &cloth, cloth.x, force );
    assert_close( double3_length( force[0] ), 0.0, 0.0 );
    triangle_oracle_damping_forces( &cloth, cloth.x, cloth.v, force );
    assert_close( double3_length( force[0] ), 0.0, 0.0 );
    triangle_oracle_assemble( &cloth, cloth.x, 0.01 );
    assert_int_equal( cloth.coincident, 1 );
    triangle_oracle_destroy( &cloth );
}

// ---- sheets ----

// A patch of equilateral triangles, rows along x.
static triangle_oracle make_equilateral( const triangle_oracle_params* params, double side )
{
    enum
    {
        LINE = 7
    };
    double3 points[LINE * LINE];
    double masses[LINE * LINE];
    int triangles[6 * ( LINE - 1 ) * ( LINE - 1 )];
    int n = 0;
    for ( int i = 0; i < LINE * LINE; ++i )
    {
        const int row = i / LINE;
        points[i] = double3_make( side * ( i % LINE + 0.5 * row ), 0.0, side * row * sqrt( 0.75 ) );
        masses[i] = 1.0;
        if ( row + 1 < LINE && i % LINE + 1 < LINE )
        {
            const int corners[6] = { i, i + LINE, i + 1, i + 1, i + LINE, i + LINE + 1 };
            memcpy( triangles + n, corners, sizeof( corners ) );
            n += 6;
        }
    }
    const triangle_oracle_def def = {
        .count = LINE * LINE, .points = points, .triangle_count = n / 3, .triangles = triangles, .masses = masses
    };
    return make_cloth( &def, params );
}

static bool is_at_hand( const triangle_oracle_link* link, int vertex )
{
    return link->i == vertex || link->j == vertex;
}

// Energy of the links at the middle of a patch, half of each, over the area that belongs to a vertex.
static double density_in_the_middle( const triangle_oracle* cloth, const double3* x, double side )
{
    double sum = 0.0;
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        sum += is_at_hand( cloth->link + k, 24 ) ? 0.5 * triangle_oracle_energy_at( cloth, k, x ) : 0.0;
    }
    return sum / ( side * side * sqrt( 0.75 ) );
}

static void a_sheet_has_the_stiffness_it_was_given_whatever_its_mesh( void** state )
{
    (void)state;
    const double sides[] = { 0.02, 0.05 }, strain = 1e-3;
    for ( int n = 0; n < 2; ++n )
    {
        triangle_oracle_params params = still_params();
        params.stiffness = TRIANGLE_ORACLE_STIFFNESS_MATERIAL;
        triangle_oracle cloth = make_equilateral( &params, sides[n] );
        double3 x[49];
        for ( int i = 0; i < 49; ++i )
        {
            x[i] = double3_scale( 1.0 + strain, cloth.x[i] );
        }
        // springs in a triangular mesh have Poisson's number 1/3: pulled both ways alike, k / (1 - 1/3) strain^2
        assert_ratio( density_in_the_middle( &cloth, x, sides[n] ), 200.0 / ( 1.0 - 1.0 / 3.0 ) * strain * strain,
                      1e-9 );
        triangle_oracle_destroy( &cloth );
    }
}

// A triangle in the middle, in whatever direction the sheet is rolled up.
static void a_sheet_on_a_cylinder_has_the_energy_of_its_rigidity( void** state )
{
    (void)state;
    const double side = 0.02, radius = 2.0;
    triangle_oracle_params params = still_params();
    params.stiffness = TRIANGLE_ORACLE_STIFFNESS_MATERIAL;
    for ( int n = 0; n < 4; ++n )
    {
        triangle_oracle cloth = make_equilateral( &params, side );
        double3 x[49];
        for ( int i = 0; i < 49; ++i )
        {
            const double turn = 0.3 * n, c = cos( turn ), s = sin( turn );
            const double along = c * cloth.x[i].x + s * cloth.x[i].z, foreign = -s * cloth.x[i].x + c * cloth.x[i].z;
            x[i] = double3_make( radius * sin( along / radius ), radius * cos( along / radius ), foreign );
        }
        const double area = side * side * sqrt( 0.75 ) / 2.0, per_area = 0.5 / ( radius * radius );
        // second order in side / radius
        assert_ratio( plate_oracle_triangle_energy( &cloth.plate, 42, x ) / area, per_area, 1e-3 );
        triangle_oracle_destroy( &cloth );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( two_triangles_have_five_edges_and_a_diagonal ),
        cmocka_unit_test( an_edge_of_the_border_has_no_diagonal ),
        cmocka_unit_test( a_fan_has_diagonals_across_its_spokes ),
        cmocka_unit_test( a_pair_that_is_edge_and_diagonal_is_two_links_and_one_neighbour ),
        cmocka_unit_test( a_vertex_seen_across_two_edges_is_one_diagonal ),
        cmocka_unit_test( three_triangles_at_an_edge_have_three_diagonals ),
        cmocka_unit_test( pairs_by_hand_take_the_place_of_the_mesh ),
        cmocka_unit_test( wrong_data_is_refused_in_a_message ),
        cmocka_unit_test( the_weights_of_a_vertex_sum_to_the_most_neighbours ),
        cmocka_unit_test( the_rewrite_is_equation_3_as_printed ),
        cmocka_unit_test( a_pair_weighs_as_its_ends_do_on_the_mean ),
        cmocka_unit_test( a_vertex_without_neighbours_keeps_its_mass ),
        cmocka_unit_test( stretch_is_the_gradient_of_its_energy ),
        cmocka_unit_test( bending_is_the_gradient_of_its_energy ),
        cmocka_unit_test( a_stretched_link_pulls_its_ends_together ),
        cmocka_unit_test( a_short_edge_has_no_force_and_the_force_begins_at_zero ),
        cmocka_unit_test( the_jacobian_of_stretch_is_its_derivative ),
        cmocka_unit_test( the_inverse_of_sinc_leaves_no_residual ),
        cmocka_unit_test( the_load_of_an_arc_has_its_known_values ),
        cmocka_unit_test( load_and_slope_of_an_arc_are_derivatives ),
        cmocka_unit_test( a_bent_link_pushes_its_ends_apart ),
        cmocka_unit_test( the_ramped_load_is_continuous_and_never_below_the_arc ),
        cmocka_unit_test( the_ramped_energy_is_the_integral_of_the_load ),
        cmocka_unit_test( the_jacobian_of_bending_is_its_derivative_and_drops_one_term ),
        cmocka_unit_test( coincident_ends_have_no_force ),
        cmocka_unit_test( a_sheet_has_the_stiffness_it_was_given_whatever_its_mesh ),
        cmocka_unit_test( a_sheet_on_a_cylinder_has_the_energy_of_its_rigidity ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
