// The balloon's equations and the topology of its meshes on the double-precision oracle. Motion is in
// test_balloon_oracle_motion.c, the constraints of Eq. 3-8 in test_constraint_oracle.c. Numbers of equations, figures
// and sections are those of the balloon paper (docs/methods.md).
#include "oracle_support.h"

#include "oracle/balloon_meshes.h"
#include "oracle/balloon_oracle.h"

static const uint64_t random_seed = 22;

static const double3 up = { 0.0, 1.0, 0.0 };
static const double3 gravity = { 0.0, -9.8, 0.0 };

static balloon_mesh new_sphere( int level, double radius )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, level, radius ) );
    return mesh;
}

static double* new_masses( const balloon_mesh* mesh, double areal_density )
{
    double* mass = checked_calloc( (size_t)mesh->vertex_count, sizeof( double ) );
    balloon_oracle_masses( mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count, areal_density,
                           mass );
    return mass;
}

static double air_density( void )
{
    return balloon_oracle_density( 101325.0, BALLOON_ORACLE_AIR, 293.15 );
}

static double helium_density( void )
{
    return balloon_oracle_density( 101325.0, BALLOON_ORACLE_HELIUM, 293.15 );
}

// Eq. 1; gravity
static void a_constant_force_gives_n_dt_f_over_m_and_a_pinned_vertex_stays( void** state )
{
    (void)state;
    double dt = 1.0 / 60.0, m = 0.25;
    double3 v = { 0.0, 0.0, 0.0 }, x = { 1.0, 2.0, 3.0 }, still = { 0.0, 0.0, 0.0 },
            weight = double3_scale( m, gravity );
    for ( int n = 1; n <= 100; ++n )
    {
        x = balloon_oracle_predict( x, &v, 1.0 / m, weight, dt );
        double3 pinned = balloon_oracle_predict( x, &still, 0.0, weight, dt );
        assert_close( v.y, -9.8 * n * dt, 1e-13 );
        assert_true( double3_distance( pinned, x ) == 0.0 && double3_length( still ) == 0.0 );
        // symplectic Euler falls by g dt^2 n (n + 1) / 2
        assert_close( x.y, 2.0 - 9.8 * dt * dt * n * ( n + 1 ) / 2.0, 1e-12 );
    }
}

// Eq. 2
static void the_velocity_carries_the_old_position_to_the_new_one( void** state )
{
    (void)state;
    for ( int n = 0; n < 100; ++n )
    {
        double3 x = random_vector( n, 0 ), p = random_vector( n, 1 );
        double dt = random_between( n, 9, 1e-3, 0.05 );
        double3 v = balloon_oracle_velocity( x, p, dt );
        assert_close( double3_distance( double3_scale( dt, v ), double3_sub( p, x ) ), 0.0, 1e-15 );
    }
}

// Fig. 2
static void a_closed_mesh_has_three_edges_for_two_faces_and_a_bend_pair_across_each( void** state )
{
    (void)state;
    balloon_mesh meshes[5];
    assert_true( balloon_mesh_tetrahedron( &meshes[0], 1.0 ) && balloon_mesh_cube( &meshes[1], 1.0 ) &&
                 balloon_mesh_bipyramid( &meshes[2], 1.0 ) && balloon_mesh_icosphere( &meshes[3], 3, 1.0 ) &&
                 balloon_mesh_torus( &meshes[4], 7, 5, 1.0, 0.3 ) );
    for ( int n = 0; n < 5; ++n )
    {
        const balloon_mesh* mesh = &meshes[n];
        balloon_mesh_topology t;
        assert_true( balloon_mesh_build_topology( mesh, &t ) );
        int* pairs = checked_calloc( 2 * (size_t)t.edge_count, sizeof( int ) );
        assert_int_equal( t.edge_count, 3 * mesh->triangle_count / 2 );
        assert_int_equal( balloon_mesh_structural_pairs( &t, pairs ), t.edge_count );
        for ( int e = 1; e < t.edge_count; ++e )
        {
            // ascending order, so that each occurs once
            int ahead = pairs[2 * e] - pairs[2 * e - 2], behind = pairs[2 * e + 1] - pairs[2 * e - 1];
            assert_true( ahead > 0 || ( ahead == 0 && behind > 0 ) );
        }
        assert_int_equal( balloon_mesh_bend_pairs( &t, pairs ), t.edge_count );
        assert_int_equal( t.border_count + t.crossed_count + t.crowded_count, 0 );
        assert_int_equal( t.component_count, 1 );
        free( pairs );
        balloon_mesh_destroy_topology( &t );
        balloon_mesh_destroy( &meshes[n] );
    }
    balloon_mesh mesh;
    balloon_mesh_topology t;
    int pairs[10];
    assert_true( balloon_mesh_two_triangles( &mesh, 1.0 ) && balloon_mesh_build_topology( &mesh, &t ) );
    assert_int_equal( balloon_mesh_structural_pairs( &t, pairs ), 5 );
    assert_int_equal( balloon_mesh_bend_pairs( &t, pairs ), 1 );
    assert_true( pairs[0] == 2 && pairs[1] == 3 );
    balloon_mesh_destroy_topology( &t );
    balloon_mesh_destroy( &mesh );
}

// Fig. 2b: the ring of a bipyramid is a cycle of three edges and no face, its edges have three common neighbours
static void a_bend_pair_comes_from_the_faces_and_not_from_common_neighbours( void** state )
{
    (void)state;
    balloon_mesh mesh;
    balloon_mesh_topology t;
    int pairs[18];
    assert_true( balloon_mesh_bipyramid( &mesh, 1.0 ) && balloon_mesh_build_topology( &mesh, &t ) );
    assert_int_equal( balloon_mesh_bend_pairs( &t, pairs ), 9 );
    for ( int e = 0; e < 9; ++e )
    {
        int lower = pairs[2 * e] < pairs[2 * e + 1] ? pairs[2 * e] : pairs[2 * e + 1];
        int upper = pairs[2 * e] + pairs[2 * e + 1] - lower;
        bool ring = t.edges[e].b < 3;
        assert_int_equal( lower, ring ? 3 : t.edges[e].a == 0 ? 1 : 0 );
        assert_int_equal( upper, ring ? 4 : t.edges[e].a == 2 ? 1 : 2 );
    }
    balloon_mesh_destroy_topology( &t );
    balloon_mesh_destroy( &mesh );
}

// Eq. 9
static void the_gas_law_gives_the_densities_and_pressures_of_the_source( void** state )
{
    (void)state;
    assert_close( helium_density(), 0.16639, 5e-6 );
    assert_close( air_density(), 1.20410, 5e-6 );
    assert_close( air_density() - helium_density(), 1.03770, 1e-5 );
    for ( int n = 0; n < 100; ++n )
    {
        double amount = random_between( n, 0, 0.1, 10.0 ), volume = random_between( n, 1, 0.001, 1.0 );
        double pressure = balloon_oracle_gas_pressure( amount, volume, 293.15 );
        assert_close( pressure * volume / ( amount * BALLOON_ORACLE_GAS_CONSTANT * 293.15 ), 1.0, 4e-16 );
    }
}

// Section III.2
static void the_gas_amount_comes_from_its_volume_at_atmospheric_pressure( void** state )
{
    (void)state;
    double amount = balloon_oracle_gas_amount( 101325.0, 1.0, 293.15 );
    assert_close( amount, 41.57, 5e-3 );
    assert_close( balloon_oracle_gas_pressure( amount, 0.5, 293.15 ), 2.0 * 101325.0, 1e-9 );
    // moles taken as added cubic metres need 41.57 volumes before their pressure equals that of the atmosphere
    assert_close( balloon_oracle_gas_pressure_printed( amount * 0.014, 0.014, 293.15 ), 101325.0, 1e-9 );
}

// Eq. 10
static void buoyancy_points_up_and_floats_three_grams_at_the_radius_of_the_source( void** state )
{
    (void)state;
    double difference = air_density() - helium_density();
    double3 f = balloon_oracle_buoyancy( gravity, 0.0141372, air_density(), helium_density() );
    assert_true( f.x == 0.0 && f.z == 0.0 );
    assert_close( f.y, 9.8 * 0.0141372 * difference, 1e-15 );
    // printed digits of the specification
    assert_close( balloon_oracle_true_lift_off_radius_of_mass( 0.003, difference ), 0.0884, 5e-5 );
    assert_close( balloon_oracle_true_lift_off_radius( 0.02, difference ), 0.058, 5e-4 );
    assert_close( balloon_oracle_true_lift_off_radius( 0.05, difference ), 0.145, 5e-4 );
    double r = balloon_oracle_true_lift_off_radius_of_mass( 0.003, difference );
    assert_close( 4.0 / 3.0 * pi * r * r * r * difference, 0.003, 1e-15 );
    // references, section 1: 0.14 m of helium lift 0.11799 N at 9.81 m/s^2 and the densities of 15 degrees
    f = balloon_oracle_buoyancy( double3_make( 0.0, -9.81, 0.0 ), 4.0 / 3.0 * pi * 0.14 * 0.14 * 0.14, 1.225,
                                 0.1786 );
    assert_close( f.y, 0.11799, 5e-6 );
}

static double3 sphere_drag( const balloon_mesh* mesh, balloon_oracle_drag drag, double3 v )
{
    size_t n = (size_t)mesh->vertex_count;
    double3* normal = calloc( n, sizeof( double3 ) );
    double* area = calloc( n, sizeof( double ) );
    assert_non_null( normal );
    assert_non_null( area );
    assert_int_equal( balloon_oracle_skin( mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                                           normal, area ),
                      0 );
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        double c = 0.5 * air_density() * 0.5 * area[i];
        sum = double3_add( sum, balloon_oracle_drag_force( drag, c, v, normal[i], 0.0 ) );
    }
    free( normal );
    free( area );
    return sum;
}

// Eq. 11
static void the_drag_of_a_rigid_sphere_is_what_each_variant_says( void** state )
{
    (void)state;
    balloon_mesh mesh = new_sphere( 4, 0.15 );
    assert_int_equal( mesh.triangle_count, 5120 );
    double3 v = { 1.2, -0.9, 2.0 };
    double speed = double3_length( v ), full = 0.5 * air_density() * 0.5 * pi * 0.15 * 0.15 * speed * speed;
    const balloon_oracle_drag variant[] = { BALLOON_ORACLE_DRAG_MAX, BALLOON_ORACLE_DRAG_ABS,
                                            BALLOON_ORACLE_DRAG_SIGNED, BALLOON_ORACLE_DRAG_NORMAL };
    // the measured factors; they depend in the fourth digit on the direction of the flow
    const double expected[] = { 0.9987, 1.9975, 0.0, 4.0 / 3.0 }, allowed[] = { 1e-3, 2e-3, 1e-12, 3e-3 };
    for ( int n = 0; n < 4; ++n )
    {
        double3 f = sphere_drag( &mesh, variant[n], v );
        assert_close( -double3_dot( f, v ) / speed / full, expected[n], allowed[n] );
        // nothing sideways
        assert_close( double3_length( double3_cross( f, v ) ) / speed / full, 0.0, 1e-3 );
    }
    balloon_mesh_destroy( &mesh );
}

// Explicit drag may reverse v, limited drag may not; |v| = 0 and a cancelled normal give nothing.
static void limited_drag_never_reverses_a_velocity( void** state )
{
    (void)state;
    double3 v = { 0.0, 300.0, 0.0 }, zero = { 0.0, 0.0, 0.0 };
    double w = 1.0 / 1e-5, dt = 1.0 / 60.0, c = 1e-4;
    double3 plain = balloon_oracle_drag_force( BALLOON_ORACLE_DRAG_MAX, c, v, up, 0.0 );
    assert_close( plain.y, -c * 300.0 * 300.0, 1e-12 );
    assert_true( v.y + dt * w * plain.y < 0.0 );
    double3 limited = balloon_oracle_drag_force( BALLOON_ORACLE_DRAG_MAX, c, v, up, dt * w );
    assert_close( v.y + dt * w * limited.y, 300.0 / ( 1.0 + c * 300.0 * dt * w ), 1e-10 );
    assert_true( double3_length( balloon_oracle_drag_force( BALLOON_ORACLE_DRAG_MAX, c, zero, up, 0.0 ) ) == 0.0 );
    assert_true( double3_length( balloon_oracle_drag_force( BALLOON_ORACLE_DRAG_MAX, c, v, zero, 0.0 ) ) == 0.0 );
}

// Eq. 12
static void the_outlet_speed_flow_and_thrust_have_the_magnitudes_of_the_specification( void** state )
{
    (void)state;
    const double gauge[] = { 1000.0, 2500.0, 7500.0 }, speed[] = { 109.6, 173.3, 300.0 };
    const double flow[] = { 1.82e-3, 2.88e-3, 4.996e-3 }, force[] = { 0.2, 0.5, 1.5 };
    for ( int n = 0; n < 3; ++n )
    {
        double v = balloon_oracle_outlet_speed( gauge[n], helium_density() );
        double mass_flow = balloon_oracle_mass_flow( helium_density(), 1e-4, v );
        double3 f = balloon_oracle_reaction( mass_flow, v, up );
        assert_close( v, speed[n], n == 2 ? 0.5 : 0.05 ); // "300" is rounded to the metre
        assert_close( mass_flow, flow[n], 5e-6 );
        assert_close( -f.y / force[n], 1.0, 1e-12 );
        assert_close( -f.y / ( 2.0 * 1e-4 * gauge[n] ), 1.0, 1e-12 );
    }
    assert_true( balloon_oracle_outlet_speed( 0.0, helium_density() ) == 0.0 );
    assert_true( balloon_oracle_outlet_speed( -500.0, helium_density() ) == 0.0 );
    // with a frozen constant an emptier balloon has a stronger jet
    assert_true( balloon_oracle_outlet_speed_printed( 103825.0, 102000.0, helium_density() ) >
                 balloon_oracle_outlet_speed_printed( 103825.0, 103000.0, helium_density() ) );
}

// Section III.2: 10 Pa and 50 Pa
static void the_jet_ends_at_ten_pascal_and_starts_again_only_above_fifty( void** state )
{
    (void)state;
    const double gauge[] = { 40.0, 50.0, 51.0, 30.0, 11.0, 10.0, 30.0, 50.0, 60.0, 0.0 };
    const bool expected[] = { false, false, true, true, true, false, false, false, true, false };
    bool running = false;
    for ( int n = 0; n < 10; ++n )
    {
        running = balloon_oracle_jet_runs( running, gauge[n], 1e5, 1e-4, 5e-4 );
        assert_int_equal( running, expected[n] );
    }
}

// Eq. 13: vertex 0 of an icosphere has five equal neighbours, so its normal is radial
static void a_radial_jet_has_no_torque_and_an_offset_one_has_r_cross_f( void** state )
{
    (void)state;
    balloon_mesh mesh = new_sphere( 2, 0.15 );
    double3 normal[162];
    double area[162];
    assert_int_equal( balloon_oracle_skin( mesh.positions, 162, mesh.triangles, mesh.triangle_count, normal, area ),
                      0 );
    double* mass = new_masses( &mesh, 0.02 );
    double3 centre = balloon_oracle_centre( mesh.positions, mass, 162 );
    double3 force = balloon_oracle_reaction( 2e-3, 100.0, normal[0] );
    double3 torque = balloon_oracle_torque( mesh.positions[0], centre, force );
    assert_close( double3_length( torque ) / ( 0.15 * double3_length( force ) ), 0.0, 1e-14 );
    force = double3_make( 0.0, 0.0, 0.2 );
    torque = balloon_oracle_torque( double3_make( 1.3, 0.0, 5.0 ), double3_make( 1.0, 0.5, 4.0 ), force );
    assert_close( double3_distance( torque, double3_make( -0.1, -0.06, 0.0 ) ), 0.0, 1e-16 );
    free( mass );
    balloon_mesh_destroy( &mesh );
}

// The effect of Eq. 14 and the kick on the angular momentum and the momentum of an asymmetric body.
static void kick_pear( double dt, double3* gained, double3* momentum_change, double3* expected, double* strain )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_pear( &mesh, 2, 0.15 ) );
    double* mass = new_masses( &mesh, 0.02 );
    double3 v[162], before[162], torque = { 0.002, -0.005, 0.003 };
    double w[162];
    for ( int i = 0; i < 162; ++i )
    {
        v[i] = before[i] = double3_scale( 0.1, random_vector( i, 0 ) );
        w[i] = 1.0 / mass[i];
    }
    double3 c = balloon_oracle_centre( mesh.positions, mass, 162 );
    balloon_oracle_matrix inertia = balloon_oracle_inertia( mesh.positions, mass, 162, c );
    double3 increment = balloon_oracle_spin_increment( &inertia, torque, dt );
    balloon_oracle_spin_kick( mesh.positions, v, w, 162, c, increment );
    *expected = double3_scale( dt, torque );
    *gained = double3_sub( balloon_oracle_angular_momentum( mesh.positions, v, mass, 162, c ),
                           balloon_oracle_angular_momentum( mesh.positions, before, mass, 162, c ) );
    *momentum_change =
        double3_sub( balloon_oracle_momentum( v, mass, 162 ), balloon_oracle_momentum( before, mass, 162 ) );
    *strain = 0.0;
    for ( int n = 0; n < 3 * mesh.triangle_count; ++n )
    {
        int a = mesh.triangles[n], b = mesh.triangles[n - n % 3 + ( n + 1 ) % 3];
        double3 edge = double3_sub( mesh.positions[a], mesh.positions[b] );
        double3 moved = double3_add( edge, double3_scale( dt, double3_cross( increment, edge ) ) );
        *strain = fmax( *strain, fabs( double3_length( moved ) / double3_length( edge ) - 1.0 ) );
    }
    // the largest possible strain of x + dt omega x x
    assert_true( *strain <= 0.5 * pow( dt * double3_length( increment ), 2.0 ) + 1e-15 );
    free( mass );
    balloon_mesh_destroy( &mesh );
}

// Eq. 14, and section III.4
static void a_kick_adds_dt_tau_to_the_angular_momentum_and_nothing_to_the_momentum( void** state )
{
    (void)state;
    double3 gained, change, expected;
    double strain[2];
    for ( int n = 0; n < 2; ++n )
    {
        kick_pear( n == 0 ? 0.02 : 0.01, &gained, &change, &expected, &strain[n] );
        assert_close( double3_distance( gained, expected ) / double3_length( expected ), 0.0, 1e-10 );
        // relative to the 6 g body at 0.1 m/s
        assert_close( double3_length( change ) / 6e-4, 0.0, 1e-12 );
    }
    // the increment and its displacement are both proportional to dt: a kick strains by its fourth power
    assert_true( strain[0] > 1e-6 );
    assert_close( strain[0] / strain[1], 16.0, 0.1 );
}

// Eq. 15
static void a_quaternion_stays_of_unit_length_and_its_angle_error_falls_with_dt_squared( void** state )
{
    (void)state;
    double3 omega = { 0.6, -1.0, 0.3 };
    double error[2];
    for ( int n = 0; n < 2; ++n )
    {
        int steps = n == 0 ? 50 : 100;
        balloon_oracle_quaternion q = { 1.0, 0.0, 0.0, 0.0 };
        for ( int k = 0; k < steps; ++k )
        {
            q = balloon_oracle_turn( q, omega, 1.0 / steps );
            assert_close( q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1.0, 1e-15 );
        }
        error[n] = double3_length( omega ) - balloon_oracle_angle( q );
        double3 along = balloon_oracle_rotate( q, omega );
        assert_close( double3_distance( along, omega ), 0.0, 1e-14 );
        // one step turns by 2 atan(omega dt/2), short of omega dt by (omega dt)^3/12
        assert_close( error[n] / ( pow( double3_length( omega ), 3.0 ) / ( 12.0 * steps * steps ) ), 1.0, 1e-3 );
    }
    assert_close( error[0] / error[1], 4.0, 1e-2 );
    balloon_oracle_quaternion quarter = { sqrt( 0.5 ), 0.0, 0.0, sqrt( 0.5 ) };
    double3 turned = balloon_oracle_rotate( quarter, double3_make( 1.0, 0.0, 0.0 ) );
    assert_close( double3_distance( turned, up ), 0.0, 1e-15 );
}

// Eq. 16-17
static void the_inertia_of_a_shell_is_two_thirds_m_r_squared( void** state )
{
    (void)state;
    balloon_mesh mesh = new_sphere( 3, 0.15 );
    double* mass = new_masses( &mesh, 0.02 );
    double total = 0.0;
    for ( int i = 0; i < mesh.vertex_count; ++i )
    {
        total += mass[i];
        mesh.positions[i] = double3_add( mesh.positions[i], double3_make( 3.0, -2.0, 1.0 ) );
    }
    double3 c = balloon_oracle_centre( mesh.positions, mass, mesh.vertex_count );
    assert_close( double3_distance( c, double3_make( 3.0, -2.0, 1.0 ) ), 0.0, 1e-14 );
    balloon_oracle_matrix inertia = balloon_oracle_inertia( mesh.positions, mass, mesh.vertex_count, c );
    double reference = balloon_oracle_true_shell_inertia( total, 0.15 );
    for ( int a = 0; a < 3; ++a )
    {
        assert_close( inertia.m[a][a] / reference, 1.0, 0.01 );
        for ( int b = 0; b < 3; ++b )
        {
            double brute = balloon_oracle_product_of_inertia( mesh.positions, mass, mesh.vertex_count, c, a, b );
            double other =
                a != b ? 0.0
                       : balloon_oracle_product_of_inertia( mesh.positions, mass, mesh.vertex_count, c, 0, 0 ) +
                             balloon_oracle_product_of_inertia( mesh.positions, mass, mesh.vertex_count, c, 1, 1 ) +
                             balloon_oracle_product_of_inertia( mesh.positions, mass, mesh.vertex_count, c, 2, 2 );
            assert_true( inertia.m[a][b] == inertia.m[b][a] );
            assert_close( inertia.m[a][b], other - brute, 1e-14 * reference );
        }
    }
    free( mass );
    balloon_mesh_destroy( &mesh );
}

// All vertices on a line have no spin about it
static void a_singular_inertia_is_inverted_where_it_can_be( void** state )
{
    (void)state;
    double3 x[5], direction = { 0.48, 0.6, 0.64 };
    const double mass[5] = { 1.0, 2.0, 1.0, 0.5, 1.0 };
    for ( int i = 0; i < 5; ++i )
    {
        x[i] = double3_scale( 0.1 * i, direction );
    }
    double3 c = balloon_oracle_centre( x, mass, 5 ), foreign = { 0.8, 0.0, -0.6 };
    balloon_oracle_matrix inertia = balloon_oracle_inertia( x, mass, 5, c );
    double3 about = balloon_oracle_spin_increment( &inertia, direction, 1.0 );
    assert_close( double3_length( about ), 0.0, 1e-12 );
    double3 spin = balloon_oracle_spin_increment( &inertia, foreign, 1.0 );
    assert_close( double3_distance( balloon_oracle_apply( &inertia, spin ), foreign ), 0.0, 1e-12 );

    for ( int n = 0; n < 50; ++n )
    {
        balloon_oracle_matrix axes, a = { { { 0.0 } } };
        for ( int k = 0; k < 3; ++k )
        {
            double3 r = random_vector( n, k );
            const double column[3] = { r.x, r.y, r.z };
            for ( int i = 0; i < 9; ++i )
            {
                a.m[i / 3][i % 3] += column[i / 3] * column[i % 3];
            }
        }
        double3 value = balloon_oracle_eigen( &a, &axes ), v = { axes.m[0][1], axes.m[1][1], axes.m[2][1] };
        assert_close( double3_distance( balloon_oracle_apply( &a, v ), double3_scale( value.y, v ) ), 0.0, 1e-14 );
    }
}

static void a_triangle_without_area_and_a_cancelled_normal_are_counted_and_harmless( void** state )
{
    (void)state;
    // two faces back to back: every normal cancels; and a needle that adds nothing
    const double3 x[5] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 2, 0, 0 }, { 4, 0, 0 } };
    const int back_to_back[6] = { 0, 1, 2, 0, 2, 1 }, needle[6] = { 0, 1, 2, 1, 3, 4 };
    double3 normal[5];
    double area[5];
    assert_int_equal( balloon_oracle_skin( x, 5, back_to_back, 2, normal, area ), 5 );
    assert_close( area[0], 1.0 / 3.0, 1e-16 );
    assert_true( double3_length( normal[0] ) == 0.0 );
    assert_int_equal( balloon_oracle_skin( x, 5, needle, 2, normal, area ), 2 );
    assert_true( normal[1].z == 1.0 && area[3] == 0.0 );
    assert_true( constraint_oracle_volume( x, needle, 2 ) == 0.0 );
}

static wisp_status create_from( const balloon_mesh* mesh, wisp_error* error )
{
    balloon_oracle_options options = balloon_oracle_default_options();
    balloon_oracle balloon;
    wisp_status status = balloon_oracle_create_from_mesh( mesh, 0.02, -1, &options, &balloon, error );
    if ( status == WISP_OK )
    {
        balloon_oracle_destroy( &balloon );
    }
    return status;
}

static void assert_refused( const balloon_mesh* mesh, const char* words )
{
    wisp_error error = { 0 };
    assert_int_equal( create_from( mesh, &error ), WISP_BAD_INPUT );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_contains( error.message, words );
}

static void a_mesh_without_one_inside_is_refused_with_the_edge_that_is_wrong( void** state )
{
    (void)state;
    balloon_mesh mesh, twice;
    assert_true( balloon_mesh_cube( &mesh, 0.2 ) );
    assert_int_equal( create_from( &mesh, NULL ), WISP_OK );
    assert_true( balloon_mesh_join( &twice, &mesh, &mesh, double3_make( 1.0, 0.0, 0.0 ) ) );
    assert_refused( &twice, "2 shells" );
    balloon_mesh_destroy( &twice );

    mesh.triangle_count = 11;
    assert_refused( &mesh, "open at edge 3-4" );
    mesh.triangle_count = 12;
    int kept = mesh.triangles[0];
    mesh.triangles[0] = mesh.triangles[1];
    mesh.triangles[1] = kept;
    assert_refused( &mesh, "same direction" );
    kept = mesh.triangles[0];
    mesh.triangles[0] = mesh.triangles[1];
    mesh.triangles[1] = kept;
    mesh.triangles[3] = 0;
    mesh.triangles[4] = 2;
    mesh.triangles[5] = 1;
    assert_refused( &mesh, "faces" );
    balloon_mesh_destroy( &mesh );

    assert_true( balloon_mesh_cube( &mesh, 0.2 ) );
    mesh.triangles[7] = 8;
    assert_refused( &mesh, "index 7 of the triangle list is 8" );
    mesh.triangles[7] = 5;
    mesh.positions[3].y = (double)NAN;
    assert_refused( &mesh, "vertex 3 is not finite" );
    balloon_mesh_destroy( &mesh );
    assert_true( balloon_mesh_two_triangles( &mesh, 0.2 ) );
    assert_refused( &mesh, "2 triangles" );
    balloon_mesh_destroy( &mesh );
}

static void parameters_out_of_range_are_refused_by_name( void** state )
{
    (void)state;
    balloon_mesh mesh;
    assert_true( balloon_mesh_cube( &mesh, 0.2 ) );
    balloon_oracle_options bad[4];
    const char* words[4] = { "dt", "substeps", "close_at", "inflow" };
    for ( int n = 0; n < 4; ++n )
    {
        bad[n] = balloon_oracle_default_options();
    }
    bad[0].dt = 0.0;
    bad[1].substeps = 0;
    bad[2].close_at = 1.0;
    bad[3].inflow = (double)INFINITY;
    for ( int n = 0; n < 4; ++n )
    {
        wisp_error error = { 0 };
        balloon_oracle balloon;
        assert_int_equal( balloon_oracle_create_from_mesh( &mesh, 0.02, -1, &bad[n], &balloon, &error ),
                          WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, words[n] ) );
    }
    balloon_oracle_options options = balloon_oracle_default_options();
    balloon_oracle balloon;
    wisp_error error = { 0 };
    assert_int_equal( balloon_oracle_create_from_mesh( &mesh, 0.02, 8, &options, &balloon, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "index 0 of the outlet list is 8" ) );
    balloon_mesh_destroy( &mesh );
}

// V < 0 turns all, flood fill repairs some
static void winding_is_repaired_and_an_inside_out_mesh_is_turned( void** state )
{
    (void)state;
    balloon_mesh mesh = new_sphere( 1, 0.15 );
    double volume = constraint_oracle_volume( mesh.positions, mesh.triangles, 80 );
    for ( int round = 0; round < 3; ++round )
    {
        int turned = 0, flipped = 0;
        for ( int t = 0; t < 80; ++t )
        {
            // all, every third, or none
            if ( round == 0 || ( round == 1 && t % 3 == 0 ) )
            {
                int kept = mesh.triangles[3 * t];
                mesh.triangles[3 * t] = mesh.triangles[3 * t + 1];
                mesh.triangles[3 * t + 1] = kept;
                turned += 1;
            }
        }
        // a body reverses a wholly inverted mesh by itself
        assert_int_equal( create_from( &mesh, NULL ), round == 1 ? WISP_BAD_INPUT : WISP_OK );
        assert_true( balloon_mesh_orient( &mesh, &flipped ) );
        assert_int_equal( flipped, turned );
        assert_close( constraint_oracle_volume( mesh.positions, mesh.triangles, 80 ) / volume, 1.0, 1e-14 );
    }
    balloon_mesh_destroy( &mesh );

    // a strip of five triangles joined with half a turn has one side
    const int strip[15] = { 0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4, 0, 4, 0, 1 };
    assert_true( balloon_mesh_bipyramid( &mesh, 1.0 ) );
    memcpy( mesh.triangles, strip, sizeof( strip ) );
    mesh.triangle_count = 5;
    int flipped = 0;
    assert_false( balloon_mesh_orient( &mesh, &flipped ) );
    balloon_mesh_destroy( &mesh );
}

// allow_open: a flat hole is closed by its fan exactly
static void a_fan_over_a_hole_restores_the_volume_of_a_cube( void** state )
{
    (void)state;
    balloon_mesh mesh;
    double volume = 0.0;
    assert_true( balloon_mesh_cube( &mesh, 0.5 ) );
    for ( int removed = 0; removed <= 2; ++removed )
    {
        mesh.triangle_count = 12 - removed;
        assert_true( balloon_mesh_capped_volume( &mesh, &volume ) );
        assert_close( volume, 0.125, 1e-16 );
    }
    balloon_mesh_destroy( &mesh );
}

// Closed forms
static void the_virial_of_a_scaled_mesh_is_its_closed_form( void** state )
{
    (void)state;
    for ( int level = 1; level <= 3; ++level )
    {
        balloon_mesh mesh = new_sphere( level, 0.15 );
        balloon_oracle_options options = balloon_oracle_default_options();
        options.bend_stiffness = 1e-12;
        balloon_oracle b;
        assert_int_equal( balloon_oracle_create_from_mesh( &mesh, 0.05, -1, &options, &b, NULL ), WISP_OK );
        double s = cbrt( 1.2 ), sum = 0.0;
        for ( int e = 0; e < b.structural_count; ++e )
        {
            sum += 2000.0 * b.structural[e].rest * b.structural[e].rest;
        }
        for ( int i = 0; i < b.vertex_count; ++i )
        {
            b.x[i] = double3_scale( s, b.x[i] );
        }
        double virial = balloon_oracle_gauge( &b, BALLOON_ORACLE_PRESSURE_VIRIAL );
        assert_close( virial / balloon_oracle_true_scaled_pressure( sum, b.rest_volume, s ), 1.0, 1e-12 );
        // 42, 162 and 642 vertices are at 1.074, 1.027, 1.015, the limit is 1.011: an icosphere is no regular
        // lattice, so the printed 5 % hold from 162 vertices on
        double smooth = balloon_oracle_true_sphere_pressure( 2000.0, 0.15, s - 1.0 );
        assert_close( virial / smooth, 1.0, level == 1 ? 0.1 : 0.05 );
        balloon_oracle_destroy( &b );
        balloon_mesh_destroy( &mesh );
    }
    assert_close( balloon_oracle_true_sphere_pressure( 2000.0, 0.15, cbrt( 1.2 ) - 1.0 ), 2564.0, 2.0 );
    // the peak at s = 2 is sum(k l^2) / (12 V_rest)
    assert_close( balloon_oracle_true_scaled_pressure( 7.0, 0.5, 2.0 ), 7.0 / 6.0, 1e-15 );
    assert_true( balloon_oracle_true_scaled_pressure( 7.0, 0.5, 1.99 ) < 7.0 / 6.0 );
    assert_true( balloon_oracle_true_scaled_pressure( 7.0, 0.5, 2.01 ) < 7.0 / 6.0 );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_constant_force_gives_n_dt_f_over_m_and_a_pinned_vertex_stays ),
        cmocka_unit_test( the_velocity_carries_the_old_position_to_the_new_one ),
        cmocka_unit_test( a_closed_mesh_has_three_edges_for_two_faces_and_a_bend_pair_across_each ),
        cmocka_unit_test( a_bend_pair_comes_from_the_faces_and_not_from_common_neighbours ),
        cmocka_unit_test( the_gas_law_gives_the_densities_and_pressures_of_the_source ),
        cmocka_unit_test( the_gas_amount_comes_from_its_volume_at_atmospheric_pressure ),
        cmocka_unit_test( buoyancy_points_up_and_floats_three_grams_at_the_radius_of_the_source ),
        cmocka_unit_test( the_drag_of_a_rigid_sphere_is_what_each_variant_says ),
        cmocka_unit_test( limited_drag_never_reverses_a_velocity ),
        cmocka_unit_test( the_outlet_speed_flow_and_thrust_have_the_magnitudes_of_the_specification ),
        cmocka_unit_test( the_jet_ends_at_ten_pascal_and_starts_again_only_above_fifty ),
        cmocka_unit_test( a_radial_jet_has_no_torque_and_an_offset_one_has_r_cross_f ),
        cmocka_unit_test( a_kick_adds_dt_tau_to_the_angular_momentum_and_nothing_to_the_momentum ),
        cmocka_unit_test( a_quaternion_stays_of_unit_length_and_its_angle_error_falls_with_dt_squared ),
        cmocka_unit_test( the_inertia_of_a_shell_is_two_thirds_m_r_squared ),
        cmocka_unit_test( a_singular_inertia_is_inverted_where_it_can_be ),
        cmocka_unit_test( a_triangle_without_area_and_a_cancelled_normal_are_counted_and_harmless ),
        cmocka_unit_test( a_mesh_without_one_inside_is_refused_with_the_edge_that_is_wrong ),
        cmocka_unit_test( parameters_out_of_range_are_refused_by_name ),
        cmocka_unit_test( winding_is_repaired_and_an_inside_out_mesh_is_turned ),
        cmocka_unit_test( a_fan_over_a_hole_restores_the_volume_of_a_cube ),
        cmocka_unit_test( the_virial_of_a_scaled_mesh_is_its_closed_form ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
