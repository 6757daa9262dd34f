// Printed forms of the balloon paper beside their resolution: laws of drag, the drift of spin, the printed spin. Closed forms and
// momentum hold the engine, and with it the oracle, in test_balloon_*.c. Numbers of equations, figures and sections are those of the balloon paper (docs/methods.md).
#include "oracle_support.h"

#include "oracle/balloon_meshes.h"
#include "oracle/balloon_oracle.h"

static const uint64_t random_seed = 22;

static balloon_mesh new_sphere( int level, double radius )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, level, radius ) );
    return mesh;
}

static double air_density( void )
{
    return balloon_oracle_density( 101325.0, BALLOON_ORACLE_AIR, 293.15 );
}

static double3 sphere_drag( const balloon_mesh* mesh, balloon_oracle_drag drag, double3 v )
{
    size_t n = (size_t)mesh->vertex_count;
    SCOPED( free_local ) double3* normal = calloc( n, sizeof( double3 ) );
    SCOPED( free_local ) double* area = calloc( n, sizeof( double ) );
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
    return sum;
}

// Eq. 11
TEST( the_drag_of_a_rigid_sphere_is_what_each_variant_says )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = new_sphere( 4, 0.15 );
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
}

// An asymmetric body whose outlet is off its axis.
static balloon_oracle new_pear( double3 outlet_direction, const balloon_oracle_options* options )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh;
    balloon_oracle body;
    wisp_error error = { 0 };
    assert_true( balloon_mesh_pear( &mesh, 2, 0.15 ) );
    const int outlet = balloon_mesh_farthest( &mesh, outlet_direction );
    assert_ok( balloon_oracle_create_from_mesh( &mesh, 0.02, outlet, options, &body, &error ), error );
    return body;
}

static balloon_oracle_options without_surroundings( void )
{
    balloon_oracle_options options = balloon_oracle_default_options();
    options.use_gravity = options.use_buoyancy = options.use_drag = false;
    return options;
}

static void steps( balloon_oracle* body, int count )
{
    for ( int n = 0; n < count; ++n )
    {
        balloon_oracle_step( body );
    }
}

static double3 body_centre( const balloon_oracle* body )
{
    return balloon_oracle_centre( body->x, body->mass, body->vertex_count );
}

static double3 body_angular_momentum( const balloon_oracle* body )
{
    return balloon_oracle_angular_momentum( body->x, body->v, body->mass, body->vertex_count, body_centre( body ) );
}

// The printed form turns positions and keeps velocities, so the particles do not receive the spin
TEST( the_printed_spin_turns_positions_and_gives_hardly_any_angular_momentum )
{
    double momentum[2];
    for ( int mode = 0; mode < 2; ++mode )
    {
        balloon_oracle_options options = without_surroundings();
        options.spin = mode == 0 ? BALLOON_ORACLE_SPIN_KICK : BALLOON_ORACLE_SPIN_PRINTED;
        options.outlet_open = true;
        SCOPED( balloon_oracle_destroy ) balloon_oracle body = new_pear( double3_make( 1.0, 0.3, 0.2 ), &options );
        body.gas_volume = 1.2 * body.rest_volume;
        steps( &body, 10 );
        assert_true( double3_length( body.omega ) > 1.0 );
        assert_true( balloon_oracle_angle( body.q ) > 0.1 );
        momentum[mode] = double3_length( body_angular_momentum( &body ) );
    }
    // the remainder comes from the skin, which swings while it empties; measured 0.10 of the kick's
    assert_true( momentum[1] < 0.2 * momentum[0] );
}
