// The default parameters of the published methods, as their papers give them or as docs/methods.md states them. Results and
// figures are compared under these, so a default that drifts would move all of them without a test that fails.
#include "balloon.h"
#include "boundary.h"
#include "frozen_hair.h"
#include "implicit_cloth.h"

#include "unit.h"

TEST( frozen_hair_has_the_numbers_of_its_contract )
{
    const wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    assert_true( def.freeze && def.align && def.clump );
    assert_float_equal( def.stretch_stiffness, 7.0f, 0.0f );
    assert_float_equal( def.bend_stiffness, 7.0f, 0.0f );
    assert_float_equal( def.max_bend_angle, 0.785398163f, 1e-7f );
    assert_float_equal( def.intensity, 0.8f, 0.0f );
    assert_float_equal( def.reach, 0.15f, 0.0f );
    assert_float_equal( def.clump_radius, 0.01f, 0.0f );
    assert_int_equal( def.clump_iterations, 4 );
    assert_true( def.clump_step_length == -1.0f && def.min_distance == -1.0f ); // 0.1 and 0.02 of the radius
    assert_true( def.min_lambda == 0.0f );
}

TEST( balloons_are_of_helium_in_standard_air )
{
    const wisp_balloon_def def = wisp_default_balloon_def();
    assert_float_equal( def.atmospheric_pressure, 101325.0f, 0.0f );
    assert_float_equal( def.temperature, 293.15f, 0.0f );
    assert_float_equal( def.gas_molar_mass, 4.0026e-3f, 0.0f );
    assert_float_equal( def.air_molar_mass, 28.9647e-3f, 0.0f );
    assert_float_equal( def.drag_coefficient, 0.5f, 0.0f );
    assert_float_equal( def.edge_stiffness, 2000.0f, 0.0f );
    assert_float_equal( def.bend_link_stiffness, 20.0f, 0.0f );
    assert_float_equal( def.stretch_stiffness, 0.9f, 0.0f );
    assert_float_equal( def.bend_stiffness, 0.1f, 0.0f );
    assert_float_equal( def.volume_stiffness, 1.0f, 0.0f );
    assert_float_equal( def.outlet_area, 1e-4f, 0.0f );
    assert_true( def.buoyancy );
}

TEST( implicit_cloth_has_the_numbers_of_its_contract )
{
    const wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    assert_float_equal( def.stretch_stiffness, 200.0f, 0.0f );
    assert_float_equal( def.bend_stiffness, 1e-6f, 0.0f );
    assert_float_equal( def.link_damping, 0.02f, 0.0f );
    assert_float_equal( def.tolerance, 1e-4f, 0.0f );
    assert_int_equal( def.weights, WISP_IMPLICIT_WEIGHTS_EFFECTIVE );
    assert_int_equal( def.integrator, WISP_INTEGRATOR_EULER );
}

TEST( boundary_points_are_even_and_counted_downwards )
{
    const wisp_boundary_def def = wisp_default_boundary_def();
    assert_int_equal( def.policy, WISP_SPACING_EVEN );
    assert_int_equal( def.rounding, WISP_ROUND_DOWN );
    assert_true( def.spacing == 0.0f && def.eye_angle == 0.0f );
}
