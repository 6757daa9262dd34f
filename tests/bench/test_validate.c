// The theory of `wisp validate` against numbers of the literature and against itself, and its overview. What solvers make of it is held to
// data/suites/validate/cases.yaml.
#include "unit.h"

#include "oracle/balloon_meshes.h"
#include "oracle/chain_theory.h"
#include "oracle/plate_theory.h"
#include "oracle/slender_theory.h"
#include "oracle/slip_theory.h"
#include "surfaces.h"
#include "validate/validate.h"
#include "validate/validate_balloons.h"
#include "validate/validate_bodies.h"

#include <math.h>
#include <stdlib.h>

static const double PI = VALIDATE_PI, HALF_PI = 0.5 * VALIDATE_PI;

static double difference( double value, double expected )
{
    return fabs( value / expected - 1.0 );
}

static void assert_near( double measured, double reference, double tolerance, const char* what )
{
    // written so that a NaN fails
    if ( !( fabs( measured - reference ) <= tolerance ) )
    {
        fail_msg( "%s: got %.9g, expected %.9g within %.3g", what, measured, reference, tolerance );
    }
}

// ---- slender bodies ----

TEST( critical_loads_are_those_of_the_literature )
{
    // Greenhill: 9/4 of the square of the first zero of the Bessel function J_(-1/3), 1.866350859
    assert_true( fabs( slender_column_load() - 2.25 * 1.866350859 * 1.866350859 ) < 1e-6 );
    // Timoshenko and Gere, Theory of Elastic Stability, section 6.3: 12.85
    assert_true( fabs( slender_blade_load() - 12.85 ) < 0.01 );
}

TEST( the_elastica_has_the_numbers_of_the_closed_form )
{
    // G, drop and reach of the length, by another integration in double
    static const double known[][3] = { { 1.0, 0.12347140, 0.99124640 },
                                       { 10.0, 0.70019972, 0.65635376 },
                                       { 100.0, 0.93752394, 0.15922338 } };
    for ( int i = 0; i < 3; ++i )
    {
        double points[5][2];
        elastica_lay_loaded( known[i][0], 0.0, 5, points );
        assert_true( fabs( -points[4][1] - known[i][1] ) < 1e-6 );
        assert_true( fabs( points[4][0] - known[i][2] ) < 1e-6 );
        assert_true( points[0][0] == 0.0 && points[0][1] == 0.0 );
    }
}

// Mattiasson 1981, Int. J. Numerical Methods in Engineering 17, by elliptic integrals: how far the end of a
// cantilever moves back and down, in lengths.
TEST( a_cantilever_with_an_end_load_bends_as_in_the_table_of_mattiasson )
{
    static const double rows[][3] = {
        { 0.2, 0.00265, 0.06636 }, { 1.0, 0.05643, 0.30172 }, { 2.0, 0.16064, 0.49346 },
        { 3.0, 0.25442, 0.60325 }, { 5.0, 0.38763, 0.71379 }, { 10.0, 0.55500, 0.81061 }
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        double points[2][2];
        elastica_lay_loaded( 0.0, rows[i][0], 2, points );
        assert_near( 1.0 - points[1][0], rows[i][1], 6e-6, "back" );
        assert_near( -points[1][1], rows[i][2], 6e-6, "down" );
    }
}

// sigma'' + ( M^2 / 4 - F - w ( 1 - s ) ) sigma = 0, sigma( 0 ) = 0. @return the first zero beyond
static double first_zero( double moment, double tension, double weight )
{
    const double h = 1.0 / 4000;
    double y = 0.0, v = 1.0, s = 0.0;
    while ( s < 2.0 )
    {
        // by the middle of each piece, which is of second order
        const double a = -( 0.25 * moment * moment - tension - weight * ( 1.0 - s - 0.5 * h ) );
        const double next = y + h * v + 0.5 * h * h * a * y, middle = y + 0.5 * h * v;
        if ( next <= 0.0 && s > 0.0 )
        {
            return s + h * y / ( y - next );
        }
        v += h * a * middle;
        y = next;
        s += h;
    }
    return s;
}

TEST( a_twisted_rod_is_straight_up_to_the_moment_of_greenhill )
{
    assert_near( rod_straight_moment( 0.0, 0.0 ), 2.0 * PI, 1e-12, "one turn without tension" );
    const double tensions[] = { 0.0, 20.0, 50.0 }, weights[] = { 0.0, 1.28, 3.2 };
    for ( int i = 0; i < WISP_COUNT( tensions ); ++i )
    {
        // the moment whose first zero is the other end
        double lower = 2.0 * sqrt( tensions[i] ), upper = 40.0;
        for ( int k = 0; k < 60; ++k )
        {
            const double middle = 0.5 * ( lower + upper );
            *( first_zero( middle, tensions[i], weights[i] ) > 1.0 ? &lower : &upper ) = middle;
        }
        // 0.0011 w^2 of the square of half of the moment is left out: 0.011 of 61 at most
        assert_near( rod_straight_moment( tensions[i], weights[i] ), lower, 2e-4 * lower, "moment" );
    }
}

// Goriely 2006, J. Elasticity 84: sqrt( 3 ) turns, for a rod as stiff against twist as against bending.
TEST( a_ring_stays_flat_up_to_the_twist_of_michell )
{
    assert_near( rod_ring_twist( 1.0 ) / ( 2.0 * PI ), 1.7320508, 1e-6, "turns" );
    assert_near( rod_ring_twist( 1.5 ) / ( 2.0 * PI ), 1.1547005, 1e-6, "turns" );
}

// The top of Kirchhoff (Love 1927): with the moment and the tension that the closed form gives, the
// angle falls from its largest value by theta'^2 = 4 F sin^2( theta / 2 ) - M^2 tan^2( theta / 2 ). Its shortening
// and what its ends turn beyond M / GJ are integrals of 1 - cos( theta ) and of M tan^2( theta / 2 ).
TEST( a_rod_that_writhes_is_a_top_of_kirchhoff )
{
    const double angles[] = { 0.5, 1.0, 1.25, 2.0 }, shortening = 0.1, ratio = 0.8;
    for ( int i = 0; i < WISP_COUNT( angles ); ++i )
    {
        const rod_writhe rod = rod_writhe_of( angles[i], shortening, ratio );
        const double half = cos( 0.5 * angles[i] );
        assert_near( rod.moment * rod.moment / ( 4.0 * rod.tension ), half * half, 1e-12,
                     "theta' at the largest angle" );

        // its derivative, theta'' = F sin( theta ) - M^2 / 2 tan( theta / 2 ) / cos^2( theta / 2 ), from the middle of
        // the rod outwards
        const double h = 2e-5 / sqrt( rod.tension );
        double theta = angles[i], rate = 0.0, shorter = 0.0, turned = 0.0;
        for ( int k = 0; k < 4000000 && theta > 1e-6 && rate <= 0.0; ++k )
        {
            const double t = tan( 0.5 * theta ), c = cos( 0.5 * theta );
            const double bend = rod.tension * sin( theta ) - 0.5 * rod.moment * rod.moment * t / ( c * c );
            const double middle = theta + 0.5 * h * rate, tangent = tan( 0.5 * middle );
            shorter += 2.0 * h * ( 1.0 - cos( middle ) );
            turned += 2.0 * h * rod.moment * tangent * tangent;
            theta += h * rate + 0.5 * h * h * bend;
            rate += h * bend;
        }
        assert_near( shorter, shortening, 1e-3 * shortening, "shortening" );
        assert_near( turned + rod.moment / ratio, rod.rotation, 1e-3 * rod.rotation, "rotation" );
    }
}

// With D = L / 10 and EI = GJ: 43.2 rad, and less to both sides.
TEST( the_limit_of_a_writhe_is_its_largest_rotation )
{
    const double limit = rod_writhe_limit( 0.1, 1.0 ).rotation;
    double most = 0.0;
    for ( double angle = 0.2; angle < 3.0; angle += 0.001 )
    {
        most = fmax( most, rod_writhe_of( angle, 0.1, 1.0 ).rotation );
    }
    assert_near( limit, most, 1e-4, "largest rotation, rad" );
    assert_true( limit >= most );
}

// One link that falls from the level: t = sqrt( 2 ) times the integral of 1 / sqrt( 1 - u^4 ) to sqrt( depth ), the
// arc of the lemniscate, and all energy is motion.
TEST( a_chain_of_one_link_is_a_pendulum )
{
    const double points[2][2] = { { 0.0, 0.0 }, { 1.0, 0.0 } };
    const int pieces = 1000;
    const double h = sqrt( 0.5 ) / pieces;
    double sum = 0.0;
    for ( int i = 0; i < pieces; ++i )
    {
        const double u = h * ( i + 0.5 );
        sum += h / sqrt( 1.0 - u * u * u * u );
    }
    chain_fall fall;
    assert_true( chain_fall_of_masses( 1, points, 0.5, 4000, &fall ) );
    assert_near( fall.time, sqrt( 2.0 ) * sum, 1e-6, "time" );
    assert_near( fall.speed, sqrt( 0.75 ), 1e-6, "speed downwards" ); // speed 1, at 30 degrees from the level
}

TEST( a_chain_of_masses_keeps_its_energy_and_its_lengths )
{
    double points[34][2];
    chain_fall coarse, fine;
    chain_fold( 33, points );
    assert_true( chain_fall_of_masses( 33, (const double( * )[2])points, 0.9, 2000, &coarse ) );
    assert_true( chain_fall_of_masses( 33, (const double( * )[2])points, 0.9, 4000, &fine ) );
    assert_near( coarse.time, fine.time, 1e-6, "time" );
    assert_near( coarse.speed, fine.speed, 1e-4, "speed" );
    assert_near( fine.energy_error, 0.0, 1e-7, "energy" );
    assert_near( fine.length_error, 0.0, 1e-7, "length" );
}

// Calkin and March 1989, American Journal of Physics 57: 0.847 of the time of free fall. Chains of more and narrower
// links come nearer.
TEST( a_folded_chain_falls_faster_than_a_stone )
{
    assert_near( chain_fall_continuous( 1.0 ).time / sqrt( 2.0 ), 0.847, 5e-4, "of free fall" );
    const chain_fall limit = chain_fall_continuous( 0.9 );
    assert_near( limit.speed, sqrt( 0.9 * 1.1 / 0.1 ), 1e-12, "speed" );
    double last = INFINITY;
    for ( int links = 17; links <= 65; links += 16 )
    {
        double points[66][2];
        chain_fall fall;
        chain_fold( links, points );
        assert_true( chain_fall_of_masses( links, (const double( * )[2])points, 0.9, 2000, &fall ) );
        assert_true( fall.time < sqrt( 1.8 ) && fall.time > limit.time && fall.time < last );
        last = fall.time;
    }
    assert_near( last, limit.time, 0.02, "time of 65 links" );
}

// ---- plates ----

static plate_theory_forces push( const void* context, double x, double y )
{
    (void)context, (void)x, (void)y;
    return ( plate_theory_forces ){ .xx = -1.0 };
}

static plate_theory_forces shear( const void* context, double x, double y )
{
    (void)context, (void)x, (void)y;
    return ( plate_theory_forces ){ .xy = 1.0 };
}

// A moment in the plane of a square.
static plate_theory_forces bend( const void* context, double x, double y )
{
    (void)context, (void)x;
    return ( plate_theory_forces ){ .xx = 2.0 * y };
}

// Timoshenko and Gere, Theory of Elastic Stability (1961), sections 9.2, 9.6 and 9.7: N = k pi^2 D / b^2 of a square hinged all round,
// k = 4 under pressure, 25.6 under bending and 9.34 under shear; the last two are of few terms.
TEST( hinged_squares_buckle_as_in_the_literature )
{
    const plate_theory_plate plate = { PLATE_HINGED_ALL_ROUND, 1.0, 0.3, 9, 9 };
    assert_true( difference( plate_theory_factor( &plate, push, NULL ), 4.0 * PI * PI ) < 1e-6 );
    assert_true( difference( plate_theory_factor( &plate, bend, NULL ), 25.6 * PI * PI ) < 0.005 );
    assert_true( difference( plate_theory_factor( &plate, shear, NULL ), 9.34 * PI * PI ) < 0.005 );
}

// With Poisson's ratio 0 a plate that is clamped at one end is Euler's column, at any width.
TEST( a_pressed_plate_is_the_column_of_euler )
{
    const plate_theory_plate plate = { PLATE_CLAMPED_AT_ONE_END, 0.7, 0.0, 9, 5 };
    assert_true( difference( plate_theory_factor( &plate, push, NULL ), PI * PI / 4.0 ) < 1e-6 );
}

// The weight beyond a cut is carried by the forces across it, whatever the material.
TEST( forces_in_the_plane_carry_the_weight_beyond_a_cut )
{
    enum
    {
        SLICES = 400
    };
    const double width = 0.5, x = 0.4, beyond = width * ( 1.0 - x );
    for ( int is_sideways = 0; is_sideways < 2; ++is_sideways )
    {
        plate_theory_weight* weight =
            plate_theory_weigh( width, plate_theory_isotropic( 0.3 ), is_sideways == 1, 13 );
        assert_non_null( weight );
        double along = 0.0, across = 0.0, moment = 0.0;
        for ( int i = 0; i < SLICES; ++i )
        {
            const double y = width * ( ( i + 0.5 ) / SLICES - 0.5 );
            const plate_theory_forces n = plate_theory_weight_forces( weight, x, y );
            along += n.xx * width / SLICES;
            across += n.xy * width / SLICES;
            moment += n.xx * y * width / SLICES;
        }
        plate_theory_destroy( weight );
        assert_true( fabs( along - ( is_sideways == 1 ? 0.0 : -beyond ) ) < 0.002 * beyond );
        assert_true( fabs( across - ( is_sideways == 1 ? -beyond : 0.0 ) ) < 0.002 * beyond );
        assert_true( fabs( moment - ( is_sideways == 1 ? 0.5 * beyond * ( 1.0 - x ) : 0.0 ) ) < 0.002 * beyond );
    }
}

// EI = D (1 - nu^2) W and GJ = 2 D (1 - nu) W of a narrow plate. The clamp hinders the warping of its end, which stiffens it in
// proportion to its width: two widths lead to the width 0.
TEST( a_narrow_plate_on_edge_is_the_blade_of_michell_and_prandtl )
{
    static const double ratios[] = { 0.0, 0.3 };
    for ( int i = 0; i < WISP_COUNT( ratios ); ++i )
    {
        const double nu = ratios[i];
        const plate_theory_membrane membrane = plate_theory_isotropic( nu );
        const double wide = plate_theory_load( 0.06, nu, membrane, true ),
                     narrow = plate_theory_load( 0.03, nu, membrane, true );
        const double blade = 12.85 * sqrt( 2.0 * ( 1.0 - nu ) * ( 1.0 - nu * nu ) );
        assert_true( difference( 2.0 * narrow - wide, blade ) < 0.003 );
        assert_true( wide > narrow && narrow > blade );
    }
}

// Bending to a cylinder has the rigidity D; a narrow plate is free to bend across too, which leaves D (1 - nu^2).
TEST( an_upright_plate_is_the_column_of_greenhill )
{
    static const double widths[] = { 0.25, 1.0, 2.0 };
    for ( int i = 0; i < WISP_COUNT( widths ); ++i )
    {
        const double load = plate_theory_load( widths[i], 0.0, plate_theory_isotropic( 0.0 ), false );
        assert_true( difference( load, slender_column_load() ) < 1e-4 );
    }
    const double narrow = plate_theory_load( 0.02, 0.3, plate_theory_isotropic( 0.3 ), false );
    assert_true( difference( narrow, 0.91 * slender_column_load() ) < 0.01 );
}

// The case compares with an isotropic sheet of Poisson's ratio 1/3 in its plane. Edges of implicit cloth on squares have the
// constants 1.25, 0.25 and 0.25 instead.
TEST( elasticity_in_the_plane_hardly_matters )
{
    static const double widths[] = { 0.05, 1.0 };
    const plate_theory_membrane squares = { 1.25, 0.25, 0.25 };
    for ( int i = 0; i < WISP_COUNT( widths ); ++i )
    {
        const double load = plate_theory_load( widths[i], 0.0, plate_theory_isotropic( 1.0 / 3.0 ), true );
        assert_true( difference( plate_theory_load( widths[i], 0.0, plate_theory_isotropic( 0.0 ), true ), load ) <
                     0.002 );
        assert_true( difference( plate_theory_load( widths[i], 0.0, squares, true ), load ) < 0.002 );
    }
}

// More polynomials can only lower a load found by Ritz, and these ones hardly do.
TEST( loads_have_settled )
{
    static const double widths[] = { 0.05, 1.0 };
    for ( int i = 0; i < WISP_COUNT( widths ); ++i )
    {
        const plate_theory_membrane membrane = plate_theory_isotropic( 1.0 / 3.0 );
        const plate_theory_plate more = { PLATE_CLAMPED_AT_ONE_END, widths[i], 0.0, 20, 8 };
        plate_theory_weight* weight = plate_theory_weigh( widths[i], membrane, true, 15 );
        assert_non_null( weight );
        const double settled = plate_theory_factor( &more, plate_theory_weight_forces, weight );
        plate_theory_destroy( weight );
        assert_true( difference( plate_theory_load( widths[i], 0.0, membrane, true ), settled ) < 0.001 );
    }
}

// ---- curls ----

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
    elastica_lay_loaded( 10.0, 0.0, 2, exact );
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

// ---- the bowed rod ----

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

// ---- sheets and fabrics ----

TEST( the_catenary_has_the_sag_of_tables_of_hyperbolic_functions )
{
    // with a = 1 and supports at x = -1 and 1 the length is 2 sinh 1 and the sag cosh 1 - 1
    const double length = 2.0 * 1.1752011936, sag = 0.5430806348;
    double middle[2], end[2], quarter[2];
    sheet_catenary( 2.0 / length, 0.5, middle );
    sheet_catenary( 2.0 / length, 1.0, end );
    // at arc length sinh 0.5 from the middle x is 0.5
    sheet_catenary( 2.0 / length, 0.5 + 0.5210953055 / length, quarter );
    assert_true( fabs( middle[0] ) < 1e-9 && fabs( middle[1] + sag / length ) < 1e-9 );
    assert_true( fabs( end[0] - 1.0 / length ) < 1e-9 && fabs( end[1] ) < 1e-9 );
    assert_true( fabs( quarter[0] - 0.5 / length ) < 1e-9 );
}

TEST( friction_holds_below_its_angle_and_lets_slide_above )
{
    const double degree = PI / 180.0;
    // 30 degrees: half of g without friction; atan( 0.5 ) is 26.565 degrees
    assert_true( fabs( sheet_slide( 9.81, 30.0 * degree, 0.0 ) - 4.905 ) < 1e-9 );
    assert_true( sheet_slide( 9.81, 26.56 * degree, 0.5 ) <= 0.0 );
    assert_true( sheet_slide( 9.81, 26.57 * degree, 0.5 ) > 0.0 );
    assert_true( sheet_slide( 9.81, 26.57 * degree, 0.5 ) < 2e-3 );
}

// T( pi ) by Heun's method in 4000 pieces, which leaves 1e-7.
TEST( a_rope_is_held_by_the_law_of_the_capstan )
{
    const double sides[][3] = { { 0.4, 0.6, 0.103 }, { 0.3, 0.7, 0.103 }, { 0.2, 0.8, 0.103 }, { 0.3, 0.7, 0.0 } };
    const double expected[] = { 0.1018, 0.2093, 0.3306, 0.2697 };
    const double piece = acos( -1.0 ) / 4000.0;
    for ( int i = 0; i < WISP_COUNT( sides ); ++i )
    {
        const double mu = sheet_capstan( sides[i][0], sides[i][1], sides[i][2] );
        double tension = sides[i][0], rate = sides[i][2] + mu * tension;
        for ( int k = 0; k < 4000; ++k )
        {
            const double a = piece * ( k + 1 ), guess = tension + piece * rate;
            const double next = sides[i][2] * cos( a ) + mu * ( guess + sides[i][2] * sin( a ) );
            tension += 0.5 * piece * ( rate + next );
            rate = sides[i][2] * cos( a ) + mu * ( tension + sides[i][2] * sin( a ) );
        }
        assert_true( fabs( tension - sides[i][1] ) < 1e-6 );
        assert_true( fabs( mu - expected[i] ) < 1e-4 );
    }
}

TEST( a_fall_through_air_begins_as_a_free_one_and_ends_at_its_terminal_speed )
{
    const double terminal = sheet_terminal_speed( 2.0, 1.25, 0.8, 4.0 );
    assert_true( fabs( terminal - 1.0 ) < 1e-12 ); // 1/2 1.25 0.8 4 = 2
    assert_true( fabs( sheet_fall_speed( terminal, 10.0, 1e-3 ) - 1e-2 ) < 1e-6 );
    assert_true( fabs( sheet_fall_speed( terminal, 10.0, 0.1 ) - 0.7615941560 ) < 1e-9 ); // tanh 1
}

TEST( a_strip_of_twice_the_bending_length_hangs_at_the_angle_of_the_flexometer )
{
    // Peirce 1930: c is half of the overhang whose chord is 41.5 degrees below level. Its cube over c^3 is G = 8
    const double c = sheet_bending_length( 1.0e-5, 1.25 );
    double exact[2][2];
    elastica_lay_loaded( pow( 2.0 * c, 3.0 ) * 1.25 / 1.0e-5, 0.0, 2, exact );
    assert_true( fabs( atan2( -exact[1][1], exact[1][0] ) * 180.0 / PI - 41.5 ) < 1.0 );
}

TEST( the_regression_of_cusick_is_worked_by_hand )
{
    // c = 2 cm, A = 20 degrees: 71.2 - 14.44 - 51.8 + 18.44 + 17
    assert_true( fabs( sheet_cusick( 2.0, 20.0 ) - 40.4 ) < 1e-9 );
    const double softest = sheet_cusick_softest();
    assert_true( sheet_cusick( 2.0, softest ) < sheet_cusick( 2.0, softest - 1.0 ) );
    assert_true( sheet_cusick( 2.0, softest ) < sheet_cusick( 2.0, softest + 1.0 ) );
}

// ---- specimens ----

static double area_from_above( const wisp_mesh* mesh )
{
    double sum = 0.0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* v = mesh->triangles + 3 * t;
        const wisp_vec3 a = mesh->points[v[0]], b = mesh->points[v[1]], c = mesh->points[v[2]];
        const double area =
            0.5 * ( (double)( b.z - a.z ) * (double)( c.x - a.x ) - (double)( b.x - a.x ) * (double)( c.z - a.z ) );
        assert_true( area > 0.0 );
        sum += area;
    }
    return sum;
}

TEST( a_specimen_covers_its_ring_once_and_its_shadow_counts_layers_once )
{
    for ( int turn = 1; turn <= 2; ++turn )
    {
        wisp_mesh mesh;
        int pins = 0;
        assert_int_equal( disc_mesh( DRAPE_DISC, DRAPE_CLOTH, 8, turn, &mesh, &pins, NULL ), WISP_OK );
        const double inner = DRAPE_DISC - ( DRAPE_CLOTH - DRAPE_DISC ) / 8.0;
        // polygons of some hundred sides: less than 0.2 % of the ring is missing
        const double ring = PI * ( DRAPE_CLOTH * DRAPE_CLOTH - inner * inner );
        assert_true( fabs( area_from_above( &mesh ) / ring - 1.0 ) < 2e-3 );
        const double overhang = PI * ( DRAPE_CLOTH * DRAPE_CLOTH - DRAPE_DISC * DRAPE_DISC );
        assert_true( fabs( disc_shadow( &mesh, mesh.points, DRAPE_DISC, DRAPE_CLOTH ) / overhang - 1.0 ) < 3e-3 );
        for ( int i = 0; i < pins; ++i )
        {
            assert_true( hypot( (double)mesh.points[i].x, (double)mesh.points[i].z ) < DRAPE_DISC + 1e-6 );
        }
        // folded in the middle, two layers have the shadow of one, but for the triangles that the fold crosses
        for ( int i = 0; i < mesh.vertex_count; ++i )
        {
            mesh.points[i].z = fabsf( mesh.points[i].z );
        }
        assert_true( fabs( disc_shadow( &mesh, mesh.points, DRAPE_DISC, DRAPE_CLOTH ) / overhang - 0.5 ) < 0.02 );
        wisp_mesh_release( &mesh );
    }
}

TEST( fabrics_have_the_units_of_their_source )
{
    // cotton broad: 0.118 gf cm is 11.57 uN m, and 12.38 mg / cm^2 is 123.8 g / m^2
    const drape_fabric* cotton = drape_fabrics + DRAPE_FABRICS - 1;
    assert_true( fabs( drape_rigidity( cotton ) - 11.572e-6 ) < 1e-9 );
    assert_true( fabs( drape_density( cotton ) - 0.1238 ) < 1e-9 );
}

// ---- balloons ----

TEST( a_mylar_balloon_has_the_sizes_of_the_literature )
{
    // Mladenov and Oprea 2003: r = 0.7627 a, thickness 0.5991 diameters, V = 1.2185 a^3; Paulsen 1994: thickness 0.9139 a
    const balloon_theory_mylar exact = balloon_theory_mylar_shape();
    assert_true( fabs( exact.radius - 0.7627 ) < 1e-4 );
    assert_true( fabs( exact.thickness - 0.9139 ) < 1e-4 );
    assert_true( fabs( exact.thickness / ( 2.0 * exact.radius ) - 0.5991 ) < 1e-4 );
    assert_true( fabs( exact.volume - 1.2185 ) < 1e-4 );
}

static double constant_pressure( const void* context, double gas_volume )
{
    (void)gas_volume;
    return *(const double*)context;
}

// p = 1000 V_0, until 0
static double linear_pressure( const void* context, double gas_volume )
{
    return *(const double*)context * gas_volume;
}

// At one pressure all gas leaves with one speed, so momentum is its mass times that. 0.01 m^3 of 2 kg/m^3 at 100 Pa: 10 m/s, and 0.2 N s.
TEST( a_jet_of_constant_pressure_gives_the_momentum_of_its_gas )
{
    const double pressure = 100.0;
    const balloon_theory_jet jet = { constant_pressure, &pressure, 2.0, 0.5, 1e-4 };
    const balloon_theory_flow flow = balloon_theory_empty( &jet, 0.03, 0.02 );
    assert_true( fabs( flow.speed - 0.4 ) < 1e-9 );
    assert_true( fabs( flow.seconds - 10.0 ) < 1e-9 );
}

// A tank whose pressure falls with its content drains like Torricelli's: the last drop takes as long as if the flow of the start had
// gone on for twice the time.
TEST( a_tank_drains_in_twice_the_time_of_its_first_flow )
{
    const double slope = 1000.0;
    const balloon_theory_jet jet = { linear_pressure, &slope, 2.0, 0.5, 1e-4 };
    const balloon_theory_flow flow = balloon_theory_empty( &jet, 0.1, 0.0 );
    assert_true( fabs( flow.seconds - 2.0 * 0.1 / ( 1e-4 * 10.0 ) ) < 1e-6 );
    assert_true( fabs( flow.speed - 2.0 / 3.0 * 2.0 * 0.1 * 10.0 / 0.5 ) < 1e-6 );
}

// The integral of each law over a sphere, by rings.
TEST( laws_of_drag_have_their_factor_on_a_sphere )
{
    enum
    {
        RINGS = 20000,
    };
    double sums[BALLOON_THEORY_DRAG_COUNT] = { 0.0 };
    for ( int i = 0; i < RINGS; ++i )
    {
        const double angle = PI * ( i + 0.5 ) / RINGS, c = cos( angle ), area = 2.0 * sin( angle ) * PI / RINGS;
        sums[BALLOON_THEORY_DRAG_MAX] += fmax( 0.0, c ) * area;
        sums[BALLOON_THEORY_DRAG_ABS] += fabs( c ) * area;
        sums[BALLOON_THEORY_DRAG_SIGNED] += c * area;
        sums[BALLOON_THEORY_DRAG_NORMAL] += c * c * area;
    }
    for ( int law = 0; law < BALLOON_THEORY_DRAG_COUNT; ++law )
    {
        assert_true( fabs( sums[law] - balloon_theory_drag_factor( (balloon_theory_drag)law ) ) < 1e-6 );
    }
}

// A sphere of 1 m^2 frontal area and C = 1 in air of 2 kg/m^3: 9 N at 3 m/s.
TEST( drag_holds_a_force_at_the_terminal_speed )
{
    assert_true( fabs( balloon_theory_terminal_speed( 9.0, 2.0, 1.0, sqrt( 1.0 / PI ) ) - 3.0 ) < 1e-12 );
}

TEST( a_full_sphere_holds_the_pressure_of_its_gas )
{
    const balloon_theory_sphere sphere = { 0.15, 2000.0, 20.0, 101325.0, 1.2 };
    const double s = balloon_theory_sphere_scale( &sphere );
    // Boyle: p V = P_atm V_0
    const double pressure = balloon_theory_sphere_pressure( &sphere, s );
    assert_true( fabs( ( pressure + 101325.0 ) * s * s * s / ( 101325.0 * 1.2 ) - 1.0 ) < 1e-12 );
    // docs/methods.md: a sphere at 1.2 volumes reads 2.42 kPa, on a mesh whose links differ by a few percent
    assert_true( fabs( pressure / 2420.0 - 1.0 ) < 0.05 );
}

// ---- the foil ----

TEST( foils_are_closed_and_have_the_volume_between_two_parabolas )
{
    for ( int mesh = 0; mesh < VALIDATE_FOIL_COUNT; ++mesh )
    {
        const validate_foil foil = { (validate_foil_mesh)mesh, 24, 0.2, 0.01 };
        wisp_mesh made = { 0 };
        wisp_mesh_diagnostics report;
        wisp_error error = { 0 };
        assert_ok( validate_foil_make( &foil, &made, &error ), error );
        assert_ok( wisp_mesh_examine( &made, &report, &error ), error );
        assert_ok( wisp_mesh_require( &report,
                                      WISP_MESH_CLOSED | WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN,
                                      "foil", &error ),
                   error );
        // pi a^2 h; polygons and chords lack some parts in 24^2
        assert_true( fabs( report.volume / ( PI * 0.04 * 0.01 ) - 1.0 ) < 0.005 );
        assert_true( made.points[validate_foil_pole( &foil )].y == -made.points[0].y );
        for ( int i = validate_foil_rim( &foil ); i < made.vertex_count; ++i )
        {
            assert_true( fabs( hypot( (double)made.points[i].x, (double)made.points[i].z ) - 0.2 ) < 1e-6 );
        }
        wisp_mesh_release( &made );
    }
}

// ---- the overview ----

static void put_row( results* all, const char* variant, double error, double other, double ms )
{
    results_row* row = results_add_row( all, "accuracy.x", variant );
    assert_non_null( row );
    row->ms_median = ms;
    if ( isfinite( error ) )
    {
        results_put( &row->error, "error", error );
    }
    results_put( &row->error, "other", other );
}

// Of a solver with several settings the least error counts, and one without an error is no error of 0.
TEST( an_overview_has_the_least_and_the_largest_error_of_each_solver )
{
    results all = { .failed = false };
    char summary[400];
    const int table = validate_begin_overview( &all );
    put_row( &all, "rod, 4 cells", 9.0, 0.1, 1.0 );
    put_row( &all, "rod, 8 cells", 2.0, 0.1, 3.0 );
    put_row( &all, "rod, 16 cells", NAN, 0.1, 5.0 );
    put_row( &all, "cloth, 4 cells", 50.0, 0.1, 7.0 );
    put_row( &all, "hair, 4 cells", NAN, 0.1, 7.0 );
    validate_add_to_overview( table, "x", 0, &all );
    validate_end_overview( table, &all, summary, sizeof summary );
    const char* const expected[3][6] = {
        { "x", "rod", "2", "9; 1 of 3 without", "3", "rod, 8 cells" },
        { "x", "cloth", "50", "50", "7", "cloth, 4 cells" },
        { "x", "hair", "-", "-; 1 of 1 without", "-", "-" },
    };
    assert_int_equal( all.tables[table].row_count, 4 );
    for ( int i = 0; i < 18; ++i )
    {
        assert_string_equal( results_cell( all.tables + table, 1 + i / 6, i % 6 ), expected[i / 6][i % 6] );
    }
    assert_non_null( strstr( summary, "1 of 3 lines" ) );
    assert_non_null( strstr( summary, "not `x` by cloth (50), `x` by hair (-)." ) );
    results_free( &all );
}

TEST( each_case_says_what_it_tests_and_where_its_answer_is_from )
{
    static const char* const keys[] = { "tests", "leaves out", "theory", "source" };
    int count;
    const validate_case* const* cases = validate_cases( &count );
    wisp_error error = { 0 };
    text_node* said;
    assert_ok( validate_read( &said, &error ), error );
    assert_int_equal( said->count, count );
    for ( int i = 0; i < count; ++i )
    {
        for ( int k = 0; k < WISP_COUNT( keys ); ++k )
        {
            assert_true( text_at( text_find( said, cases[i]->name ), keys[k] )[0] != '\0' );
        }
    }
    text_release( said );
}
