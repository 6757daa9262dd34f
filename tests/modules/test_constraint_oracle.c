// The oracles of constraints and of plates are sound: gradients by differences, closed forms. Numbers of equations are those
// of the balloon paper (docs/methods.md). Plates: the oracle against quadratic surfaces, the engine's matrix against the
// oracle.
#include "implicit_cloth_fixture.h"

#include "oracle/constraint_oracle.h"
#include "oracle/plate_oracle.h"
#include "oracle_support.h"

#include "wisp/module/plate.h"

static const uint64_t random_seed = 21;

// Two triangles with a common edge, of good shape, folded at random by up to `fold` rad.
static void random_hinge( int n, double fold, double3 p[4] )
{
    double angle = random_between( n, 50, -fold, fold );
    p[0] = double3_make( 0.0, 0.0, 0.0 );
    p[1] = double3_make( 1.0, 0.0, 0.0 );
    p[2] = double3_make( random_between( n, 51, -0.3, 1.3 ), random_between( n, 52, 0.5, 1.5 ), 0.0 );
    double height = random_between( n, 53, 0.5, 1.5 );
    p[3] = double3_make( random_between( n, 54, -0.3, 1.3 ), -height * cos( angle ), -height * sin( angle ) );
}

typedef constraint_oracle_term term_fn( const double3 p[4], void* user );

static double value_of( term_fn* form, void* user, const double3 p[4], int vertex, int axis, double h )
{
    double3 moved[4];
    memcpy( moved, p, sizeof( moved ) );
    double* coordinate[3] = { &moved[vertex].x, &moved[vertex].y, &moved[vertex].z };
    *coordinate[axis] += h;
    return form( moved, user ).value;
}

// Central differences with h = 1e-5 leave h^2 C''' / 6, about 1e-10, and rounding 1e-16 / h = 1e-11.
static void assert_gradient( term_fn* form, void* user, const double3 p[4] )
{
    constraint_oracle_term term = form( p, user );
    double largest = 0.0, worst = 0.0;
    for ( int i = 0; i < term.count; ++i )
    {
        const double g[3] = { term.gradient[i].x, term.gradient[i].y, term.gradient[i].z };
        for ( int axis = 0; axis < 3; ++axis )
        {
            double up = value_of( form, user, p, i, axis, 1e-5 ), down = value_of( form, user, p, i, axis, -1e-5 );
            worst = fmax( worst, fabs( ( up - down ) / 2e-5 - g[axis] ) );
            largest = fmax( largest, fabs( g[axis] ) );
        }
    }
    assert_true( largest > 0.0 );
    assert_close( worst / largest, 0.0, 1e-6 );
}

static constraint_oracle_term distance_form( const double3 p[4], void* user )
{
    return constraint_oracle_distance( p[0], p[1], *(double*)user );
}

static constraint_oracle_term limit_form( const double3 p[4], void* user )
{
    return constraint_oracle_strain_limit( p[0], p[1], *(double*)user, 0.95, 1.05 );
}

static constraint_oracle_term dihedral_form( const double3 p[4], void* user )
{
    return constraint_oracle_dihedral( p, *(double*)user );
}

static constraint_oracle_term energy_form( const double3 p[4], void* user )
{
    return constraint_oracle_isometric_energy( p, user );
}

static constraint_oracle_term root_form( const double3 p[4], void* user )
{
    return constraint_oracle_isometric_root( p, user );
}

// Every gradient of at most four vertices; that of the volume is below (Eq. 8).
TEST( gradients_agree_with_central_differences )
{
    for ( int n = 0; n < 200; ++n )
    {
        double3 rest[4], p[4];
        double q[4][4], length = 0.4, angle = random_between( n, 60, -0.3, 0.3 );
        random_hinge( n, 0.0, rest );
        random_hinge( n + 1000, 2.5, p );
        assert_true( constraint_oracle_isometric_matrix( rest, q ) );
        assert_gradient( distance_form, &length, p );
        assert_gradient( limit_form, &length, p );
        assert_gradient( dihedral_form, &angle, p );
        assert_gradient( energy_form, q, p );
        assert_gradient( root_form, q, p );
    }
}

// Bergou et al. 2006: on a fold, sum K x = |e| (the sum of the unit conormals), so E = 6 |e|^2 sin^2(theta/2) / (A0 +
// A1).
TEST( the_isometric_energy_of_a_fold_has_its_closed_form )
{
    for ( int n = 1; n < 30; ++n )
    {
        double a = 0.1 * n, q[4][4];
        const double3 rest[4] = { { 0, 0, 0 }, { 2, 0, 0 }, { 0.5, 1, 0 }, { 0.8, -1.5, 0 } };
        double3 p[4] = { rest[0], rest[1], rest[2], { 0.8, -1.5 * cos( a ), -1.5 * sin( a ) } };
        assert_true( constraint_oracle_isometric_matrix( rest, q ) );
        double expected = 6.0 * 4.0 * pow( sin( 0.5 * a ), 2.0 ) / ( 1.0 + 1.5 );
        assert_close( constraint_oracle_isometric_energy( p, q ).value / expected, 1.0, 1e-12 );
        assert_close( constraint_oracle_isometric_root( p, q ).value, sqrt( 2.0 * expected ), 1e-12 );
    }
}

// ---- plates ----

enum
{
    SIDE = 9,
    COUNT = SIDE * SIDE,
};

// A square of vertices that stand some part of the spacing off a grid, each cell cut along its shorter diagonal.
static test_mesh square_of( double spacing, float off )
{
    test_mesh m = hanging_mesh( SIDE, SIDE, 1.0f, 1.0f );
    m.triangle_count = 0;
    for ( int v = 0; v < COUNT; ++v )
    {
        const double x = v % SIDE + (double)test_random_float( v, 7, -off, off );
        const double z = v / SIDE + (double)test_random_float( v, 8, -off, off );
        m.points[v] = ( wisp_vec3 ){ (float)( spacing * x ), 0.0f, (float)( spacing * z ) };
    }
    for ( int cell = 0; cell < ( SIDE - 1 ) * ( SIDE - 1 ); ++cell )
    {
        const int a = cell / ( SIDE - 1 ) * SIDE + cell % ( SIDE - 1 ), b = a + 1, c = a + SIDE, d = c + 1;
        const bool falls = vec_distance( m.points[a], m.points[d] ) < vec_distance( m.points[b], m.points[c] );
        const int32_t one[6] = { a, c, d, a, d, b }, other[6] = { a, c, b, b, c, d };
        memcpy( m.triangles + 3 * (size_t)m.triangle_count, falls ? one : other, sizeof( one ) );
        m.triangle_count += 2;
    }
    return m;
}

static plate_oracle oracle_of( const test_mesh* m, const bool* pinned, double3 rest[COUNT] )
{
    for ( int v = 0; v < COUNT; ++v )
    {
        rest[v] = double3_make( (double)m->points[v].x, (double)m->points[v].y, (double)m->points[v].z );
    }
    return plate_oracle_create( rest, COUNT, m->triangles, m->triangle_count, pinned );
}

static bool is_deep( int v )
{
    const int i = v % SIDE, j = v / SIDE;
    return i > 2 && j > 2 && i < SIDE - 3 && j < SIDE - 3;
}

// E = A / 2 |curvature|^2 in each triangle inside, and no force on a vertex inside: a uniform moment is in balance. Shares are
// fitted with a damping of 1e-4.
TEST( every_quadratic_surface_has_its_energy_and_is_in_balance )
{
    static const double CURVATURES[][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 0 }, { 1, -1, 0.5 } };
    SCOPED( test_mesh_free ) test_mesh m = square_of( 0.1, 0.33f );
    double3 rest[COUNT], x[COUNT], force[COUNT];
    SCOPED( plate_oracle_destroy ) plate_oracle plate = oracle_of( &m, NULL, rest );
    for ( int n = 0; n < WISP_COUNT( CURVATURES ); ++n )
    {
        const double *k = CURVATURES[n], square = k[0] * k[0] + k[1] * k[1] + 2.0 * k[2] * k[2];
        for ( int v = 0; v < COUNT; ++v )
        {
            const double px = rest[v].x, pz = rest[v].z;
            x[v] = double3_make( px, 0.5 * k[0] * px * px + 0.5 * k[1] * pz * pz + k[2] * px * pz, pz );
        }
        plate_oracle_multiply( &plate, x, COUNT, force );
        for ( int v = 0; v < COUNT; ++v )
        {
            // forces next to the edge are about a moment over the spacing
            assert_near( is_deep( v ) ? double3_length( force[v] ) : 0.0, 0.0, 1e-4 * sqrt( square ) / 0.1 );
        }
        for ( int t = 0; t < m.triangle_count; ++t )
        {
            const int32_t* c = m.triangles + 3 * (size_t)t;
            const double3 normal =
                double3_cross( double3_sub( rest[c[1]], rest[c[0]] ), double3_sub( rest[c[2]], rest[c[0]] ) );
            const double expected = 0.25 * double3_length( normal ) * square;
            if ( is_deep( c[0] ) && is_deep( c[1] ) && is_deep( c[2] ) )
            {
                assert_near( plate_oracle_triangle_energy( &plate, t, x ) / expected, 1.0, 1e-3 );
            }
        }
    }
}

// Weights that a plate had without pins leave no trace.
static void update_plate( wisp_plate* plate, const wisp_fabric* f, const float* position )
{
    SCOPED( free_local ) float* unpinned = malloc( 4 * (size_t)f->slot_count * sizeof( float ) );
    assert_non_null( unpinned );
    for ( int i = 0; i < 4 * f->slot_count; ++i )
    {
        unpinned[i] = 1.0f;
    }
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_plate_input input = { .position = i == 0 ? unpinned : position, .max_rate = INFINITY };
        assert_int_equal( wisp_plate_update( &plate, f, &input ), 0 );
    }
}

// The engine drops shares below 1e-5 and stores floats.
static void compare_with_oracle( float off, bool with_pins )
{
    SCOPED( close_world ) hosted h;
    open_implicit( &h, 1 );
    SCOPED( test_mesh_free ) test_mesh m = square_of( 0.1, off );
    bool pinned[COUNT] = { false };
    int32_t pins[3 * SIDE];
    for ( int n = 0; n < 3 * SIDE; ++n )
    {
        pins[n] = n;
        pinned[n] = with_pins;
    }
    wisp_fabric_def fabric_def = test_fabric_def( &m );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = with_pins ? 3 * SIDE : 0;
    const wisp_entity e = test_surface_of( h.world, &fabric_def, surface );
    const wisp_fabric* f = wisp_world_fabric( h.world, e );
    wisp_plate* plate;
    assert_int_equal( wisp_plate_create( f, NULL, f->slot_count, false, wisp_world_allocator( h.world ), &plate ),
                      WISP_OK );
    const float* position = wisp_world_column( h.world, e, WISP_PARTICLE_POSITION, 0 );
    update_plate( plate, f, position );
    double3 rest[COUNT], x[COUNT], expected[COUNT];
    plate_oracle oracle = oracle_of( &m, pinned, rest );
    double largest = 0.0;
    for ( int v = 0; v < COUNT; ++v )
    {
        x[v] = double3_make( 0.0, (double)test_random_float( v, 9, -1.0f, 1.0f ), 0.0 );
    }
    plate_oracle_multiply( &oracle, x, COUNT, expected );
    for ( int v = 0; v < COUNT; ++v )
    {
        largest = fmax( largest, fabs( expected[v].y ) );
    }
    const wisp_plate_rows rows = wisp_plate_get_rows( plate );
    for ( int v = 0; v < COUNT; ++v )
    {
        const int row = f->vertex_slot[v];
        double sum = 0.0;
        for ( int entry = rows.begin[row / 8]; entry < rows.begin[row / 8 + 1]; ++entry )
        {
            const int32_t other = f->slot_vertex[row - row % 8 + rows.near_x4[entry][row % 8] / 4];
            sum += other >= 0 ? (double)rows.weight[entry][row % 8] * ( x[v].y - x[other].y ) : 0.0;
        }
        assert_near( sum, expected[v].y, 1e-4 * largest );
    }
    plate_oracle_destroy( &oracle );
    wisp_plate_release( plate, wisp_world_allocator( h.world ) );
}

TEST( the_engine_has_the_matrix_of_the_oracle )
{
    for ( int with_pins = 0; with_pins < 2; ++with_pins )
    {
        compare_with_oracle( 0.33f, with_pins != 0 );
        compare_with_oracle( 0.0f, with_pins != 0 ); // right angles: rows have fewer entries
    }
}
