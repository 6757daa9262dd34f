// The theory of plates that buckle against the literature, and what sheets make of it.
#include "accuracy_scenes.h"

#include "oracle/plate_theory.h"
#include "oracle/slender_theory.h"
#include "validate/validate.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

static double difference( double value, double expected )
{
    return fabs( value / expected - 1.0 );
}

// ---- theory ----

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

// ---- sheets ----

// Ten cells leave 3.2 % at W = L / 4.
TEST( a_sheet_on_edge_turns_aside_at_its_load )
{
    const double load = plate_theory_load( 0.25, 0.0, plate_theory_isotropic( 1.0 / 3.0 ), true );
    assert_true(
        difference( observe_one( validate_lateral_buckling, true, "implicit, 10 cells, 2 substeps" ).measures[1],
                    load ) < 0.04 );
}

// Ten cells leave 0.4 %, which is the uncertainty of the measurement.
TEST( an_upright_sheet_gives_way_at_its_load )
{
    const char* const settings[] = { "dihedral, 10 cells, 8 substeps",
                                     "isometric, irregular, 10 cells, 32 substeps" };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        assert_true( difference( observe_one( validate_plate_column, true, settings[i] ).measures[1],
                                 slender_column_load() ) < 0.01 );
    }
}
