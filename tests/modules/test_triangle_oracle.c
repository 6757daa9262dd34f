// The oracle of triangle cloth is sound: Eq. 3 as printed, forces and Jacobians by differences, the solver against
// elimination, momentum. Numbers of equations are those of Noh and Jung. The engine is held to this oracle in
// test_implicit_cloth_against_oracle.c.
#include "oracle_support.h"

#include "oracle/triangle_oracle.h"

static const uint64_t random_seed = 53;

static const double3 zero = { 0.0, 0.0, 0.0 };

static double component( double3 v, int axis )
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static double3 along_axis( int axis, double length )
{
    return double3_make( axis == 0 ? length : 0.0, axis == 1 ? length : 0.0, axis == 2 ? length : 0.0 );
}

// Two vertices along x with one link between them.
static triangle_oracle make_pair_of( const triangle_oracle_params* params, bool bends, double length, double mass )
{
    static const int ends[2] = { 0, 1 };
    const double3 points[2] = { zero, { length, 0.0, 0.0 } };
    const double masses[2] = { mass, mass };
    const triangle_oracle_def def = { .count = 2,
                                      .points = points,
                                      .masses = masses,
                                      .stretch_pairs = bends ? NULL : ends,
                                      .bend_pairs = bends ? ends : NULL,
                                      .stretch_pair_count = bends ? 0 : 1,
                                      .bend_pair_count = bends ? 1 : 0 };
    return triangle_oracle_create( &def, params );
}

static triangle_oracle_params still_params( void )
{
    triangle_oracle_params params = triangle_oracle_default_params();
    params.gravity = zero;
    params.damping = 0.0;
    return params;
}

enum
{
    SHEET_SIDE = 6,
    SHEET_COUNT = SHEET_SIDE * SHEET_SIDE,
    SHEET_TRIANGLES = 2 * ( SHEET_SIDE - 1 ) * ( SHEET_SIDE - 1 ),
};

// A square of 6 x 6 vertices in the plane y = 0, 3 cm apart but for a disturbance, with diagonals both ways, so
// that valences differ.
static triangle_oracle make_sheet( const triangle_oracle_params* params )
{
    double3 points[SHEET_COUNT];
    double masses[SHEET_COUNT];
    int triangles[3 * SHEET_TRIANGLES];
    int n = 0;
    for ( int i = 0; i < SHEET_COUNT; ++i )
    {
        const double3 off = double3_scale( 0.005, random_vector( 2, i ) );
        points[i] = double3_make( 0.03 * ( i % SHEET_SIDE ) + off.x, 0.0, 0.03 * ( i / SHEET_SIDE ) + off.z );
    }
    for ( int cell = 0; cell < SHEET_TRIANGLES / 2; ++cell )
    {
        const int a = cell / ( SHEET_SIDE - 1 ) * SHEET_SIDE + cell % ( SHEET_SIDE - 1 );
        const int b = a + 1, c = a + SHEET_SIDE, d = c + 1;
        const bool other = random_between( 3, cell, 0.0, 1.0 ) < 0.5;
        const int corners[6] = { a, c, other ? d : b, other ? a : b, other ? d : c, other ? b : d };
        memcpy( triangles + n, corners, sizeof( corners ) );
        n += 6;
    }
    triangle_oracle_def def = { .count = SHEET_COUNT,
                                .points = points,
                                .triangle_count = SHEET_TRIANGLES,
                                .triangles = triangles,
                                .masses = masses };
    triangle_oracle_lump( &def, 0.2, masses );
    return triangle_oracle_create( &def, params );
}

// Every vertex elsewhere, so that about half of the links are longer than at rest.
static void crumple( triangle_oracle* cloth, int key, double by, double speed )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->x[i] = double3_add( cloth->x[i], double3_scale( by, random_vector( key, i ) ) );
        cloth->v[i] = double3_scale( speed, random_vector( key + 1, i ) );
    }
}

// Eq. 1-4, Fig. 5
TEST( the_rewrite_is_equation_3_as_printed )
{
    const triangle_oracle_params params = triangle_oracle_default_params();
    SCOPED( triangle_oracle_destroy ) triangle_oracle cloth = make_sheet( &params );
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
        // one weight for each neighbour
        assert_ratio( cloth.weight[i] * cloth.neighbours[i], cloth.max_neighbours, 1e-15 );
    }
}

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

TEST( stretch_is_the_gradient_of_its_energy )
{
    const triangle_oracle_params params = still_params();
    SCOPED( triangle_oracle_destroy ) triangle_oracle cloth = make_sheet( &params );
    crumple( &cloth, 10, 0.01, 0.0 );
    assert_true( worst_force( &cloth, false ) < 1e-6 );
}

TEST( bending_is_the_gradient_of_its_energy )
{
    triangle_oracle_params params = still_params();
    params.bend_stiffness = 3e-4;
    params.compression_stiffness = 150.0; // both branches of (12) are there
    SCOPED( triangle_oracle_destroy ) triangle_oracle cloth = make_sheet( &params );
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

TEST( the_jacobian_of_stretch_is_its_derivative )
{
    const triangle_oracle_params params = still_params();
    SCOPED( triangle_oracle_destroy ) triangle_oracle cloth = make_pair_of( &params, false, 1.0, 1.0 );
    for ( int n = 0; n < 20; ++n )
    {
        const double3 way = random_vector( 20, n );
        cloth.x[1] = double3_scale( random_between( 21, n, 1.01, 3.0 ) / double3_length( way ), way );
        assert_true( worst_jacobian( &cloth, cloth.x ) < 1e-5 );
        const triangle_oracle_term term = triangle_oracle_term_at( &cloth, 0, cloth.x );
        assert_true( term.k1 > 0.0 && term.k2 >= 0.0 ); // semidefinite
    }
}

TEST( the_jacobian_of_bending_is_its_derivative_and_drops_one_term )
{
    triangle_oracle_params params = still_params();
    params.bend_stiffness = 1.0;
    SCOPED( triangle_oracle_destroy ) triangle_oracle dropped = make_pair_of( &params, true, 1.0, 1.0 );
    params.jacobian = TRIANGLE_ORACLE_JACOBIAN_FULL;
    SCOPED( triangle_oracle_destroy ) triangle_oracle full = make_pair_of( &params, true, 1.0, 1.0 );
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
}

TEST( momentum_of_the_rows_is_kept )
{
    for ( int form = 0; form < 6; ++form )
    {
        triangle_oracle_params params = triangle_oracle_default_params();
        params.weights = (triangle_oracle_weights)( form % 3 );
        params.integrator = (triangle_oracle_integrator)( form / 3 );
        params.gravity = zero;
        SCOPED( triangle_oracle_destroy ) triangle_oracle cloth = make_sheet( &params );
        crumple( &cloth, 10, 0.01, 1.0 );
        const double3 before = triangle_oracle_momentum( &cloth );
        for ( int k = 0; k < 50; ++k )
        {
            triangle_oracle_step( &cloth, 0.01, NULL );
        }
        const double3 after = triangle_oracle_momentum( &cloth );
        assert_close( double3_distance( before, after ), 0.0, 1e-10 * double3_length( before ) );
    }
}
