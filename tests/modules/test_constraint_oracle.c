// Constraints of cloth and balloons on their double-precision oracle. Numbers of equations
// and figures are those of the balloon paper (docs/methods.md).
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

// Every gradient of at most four vertices; that of the volume is tested below (Eq. 8).
static void gradients_agree_with_central_differences( void** state )
{
    (void)state;
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
static void a_linear_constraint_is_solved_by_one_projection( void** state )
{
    (void)state;
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
static void the_general_projection_of_a_distance_is_the_printed_one( void** state )
{
    (void)state;
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

static void every_projection_keeps_linear_and_angular_momentum( void** state )
{
    (void)state;
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

// Eq. 5-6, Fig. 1
static void a_stretched_pair_returns_to_its_length_and_moves_in_ratio_of_inverse_masses( void** state )
{
    (void)state;
    const double ratio[3][2] = { { 1.0, 1.0 }, { 1.0, 3.0 }, { 0.0, 1.0 } };
    for ( int n = 0; n < 3; ++n )
    {
        double3 p[2] = { { 0.0, 0.0, 0.0 }, { 1.5, 0.0, 0.0 } };
        constraint_oracle_skips skips = { { 0 } };
        constraint_oracle_term term = constraint_oracle_distance( p[0], p[1], 1.0 );
        constraint_oracle_project( &term, four, ratio[n], 1.0, p, &skips );
        double fraction = ratio[n][0] / ( ratio[n][0] + ratio[n][1] );
        assert_close( p[0].x, 0.5 * fraction, 1e-15 );
        assert_close( p[1].x, 1.5 - 0.5 * ( 1.0 - fraction ), 1e-15 );
        assert_close( double3_distance( p[0], p[1] ), 1.0, 1e-15 );
    }
}

static void a_stiffness_below_one_leaves_its_share_of_the_error( void** state )
{
    (void)state;
    for ( int iterations = 1; iterations <= 8; iterations *= 2 )
    {
        const double w[2] = { 1.0, 2.0 };
        double3 p[2] = { { 0.0, 0.0, 0.0 }, { 2.0, 0.0, 0.0 } };
        constraint_oracle_skips skips = { { 0 } };
        double k = constraint_oracle_stiffness_per_iteration( 0.9, iterations );
        for ( int n = 0; n < iterations; ++n )
        {
            constraint_oracle_term term = constraint_oracle_distance( p[0], p[1], 1.0 );
            constraint_oracle_project( &term, four, w, k, p, &skips );
        }
        // k' keeps the error at (1 - k) for any count
        assert_close( double3_distance( p[0], p[1] ), 1.1, 1e-14 );
    }
}

static void a_compliant_edge_carries_the_tension_of_its_spring( void** state )
{
    (void)state;
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

static void a_tether_resists_stretch_and_never_pushes( void** state )
{
    (void)state;
    const double w[2] = { 0.0, 1.0 };
    constraint_oracle_skips skips = { { 0 } };
    double3 slack[2] = { { 0.0, 0.0, 0.0 }, { 0.8, 0.0, 0.0 } }, taut[2] = { { 0.0, 0.0, 0.0 }, { 1.2, 0.0, 0.0 } };
    constraint_oracle_term term = constraint_oracle_distance( slack[0], slack[1], 1.0 );
    assert_true( constraint_oracle_project_above( &term, four, w, 1.0, slack, &skips ) == 0.0 );
    assert_true( slack[1].x == 0.8 );
    term = constraint_oracle_distance( taut[0], taut[1], 1.0 );
    assert_true( constraint_oracle_project_above( &term, four, w, 1.0, taut, &skips ) < 0.0 );
    assert_close( taut[1].x, 1.0, 1e-15 );
    // within a substep it undoes its own corrections, and no more
    double lambda = 0.0;
    double3 p[2] = { { 0.0, 0.0, 0.0 }, { 1.2, 0.0, 0.0 } };
    term = constraint_oracle_distance( p[0], p[1], 1.0 );
    constraint_oracle_project_compliant_above( &term, four, w, 0.0, &lambda, p, &skips );
    assert_close( lambda, -0.2, 1e-15 );
    p[1].x = 0.95;
    term = constraint_oracle_distance( p[0], p[1], 1.0 );
    constraint_oracle_project_compliant_above( &term, four, w, 0.0, &lambda, p, &skips );
    assert_close( lambda, -0.15, 1e-15 );
    assert_close( p[1].x, 1.0, 1e-15 );
    p[1].x = 0.5;
    term = constraint_oracle_distance( p[0], p[1], 1.0 );
    constraint_oracle_project_compliant_above( &term, four, w, 0.0, &lambda, p, &skips );
    assert_true( lambda == 0.0 );
    assert_close( p[1].x, 0.65, 1e-15 );
    double given_back = p[1].x;
    constraint_oracle_project_compliant_above( &term, four, w, 0.0, &lambda, p, &skips );
    assert_true( p[1].x == given_back );
}

static void a_strain_limit_clamps_the_length_and_ignores_what_is_within( void** state )
{
    (void)state;
    const double w[2] = { 1.0, 1.0 }, start[] = { 0.5, 0.96, 1.0, 1.04, 1.7 };
    const double expected[] = { 0.95, 0.96, 1.0, 1.04, 1.05 };
    for ( int n = 0; n < 5; ++n )
    {
        double3 p[2] = { { 0.0, 0.0, 0.0 }, { start[n], 0.0, 0.0 } };
        constraint_oracle_skips skips = { { 0 } };
        constraint_oracle_term term = constraint_oracle_strain_limit( p[0], p[1], 1.0, 0.95, 1.05 );
        constraint_oracle_project( &term, four, w, 1.0, p, &skips );
        assert_close( double3_distance( p[0], p[1] ), expected[n], 1e-15 );
    }
}

// The two normals of a convex edge enclose pi minus the inner angle.
static void a_dihedral_angle_is_signed_and_known_on_solids( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_tetrahedron( &mesh, 2.0 ) );
    balloon_mesh_topology topology;
    assert_true( balloon_mesh_build_topology( &mesh, &topology ) );
    for ( int e = 0; e < topology.edge_count; ++e )
    {
        const balloon_mesh_edge* edge = topology.edges + e;
        // opposite[0] belongs to the lower triangle, which may have the edge in either direction
        const int* c = mesh.triangles + 3 * edge->triangle[0];
        bool forward = ( c[0] == edge->a && c[1] == edge->b ) || ( c[1] == edge->a && c[2] == edge->b ) ||
                       ( c[2] == edge->a && c[0] == edge->b );
        const double3 p[4] = { mesh.positions[edge->a], mesh.positions[edge->b],
                               mesh.positions[edge->opposite[forward ? 0 : 1]],
                               mesh.positions[edge->opposite[forward ? 1 : 0]] };
        assert_close( constraint_oracle_dihedral_angle( p ), pi - acos( 1.0 / 3.0 ), 1e-14 );
    }
    balloon_mesh_destroy_topology( &topology );
    balloon_mesh_destroy( &mesh );

    for ( int n = -31; n <= 31; ++n )
    {
        double a = 0.1 * n;
        const double3 p[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1, 0 }, { 0.5, -cos( a ), -sin( a ) } };
        assert_close( constraint_oracle_dihedral_angle( p ), a, 1e-15 );
    }
}

static void a_bend_finds_its_rest_angle_from_flat_and_the_short_way_through_pi( void** state )
{
    (void)state;
    const double starts[] = { 0.0, 0.5, 3.0 }, rests[] = { 0.8, 0.0, -3.0 }, first[] = { -0.8, 0.5, 6.0 - 2.0 * pi };
    for ( int n = 0; n < 3; ++n )
    {
        const double w[4] = { 1.0, 2.0, 1.0, 0.5 };
        double3 p[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.3, 1, 0 }, { 0.6, -cos( starts[n] ), -sin( starts[n] ) } };
        constraint_oracle_skips skips = { { 0 } };
        constraint_oracle_term term = constraint_oracle_dihedral( p, rests[n] );
        assert_close( term.value, first[n], 1e-14 );
        for ( int k = 0; k < 20; ++k )
        {
            term = constraint_oracle_dihedral( p, rests[n] );
            constraint_oracle_project( &term, four, w, 1.0, p, &skips );
        }
        assert_close( constraint_oracle_dihedral( p, rests[n] ).value, 0.0, 1e-12 );
    }
}

static void the_isometric_matrix_is_symmetric_and_blind_to_flat_shapes( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        double3 rest[4];
        double q[4][4];
        random_hinge( n, 0.0, rest );
        assert_true( constraint_oracle_isometric_matrix( rest, q ) );
        double size = q[0][0] + q[1][1] + q[2][2] + q[3][3];
        for ( int i = 0; i < 4; ++i )
        {
            assert_close( ( q[i][0] + q[i][1] + q[i][2] + q[i][3] ) / size, 0.0, 1e-14 );
            for ( int j = 0; j < 4; ++j )
            {
                assert_true( q[i][j] == q[j][i] );
            }
        }
        // any affine image of the flat rest shape is free; the terms of x^T Q x cancel to rounding
        for ( int i = 0; i < 4; ++i )
        {
            rest[i] = double3_make( 1000.0 + 2.0 * rest[i].x + rest[i].y, 3.0 * rest[i].y, rest[i].x - rest[i].y );
        }
        assert_close( constraint_oracle_isometric_energy( rest, q ).value / size, 0.0, 1e-14 );
    }
}

// Bergou et al. 2006: on a fold, sum K x = |e| (the sum of the unit conormals), so E = 6 |e|^2 sin^2(theta/2) / (A0 +
// A1).
static void the_isometric_energy_of_a_fold_has_its_closed_form( void** state )
{
    (void)state;
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

static void the_energy_form_halves_a_fold_and_the_root_form_solves_it( void** state )
{
    (void)state;
    for ( int n = 0; n < 50; ++n )
    {
        double3 rest[4], start[4], p[4];
        double q[4][4], w[4];
        random_hinge( n, 0.0, rest );
        random_hinge( n + 500, 2.0, start );
        assert_true( constraint_oracle_isometric_matrix( rest, q ) );
        double weight = 0.0;
        for ( int i = 0; i < 4; ++i )
        {
            w[i] = random_between( n, 110 + i, 0.5, 2.0 );
            weight += w[i] * q[i][i];
        }
        constraint_oracle_skips skips = { { 0 } };
        memcpy( p, start, sizeof( p ) );
        constraint_oracle_term energy = constraint_oracle_isometric_energy( p, q );
        constraint_oracle_project( &energy, four, w, 1.0, p, &skips );
        assert_close( constraint_oracle_isometric_energy( p, q ).value / energy.value, 0.25, 1e-10 );
        memcpy( p, start, sizeof( p ) );
        constraint_oracle_term root = constraint_oracle_isometric_root( p, q );
        double lambda = 0.0;
        constraint_oracle_project_compliant( &root, four, w, weight, &lambda, p, &skips );
        // sum w |grad C|^2 = sum w_i Q_ii, so an alpha of that size leaves one half
        assert_close( constraint_oracle_isometric_root( p, q ).value / root.value, 0.5, 1e-10 );
        memcpy( p, start, sizeof( p ) );
        constraint_oracle_project( &root, four, w, 1.0, p, &skips );
        // the root of an energy at rounding level, 1e-16 of the original
        assert_close( constraint_oracle_isometric_root( p, q ).value / root.value, 0.0, 1e-7 );
    }
}

// Eq. 7
static void a_cube_has_volume_one_wherever_it_is( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_cube( &mesh, 1.0 ) );
    assert_true( mesh_volume( &mesh ) == 1.0 );
    // the printed sum is six times the volume
    assert_true( constraint_oracle_volume_sum( mesh.positions, mesh.triangles, 12 ) == 6.0 );
    for ( int i = 0; i < 8; ++i )
    {
        mesh.positions[i] = double3_add( mesh.positions[i], double3_make( 1000.1, -999.7, 1000.3 ) );
    }
    assert_close( mesh_volume( &mesh ), 1.0, 1e-9 );
    balloon_mesh_destroy( &mesh );
}

static void volumes_of_solids_have_their_closed_forms( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_tetrahedron( &mesh, 2.0 ) );
    assert_close( mesh_volume( &mesh ), 8.0 / ( 6.0 * sqrt( 2.0 ) ), 1e-15 );
    balloon_mesh_destroy( &mesh );

    // a torus of 120 x 60: an inscribed polygon of k sides loses (2 pi / k)^2 / 6 of its area
    assert_true( balloon_mesh_torus( &mesh, 120, 60, 1.0, 0.4 ) );
    double lost = pow( 2.0 * pi / 120.0, 2.0 ) / 6.0 + pow( 2.0 * pi / 60.0, 2.0 ) / 6.0;
    assert_close( mesh_volume( &mesh ) / ( 2.0 * pi * pi * 0.16 ), 1.0 - lost, 0.1 * lost );
    balloon_mesh_destroy( &mesh );

    // the volume error falls with the number of faces
    double error[2];
    for ( int n = 0; n < 2; ++n )
    {
        assert_true( balloon_mesh_icosphere( &mesh, 3 + n, 0.15 ) );
        error[n] = 1.0 - mesh_volume( &mesh ) / ( 4.0 / 3.0 * pi * pow( 0.15, 3.0 ) );
        balloon_mesh_destroy( &mesh );
    }
    assert_close( error[0] / error[1], 4.0, 0.1 );
}

static void volume_does_not_change_with_translation_and_rotation( void** state )
{
    (void)state;
    balloon_mesh mesh = new_perturbed_sphere();
    double volume = mesh_volume( &mesh ), c = cos( 1.1 ), s = sin( 1.1 );
    for ( int i = 0; i < mesh.vertex_count; ++i )
    {
        double3 p = mesh.positions[i];
        mesh.positions[i] = double3_make( c * p.x - s * p.y + 0.7, s * p.x + c * p.y - 0.4, p.z + 1.3 );
    }
    assert_close( mesh_volume( &mesh ) / volume, 1.0, 1e-12 );
    balloon_mesh_destroy( &mesh );
}

// Eq. 8
static void the_volume_gradient_agrees_with_differences_and_with_its_identities( void** state )
{
    (void)state;
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
    assert_close( double3_length( sum ) / largest, 0.0, 1e-14 );
    assert_close( virial / ( 3.0 * mesh_volume( &mesh ) ), 1.0, 1e-13 );
    balloon_mesh_destroy( &mesh );
}

static void only_the_origin_free_gradient_keeps_its_digits_far_away( void** state )
{
    (void)state;
    balloon_mesh mesh = new_perturbed_sphere();
    double3 near[42], far[42], printed[42];
    double error = 0.0, printed_error = 0.0;
    constraint_oracle_volume_gradient( mesh.positions, 42, mesh.triangles, 80, near );
    for ( int i = 0; i < 42; ++i )
    {
        mesh.positions[i] = double3_add( mesh.positions[i], double3_make( 1e4, -1e4, 1e4 ) );
    }
    constraint_oracle_volume_gradient( mesh.positions, 42, mesh.triangles, 80, far );
    constraint_oracle_volume_gradient_printed( mesh.positions, 42, mesh.triangles, 80, printed );
    for ( int i = 0; i < 42; ++i )
    {
        error = fmax( error, double3_distance( near[i], far[i] ) );
        printed_error = fmax( printed_error, double3_distance( near[i], double3_scale( 1.0 / 6.0, printed[i] ) ) );
    }
    // coordinates of 1e4 m are rounded to 1e-12 m and edges are 0.1 m long; the printed form multiplies 1e4 by 1e4
    assert_true( error < 1e-12 );
    assert_true( printed_error > 1e-9 );
    balloon_mesh_destroy( &mesh );
}

static void volume_projections_reach_their_target_and_their_pressure( void** state )
{
    (void)state;
    balloon_mesh mesh = new_perturbed_sphere();
    double3 scratch[42], p[42];
    double w[42], target = 1.3 * mesh_volume( &mesh );
    constraint_oracle_skips skips = { { 0 } };
    for ( int i = 0; i < 42; ++i )
    {
        p[i] = mesh.positions[i];
        w[i] = i == 5 ? 0.0 : 1.0 / 3e-4;
    }
    for ( int n = 0; n < 5; ++n )
    {
        constraint_oracle_project_volume( p, w, 42, mesh.triangles, 80, target, 1.0, scratch, &skips );
    }
    // each projection squares the relative error of the previous one
    assert_close( constraint_oracle_volume( p, mesh.triangles, 80 ) / target, 1.0, 1e-12 );
    assert_close( double3_distance( p[5], mesh.positions[5] ), 0.0, 0.0 );
    // lambda/dt^2 is the pressure: at convergence C + alpha lambda = 0 is P_atm (V_0 - V)/V_0
    double dt = 1e-3, alpha = target / 101325.0 / ( dt * dt ), lambda = 0.0;
    memcpy( p, mesh.positions, sizeof( p ) );
    for ( int n = 0; n < 20; ++n )
    {
        constraint_oracle_project_volume_compliant( p, w, 42, mesh.triangles, 80, target, alpha, &lambda, scratch,
                                                    &skips );
    }
    double volume = constraint_oracle_volume( p, mesh.triangles, 80 );
    assert_true( lambda > 0.0 && volume < target );
    assert_close( lambda / ( dt * dt ) / ( 101325.0 * ( target - volume ) / target ), 1.0, 1e-9 );
    balloon_mesh_destroy( &mesh );
}

static void degenerate_constraints_move_nothing_and_are_counted( void** state )
{
    (void)state;
    const double pinned[4] = { 0.0, 0.0, 0.0, 0.0 }, loose[4] = { 1.0, 1.0, 1.0, 1.0 };
    constraint_oracle_skips skips = { { 0 } };
    double lambda = 0.0, q[4][4];
    double3 same[4] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 2, 1 }, { 1, 0, 1 } };
    double3 flat[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 0.5, -1, 0 } };
    double3 before[4];
    memcpy( before, same, sizeof( before ) );
    constraint_oracle_term term = constraint_oracle_distance( same[0], same[1], 1.0 );
    constraint_oracle_project( &term, four, loose, 1.0, same, &skips );
    constraint_oracle_project_compliant( &term, four, loose, 1.0, &lambda, same, &skips );
    constraint_oracle_project_above( &term, four, loose, 1.0, same, &skips );
    constraint_oracle_project_compliant_above( &term, four, loose, 1.0, &lambda, same, &skips );
    term = constraint_oracle_dihedral( same, 0.5 );
    constraint_oracle_project( &term, four, loose, 1.0, same, &skips );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_ZERO_LENGTH], 5 );
    assert_memory_equal( same, before, sizeof( before ) );
    assert_true( lambda == 0.0 );
    memcpy( before, flat, sizeof( before ) );
    term = constraint_oracle_dihedral( flat, 0.5 );
    constraint_oracle_project( &term, four, loose, 1.0, flat, &skips );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_ZERO_AREA], 1 );
    assert_false( constraint_oracle_isometric_matrix( flat, q ) );
    assert_true( q[0][0] == 0.0 && q[3][2] == 0.0 );
    term = constraint_oracle_distance( flat[0], flat[1], 2.0 );
    constraint_oracle_project( &term, four, pinned, 1.0, flat, &skips );
    constraint_oracle_project_compliant( &term, four, pinned, 0.0, &lambda, flat, &skips );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_PINNED], 2 );
    assert_memory_equal( flat, before, sizeof( before ) );
    // a mesh in one point cannot grow; a satisfied constraint without a gradient is no fault
    balloon_mesh mesh;
    double3 scratch[4];
    assert_true( balloon_mesh_tetrahedron( &mesh, 0.0 ) );
    constraint_oracle_project_volume( mesh.positions, loose, 4, mesh.triangles, 4, 1.0, 1.0, scratch, &skips );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_ZERO_GRADIENT], 1 );
    constraint_oracle_project_volume( mesh.positions, loose, 4, mesh.triangles, 4, 0.0, 1.0, scratch, &skips );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_ZERO_GRADIENT], 1 );
    assert_int_equal( skips.count[CONSTRAINT_ORACLE_SOUND], 0 );
    balloon_mesh_destroy( &mesh );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( gradients_agree_with_central_differences ),
        cmocka_unit_test( a_linear_constraint_is_solved_by_one_projection ),
        cmocka_unit_test( the_general_projection_of_a_distance_is_the_printed_one ),
        cmocka_unit_test( every_projection_keeps_linear_and_angular_momentum ),
        cmocka_unit_test( a_stretched_pair_returns_to_its_length_and_moves_in_ratio_of_inverse_masses ),
        cmocka_unit_test( a_stiffness_below_one_leaves_its_share_of_the_error ),
        cmocka_unit_test( a_compliant_edge_carries_the_tension_of_its_spring ),
        cmocka_unit_test( a_tether_resists_stretch_and_never_pushes ),
        cmocka_unit_test( a_strain_limit_clamps_the_length_and_ignores_what_is_within ),
        cmocka_unit_test( a_dihedral_angle_is_signed_and_known_on_solids ),
        cmocka_unit_test( a_bend_finds_its_rest_angle_from_flat_and_the_short_way_through_pi ),
        cmocka_unit_test( the_isometric_matrix_is_symmetric_and_blind_to_flat_shapes ),
        cmocka_unit_test( the_isometric_energy_of_a_fold_has_its_closed_form ),
        cmocka_unit_test( the_energy_form_halves_a_fold_and_the_root_form_solves_it ),
        cmocka_unit_test( a_cube_has_volume_one_wherever_it_is ),
        cmocka_unit_test( volumes_of_solids_have_their_closed_forms ),
        cmocka_unit_test( volume_does_not_change_with_translation_and_rotation ),
        cmocka_unit_test( the_volume_gradient_agrees_with_differences_and_with_its_identities ),
        cmocka_unit_test( only_the_origin_free_gradient_keeps_its_digits_far_away ),
        cmocka_unit_test( volume_projections_reach_their_target_and_their_pressure ),
        cmocka_unit_test( degenerate_constraints_move_nothing_and_are_counted ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
