// The oracle of constraints is sound: gradients, momentum, closed forms. Numbers of equations are those of the balloon
// paper (docs/methods.md).
#include "oracle_support.h"

#include "oracle/balloon_meshes.h"
#include "oracle/constraint_oracle.h"

static const uint64_t random_seed = 21;

static const int four[4] = { 0, 1, 2, 3 };

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

static balloon_mesh new_perturbed_sphere( void )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, 1, 0.15 ) );
    for ( int i = 0; i < mesh.vertex_count; ++i )
    {
        mesh.positions[i] = double3_add( mesh.positions[i], double3_scale( 0.02, random_vector( i, 9 ) ) );
    }
    return mesh;
}

static double mesh_volume( const balloon_mesh* mesh )
{
    return constraint_oracle_volume( mesh->positions, mesh->triangles, mesh->triangle_count );
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

// Eq. 3
TEST( a_linear_constraint_is_solved_by_one_projection )
{
    for ( int n = 0; n < 100; ++n )
    {
        constraint_oracle_term term = { .count = 4, .value = random_between( n, 70, -1.0, 1.0 ) };
        constraint_oracle_skips skips = { { 0 } };
        double3 p[4], before[4];
        double w[4];
        for ( int i = 0; i < 4; ++i )
        {
            term.gradient[i] = random_vector( n, 20 + i );
            p[i] = before[i] = random_vector( n, 24 + i );
            w[i] = random_between( n, 80 + i, 0.5, 2.0 );
        }
        constraint_oracle_project( &term, four, w, 1.0, p, &skips );
        double residual = term.value;
        for ( int i = 0; i < 4; ++i )
        {
            residual += double3_dot( term.gradient[i], double3_sub( p[i], before[i] ) );
        }
        assert_close( residual, 0.0, 1e-12 );
    }
}

// Eq. 4 against Eq. 6
TEST( the_general_projection_of_a_distance_is_the_printed_one )
{
    for ( int n = 0; n < 200; ++n )
    {
        double3 p[2] = { random_vector( n, 0 ), random_vector( n, 1 ) }, before[2] = { p[0], p[1] }, step[2];
        double w[2] = { random_between( n, 90, 0.0, 2.0 ), random_between( n, 91, 0.1, 2.0 ) };
        constraint_oracle_skips skips = { { 0 } };
        constraint_oracle_term term = constraint_oracle_distance( p[0], p[1], 0.7 );
        constraint_oracle_distance_step( p[0], p[1], w[0], w[1], 0.7, &step[0], &step[1] );
        constraint_oracle_project( &term, four, w, 1.0, p, &skips );
        for ( int i = 0; i < 2; ++i )
        {
            assert_close( double3_distance( p[i], double3_add( before[i], step[i] ) ), 0.0, 1e-15 );
        }
    }
}

// Eq. 4, momentum: sum m Dp and sum m p x Dp of one projection, relative to the sum of their lengths
static void assert_momentum_kept( const double3* before, const double3* after, const double* w, int count )
{
    double3 sum = { 0.0, 0.0, 0.0 }, turn = sum;
    double size = 0.0, turn_size = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        double3 step = double3_scale( 1.0 / w[i], double3_sub( after[i], before[i] ) );
        double3 torque = double3_cross( before[i], step );
        sum = double3_add( sum, step );
        turn = double3_add( turn, torque );
        size += double3_length( step );
        turn_size += double3_length( torque );
    }
    assert_true( size > 0.0 );
    assert_close( double3_length( sum ) / size, 0.0, 1e-12 );
    assert_close( double3_length( turn ) / turn_size, 0.0, 1e-12 );
}

TEST( every_projection_keeps_linear_and_angular_momentum )
{
    for ( int n = 0; n < 100; ++n )
    {
        double3 rest[4], start[4];
        double q[4][4], w[4], length = 0.4, angle = 0.1;
        random_hinge( n, 0.0, rest );
        random_hinge( n + 2000, 2.0, start );
        assert_true( constraint_oracle_isometric_matrix( rest, q ) );
        for ( int i = 0; i < 4; ++i )
        {
            w[i] = random_between( n, 100 + i, 0.5, 2.0 );
            start[i] = double3_add( start[i], double3_make( 0.3, -0.2, 0.5 ) );
        }
        term_fn* forms[] = { distance_form, limit_form, dihedral_form, energy_form, root_form };
        void* users[] = { &length, &length, &angle, q, q };
        for ( int k = 0; k < 5; ++k )
        {
            // steps of about a metre against rounding of 1e-16 m: no cancellation below 1e-12
            double3 p[4];
            memcpy( p, start, sizeof( p ) );
            constraint_oracle_skips skips = { { 0 } };
            constraint_oracle_term term = forms[k]( p, users[k] );
            constraint_oracle_project( &term, four, w, 1.0, p, &skips );
            assert_momentum_kept( start, p, w, term.count );
        }
    }
    balloon_mesh mesh = new_perturbed_sphere();
    double3 after[42], scratch[42];
    double w[42];
    for ( int i = 0; i < 42; ++i )
    {
        after[i] = mesh.positions[i];
        w[i] = random_between( i, 104, 0.5, 2.0 );
    }
    constraint_oracle_skips skips = { { 0 } };
    constraint_oracle_project_volume( after, w, 42, mesh.triangles, mesh.triangle_count, 2.0 * mesh_volume( &mesh ),
                                      1.0, scratch, &skips );
    assert_momentum_kept( mesh.positions, after, w, 42 );
    balloon_mesh_destroy( &mesh );
}

TEST( a_compliant_edge_carries_the_tension_of_its_spring )
{
    const double w[2] = { 3.0, 5.0 };
    double dt = 0.01, k_edge = 2000.0, alpha = 1.0 / ( k_edge * dt * dt ), lambda = 0.0, length = 0.0;
    double3 p[2] = { { 0.0, 0.0, 0.0 }, { 1.5, 0.0, 0.0 } };
    constraint_oracle_skips skips = { { 0 } };
    for ( int n = 0; n < 5; ++n )
    {
        constraint_oracle_term term = constraint_oracle_distance( p[0], p[1], 1.0 );
        constraint_oracle_project_compliant( &term, four, w, alpha, &lambda, p, &skips );
        length = n == 0 ? double3_distance( p[0], p[1] ) : length;
        // one projection solves a single edge; more of them change nothing
        assert_close( double3_distance( p[0], p[1] ), length, 1e-14 );
        assert_close( -lambda / ( dt * dt ), k_edge * ( length - 1.0 ), 1e-9 );
    }
    assert_close( length - 1.0, 0.5 * alpha / ( w[0] + w[1] + alpha ), 1e-14 );
}

TEST( a_dihedral_angle_is_signed )
{
    for ( int n = -31; n <= 31; ++n )
    {
        double a = 0.1 * n;
        const double3 p[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1, 0 }, { 0.5, -cos( a ), -sin( a ) } };
        assert_close( constraint_oracle_dihedral_angle( p ), a, 1e-15 );
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

// Eq. 8
TEST( the_volume_gradient_agrees_with_differences_and_with_its_identities )
{
    balloon_mesh mesh = new_perturbed_sphere();
    double3 g[42], printed[42], sum = { 0.0, 0.0, 0.0 };
    double virial = 0.0, largest = 0.0, worst = 0.0, h = 1e-5;
    constraint_oracle_volume_gradient( mesh.positions, 42, mesh.triangles, mesh.triangle_count, g );
    constraint_oracle_volume_gradient_printed( mesh.positions, 42, mesh.triangles, mesh.triangle_count, printed );
    for ( int i = 0; i < 42; ++i )
    {
        // the ring and the printed form agree to rounding of areas of 0.1 m^2
        assert_close( double3_distance( g[i], double3_scale( 1.0 / 6.0, printed[i] ) ), 0.0, 1e-16 );
        sum = double3_add( sum, g[i] );
        virial += double3_dot( mesh.positions[i], g[i] );
        double* coordinate[3] = { &mesh.positions[i].x, &mesh.positions[i].y, &mesh.positions[i].z };
        const double component[3] = { g[i].x, g[i].y, g[i].z };
        for ( int axis = 0; axis < 3; ++axis )
        {
            double kept = *coordinate[axis];
            *coordinate[axis] = kept + h;
            double up = mesh_volume( &mesh );
            *coordinate[axis] = kept - h;
            double difference = ( up - mesh_volume( &mesh ) ) / ( 2.0 * h );
            *coordinate[axis] = kept;
            worst = fmax( worst, fabs( difference - component[axis] ) );
            largest = fmax( largest, fabs( component[axis] ) );
        }
    }
    assert_close( worst / largest, 0.0, 1e-6 );
    // the printed sum is six times the volume
    assert_ratio( constraint_oracle_volume_sum( mesh.positions, mesh.triangles, mesh.triangle_count ),
                  6.0 * mesh_volume( &mesh ), 1e-13 );
    assert_close( double3_length( sum ) / largest, 0.0, 1e-14 );
    assert_close( virial / ( 3.0 * mesh_volume( &mesh ) ), 1.0, 1e-13 );
    balloon_mesh_destroy( &mesh );
}
