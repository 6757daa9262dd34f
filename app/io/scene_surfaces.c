// Surfaces: what no table can say about an entry, and the list of them.

#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

// ---- values ----

// Values of a surface: limits, gas, words of `compute`.

// ---- limits and gas ----

wisp_status scene_read_strain_limit( scene_reader* r, const text_node* node, void* at )
{
    static const scene_field pair[2] = { { "least", SCENE_NUMBER, .range = UNIT_RANGE },
                                         { "most", SCENE_NUMBER, .range = RANGE( 1, 1e6 ) } };
    float* limit = at;
    return scene_read_pair( r, node, "a pair [min, max] in rest lengths", pair, &limit[0], &limit[1] );
}

wisp_status scene_read_tile_size( scene_reader* r, const text_node* node, void* at )
{
    static const scene_field field = { "tile_size", SCENE_WHOLE, .range = RANGE( 0, 65536 ) };
    int* size = at;
    WISP_TRY( scene_read_whole( r, node, &field, size ) );
    return *size == 0 || ( *size >= 64 && *size % 8 == 0 )
               ? WISP_OK
               : scene_refuse_node( r, node, "got %d, expected 0, or a multiple of 8 in [64, 65536]", *size );
}

wisp_status scene_read_outlet( scene_reader* r, const text_node* node, void* at )
{
    wisp_scene_surface* surface = at;
    WISP_TRY( scene_expect_list( r, node, "a list of vertices" ) );
    if ( node->count == 0 || node->count > WISP_BALLOON_MAX_OUTLET )
    {
        return scene_refuse_node( r, node, "got %d vertices, expected 1 to %d", node->count,
                                  WISP_BALLOON_MAX_OUTLET );
    }
    surface->balloon.outlet_count = node->count;
    return scene_read_vertices( r, node, surface->balloon.outlet );
}

static wisp_status read_fill( scene_reader* r, const text_node* node, int index, void* keyframes )
{
    static const scene_field pair[2] = { { "time", SCENE_NUMBER, .range = TIME, .unit = SECONDS },
                                         { "gas_ratio", SCENE_NUMBER, .range = RANGE( 1e-3, 1e6 ) } };
    wisp_scene_gas_ratio_keyframe* gas_ratio = (wisp_scene_gas_ratio_keyframe*)keyframes + index;
    WISP_TRY( scene_read_pair( r, node, "a pair [time, gas_ratio]", pair, &gas_ratio->time, &gas_ratio->gas_ratio ) );
    return index == 0 ? WISP_OK : scene_check_rises( r, text_first( node ), gas_ratio[-1].time, gas_ratio->time );
}

static const scene_list GAS_RATIO_KEYFRAMES = { .what = "a list of pairs [time, gas_ratio]",
                                                .size = sizeof( wisp_scene_gas_ratio_keyframe ),
                                                .read = read_fill };

// ---- compute ----

#define AT( member ) offsetof( wisp_scene_surface, member )

static const scene_choice WORDS[] = {
    { "points", "positions" },
    { "normals", "unit normals of vertices" },
    { "strain", "relative error of the length of each edge" },
    { "speed", "speed of each vertex" },
    { "motion_stats", "mass, momentum, energy, volume, largest strain and speed" },
    { "effect_stats", "forces, pressure and volume of a balloon; solves of an implicit cloth" },
    { "collision_stats", "largest penetration and number of contacts; needs `collision`" },
    { NULL, NULL },
};

static wisp_status check_word( scene_reader* r, const text_node* item, int word, const void* entry )
{
    const wisp_scene_surface* s = entry;
    const char* name = WORDS[word].word;
    if ( strcmp( name, "effect_stats" ) == 0 && !s->has_balloon && !s->has_implicit )
    {
        return scene_refuse_node( r, item, "'effect_stats' needs the key 'balloon' or 'implicit'" );
    }
    return strcmp( name, "collision_stats" ) == 0 && !s->has_collision
               ? scene_refuse_node( r, item, "'collision_stats' needs the key 'collision'" )
               : WISP_OK;
}

static const size_t REQUESTS[] = { AT( request_points ),  AT( request_normals ),      AT( request_strain ),
                                   AT( request_speed ),   AT( request_motion_stats ), AT( request_stats ),
                                   AT( request_contacts ) };

// ---- tables ----

// Every key of a surface.

static const scene_choice SOLVERS[] = { { "xpbd", "extended position based dynamics, with compliances in SI units" },
                                        { "pbd", "position based dynamics, with stiffnesses in 0 .. 1" },
                                        { NULL, NULL } };

// ---- cloth ----

static const scene_choice BENDINGS[] = {
    { "bend_links", "links between the vertices opposite an edge, cheap" },
    { "dihedral", "the angle between two triangles" },
    { "isometric", "quadratic in positions, cheaper than the angle, for cloth that hardly stretches" },
    { "none", "no resistance" },
    { NULL, NULL }
};

static const scene_field CLOTH_FIELDS[] = {
    { "solver", .choices = SOLVERS, .constants = "WISP_SOLVER_", .help = "Solver of links and bending." },
    { "warp_compliance", .map = WISP_MAP_STRETCH_COMPLIANCE,
      .help =
          "Compliance of a link along the warp, with `solver: xpbd`; 0 is inextensible. A map scales those of weft "
          "and shear in proportion." },
    { "weft_compliance", .help = "Compliance of a link across the warp, with `solver: xpbd`." },
    { "shear_compliance", .help = "Compliance of a link between the two, with `solver: xpbd`." },
    { "stretch_stiffness", .map = WISP_MAP_STRETCH_STIFFNESS,
      .help = "Stiffness of links along and across the warp, with `solver: pbd`. A map scales that of shear in "
              "proportion." },
    { "shear_stiffness", .help = "Stiffness of links at 45 degrees to the warp, with `solver: pbd`." },
    { "warp", .help = "Direction of the warp in the mesh before it is turned; not zero." },
    { "bending", .choices = BENDINGS, .constants = "WISP_CLOTH_BENDING_", .help = "How cloth resists bending." },
    { "bend_stiffness", .map = WISP_MAP_BEND_STIFFNESS, .help = "Stiffness against bending, with `solver: pbd`." },
    { "bend_compliance", .map = WISP_MAP_BEND_COMPLIANCE, .help = "Compliance of bend links, with `solver: xpbd`." },
    { "bend_rigidity", .map = WISP_MAP_BEND_RIGIDITY,
      .help = "Bending rigidity of the cloth, with `solver: xpbd` and `bending: dihedral` or `isometric`. With "
              "`bending: bend_links`, that of sharp folds." },
    { "internal_damping", .map = WISP_MAP_INTERNAL_DAMPING,
      .help = "Rate at which relative velocities die; where the cloth is pinned, all velocities." },
    { "wind", .help = "Velocity of the air." },
    { "air_density", .help = "Density of the air." },
    { "drag_coefficient", .map = WISP_MAP_DRAG,
      .help = "Drag coefficient along the relative wind; 0 switches drag off." },
    { "lift_coefficient", .map = WISP_MAP_LIFT,
      .help = "Lift coefficient across the relative wind; 0 switches lift off." },
    { "tethers", .help = "Keeps each vertex within its rest distance to the nearest pin, measured along the mesh." },
    { "tether_slack", .help = "Factor of the rest distance that a tether allows." },
    { "coarse_substeps",
      .help = "Coarse sheets carry the cloth: substeps of the coarsest one in a substep, by BDF2; 0 has none. Needs "
              "xpbd.",
      .initial = "1 of a mesh of more than about 600 vertices that can have them" },
    { "coarse_passes", .help = "Passes over the coarsest sheet in each of its substeps." },
};
static const scene_block CLOTH_BLOCK = SCENE_BLOCK_OF( CLOTH_FIELDS, cloth_def, wisp_scene_surface, cloth );

// ---- balloon ----

static const scene_choice VOLUMES[] = { { "xpbd", "a gas, whose compliance follows from its pressure" },
                                        { "pbd", "a constraint with `volume_stiffness`" },
                                        { NULL, NULL } };

static const scene_field BALLOON_FIELDS[] = {
    { "solver", .choices = SOLVERS, .constants = "WISP_SOLVER_", .help = "Solver of the skin." },
    { "edge_stiffness", .help = "Stiffness of links along edges, with `solver: xpbd`." },
    { "bend_link_stiffness", .help = "Stiffness of bend links, with `solver: xpbd`." },
    { "stretch_stiffness", .help = "Stiffness of links along edges, with `solver: pbd`." },
    { "bend_stiffness", .help = "Stiffness of bend links, with `solver: pbd`." },
    { "volume", .choices = VOLUMES, .constants = "WISP_SOLVER_", .help = "How the volume is held." },
    { "volume_stiffness", .help = "Stiffness of the volume, with `volume: pbd`." },
    { "gas_ratio", .help = "Volume of the gas at atmospheric pressure, in rest volumes; at least `min_gas_ratio`." },
    { "gas_ratio_keyframes", SCENE_ENTRIES, .at = AT( gas_ratio_keyframes ), .of = &GAS_RATIO_KEYFRAMES,
      .help = "Gas ratio over time; it counts from the first pair to the last one, then the gas is left alone.",
      .form = "list of pairs [time, gas_ratio], times rise", .initial = "none" },
    { "inflation_rate", .help = "Gas at atmospheric pressure that flows in; negative lets it out." },
    { "min_gas_ratio", .help = "The gas ratio never falls below this." },
    { "atmospheric_pressure", .help = "Pressure of the air." },
    { "temperature", .help = "Temperature of gas and air." },
    { "gas_molar_mass", .help = "Molar mass of the gas; the default is helium." },
    { "air_molar_mass", .help = "Molar mass of the air." },
    { "buoyancy", .help = "Whether the air carries the balloon." },
    { "drag_coefficient", .help = "Drag coefficient; 0 switches drag off." },
    { "outlet", SCENE_CUSTOM, .read = scene_read_outlet, .help = "Vertices of the outlet.",
      .form = "list of 1 to 64 vertices", .initial = "no outlet" },
    { "outlet_nearest", SCENE_VECTOR, .at = AT( outlet_nearest ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_outlet_nearest ),
      .help = "Point where the mesh starts; the nearest vertex is the outlet, instead of `outlet`.",
      .initial = "no outlet" },
    { "outlet_radius", SCENE_NUMBER, .at = AT( outlet_radius ), .range = RANGE( 0, 1e6 ), .unit = METRES,
      .help = "All vertices within this distance of `outlet_nearest` belong to the outlet too, 64 at most." },
    { "outlet_area", .help = "Area of the outlet." },
    { "outlet_open", .help = "Whether the outlet is open." },
    { "allow_open",
      .help =
          "Closes holes of the mesh by virtual triangles, for the volume only; without it an open mesh is refused." },
};
static const scene_block BALLOON_BLOCK = SCENE_BLOCK_OF( BALLOON_FIELDS, balloon_def, wisp_scene_surface, balloon );

// ---- implicit ----

static const scene_choice STIFFNESS_OF[] = { { "link", "each link alike, so that another mesh is another cloth" },
                                             { "material", "the cloth, so that another mesh is the same cloth" },
                                             { NULL, NULL } };
static const scene_choice WEIGHTS[] = { { "effective", "by effective masses, as published" },
                                        { "none", "1" },
                                        { NULL, NULL } };
static const scene_choice INTEGRATORS[] = { { "euler", "implicit Euler, first order" },
                                            { "bdf2", "implicit, second order" },
                                            { NULL, NULL } };
static const scene_choice LINKS[] = {
    { "mesh", "edges stretch, diagonals bend" },
    { "quad", "of a plane, first neighbours stretch, second neighbours bend; with `stiffness_model: link`" },
    { NULL, NULL }
};

static const scene_field IMPLICIT_FIELDS[] = {
    { "stiffness_model", .choices = STIFFNESS_OF, .constants = "WISP_IMPLICIT_STIFFNESS_",
      .help = "What a stiffness belongs to." },
    { "stretch_stiffness", .help = "Stretch stiffness of a link, or of the material." },
    { "bend_stiffness", .help = "Bending stiffness of a diagonal, with `stiffness_model: link`." },
    { "bend_rigidity",
      .help = "Bending rigidity of the cloth, with `stiffness_model: material`; edges of 20 mm crumple below 5e-5." },
    { "compression_stiffness",
      .help = "Slope of the force where a compressed link starts to bend; 0 takes `stretch_stiffness`." },
    { "link_damping", .help = "Damping of a link." },
    { "weights", .choices = WEIGHTS, .constants = "WISP_IMPLICIT_WEIGHTS_",
      .help = "Weight of the force of a neighbour." },
    { "integrator", .choices = INTEGRATORS, .constants = "WISP_INTEGRATOR_", .help = "Time integration." },
    { "newton_iterations", .help = "Linear solves of a substep." },
    { "max_newton_iterations",
      .help = "Linear solves of a stiff substep at most; 1 makes as many as in other substeps, which is cheaper and "
              "can gain energy." },
    { "tolerance",
      .help = "Residual at which a solve ends, relative to that of standing still; stiff links get 1e-4 at least." },
    { "max_iterations", .help = "Iterations of a solve at most; 0 takes three per vertex." },
    { "links", SCENE_EITHER, .at = AT( has_quad_links ), .choices = LINKS, .help = "Which links the cloth has." },
};
static const scene_block IMPLICIT_BLOCK =
    SCENE_BLOCK_OF( IMPLICIT_FIELDS, implicit_cloth_def, wisp_scene_surface, implicit );

// ---- a surface ----

static const scene_field TRANSFORM_FIELDS[] = {
    { "scale", SCENE_NUMBER, .at = AT( mesh.scale ), .range = SIZE,
      .help = "Factor of the size of the mesh; the scaled shape is the rest shape." },
    { "rotate", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation,
      .help = "Rotation about the origin, before the mesh is moved.", .form = "rotation", .initial = "none" },
    { "translate", SCENE_VECTOR, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES,
      .help = "Displacement after scale and rotation." },
};
static const scene_block TRANSFORM_BLOCK = SCENE_BLOCK_ALONE( TRANSFORM_FIELDS );

static const scene_block COPIES_BLOCK = SCENE_BLOCK_IN( SCENE_COPIES_FIELDS, wisp_scene_surface, copies );

static const scene_field START_FIELDS[] = {
    { "file", SCENE_CUSTOM, .at = offsetof( wisp_scene_start, file ), .read = scene_read_file,
      .help = "Mesh with the positions of all vertices in the order of the mesh, before `transform`, `scale` and "
              "`shape`; its "
              "triangles are not used. Pinned vertices start there too.",
      .form = "path", .initial = "the rest shape" },
    SCENE_START_FIELDS,
};
static const scene_block START_BLOCK = SCENE_BLOCK_IN( START_FIELDS, wisp_scene_surface, start );

#define COLLISION( member ) offsetof( wisp_scene_surface, collision.member )

static const scene_choice FEATURES[] = { { "vertices",
                                           "vertices alone: what is thinner than the cells passes between them" },
                                         { "all", "vertices, edges and triangles" },
                                         { NULL, NULL } };

static const scene_field COLLISION_FIELDS[] = {
    { "thickness", .map = WISP_MAP_COLLISION_THICKNESS,
      .help = "Distance that vertices keep from colliders, on both sides; less room loads it: 5000 weights at the "
              "depth of the thickness. Of implicit cloth, the margin within which a vertex is held.",
      .initial = "a quarter of the mean edge" },
    { "friction_scale", .map = WISP_MAP_COLLISION_FRICTION, .help = "Factor of the friction of the collider." },
    { "max_push_out_speed", .help = "Speed at which a vertex that starts inside is moved out.",
      .initial = "ten mean edges per second" },
    { "features", .choices = FEATURES, .constants = "WISP_COLLISION_",
      .help = "What keeps the thickness from bodies. A plane needs no more than vertices." },
    { "mask", SCENE_CUSTOM, .at = COLLISION( mask ), .read = scene_read_layers,
      .help = "Numbers of the collider layers that stop it.", .form = "list of layers, 0 .. 31",
      .initial = "all layers" },
};
static const scene_block COLLISION_BLOCK =
    SCENE_BLOCK_OF( COLLISION_FIELDS, collision_def, wisp_scene_surface, collision );

static const scene_choice SWEEPS[] = {
    { "colour", "colour by colour, stable at any stiffness" },
    { "list", "along the mesh from the pins, carries corrections farther, can gain energy" },
    { NULL, NULL }
};

// `generate` stands before what names its vertices, and the effects before `compute`.
static const scene_field SURFACE_FIELDS[] = {
    SCENE_NAME_FIELD,
    { "file", SCENE_CUSTOM, .at = AT( mesh.file ), .read = scene_read_file,
      .help = "Mesh to read (`.obj`, `.ply`, `.glb`, `.gltf`), relative to the folder of the scene.", .form = "path",
      .initial = "none" },
    { "generate", SCENE_CUSTOM, .at = AT( mesh ), .read = scene_read_mesh_generate,
      .help = "Generates the mesh instead of reading it.", .form = "block" },
    { "instance_of", SCENE_CUSTOM, .read = scene_read_later_name,
      .help = "Surface above this one, itself no instance, whose fabric this one shares.",
      .form = "name of a surface", .initial = "none" },
    { "repair", SCENE_WORDS, .at = AT( mesh.repairs ), .choices = SCENE_REPAIR_WORDS, .bits = SCENE_REPAIR_BITS,
      .help = "Repairs of the mesh before it is used; what was repaired is printed.", .initial = "none" },
    { "weld_distance", SCENE_NUMBER, .at = AT( mesh.weld_distance ), .range = SIZE, .unit = METRES,
      .help = "Distance of `repair: [weld]`, before `transform.scale`.",
      .initial = "a hundred-thousandth of the longest side of the mesh" },
    { "require", SCENE_WORDS, .at = AT( mesh.demands ), .choices = SCENE_REQUIRE_WORDS, .bits = SCENE_REQUIRE_BITS,
      .help = "Properties that the repaired mesh must have; a mesh without them is refused.", .initial = "none" },
    { "transform", SCENE_BLOCK, .block = &TRANSFORM_BLOCK, .help = "Scales, turns and moves the mesh." },
    { "copies", SCENE_BLOCK, .block = &COPIES_BLOCK,
      .help = "Makes several entries of this one, in a grid; they share its fabric." },
    { "start", SCENE_BLOCK, .at = AT( has_start ), .block = &START_BLOCK,
      .help = "Starts away from the rest shape; pinned vertices are only scaled." },
    { "area_density", SCENE_NUMBER, .map = WISP_MAP_AREA_DENSITY, .at = AT( area_density ),
      .range = RANGE( 1e-12, 1e12 ), .unit = DENSITIES, .help = "Mass per area." },
    { "vertex_mass", SCENE_NUMBER, .at = AT( vertex_mass ), .range = RANGE( 1e-12, 1e12 ), .unit = MASSES,
      .help = "Mass of every vertex, instead of the density.", .initial = "by area" },
    { "mass_ratio", SCENE_NUMBER, .at = AT( mass_ratio ), .range = RANGE( 1e-9, 1e9 ),
      .help =
          "Mass of the lowest vertex over that of the highest, as placed; between them it grows by equal factors." },
    SCENE_PIN_FIELDS( AT( pins ) ),
    { "pin_groups", SCENE_ENTRIES, .at = AT( pin_groups ), .of = &SCENE_PIN_GROUPS,
      .help = "Further pins, in groups that move, are attached and are released each by itself.",
      .form = "list of blocks", .initial = "none" },
    { "animation", SCENE_BLOCK, .at = AT( has_animation ), .block = &SCENE_ANIMATION_BLOCK,
      .help = "Clips of keyframes that move the skeleton of the mesh, a glTF file. Pins and motion targets go "
              "along; without `cloth`, `balloon` and `implicit` every vertex does." },
    { "velocity", SCENE_VECTOR, .at = AT( velocity ), .range = VELOCITY, .unit = SPEEDS,
      .help = "Velocity at the start." },
    { "angular_velocity", SCENE_VECTOR, .at = AT( angular_velocity ), .range = VELOCITY, .unit = TURNS,
      .help = "Angular velocity at the start, about the centre of mass." },
    { "gravity", SCENE_VECTOR, .at = AT( gravity ), .range = ACCELERATION, .unit = ACCELERATIONS,
      .help = "Gravity of this surface.", .initial = "that of the scene" },
    { "damping", SCENE_NUMBER, .map = WISP_MAP_DAMPING, .at = AT( damping ), .range = RANGE( 0, 1e9 ), .unit = RATES,
      .help = "Rate at which all velocities die." },
    { "substeps", SCENE_WHOLE, .at = AT( substeps ), .range = RANGE( 0, 10000 ),
      .help = "Substeps of this surface, rounded up to a multiple of those of the scene, which has the fewest. "
              "Those with `contact` all have those of the one with the most.",
      .initial = "those of the scene" },
    { "strain_limit", SCENE_CUSTOM, .at = AT( strain_limit ), .read = scene_read_strain_limit,
      .help = "Shortest and longest length of an edge, in rest lengths.",
      .form = "pair [min, max], min in 0 .. 1, max in 1 .. 1e6", .initial = "none" },
    { "cloth", SCENE_BLOCK, .at = AT( has_cloth ), .block = &CLOTH_BLOCK,
      .help = "Cloth by position based dynamics." },
    { "balloon", SCENE_BLOCK, .at = AT( has_balloon ), .block = &BALLOON_BLOCK,
      .help = "Balloon: a closed skin filled with gas; not with `cloth`." },
    { "implicit", SCENE_BLOCK, .at = AT( has_implicit ), .block = &IMPLICIT_BLOCK,
      .help = "Cloth by an implicit solver; not with `cloth`, `balloon` or `strain_limit`." },
    { "solve_order", SCENE_CHOICE, .at = AT( solve_order ), .choices = SWEEPS, .constants = "WISP_SOLVE_ORDER_",
      .help = "Order in which constraints are projected." },
    { "tile_size", SCENE_CUSTOM, .at = AT( tile_size ), .read = scene_read_tile_size,
      .help = "Number of vertices of a tile; 0 lets the engine choose.",
      .form = "0, or a multiple of 8 in 64 .. 65536", .initial = "0" },
    { "collision", SCENE_USUAL, .at = AT( has_collision ), .block = &COLLISION_BLOCK, .initial = SCENE_COLLIDES,
      .help = "Collision with colliders." },
    { "collider", SCENE_BLOCK, .at = AT( has_collider ), .block = &SCENE_SURFACE_COLLIDER_BLOCK,
      .help = "Makes the surface a collider for others; it deforms, and they do not push it back." },
    { "contact", SCENE_BLOCK, .at = AT( has_contact ), .block = &SCENE_CONTACT_BLOCK,
      .help = "Contact with other participants and with itself." },
    { "boundary", SCENE_BLOCK, .at = AT( has_boundary ), .block = &SCENE_BOUNDARY_BLOCK,
      .help = "Layer of points on the surface, to draw and export; it changes the motion only with "
              "`contact.level: spheres`." },
    { "motion_constraints", SCENE_BLOCK, .at = AT( has_motion_constraints ), .block = &SCENE_MOTION_CONSTRAINTS_BLOCK,
      .help =
          "Keeps vertices near targets, which start where the vertices start, and out of a backstop behind them." },
    { "membrane", SCENE_BLOCK, .at = AT( has_membrane ), .block = &SCENE_MEMBRANE_BLOCK,
      .help = "Triangles of rubber instead of links, also as the skin of a `balloon`; bending and air by `cloth`." },
    { "tearing", SCENE_BLOCK, .at = AT( has_tearing ), .block = &SCENE_TEARING_BLOCK,
      .help =
          "Splits the cloth where it is pulled too hard; needs `cloth` by xpbd without coarse sheets or tethers." },
    { "frame", SCENE_BLOCK, .at = AT( has_frame ), .block = &SCENE_FRAME_BLOCK,
      .help = "A frame that moves and carries the surface by what that does not feel of it; not with `implicit`." },
    { "max_speed", SCENE_NUMBER, .at = AT( max_speed ), .range = RANGE( 1e-6, 1e6 ), .unit = SPEEDS,
      .help = "Largest speed of a vertex; faster velocities are scaled down and counted.", .initial = "no limit" },
    { "sleep", SCENE_BLOCK, .at = AT( has_sleep ), .block = &SCENE_SURFACE_SLEEP_BLOCK,
      .help = "A surface that rests costs nothing until something reaches or changes it." },
    { "detail", SCENE_BLOCK, .at = AT( has_detail ), .block = &SCENE_SURFACE_DETAIL_BLOCK,
      .help = "Level of detail: a surface that is far away or out of sight costs less." },
    { "compute", SCENE_WORDS, .given = AT( has_compute ), .choices = WORDS, .switches = REQUESTS, .check = check_word,
      .help = "What is computed for output and statistics.", .initial = "`points`; `[]`: none" },
};
#undef AT
const scene_block SCENE_SURFACE_BLOCK = SCENE_BLOCK_ALONE( SURFACE_FIELDS );

// ---- lists ----

// ---- an entry ----

static wisp_status check_source( scene_reader* r, const text_node* node, const wisp_scene_surface* surface )
{
    static const char* const of_fabric[] = { "repair",      "weld_distance", "require",
                                             "solve_order", "tile_size",     "transform.scale" };
    const bool instance = text_find_path( node, "instance_of" ) != NULL;
    const int sources = ( surface->mesh.file != NULL ) + surface->mesh.is_generated + instance;
    const scene_case cases[] = {
        { sources == 0, NULL, "got none of 'file', 'generate' and 'instance_of', expected one of them" },
        { sources > 1, NULL, "got more than one of 'file', 'generate' and 'instance_of', expected one of them" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    WISP_TRY( scene_refuse_keys( r, node, of_fabric, instance ? WISP_COUNT( of_fabric ) : 0,
                                 "is not possible with 'instance_of'" ) );
    return scene_check_weld( r, node, &surface->mesh );
}

static wisp_status check_cloth( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const wisp_vec3 warp = s->cloth.warp;
    const scene_case cases[] = {
        { !( fabsf( warp.x ) + fabsf( warp.y ) + fabsf( warp.z ) >= 1e-5f ), NULL, "cloth.warp is zero" },
        { s->cloth.coarse_substeps > 0 && s->cloth.solver == WISP_SOLVER_PBD, NULL,
          "cloth.coarse_substeps needs the solver xpbd, but 'solver' is pbd" },
    };
    return scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) );
}

static wisp_status check_balloon( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const wisp_balloon_def* b = &s->balloon;
    const scene_case cases[] = {
        { b->outlet_count > 0 && s->has_outlet_nearest, NULL,
          "got both balloon.outlet and balloon.outlet_nearest, expected one of them" },
        { b->outlet_open && b->outlet_count == 0 && !s->has_outlet_nearest, NULL,
          "balloon.outlet_open is true, but the balloon has no outlet" },
        { s->outlet_radius > 0.0f && !s->has_outlet_nearest, NULL,
          "balloon.outlet_radius needs balloon.outlet_nearest" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    if ( b->gas_ratio < b->min_gas_ratio )
    {
        return scene_refuse_node( r, node, "got balloon.gas_ratio %g, expected at least balloon.min_gas_ratio, %g",
                                  (double)b->gas_ratio, (double)b->min_gas_ratio );
    }
    for ( int i = 0; i < s->gas_ratio_keyframe_count; ++i )
    {
        if ( s->gas_ratio_keyframes[i].gas_ratio < b->min_gas_ratio )
        {
            return scene_refuse_node(
                r, node, "got %g in balloon.gas_ratio_keyframes[%d], expected at least balloon.min_gas_ratio, %g",
                (double)s->gas_ratio_keyframes[i].gas_ratio, i, (double)b->min_gas_ratio );
        }
    }
    return WISP_OK;
}

// What is refused of a plane is not what an instance shares: that is known once its source is.
static wisp_status check_quad_links( scene_reader* r, const text_node* node, const wisp_scene_mesh* mesh )
{
    return mesh->is_generated && mesh->generator.shape == WISP_MESH_PLANE_REGULAR
               ? WISP_OK
               : scene_refuse_node( r, node, "implicit.links 'quad' needs 'generate: { shape: plane }'" );
}

static wisp_status check_implicit( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const scene_case cases[] = {
        { s->has_cloth, NULL, "got both 'cloth' and 'implicit', expected one of them" },
        { s->has_balloon, NULL, "got both 'balloon' and 'implicit', expected one of them" },
        { s->strain_limit[0] > 0.0f || s->strain_limit[1] < INFINITY, NULL,
          "got both 'strain_limit' and 'implicit', expected one of them" },
        { s->has_collision && s->collision.features == WISP_COLLISION_ALL, NULL,
          "collision.features 'all' is not possible with 'implicit'" },
        { s->has_quad_links && s->implicit.stiffness_model == WISP_IMPLICIT_STIFFNESS_MATERIAL, NULL,
          "implicit.links 'quad' needs 'stiffness_model: link'" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    return s->has_quad_links && !text_find_path( node, "instance_of" ) ? check_quad_links( r, node, &s->mesh )
                                                                       : WISP_OK;
}

static wisp_status check_entry( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const bool pinned = wisp_scene_has_pins( s ) || s->has_animation;
    const bool has_own = s->pins.vertex_count + s->pins.box_count + s->pins.nearest_count > 0 || s->has_animation;
    const text_node* level = text_find_path( node, "detail.level" );
    const scene_case cases[] = {
        { s->has_cloth && s->has_balloon, NULL, "got both 'cloth' and 'balloon', expected one of them" },
        { s->pins.path.count > 0 && !has_own, NULL, "'pin_keyframes' moves pins, but nothing is pinned" },
        { s->pins.has_pivot && !has_own, NULL, "'pin_pivot' moves pins, but nothing is pinned" },
        { s->has_cloth && s->cloth.tethers && !pinned, NULL, "cloth.tethers needs pins, but nothing is pinned" },
    };
    WISP_TRY( check_source( r, node, s ) );
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    WISP_TRY( level ? scene_check_surface_detail( r, level, s, s->detail.level ) : WISP_OK );
    WISP_TRY( scene_check_held( r, node, s ) );
    WISP_TRY( s->has_animation ? scene_check_animation( r, node, s ) : WISP_OK );
    WISP_TRY( s->has_boundary ? scene_check_boundary( r, node, s ) : WISP_OK );
    WISP_TRY( s->has_implicit ? check_implicit( r, node, s ) : WISP_OK );
    WISP_TRY( s->has_cloth ? check_cloth( r, node, s ) : WISP_OK );
    return s->has_balloon ? check_balloon( r, node, s ) : WISP_OK;
}

wisp_scene_surface scene_default_surface( wisp_vec3 gravity )
{
    const wisp_surface_def def = wisp_default_surface_def();
    return ( wisp_scene_surface ){
        .mesh = { .generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR ), .scale = 1.0f },
        .copies = { .count = 1 },
        .start = scene_default_start(),
        .mass_ratio = 1.0f,
        .instance_of = -1,
        .pins = scene_default_pins(),
        .pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .area_density = def.area_density,
        .vertex_mass = def.vertex_mass,
        .gravity = gravity,
        .strain_limit = { 0.0f, INFINITY },
        .cloth = wisp_default_cloth_def(),
        .balloon = wisp_default_balloon_def(),
        .implicit = wisp_default_implicit_cloth_def(),
        .solve_order = wisp_default_fabric_def().solve_order,
        .animation = { .blend = 0.3f },
        .membrane = wisp_default_membrane_def(),
        .tearing = wisp_default_tearing_def(),
        .max_new_vertices = -1,
        .motion_constraints = wisp_default_motion_constraints_def(),
        .frame = wisp_default_moving_frame_def(),
        .max_speed = INFINITY,
        .sleep = wisp_default_sleep_def(),
        .detail = wisp_default_detail_def(),
        .collision = wisp_default_collision_def(),
        .collider = wisp_default_collider_def(),
        .contact = wisp_default_contact_def(),
        .boundary = wisp_default_boundary_def(),
    };
}

bool wisp_scene_is_driven( const wisp_scene_surface* surface )
{
    return surface->has_animation &&
           !( surface->has_cloth || surface->has_balloon || surface->has_implicit || surface->has_membrane );
}

static wisp_status read_entry( scene_reader* r, const text_node* node, int index, void* entries )
{
    wisp_scene_surface* surface = (wisp_scene_surface*)entries + index;
    *surface = scene_default_surface( r->scene->gravity );
    surface->line = node->line;
    surface->column = node->column;
    surface->has_collision = r->body_count > ( text_find_path( node, "collider" ) != NULL );
    r->entry = surface;
    WISP_TRY( scene_read_block( r, node, &SCENE_SURFACE_BLOCK, surface ) );
    if ( wisp_scene_is_driven( surface ) && text_find_path( node, "collision" ) == NULL )
    {
        surface->has_collision = false;
    }
    const bool has_links = surface->has_membrane == false && surface->cloth.solver == WISP_SOLVER_XPBD;
    if ( surface->cloth.coarse_substeps < 0 && ( has_links == false || surface->has_tearing ) )
    {
        surface->cloth.coarse_substeps = 0;
    }
    return check_entry( r, node, surface );
}

// ---- instances ----

// A source comes before its instances, so there is no circle, and it is no instance itself.
static wisp_status find_source( scene_reader* r, const text_node* node, int i )
{
    wisp_scene_surface* surface = &r->scene->surfaces[i];
    WISP_TRY( scene_read_named( r, node, SCENE_SURFACE, &surface->instance_of ) );
    const wisp_scene_surface* source = &r->scene->surfaces[surface->instance_of];
    if ( surface->instance_of >= i )
    {
        return scene_refuse_node( r, node, "got '%s', expected an entry above this one", source->name );
    }
    if ( source->instance_of >= 0 )
    {
        return scene_refuse_node( r, node, "got '%s', which is an instance, expected '%s'", source->name,
                                  r->scene->surfaces[source->instance_of].name );
    }
    if ( surface->has_cloth && surface->cloth.tethers && !wisp_scene_has_pins( source ) )
    {
        return scene_refuse_node( r, node, "cloth.tethers needs pins, but '%s' has none", source->name );
    }
    return surface->has_quad_links ? check_quad_links( r, node, &source->mesh ) : WISP_OK;
}

static wisp_status bind_instance( scene_reader* r, const text_node* item, int index, void* context )
{
    (void)context;
    const text_node* source = text_find_path( item, "instance_of" );
    const size_t outside = scene_enter_key( r, "instance_of" );
    WISP_TRY( source ? find_source( r, source, index ) : WISP_OK );
    scene_leave( r, outside );
    return WISP_OK;
}

// What a file holds is only known when it is read.
int64_t scene_surface_vertices( const wisp_scene* scene, int surface )
{
    const wisp_scene_surface* s = &scene->surfaces[surface];
    const wisp_scene_mesh* mesh = &scene->surfaces[s->instance_of >= 0 ? s->instance_of : surface].mesh;
    return mesh->is_generated ? scene_generator_vertices( &mesh->generator ) : 0;
}

// Made meshes are counted, so that a short scene cannot ask for more memory than a long one.
static wisp_status bind_instances( scene_reader* r, const text_node* node, void* at )
{
    (void)at;
    WISP_TRY( scene_read_items( r, node, bind_instance, NULL ) );
    int64_t sum = 0;
    for ( int i = 0; i < r->scene->surface_count; ++i )
    {
        sum += scene_surface_vertices( r->scene, i );
    }
    return sum <= WISP_SCENE_MAX_VERTICES
               ? WISP_OK
               : scene_refuse_node( r, node, "got %lld vertices in all surfaces, expected at most %d", (long long)sum,
                                    WISP_SCENE_MAX_VERTICES );
}

const scene_list SCENE_SURFACES_LIST = { .what = "a list of surfaces",
                                         .size = sizeof( wisp_scene_surface ),
                                         .most = WISP_SCENE_MAX_SURFACES,
                                         .read = read_entry,
                                         .finish = bind_instances,
                                         .is_named = true,
                                         .named = SCENE_SURFACE };
