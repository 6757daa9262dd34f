// The theory of suspended curls and of bowed rods on a rough floor, and what rods and strips of the engine make of it.
#include "unit.h"

#include "validate/validate_bodies.h"
#include "oracle/slender_theory.h"
#include "oracle/slip_theory.h"
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HALF_PI 1.5707963267948966

// ---- theory of curls ----

// Without a curl it is a column that stands on its clamp, whatever its twist. It is made stiffer in the plane, in which it would give way
// at the same weight. Greenhill 1881: 9/4 of the square of the first zero of the Bessel function J_(-1/3), 1.866350859.
TEST( a_straight_rod_upside_down_is_the_column_of_greenhill )
{
    const double greenhill = 2.25 * 1.866350859 * 1.866350859;
    for ( double twist = 0.5; twist < 3.0; twist *= 2.0 )
    {
        const curl_rod rod = { .weight = -10.0, .twist = twist, .in_plane = 2.0 };
        assert_true( fabs( curl_critical_weight( &rod ) + greenhill ) < 1e-6 );
    }
}

// Level and very stiff in the plane it is the blade of Michell and Prandtl (1899): rho g L^3 = 12.85 sqrt( EI GJ ).
TEST( a_level_stiff_rod_is_the_blade_of_michell_and_prandtl )
{
    for ( double twist = 0.5; twist < 3.0; twist *= 2.0 )
    {
        const curl_rod rod = { .weight = 30.0, .twist = twist, .in_plane = 1e6, .clamp = HALF_PI };
        assert_true( fabs( curl_critical_weight( &rod ) / sqrt( twist ) - 12.85 ) < 0.01 );
    }
}

TEST( a_level_straight_rod_is_the_heavy_elastica )
{
    const curl_rod rod = { .weight = 10.0, .twist = 1.0, .in_plane = 1.0, .clamp = HALF_PI };
    curl_shape shape;
    double exact[2][2];
    elastica_lay( 10.0, 2, exact );
    assert_true( curl_hang( &rod, &shape ) );
    assert_true( hypot( shape.aside - exact[1][0], shape.down + exact[1][1] ) < 1e-6 );
}

// To first order in the weight, theta( 1 ) = curl - G times the integral of s (1 - s) sin( curl s ), which has a closed form.
TEST( a_light_curl_follows_its_perturbation )
{
    const double curl = 5.0, weight = 1e-4;
    const double slope = 2.0 * ( 1.0 - cos( curl ) ) / pow( curl, 3.0 ) - sin( curl ) / ( curl * curl );
    const curl_rod rod = { .curl = curl, .weight = weight, .twist = 1.0, .in_plane = 1.0 };
    curl_shape shape;
    assert_true( curl_hang( &rod, &shape ) );
    assert_true( fabs( ( curl - shape.theta[CURL_PIECES] ) / weight - slope ) < 1e-4 );
}

// ---- the energy of a discrete rod, without any expansion ----

enum
{
    LINKS = 64,
    FREEDOMS = 2 * LINKS,
};

typedef struct frame
{
    double m[3][3]; // columns: tangent, normal in the plane, normal of the plane; rows: down, aside, out
} frame;

// The plane's frame at an angle, turned by phi about its tangent and beta about its normal: the rotation of Rodrigues.
static frame turned( double theta, double beta, double phi )
{
    const double angle = hypot( beta, phi ), c = cos( angle ), s = angle > 0.0 ? sin( angle ) / angle : 1.0;
    const double k = angle > 0.0 ? ( 1.0 - c ) / ( angle * angle ) : 0.5;
    const double own[3][3] = { { c + k * phi * phi, k * phi * beta, s * beta },
                               { k * phi * beta, c + k * beta * beta, -s * phi },
                               { -s * beta, s * phi, c } };
    const double base[3][3] = { { cos( theta ), -sin( theta ), 0.0 },
                                { sin( theta ), cos( theta ), 0.0 },
                                { 0.0, 0.0, 1.0 } };
    frame out = { { { 0.0 } } };
    for ( int i = 0; i < 27; ++i )
    {
        out.m[i / 9][i / 3 % 3] += base[i / 9][i % 3] * own[i % 3][i / 3 % 3];
    }
    return out;
}

// Bending and twist from one frame to the next, which is `length` away: half of length times strain, stiffness, strain.
static double strain_energy( const frame* a, const frame* b, double length, const curl_rod* rod )
{
    double r[3][3] = { { 0.0 } };
    for ( int i = 0; i < 27; ++i )
    {
        r[i / 9][i / 3 % 3] += a->m[i % 3][i / 9] * b->m[i % 3][i / 3 % 3];
    }
    // the logarithm of the rotation
    const double axis[3] = { r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1] };
    const double sine = 0.5 * sqrt( axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] );
    const double angle = atan2( sine, 0.5 * ( r[0][0] + r[1][1] + r[2][2] - 1.0 ) );
    const double scale = sine > 0.0 ? 0.5 * angle / sine / length : 0.5 / length;
    const double twist = scale * axis[0], across = scale * axis[1], in_plane = scale * axis[2] - rod->curl;
    return 0.5 * length * ( rod->twist * twist * twist + across * across + rod->in_plane * in_plane * in_plane );
}

static double energy_of( const curl_rod* rod, const curl_shape* shape, const double* q )
{
    const double h = 1.0 / LINKS;
    frame before = turned( shape->theta[0], 0.0, 0.0 );
    double energy = 0.0;
    for ( int i = 0; i < LINKS; ++i )
    {
        const int middle = ( 2 * i + 1 ) * CURL_PIECES / ( 2 * LINKS );
        const frame now = turned( shape->theta[middle], q[2 * i], q[2 * i + 1] );
        energy += strain_energy( &before, &now, i == 0 ? 0.5 * h : h, rod );
        energy -= rod->weight * h * ( 1.0 - ( i + 0.5 ) * h ) * now.m[0][0];
        before = now;
    }
    return energy;
}

// Whether the matrix of second differences of the energy has a negative pivot.
static bool can_fall( const curl_rod* rod, const curl_shape* shape )
{
    static double matrix[FREEDOMS][FREEDOMS];
    const double step = 1e-3;
    double q[FREEDOMS] = { 0.0 };
    for ( int i = 0; i < FREEDOMS; ++i )
    {
        for ( int k = i; k < FREEDOMS; ++k )
        {
            double corner[4] = { 0.0 };
            for ( int c = 0; c < 4 && k - i < 4; ++c )
            {
                q[i] += c & 1 ? step : -step;
                q[k] += c & 2 ? step : -step;
                corner[c] = energy_of( rod, shape, q );
                q[i] = q[k] = 0.0;
            }
            matrix[i][k] = matrix[k][i] = ( corner[3] + corner[0] - corner[1] - corner[2] ) / ( 4.0 * step * step );
        }
    }
    for ( int i = 0; i < FREEDOMS; ++i )
    {
        if ( matrix[i][i] < 0.0 )
        {
            return true;
        }
        for ( int k = i + 1; k < FREEDOMS; ++k )
        {
            const double factor = matrix[k][i] / matrix[i][i];
            for ( int j = i; j < FREEDOMS && factor != 0.0; ++j )
            {
                matrix[k][j] -= factor * matrix[i][j];
            }
        }
    }
    return false;
}

// The weight at which the discrete rod becomes unstable is within 1 % of Jacobi's condition: 64 links leave 0.3 %.
TEST( the_energy_of_a_discrete_rod_loses_its_minimum_at_the_critical_weight )
{
    static const double curls[] = { 7.0, 9.0, 11.0 };
    for ( int i = 0; i < WISP_COUNT( curls ); ++i )
    {
        curl_rod rod = { .curl = curls[i], .weight = 50.0, .twist = 2.0 / 3.0, .in_plane = 1.0 };
        const double critical = curl_critical_weight( &rod );
        curl_shape shape;
        rod.weight = 0.99 * critical;
        assert_true( curl_hang( &rod, &shape ) && shape.modes == 0 );
        assert_false( can_fall( &rod, &shape ) );
        rod.weight = 1.01 * critical;
        assert_true( curl_hang( &rod, &shape ) && shape.modes == 1 );
        assert_true( can_fall( &rod, &shape ) );
    }
}

// ---- theory of the bowed rod ----

// Near its straight state the rod carries the first load of a column between a clamp and a hinge, the square of the first root of tan q =
// q, 4.493409458, and the ratio of its forces is the angle of its tip over 1 + sqrt( 1 + q^2 ) (Timoshenko and Gere 1961, section 2.2).
TEST( a_rod_that_hardly_bows_has_the_load_of_a_column )
{
    const double q = 4.493409458;
    slip_shape shape;
    assert_true( slip_stand( 0.9999, 0.0, &shape ) );
    assert_true( fabs( -shape.force[0] / ( q * q ) - 1.0 ) < 1e-3 );
    assert_true( fabs( shape.ratio / fabs( shape.theta[SLIP_PIECES] ) * ( 1.0 + sqrt( 1.0 + q * q ) ) - 1.0 ) <
                 1e-3 );
}

// Angles of the elastica in elliptic integrals (Love 1927, article 263). With psi from the direction of the force, sin( psi / 2 ) = k
// sin( phi ) and phi' = sqrt( F ) sqrt( 1 - k^2 sin^2 phi ). From the clamp psi rises to its largest at phi = pi / 2, where the rod is straight,
// and falls to its smallest at 3 pi / 2, which is the tip. Integrated over phi, the rod has its length, and its tip the place along the force.
TEST( the_bowed_rod_obeys_the_elliptic_integrals )
{
    enum
    {
        STEPS = 2000,
    };
    for ( double height = 0.6; height < 0.95; height += 0.1 )
    {
        slip_shape shape;
        assert_true( slip_stand( height, 0.0, &shape ) );
        const double force = hypot( shape.force[0], shape.force[1] );
        // in which the rod presses the floor
        const double direction = atan2( -shape.force[1], -shape.force[0] );
        const double k = sin( 0.5 * fabs( shape.theta[SLIP_PIECES] - direction ) );
        const double begin = asin( sin( -0.5 * direction ) / k ), h = ( 3.0 * HALF_PI - begin ) / STEPS;
        double length = 0.0, along = 0.0;
        for ( int i = 0; i < STEPS; ++i )
        {
            const double sine = k * sin( begin + ( i + 0.5 ) * h ), root = sqrt( 1.0 - sine * sine );
            length += h / root / sqrt( force );
            along += h * ( 2.0 * root - 1.0 / root ) / sqrt( force );
        }
        assert_true( fabs( length - 1.0 ) < 1e-5 );
        assert_true( fabs( along - height * cos( direction ) ) < 1e-5 );
    }
}

// ---- the engine ----

static wisp_vec3 tip_of( validate_bodies* bodies, int body )
{
    wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
    assert_int_equal( validate_tip( bodies, body, &tip, NULL ), WISP_OK );
    return tip;
}

// Four percent below the critical weight a curl swings back into its plane, eight above it does not: 32 cells with 64 substeps leave 2 %.
TEST( a_curl_stays_in_its_plane_below_its_weight_and_leaves_it_above )
{
    enum
    {
        CELLS = 32,
    };
    const curl_rod rod = { .curl = 7.0, .weight = 50.0, .twist = 2.0 / 3.0, .in_plane = 1.0 };
    const double critical = curl_critical_weight( &rod ), loads[] = { 0.96 * critical, 1.08 * critical };
    const double slow = validate_frequency( critical );
    validate_point shapes[2 * ( CELLS + 1 )] = { { 0.0, 0.0 } };
    for ( int i = 0; i < CELLS; ++i )
    {
        const double angle = rod.curl * ( i + 0.5 ) / CELLS;
        shapes[i + 1].x = shapes[i].x + cos( angle ) / CELLS;
        shapes[i + 1].y = shapes[i].y + sin( angle ) / CELLS;
    }
    memcpy( shapes + CELLS + 1, shapes, ( CELLS + 1 ) * sizeof *shapes );
    const validate_def def = {
        .solver = VALIDATE_ROD,
        .cells = CELLS,
        .substeps = 64,
        .workers = 1,
        .count = 2,
        .loads = loads,
        .gravity = { 9.81f, 0.0f, 0.0f },
        .damping = 2.0 * slow,
        .shapes = shapes,
        .is_curled = true,
        .twist_ratio = rod.twist,
    };
    validate_bodies bodies;
    accuracy_run out = { .ms = NULL };
    double start[2];
    assert_int_equal( validate_create( &def, &bodies, NULL ), WISP_OK );
    assert_int_equal( validate_step_for( &bodies, 5.0 / slow, &out, NULL ), WISP_OK );
    assert_int_equal( validate_turn_gravity( &bodies, ( wisp_vec3 ){ 9.81f, 0.0f, 0.2f }, NULL ), WISP_OK );
    assert_int_equal( validate_step_for( &bodies, 1.0 / slow, &out, NULL ), WISP_OK );
    assert_int_equal( validate_turn_gravity( &bodies, def.gravity, NULL ), WISP_OK );
    assert_int_equal( validate_step_for( &bodies, 1.0 / slow, &out, NULL ), WISP_OK );
    for ( int i = 0; i < 2; ++i )
    {
        start[i] = fabs( (double)tip_of( &bodies, i ).z );
        assert_true( start[i] > 1e-4 * VALIDATE_LENGTH );
    }
    assert_int_equal( validate_step_for( &bodies, 15.0 / slow, &out, NULL ), WISP_OK );
    assert_true( fabs( (double)tip_of( &bodies, 0 ).z ) < 0.5 * start[0] );
    assert_true( fabs( (double)tip_of( &bodies, 1 ).z ) > 2.0 * start[1] );
    validate_release( &bodies );
    free( out.ms );
}

// Ten percent below the critical friction a tip slips and goes on, ten above it sticks, at two heights of the clamp: 8 cells leave 4 %. Cloth
// moves by 0.0002 before it sticks.
TEST( every_solver_slips_below_the_critical_friction_and_sticks_above )
{
    enum
    {
        CELLS = 8,
    };
    static const double heights[] = { 0.9, 0.75 };
    for ( int i = 0; i < VALIDATE_SOLVER_COUNT * WISP_COUNT( heights ); ++i )
    {
        const double height = heights[i % WISP_COUNT( heights )];
        const double loads[] = { 10.0, 10.0 }, floors[] = { height, height };
        validate_point shapes[2 * ( CELLS + 1 )];
        slip_shape shape;
        assert_true( slip_stand( height, 0.0, &shape ) );
        assert_int_equal( validate_slip_lay( height, CELLS, shapes, NULL ), WISP_OK );
        memcpy( shapes + CELLS + 1, shapes, ( CELLS + 1 ) * sizeof *shapes );
        const validate_def def = {
            .solver = (validate_solver)( i / WISP_COUNT( heights ) ),
            .cells = CELLS,
            .substeps = 16,
            .workers = 1,
            .count = 2,
            .loads = loads,
            .damping = 4.0 * validate_frequency( loads[0] ),
            .shapes = shapes,
            .floors = floors,
            .friction = 10.0,
        };
        const double mu[] = { 0.9 * shape.ratio, 1.1 * shape.ratio };
        validate_bodies bodies;
        accuracy_run out = { .ms = NULL };
        double start[2], slip[2];
        assert_int_equal( validate_create( &def, &bodies, NULL ), WISP_OK );
        assert_int_equal( validate_step_for( &bodies, 0.3, &out, NULL ), WISP_OK );
        for ( int k = 0; k < 2; ++k )
        {
            start[k] = (double)tip_of( &bodies, k ).y / VALIDATE_LENGTH;
            assert_true( fabs( (double)tip_of( &bodies, k ).x / VALIDATE_LENGTH - height ) < 1e-3 );
        }
        assert_int_equal( validate_set_friction( &bodies, mu, NULL ), WISP_OK );
        assert_int_equal( validate_step_for( &bodies, 0.3, &out, NULL ), WISP_OK );
        for ( int k = 0; k < 2; ++k )
        {
            slip[k] = start[k] - (double)tip_of( &bodies, k ).y / VALIDATE_LENGTH;
        }
        assert_true( slip[0] > 0.005 );
        assert_true( fabs( slip[1] ) < 5e-4 );
        validate_release( &bodies );
        free( out.ms );
    }
}
