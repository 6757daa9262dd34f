// The theory of rods and chains of `wisp validate` against the literature and against itself, and a result of each
// of their cases.
#include "accuracy_scenes.h"

#include "validate/validate_bodies.h"
#include "oracle/chain_theory.h"
#include "oracle/slender_theory.h"
#include "validate/validate.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

static void assert_near( double measured, double reference, double tolerance, const char* what )
{
    // written so that a NaN fails
    if ( !( fabs( measured - reference ) <= tolerance ) )
    {
        fail_msg( "%s: got %.9g, expected %.9g within %.3g", what, measured, reference, tolerance );
    }
}

// ---- theory ----

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

// ---- cases ----

static void assert_error( accuracy_scene_fn* make, const char* setting, double most )
{
    const double error = observe_one( make, true, setting ).error;
    if ( !( error <= most ) )
    {
        fail_msg( "%s: an error of %.4g, expected at most %.4g", setting, error, most );
    }
}

// 16 cells of second order leave 0.19 % of the length; links of cloth are a little soft under a heavy end.
TEST( every_solver_bends_under_an_end_load )
{
    assert_error( validate_tip_load, "rod, 16 cells, 32 substeps", 0.25 );
    assert_error( validate_tip_load, "dihedral, 16 cells, 32 substeps", 0.8 );
    assert_error( validate_tip_load, "isometric, 16 cells, 32 substeps", 0.8 );
    assert_error( validate_tip_load, "implicit, 16 cells, 4 substeps", 0.25 );
}

// Second order in cells: 11 % with 12, 3 % with 24, known to 1 %.
TEST( a_ring_leaves_its_plane_near_the_twist_of_michell )
{
    assert_error( validate_ring, "rod, 24 cells, 32 substeps", 4.1 );
}

TEST( a_rod_under_tension_gives_way_near_the_moment_of_greenhill )
{
    assert_error( validate_twisted, "rod, 16 cells, 64 substeps", 2.1 );
}

// Near the largest rotation that has a balance, angles are sensitive: 4 % with 96 cells, 2 % with 128.
TEST( a_rod_writhes_to_the_angle_of_theory )
{
    assert_error( validate_writhe, "rod, 96 cells, 16 substeps", 5.0 );
}

// Second order in cells: 11 % with 48, 7 % with 64, known to 1 %.
TEST( a_rod_forms_a_loop_near_the_rotation_of_theory )
{
    assert_error( validate_loop, "rod, 64 cells, 16 substeps", 8.1 );
}

TEST( a_hanging_chain_swings_in_its_periods )
{
    enum
    {
        SECOND_PERIOD,
    };
    accuracy_scene scene;
    open_scene( validate_chain, &scene );
    assert_well_formed( &scene );
    const accuracy_run fine = observe( &scene, "direct, 10 links, 10 substeps" );
    assert_true( fine.error < 0.02 );
    assert_true( fine.measures[SECOND_PERIOD] < 0.02 );

    // The period of implicit steps is of second order in them, and the chain's in its links.
    const double by_substeps =
        order_between( &scene, "direct, 10 links, 1 substeps", "direct, 10 links, 4 substeps", 4.0 );
    const double by_links =
        order_between( &scene, "vertices, 8 links, 40 substeps", "vertices, 32 links, 40 substeps", 4.0 );
    assert_near( by_substeps, 2.0, 0.2, "order in substeps" );
    assert_near( by_links, 2.0, 0.2, "order in links" );
    assert_same_hash( &scene, "direct, 10 links, 2 substeps" );
    close_scene( &scene );
}

// Euler loses energy in the whip, in proportion to its substeps; BDF2 keeps it.
TEST( a_folded_chain_is_as_fast_as_its_masses )
{
    assert_error( validate_folded_chain, "direct, 33 cells, 32 substeps", 2.5 );
    assert_error( validate_folded_chain, "direct bdf2, 33 cells, 4 substeps", 0.3 );
    assert_error( validate_folded_chain, "direct bdf2, 65 cells, 32 substeps", 0.2 );
}
