// Every key of a surface, and of what happens to it.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

#define AT( member ) offsetof( wisp_scene_surface, member )
#define BLOCK( fields )                                                                                              \
    {                                                                                                                \
        fields, WISP_COUNT( fields )                                                                                 \
    }

static const char* const SOLVERS[] = { "xpbd", "pbd", NULL };

// ---- cloth ----

#define CLOTH( member ) offsetof( wisp_scene_surface, cloth.member )

static const char* const BENDINGS[] = { "bend_links", "dihedral", "isometric", "none", NULL };

static const scene_field CLOTH_FIELDS[] = {
    { "solver", SCENE_CHOICE, .at = CLOTH( solver ), .choices = SOLVERS },
    { "warp_compliance", SCENE_NUMBER, .at = CLOTH( warp_compliance ), .range = COMPLIANCE, .unit = COMPLIANCES },
    { "weft_compliance", SCENE_NUMBER, .at = CLOTH( weft_compliance ), .range = COMPLIANCE, .unit = COMPLIANCES },
    { "shear_compliance", SCENE_NUMBER, .at = CLOTH( shear_compliance ), .range = COMPLIANCE, .unit = COMPLIANCES },
    { "stretch_stiffness", SCENE_NUMBER, .at = CLOTH( stretch_stiffness ), .range = UNIT_RANGE },
    { "shear_stiffness", SCENE_NUMBER, .at = CLOTH( shear_stiffness ), .range = UNIT_RANGE },
    { "warp", SCENE_VECTOR, .at = CLOTH( warp ), .range = RANGE( -5e5, 5e5 ) },
    { "bending", SCENE_CHOICE, .at = CLOTH( bending ), .choices = BENDINGS },
    { "bend_stiffness", SCENE_NUMBER, .at = CLOTH( bend_stiffness ), .range = UNIT_RANGE },
    { "bend_compliance", SCENE_NUMBER, .at = CLOTH( bend_compliance ), .range = COMPLIANCE, .unit = COMPLIANCES },
    { "bend_rigidity", SCENE_NUMBER, .at = CLOTH( bend_rigidity ), .range = RANGE( 1e-12, 1e12 ),
      .unit = RIGIDITIES },
    { "internal_damping", SCENE_NUMBER, .at = CLOTH( damping ), .range = RANGE( 0, 1e9 ), .unit = RATES },
    { "wind", SCENE_VECTOR, .at = CLOTH( wind ), .range = WIND, .unit = SPEEDS },
    { "air_density", SCENE_NUMBER, .at = CLOTH( air_density ), .range = RANGE( 0, 1e6 ), .unit = AIR_DENSITIES },
    { "drag_coefficient", SCENE_NUMBER, .at = CLOTH( drag ), .range = RANGE( 0, 1e6 ) },
    { "lift_coefficient", SCENE_NUMBER, .at = CLOTH( lift ), .range = RANGE( 0, 1e6 ) },
    { "tethers", SCENE_SWITCH, .at = CLOTH( tethers ) },
    { "tether_slack", SCENE_NUMBER, .at = CLOTH( tether_slack ), .range = RANGE( 1, 1e6 ) },
    { "level_passes", SCENE_WHOLE, .at = CLOTH( level_passes ), .range = RANGE( 0, 16 ) },
};
static const scene_block CLOTH_BLOCK = BLOCK( CLOTH_FIELDS );

// ---- balloon ----

#define BALLOON( member ) offsetof( wisp_scene_surface, balloon.member )

static const char* const PRESSURE_READINGS[] = { "virial", "multiplier", "gas", NULL };
static const char* const DRAGS[] = { "max", "abs", "signed", "normal", NULL };
static const char* const SPINS[] = { "velocity", "position", "none", NULL };

static const scene_field BALLOON_FIELDS[] = {
    { "solver", SCENE_CHOICE, .at = BALLOON( solver ), .choices = SOLVERS },
    { "edge_stiffness", SCENE_NUMBER, .at = BALLOON( edge_stiffness ), .range = RANGE( 1e-6, 1e12 ),
      .unit = STIFFNESSES },
    { "bend_link_stiffness", SCENE_NUMBER, .at = BALLOON( cross_stiffness ), .range = RANGE( 1e-6, 1e12 ),
      .unit = STIFFNESSES },
    { "stretch_stiffness", SCENE_NUMBER, .at = BALLOON( stretch_share ), .range = UNIT_RANGE },
    { "bend_stiffness", SCENE_NUMBER, .at = BALLOON( bend_share ), .range = UNIT_RANGE },
    { "volume", SCENE_CHOICE, .at = BALLOON( volume ), .choices = SOLVERS },
    { "volume_stiffness", SCENE_NUMBER, .at = BALLOON( volume_share ), .range = RANGE( 1e-6, 1 ) },
    { "gas_ratio", SCENE_NUMBER, .at = BALLOON( fill ), .range = RANGE( 1e-3, 1e6 ) },
    { "gas_ratio_keyframes", SCENE_CUSTOM, .read = scene_read_fill_path },
    { "inflation_rate", SCENE_NUMBER, .at = BALLOON( inflation_rate ), .range = RANGE( -1e6, 1e6 ), .unit = FLOWS },
    { "min_gas_ratio", SCENE_NUMBER, .at = BALLOON( least_fill ), .range = RANGE( 1e-3, 1 ) },
    { "atmospheric_pressure", SCENE_NUMBER, .at = BALLOON( atmospheric_pressure ), .range = RANGE( 1e-3, 1e12 ),
      .unit = PRESSURES },
    { "temperature", SCENE_NUMBER, .at = BALLOON( temperature ), .range = RANGE( 1e-3, 1e6 ), .unit = KELVIN },
    { "gas_molar_mass", SCENE_NUMBER, .at = BALLOON( gas_molar_mass ), .range = RANGE( 1e-6, 10 ),
      .unit = MOLAR_MASSES },
    { "air_molar_mass", SCENE_NUMBER, .at = BALLOON( air_molar_mass ), .range = RANGE( 1e-6, 10 ),
      .unit = MOLAR_MASSES },
    { "pressure", SCENE_CHOICE, .at = BALLOON( pressure ), .choices = PRESSURE_READINGS },
    { "buoyancy", SCENE_SWITCH, .at = BALLOON( buoyancy ) },
    { "drag_coefficient", SCENE_NUMBER, .at = BALLOON( drag_coefficient ), .range = RANGE( 0, 1e6 ) },
    { "drag_model", SCENE_CHOICE, .at = BALLOON( drag ), .choices = DRAGS },
    { "outlet", SCENE_CUSTOM, .read = scene_read_outlet },
    { "outlet_nearest", SCENE_VECTOR, .at = AT( outlet_nearest ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_outlet_nearest ) },
    { "outlet_radius", SCENE_NUMBER, .at = AT( outlet_radius ), .range = RANGE( 0, 1e6 ), .unit = METRES },
    { "outlet_area", SCENE_NUMBER, .at = BALLOON( outlet_area ), .range = RANGE( 1e-12, 1e6 ), .unit = AREAS },
    { "outlet_open", SCENE_SWITCH, .at = BALLOON( outlet_open ) },
    { "spin", SCENE_CHOICE, .at = BALLOON( spin ), .choices = SPINS },
    { "allow_open", SCENE_SWITCH, .at = BALLOON( allow_open ) },
};
static const scene_block BALLOON_BLOCK = BLOCK( BALLOON_FIELDS );

// ---- implicit ----

#define IMPLICIT( member ) offsetof( wisp_scene_surface, implicit.member )
#define ANY_STIFFNESS RANGE( 0, 1e9 )

static const char* const STIFFNESS_OF[] = { "link", "material", NULL };
static const char* const WEIGHTS[] = { "effective", "none", "pair", NULL };
static const char* const DAMPING_FORMS[] = { "isotropic", "axial", NULL };
static const char* const JACOBIANS[] = { "dropped", "full", NULL };
static const char* const INTEGRATORS[] = { "euler", "bdf2", NULL };
static const char* const LINKS[] = { "mesh", "quad", NULL };

static const scene_field IMPLICIT_FIELDS[] = {
    { "stiffness_model", SCENE_CHOICE, .at = IMPLICIT( stiffness ), .choices = STIFFNESS_OF },
    { "stretch_stiffness", SCENE_NUMBER, .at = IMPLICIT( stretch_stiffness ), .range = ANY_STIFFNESS,
      .unit = STIFFNESSES },
    { "bend_stiffness", SCENE_NUMBER, .at = IMPLICIT( bend_stiffness ), .range = ANY_STIFFNESS,
      .unit = ROD_RIGIDITIES },
    { "bend_rigidity", SCENE_NUMBER, .at = IMPLICIT( bend_rigidity ), .range = ANY_STIFFNESS, .unit = RIGIDITIES },
    { "compression_stiffness", SCENE_NUMBER, .at = IMPLICIT( compression_stiffness ), .range = ANY_STIFFNESS,
      .unit = STIFFNESSES },
    { "link_damping", SCENE_NUMBER, .at = IMPLICIT( damping ), .range = ANY_STIFFNESS, .unit = LINK_DAMPINGS },
    { "weights", SCENE_CHOICE, .at = IMPLICIT( weights ), .choices = WEIGHTS },
    { "damping_form", SCENE_CHOICE, .at = IMPLICIT( damping_form ), .choices = DAMPING_FORMS },
    { "jacobian", SCENE_CHOICE, .at = IMPLICIT( jacobian ), .choices = JACOBIANS },
    { "integrator", SCENE_CHOICE, .at = IMPLICIT( integrator ), .choices = INTEGRATORS },
    { "newton_iterations", SCENE_WHOLE, .at = IMPLICIT( newton_repeats ), .range = RANGE( 1, 64 ) },
    { "max_newton_iterations", SCENE_WHOLE, .at = IMPLICIT( stiff_repeats ), .range = RANGE( 1, 64 ) },
    { "tolerance", SCENE_NUMBER, .at = IMPLICIT( tolerance ), .range = RANGE( 1e-7, 0.1 ) },
    { "max_iterations", SCENE_WHOLE, .at = IMPLICIT( max_iterations ), .range = RANGE( 0, 1000000 ) },
    { "warm_start", SCENE_SWITCH, .at = IMPLICIT( warm_start ) },
    { "speculative", SCENE_SWITCH, .at = IMPLICIT( look_ahead ) },
    { "links", SCENE_EITHER, .at = AT( has_quad_links ), .choices = LINKS },
};
static const scene_block IMPLICIT_BLOCK = BLOCK( IMPLICIT_FIELDS );

// ---- a surface ----

static const scene_field TRANSFORM_FIELDS[] = {
    { "scale", SCENE_NUMBER, .at = AT( mesh.scale ), .range = SIZE },
    { "rotate", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation },
    { "translate", SCENE_VECTOR, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES },
};
static const scene_block TRANSFORM_BLOCK = BLOCK( TRANSFORM_FIELDS );

#define COLLISION( member ) offsetof( wisp_scene_surface, collision.member )

static const scene_field COLLISION_FIELDS[] = {
    { "thickness", SCENE_NUMBER, .at = COLLISION( thickness ), .range = RANGE( 0, 1e6 ), .unit = METRES },
    { "friction_scale", SCENE_NUMBER, .at = COLLISION( friction ), .range = RANGE( 0, 1e6 ) },
    { "max_push_out_speed", SCENE_NUMBER, .at = COLLISION( recovery_speed ), .range = RANGE( 0, 1e6 ),
      .unit = SPEEDS },
    { "mask", SCENE_CUSTOM, .at = COLLISION( mask ), .read = scene_read_layers },
};
static const scene_block COLLISION_BLOCK = BLOCK( COLLISION_FIELDS );

static const char* const SWEEPS[] = { "colour", "list", NULL };

// `generate` stands before what names its vertices, and the effects before `compute`.
static const scene_field SURFACE_FIELDS[] = {
    { "name", SCENE_CUSTOM, .required = true, .at = AT( name ), .read = scene_read_name },
    { "file", SCENE_CUSTOM, .at = AT( mesh.file ), .read = scene_read_file },
    { "generate", SCENE_CUSTOM, .at = AT( mesh ), .read = scene_read_mesh_make },
    { "instance_of", SCENE_CUSTOM, .read = scene_read_later_name },
    { "repair", SCENE_CUSTOM, .at = AT( mesh.repairs ), .read = scene_read_repair },
    { "require", SCENE_CUSTOM, .at = AT( mesh.demands ), .read = scene_read_require },
    { "transform", SCENE_BLOCK, .block = &TRANSFORM_BLOCK },
    { "area_density", SCENE_NUMBER, .at = AT( area_density ), .range = RANGE( 1e-12, 1e12 ), .unit = DENSITIES },
    { "vertex_mass", SCENE_NUMBER, .at = AT( vertex_mass ), .range = RANGE( 1e-12, 1e12 ), .unit = MASSES },
    { "pins", SCENE_CUSTOM, .read = scene_read_pins },
    { "pin_box", SCENE_CUSTOM, .read = scene_read_pin_box },
    { "pin_nearest", SCENE_CUSTOM, .read = scene_read_pin_nearest },
    { "pin_keyframes", SCENE_CUSTOM, .at = AT( pin_path ), .read = scene_read_pin_path },
    { "pin_pivot", SCENE_VECTOR, .at = AT( pin_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_pin_pivot ) },
    { "velocity", SCENE_VECTOR, .at = AT( velocity ), .range = VELOCITY, .unit = SPEEDS },
    { "angular_velocity", SCENE_VECTOR, .at = AT( angular_velocity ), .range = VELOCITY, .unit = TURNS },
    { "gravity", SCENE_VECTOR, .at = AT( gravity ), .range = ACCELERATION, .unit = ACCELERATIONS },
    { "damping", SCENE_NUMBER, .at = AT( damping ), .range = RANGE( 0, 1e9 ), .unit = RATES },
    { "strain_limit", SCENE_CUSTOM, .at = AT( strain_limit ), .read = scene_read_strain_limit },
    { "cloth", SCENE_BLOCK, .at = AT( has_cloth ), .block = &CLOTH_BLOCK },
    { "balloon", SCENE_BLOCK, .at = AT( has_balloon ), .block = &BALLOON_BLOCK },
    { "implicit", SCENE_BLOCK, .at = AT( has_implicit ), .block = &IMPLICIT_BLOCK },
    { "levels", SCENE_WHOLE, .at = AT( levels ), .range = RANGE( 0, WISP_FABRIC_MAX_LEVELS ) },
    { "finest_level", SCENE_WHOLE, .at = AT( finest_level ), .range = RANGE( 1, WISP_FABRIC_MAX_LEVELS ) },
    { "solve_order", SCENE_CHOICE, .at = AT( sweep ), .choices = SWEEPS },
    { "tile_size", SCENE_CUSTOM, .at = AT( tile_size ), .read = scene_read_tile_size },
    { "collision", SCENE_BLOCK, .at = AT( has_collision ), .block = &COLLISION_BLOCK },
    { "contact", SCENE_BLOCK, .at = AT( has_contact ), .block = &SCENE_CONTACT_BLOCK },
    { "boundary", SCENE_BLOCK, .at = AT( has_boundary ), .block = &SCENE_BOUNDARY_BLOCK },
    { "compute", SCENE_CUSTOM, .read = scene_read_surface_want },
};
#undef AT
const scene_block SCENE_SURFACE_BLOCK = BLOCK( SURFACE_FIELDS );

#define AT( member ) offsetof( wisp_scene_box, member )
static const scene_field BOX_FIELDS[] = {
    { "min", SCENE_VECTOR, .required = true, .at = AT( low ), .range = COORDINATE, .unit = METRES },
    { "max", SCENE_VECTOR, .required = true, .at = AT( high ), .range = COORDINATE, .unit = METRES },
};
#undef AT
const scene_block SCENE_BOX_BLOCK = BLOCK( BOX_FIELDS );

// ---- events ----

#define AT( member ) offsetof( scene_event, member )
#define EVENT( member ) offsetof( scene_event, event.member )

static const scene_field EVENT_FIELDS[] = {
    { "step", SCENE_WHOLE, .at = EVENT( step ), .range = RANGE( 0, 999999 ), .given = AT( has_step ) },
    { "time", SCENE_NUMBER, .at = AT( time ), .range = TIME, .unit = SECONDS, .given = AT( has_time ) },
    { "strands", SCENE_CUSTOM, .at = EVENT( strands ), .read = scene_read_strands_name },
    { "surface", SCENE_CUSTOM, .at = EVENT( surface ), .read = scene_read_surface_name },
    { "gas_ratio", SCENE_NUMBER, .at = EVENT( fill ), .range = RANGE( 1e-3, 1e6 ), .given = EVENT( has_fill ) },
    { "inflation_rate", SCENE_NUMBER, .at = EVENT( inflation_rate ), .range = RANGE( -1e6, 1e6 ), .unit = FLOWS,
      .given = EVENT( has_inflation_rate ) },
    { "outlet_open", SCENE_SWITCH, .at = EVENT( open ), .given = EVENT( has_open ) },
    { "wind", SCENE_VECTOR, .at = EVENT( wind ), .range = WIND, .unit = SPEEDS, .given = EVENT( has_wind ) },
    { "velocity", SCENE_VECTOR, .at = EVENT( velocity ), .range = VELOCITY, .unit = SPEEDS,
      .given = EVENT( has_velocity ) },
    { "angular_velocity", SCENE_VECTOR, .at = EVENT( angular_velocity ), .range = VELOCITY, .unit = TURNS,
      .given = EVENT( has_angular_velocity ) },
    { "release", SCENE_SWITCH, .at = EVENT( release ) },
};
#undef AT
const scene_block SCENE_EVENT_BLOCK = BLOCK( EVENT_FIELDS );
