// Keys of a surface that is held near targets, and of one in a moving frame.
#include "scene_parts.h"
#include "scene_ranges.h"

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
    { "keyframes", SCENE_CUSTOM, .at = AT( target_path ), .read = scene_read_pin_path,
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
    { "keyframes", SCENE_CUSTOM, .at = AT( frame_path ), .read = scene_read_pin_path,
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
    { "level", .choices = SCENE_DETAIL_LEVELS, .constants = "WISP_DETAIL_",
      .help = "Level from the start; an event can change it." },
    { "substep_divisor", .range = RANGE( 1, 1000 ),
      .help = "At `fewer_substeps` and `coarse`, the entry makes its substeps divided by this, rounded up." },
    { "blend_steps", .range = RANGE( 0, 10000 ), .help = "Steps over which a change of the level is blended." },
};
const scene_block SCENE_SURFACE_DETAIL_BLOCK =
    SCENE_BLOCK_OF( DETAIL_FIELDS, detail_def, wisp_scene_surface, detail );
const scene_block SCENE_STRANDS_DETAIL_BLOCK =
    SCENE_BLOCK_OF( DETAIL_FIELDS, detail_def, wisp_scene_strands, detail );

// ---- what no table can say ----

static wisp_status check_path( scene_reader* r, const scene_node* node, const char* key, const wisp_scene_path* path )
{
    for ( int i = 0; i < path->count; ++i )
    {
        if ( path->poses[i].jump )
        {
            return scene_refuse_node( r, scene_child( r, node, key ),
                                      "'jump' in keyframe %d: only keyframes of pins, colliders and heads can jump",
                                      i );
        }
    }
    return WISP_OK;
}

// What the engine would refuse too, at the line of the key.
static wisp_status check_tearing( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const struct
    {
        bool is_given;
        const char* message;
    } cases[] = {
        { s->has_cloth == false, "needs the key 'cloth'" },
        { s->cloth.solver == WISP_SOLVER_PBD, "needs the solver xpbd, but 'solver' of 'cloth' is pbd" },
        { s->cloth.coarse_substeps > 0, "is not possible with coarse sheets: set cloth.coarse_substeps to 0" },
        { s->cloth.tethers, "is not possible with cloth.tethers" },
        { s->has_motion_constraints, "is not possible with 'motion_constraints'" },
        { s->has_boundary, "is not possible with 'boundary'" },
        { s->has_animation, "is not possible with 'animation'" },
        { s->has_collider, "is not possible with 'collider'" },
        { s->vertex_mass > 0.0f, "needs 'area_density', but the surface has 'vertex_mass'" },
        { s->mass_ratio != 1.0f, "is not possible with 'mass_ratio'" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ) && s->has_tearing; ++i )
    {
        if ( cases[i].is_given )
        {
            return scene_refuse_node( r, scene_child( r, node, "tearing" ), "'tearing' %s", cases[i].message );
        }
    }
    return WISP_OK;
}

// What says how links stretch says nothing of a membrane.
static wisp_status check_membrane( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    static const char* const of_links[][2] = {
        { "balloon", "solver" },
        { "balloon", "edge_stiffness" },
        { "balloon", "bend_link_stiffness" },
        { "balloon", "stretch_stiffness" },
        { "balloon", "bend_stiffness" },
        { "cloth", "warp_compliance" },
        { "cloth", "weft_compliance" },
        { "cloth", "shear_compliance" },
        { "cloth", "stretch_stiffness" },
        { "cloth", "shear_stiffness" },
        { "cloth", "warp" },
    };
    for ( int i = 0; i < WISP_COUNT( of_links ); ++i )
    {
        const scene_node* block = scene_child( r, node, of_links[i][0] );
        const scene_node* key = block ? scene_child( r, block, of_links[i][1] ) : NULL;
        if ( key )
        {
            return scene_refuse_node( r, key, "'%s' is of links, and a membrane has none", of_links[i][1] );
        }
    }
    const scene_node* mine = scene_child( r, node, "membrane" );
    if ( s->has_cloth && s->cloth.coarse_substeps > 0 )
    {
        return scene_refuse_node( r, mine,
                                  "'membrane' is not possible with coarse sheets: set cloth.coarse_substeps to 0" );
    }
    if ( s->has_implicit || s->has_tearing )
    {
        return scene_refuse_node( r, mine, "'membrane' is not possible with '%s'",
                                  s->has_implicit ? "implicit" : "tearing" );
    }
    return s->has_cloth && s->cloth.bending == WISP_CLOTH_BENDING_LINKS
               ? scene_refuse_node( r, mine, "'membrane' needs cloth.bending dihedral, isometric or none, got links" )
               : WISP_OK;
}

// Without a limit they do nothing, whatever else is said.
static wisp_status check_motion_constraints( scene_reader* r, const scene_node* node )
{
    const scene_node* held = scene_child( r, node, "motion_constraints" );
    const scene_node* backstop = held ? scene_child( r, held, "backstop" ) : NULL;
    if ( held && !backstop && !scene_child( r, held, "max_distance" ) )
    {
        return scene_refuse_node( r, held, "'motion_constraints' needs 'max_distance' or 'backstop'" );
    }
    const scene_node* radius = held ? scene_child( r, held, "backstop_radius" ) : NULL;
    return radius && !backstop ? scene_refuse_node( r, radius, "'backstop_radius' needs 'backstop'" ) : WISP_OK;
}

wisp_status scene_check_held( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const bool has_path = s->target_path.count > 0 || s->frame_path.count > 0 || scene_moves_groups( s );
    for ( int i = 0; has_path && i < s->pins.path.count; ++i )
    {
        if ( s->pins.path.poses[i].jump )
        {
            return scene_refuse_node(
                r, scene_child( r, node, "pin_keyframes" ),
                "'jump' in keyframe %d: not with keyframes of motion_constraints, frame or pin_groups", i );
        }
    }
    if ( s->has_frame && s->has_implicit )
    {
        return scene_refuse_node( r, scene_child( r, node, "frame" ), "'frame' is not possible with 'implicit'" );
    }
    wisp_status status = check_tearing( r, node, s );
    status = status || !s->has_membrane ? status : check_membrane( r, node, s );
    status = status ? status : check_path( r, node, "motion_constraints", &s->target_path );
    status = status ? status : check_motion_constraints( r, node );
    return status ? status : check_path( r, node, "frame", &s->frame_path );
}
