// Keys of a surface that is held near targets, and of one in a moving frame.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>

#define AT( member ) offsetof( wisp_scene_surface, member )

static const scene_choice SOLVERS[] = { { "xpbd", "with compliances in SI units" },
                                        { "pbd", "with stiffnesses in 0 .. 1" },
                                        { NULL, NULL } };

// ---- motion constraints ----

#define DISTANCE RANGE( 0, 1e6 )

// Constants. Maps of vertices belong to `max_distance`, `backstop` and `backstop_radius`: the arrays of the definition take them.
static const scene_field MOTION_FIELDS[] = {
    { "max_distance", .range = DISTANCE, .help = "Largest distance of a vertex from its target; 0 holds it there.",
      .initial = "no limit" },
    { "backstop", .member = "backstop_distance", .range = DISTANCE,
      .help = "Distance behind the target, against its normal, that no vertex passes.", .initial = "none" },
    { "backstop_radius", .range = RANGE( 1e-6, 1e6 ), .help = "Radius of the sphere that is the backstop.",
      .initial = "a plane" },
    { "solver", .choices = SOLVERS, .constants = "WISP_SOLVER_", .help = "Solver of these constraints." },
    { "distance_compliance", .help = "Compliance of the largest distance, with `solver: xpbd`; 0 never exceeds it." },
    { "backstop_compliance", .help = "Compliance of the backstop, with `solver: xpbd`." },
    { "distance_stiffness", .help = "Stiffness of the largest distance, with `solver: pbd`." },
    { "backstop_stiffness", .help = "Stiffness of the backstop, with `solver: pbd`." },
    { "keyframes", SCENE_ENTRIES, .at = AT( target_path ), .of = &SCENE_PIN_PATH,
      .help = "Displacement of the targets from where the vertices start; without `jump`.",
      .form = "list of keyframes {time, translate, rotate}", .initial = "none" },
    { "pivot", SCENE_VECTOR, .at = AT( target_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_target_pivot ), .help = "Point that the keyframes rotate about.",
      .initial = "the centre of the vertices" },
};
const scene_block SCENE_MOTION_CONSTRAINTS_BLOCK =
    SCENE_BLOCK_OF( MOTION_FIELDS, motion_constraints_def, wisp_scene_surface, motion_constraints );

// ---- tearing ----

static const scene_field TEARING_FIELDS[] = {
    { "strength", .required = true, .map = WISP_SCENE_MAP_TEARING, .range = RANGE( 1e-6, 1e12 ),
      .help = "Tension at which an edge gives way: force of a strip by its width." },
    { "max_splits", .help = "Most vertices that split in a step." },
    { "max_new_vertices", SCENE_WHOLE, .at = AT( max_new_vertices ), .range = RANGE( 0, 1e7 ),
      .help = "Vertices that are reserved for splits. When all are used the cloth no longer tears.",
      .initial = "a quarter of the vertices of the mesh, at least 64" },
};
const scene_block SCENE_TEARING_BLOCK = SCENE_BLOCK_OF( TEARING_FIELDS, tearing_def, wisp_scene_surface, tearing );

// ---- membranes ----

static const scene_field MEMBRANE_FIELDS[] = {
    { "shear_modulus", .help = "Shear modulus of the material, a third of Young's modulus; latex by default." },
    { "thickness", .help = "Thickness at rest." },
    { "tension_field", .help = "Triangles hold no compression, as if they had wrinkles finer than the mesh." },
};
const scene_block SCENE_MEMBRANE_BLOCK =
    SCENE_BLOCK_OF( MEMBRANE_FIELDS, membrane_def, wisp_scene_surface, membrane );

// ---- surfaces as colliders ----

#define COLLIDER( member ) offsetof( wisp_scene_surface, collider.member )

static const scene_field COLLIDER_FIELDS[] = {
    { "double_sided", .help = "The surface has two sides and no inside; otherwise it must be closed." },
    { "static_friction", .help = "Friction coefficient that must be overcome." },
    { "kinetic_friction", .help = "Friction coefficient while sliding, at most the static one." },
    { "restitution", .help = "Fraction of the approach speed that a vertex leaves with." },
    { "thickness", .help = "Thickness that is added to that of what touches it." },
    { "tracks",
      .help = "Closest triangles are searched once per step and tracked in between; otherwise in each substep." },
    { "layers", SCENE_CUSTOM, .at = COLLIDER( layers ), .read = scene_read_layers, .form = "list of layers, 0 .. 31",
      .initial = "[0]", .help = "Layers; `collision.mask` chooses among them." },
};
const scene_block SCENE_SURFACE_COLLIDER_BLOCK =
    SCENE_BLOCK_OF( COLLIDER_FIELDS, collider_def, wisp_scene_surface, collider );

// ---- the frame ----

static const scene_field FRAME_FIELDS[] = {
    { "linear_inertia", .help = "Fraction of the displacement of the frame that the surface feels." },
    { "angular_inertia", .help = "Fraction of the rotation of the frame that the surface feels." },
    { "keyframes", SCENE_ENTRIES, .at = AT( frame_path ), .of = &SCENE_PIN_PATH,
      .help = "Displacement of the frame from where it starts; without `jump`.",
      .form = "list of keyframes {time, translate, rotate}", .initial = "none" },
    { "pivot", SCENE_VECTOR, .at = AT( frame_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_frame_pivot ), .help = "Where the frame starts; it rotates about this point.",
      .initial = "the centre of the vertices" },
};
const scene_block SCENE_FRAME_BLOCK = SCENE_BLOCK_OF( FRAME_FIELDS, moving_frame_def, wisp_scene_surface, frame );

// ---- sleep ----

static const scene_field SLEEP_FIELDS[] = {
    { "max_speed", .help = "Speed, of the displacement over a step, that no vertex may exceed." },
    { "seconds", .help = "Simulated time for which all vertices must be slower." },
    { "enabled", .help = "`false`: it never sleeps." },
};
const scene_block SCENE_SURFACE_SLEEP_BLOCK = SCENE_BLOCK_OF( SLEEP_FIELDS, sleep_def, wisp_scene_surface, sleep );
const scene_block SCENE_STRANDS_SLEEP_BLOCK = SCENE_BLOCK_OF( SLEEP_FIELDS, sleep_def, wisp_scene_strands, sleep );

// ---- level of detail ----

static const scene_field DETAIL_FIELDS[] = {
    { "level", SCENE_DETAIL_CHOICES, .help = "Level from the start; an event can change it." },
    { "substep_divisor", .range = RANGE( 1, 1000 ),
      .help = "At `fewer_substeps` and `coarse`, the entry makes its substeps divided by this, rounded up." },
    { "blend_steps", .range = RANGE( 0, 10000 ), .help = "Steps over which a change of the level is blended." },
};
const scene_block SCENE_SURFACE_DETAIL_BLOCK =
    SCENE_BLOCK_OF( DETAIL_FIELDS, detail_def, wisp_scene_surface, detail );
const scene_block SCENE_STRANDS_DETAIL_BLOCK =
    SCENE_BLOCK_OF( DETAIL_FIELDS, detail_def, wisp_scene_strands, detail );

// ---- what no table can say ----

// What the engine would refuse too, at the line of the key.
static wisp_status check_tearing( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const scene_case cases[] = {
        { s->has_cloth == false, NULL, "'tearing' needs the key 'cloth'" },
        { s->cloth.solver == WISP_SOLVER_PBD, NULL,
          "'tearing' needs the solver xpbd, but 'solver' of 'cloth' is pbd" },
        { s->cloth.coarse_substeps > 0, NULL,
          "'tearing' is not possible with coarse sheets: set cloth.coarse_substeps to 0" },
        { s->cloth.tethers, NULL, "'tearing' is not possible with cloth.tethers" },
        { s->has_motion_constraints, NULL, "'tearing' is not possible with 'motion_constraints'" },
        { s->has_boundary, NULL, "'tearing' is not possible with 'boundary'" },
        { s->has_animation, NULL, "'tearing' is not possible with 'animation'" },
        { s->has_collider, NULL, "'tearing' is not possible with 'collider'" },
        { s->vertex_mass > 0.0f, NULL, "'tearing' needs 'area_density', but the surface has 'vertex_mass'" },
        { s->mass_ratio != 1.0f, NULL, "'tearing' is not possible with 'mass_ratio'" },
    };
    return scene_refuse_cases( r, text_find_path( node, "tearing" ), cases, WISP_COUNT( cases ) );
}

// What says how links stretch says nothing of a membrane.
static wisp_status check_membrane( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    static const char* const of_links[] = {
        "balloon.solver",
        "balloon.edge_stiffness",
        "balloon.bend_link_stiffness",
        "balloon.stretch_stiffness",
        "balloon.bend_stiffness",
        "cloth.warp_compliance",
        "cloth.weft_compliance",
        "cloth.shear_compliance",
        "cloth.stretch_stiffness",
        "cloth.shear_stiffness",
        "cloth.warp",
    };
    const scene_case cases[] = {
        { s->has_cloth && s->cloth.coarse_substeps > 0, NULL,
          "'membrane' is not possible with coarse sheets: set cloth.coarse_substeps to 0" },
        { s->has_implicit, NULL, "'membrane' is not possible with 'implicit'" },
        { s->has_tearing, NULL, "'membrane' is not possible with 'tearing'" },
        { s->has_cloth && s->cloth.bending == WISP_CLOTH_BENDING_LINKS, NULL,
          "'membrane' needs cloth.bending dihedral, isometric or none, got links" },
    };
    WISP_TRY(
        scene_refuse_keys( r, node, of_links, WISP_COUNT( of_links ), "is of links, and a membrane has none" ) );
    return scene_refuse_cases( r, text_find_path( node, "membrane" ), cases, WISP_COUNT( cases ) );
}

// Without a limit they do nothing, whatever else is said.
static wisp_status check_motion_constraints( scene_reader* r, const text_node* held )
{
    const bool has_backstop = text_find_path( held, "backstop" ) != NULL;
    const scene_case cases[] = {
        { !has_backstop && text_find_path( held, "max_distance" ) == NULL, NULL,
          "'motion_constraints' needs 'max_distance' or 'backstop'" },
        { !has_backstop && text_find_path( held, "backstop_radius" ) != NULL, "backstop_radius",
          "'backstop_radius' needs 'backstop'" },
    };
    return scene_refuse_cases( r, held, cases, WISP_COUNT( cases ) );
}

wisp_status scene_check_held( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const text_node *held = text_find_path( node, "motion_constraints" ), *frame = text_find_path( node, "frame" );
    if ( s->target_path.count > 0 || s->frame_path.count > 0 || scene_moves_groups( s ) )
    {
        WISP_TRY( scene_refuse_jumps( r, text_find_path( node, "pin_keyframes" ), &s->pins.path,
                                      "not with keyframes of motion_constraints, frame or pin_groups" ) );
    }
    if ( s->has_frame && s->has_implicit )
    {
        return scene_refuse_node( r, frame, "'frame' is not possible with 'implicit'" );
    }
    WISP_TRY( s->has_tearing ? check_tearing( r, node, s ) : WISP_OK );
    WISP_TRY( s->has_membrane ? check_membrane( r, node, s ) : WISP_OK );
    WISP_TRY( scene_refuse_jumps( r, held, &s->target_path, SCENE_JUMPS ) );
    WISP_TRY( held ? check_motion_constraints( r, held ) : WISP_OK );
    return scene_refuse_jumps( r, frame, &s->frame_path, SCENE_JUMPS );
}
