// Colliders: a table for each shape, so that a size that the shape does not have is refused as unknown.
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>

#define AT( member ) offsetof( wisp_scene_collider, member )
#define DEF( member ) offsetof( wisp_scene_collider, def.member )

static const scene_choice SHAPES[] = { { "plane", "everything below y = 0 of its own frame" },
                                       { "sphere", "a ball" },
                                       { "capsule", "a capsule along y" },
                                       { "box", "a box" },
                                       { "mesh", "a triangle mesh" },
                                       { "tapered_capsule", "a capsule along y with two radii" },
                                       { "convex", "the convex hull of the vertices of a mesh" },
                                       { "height_field", "everything below a grid of heights" },
                                       { NULL, NULL } };
static const scene_choice WORDS[] = { { "reaction", "force that surfaces and strands exert on it" }, { NULL, NULL } };

// The rotation stands before the keyframes, the first of which takes it over unless it has its own.
static const scene_block COPIES_BLOCK = SCENE_BLOCK_IN( SCENE_COPIES_FIELDS, wisp_scene_collider, copies );
static const size_t REQUESTS[] = { AT( request_reaction ) };

static scene_read_fn read_friction, read_heights;

#define COMMON_FIELDS                                                                                                \
    SCENE_NAME_FIELD,                                                                                                \
        { "shape",         .member = "kind", .required = true, .choices = SHAPES, .constants = "WISP_COLLIDER_",     \
          .help = "Shape." },                                                                                        \
        { "position",          SCENE_VECTOR,   .at = DEF( pose.translation ),                                        \
          .range = COORDINATE, .unit = METRES, .help = "Where it stands." },                                         \
        { "rotation",         SCENE_CUSTOM,      .at = DEF( pose.rotation ), .read = scene_read_rotation,            \
          .form = "rotation", .initial = "none", .help = "How it is turned." },                                      \
        { "keyframes",                                                                                               \
          SCENE_ENTRIES,                                                                                             \
          .at = AT( path ),                                                                                          \
          .of = &SCENE_COLLIDER_PATH,                                                                                \
          .form = "list of keyframes {time, position, rotation}",                                                    \
          .initial = "none",                                                                                         \
          .help = "Motion; before the first keyframe it comes from `position` at time 0." },                         \
        { "friction",                                                                                                \
          SCENE_CUSTOM,                                                                                              \
          .read = read_friction,                                                                                     \
          .form = "number, or pair [static, kinetic], 0 .. 1e6",                                                     \
          .initial = "0.5",                                                                                          \
          .help = "Friction coefficients; kinetic friction is at most static friction." },                           \
        { "thickness", .help = "Thickness that is added to that of what touches it." },                              \
        { "restitution", .help = "Fraction of the approach speed that a vertex leaves with." },                      \
        { "layers",                                                                                                  \
          SCENE_CUSTOM,                                                                                              \
          .at = DEF( layers ),                                                                                       \
          .read = scene_read_layers,                                                                                 \
          .form = "list of layers, 0 .. 31",                                                                         \
          .initial = "[0]",                                                                                          \
          .help = "Layers; `collision.mask` chooses among them." },                                                  \
        { "copies", SCENE_BLOCK, .block = &COPIES_BLOCK,                                                             \
          .help = "Makes several entries of this one, in a grid, as of a surface; they move as it does." },          \
    {                                                                                                                \
        "compute", SCENE_WORDS, .choices = WORDS, .switches = REQUESTS, .initial = "none",                           \
                                .help = "What to compute; `wisp run` prints it."                                     \
    }

static const scene_field PLANE_FIELDS[] = { COMMON_FIELDS };
static const scene_field SPHERE_FIELDS[] = {
    COMMON_FIELDS,
    { "radius", .help = "Radius." },
};
static const scene_field CAPSULE_FIELDS[] = {
    COMMON_FIELDS,
    { "radius", .help = "Radius." },
    { "half_length", .help = "From the middle to the centre of a cap, along y." },
};
static const scene_field TAPERED_CAPSULE_FIELDS[] = {
    COMMON_FIELDS,
    { "top_radius", .help = "Radius of the cap at +y." },
    { "bottom_radius", .help = "Radius of the cap at -y." },
    { "half_length", .help = "From the middle to the centre of a cap, along y." },
};
static const scene_field BOX_FIELDS[] = {
    COMMON_FIELDS,
    { "half_extent", .help = "Half of the edges along x, y and z." },
};
#define MESH_SOURCE_FIELDS                                                                                           \
    { "file",                                                                                                        \
      SCENE_CUSTOM,                                                                                                  \
      .at = AT( mesh.file ),                                                                                         \
      .read = scene_read_file,                                                                                       \
      .help = "Mesh to read (`.obj`, `.ply`, `.glb`, `.gltf`), relative to the folder of the scene.",                \
      .form = "path",                                                                                                \
      .initial = "none" },                                                                                           \
    {                                                                                                                \
        "generate", SCENE_CUSTOM, .at = AT( mesh ), .read = scene_read_mesh_generate,                                \
                                  .help = "Generates the mesh instead of reading it, as for a surface.",             \
                                  .form = "block"                                                                    \
    }
static const scene_field MESH_FIELDS[] = {
    COMMON_FIELDS,
    MESH_SOURCE_FIELDS,
    { "repair", SCENE_WORDS, .at = AT( mesh.repairs ), .choices = SCENE_REPAIR_WORDS, .bits = SCENE_REPAIR_BITS,
      .help = "Repairs of the mesh, as for a surface.", .initial = "none" },
    { "weld_distance", SCENE_NUMBER, .at = AT( mesh.weld_distance ), .range = SIZE, .unit = METRES,
      .help = "Distance of `repair: [weld]`, before `scale`.",
      .initial = "a hundred-thousandth of the longest side of the mesh" },
    { "require", SCENE_WORDS, .at = AT( mesh.demands ), .choices = SCENE_REQUIRE_WORDS, .bits = SCENE_REQUIRE_BITS,
      .help = "Properties that the repaired mesh must have, as for a surface.", .initial = "none" },
    { "scale", SCENE_NUMBER, .at = AT( mesh.scale ), .range = SIZE, .help = "Factor of the size of the mesh." },
    { "double_sided", .help = "The mesh has two sides and no inside; otherwise it must be closed." },
    { "tracks",
      .help = "Closest triangles are searched once per step and tracked in between; otherwise in each substep." },
};
static const scene_field CONVEX_FIELDS[] = {
    COMMON_FIELDS,
    MESH_SOURCE_FIELDS,
    { "scale", SCENE_NUMBER, .at = AT( mesh.scale ), .range = SIZE, .help = "Factor of the size of the mesh." },
};
static const scene_field HEIGHT_FIELD_FIELDS[] = {
    COMMON_FIELDS,
    { "heights", SCENE_CUSTOM, .required = true, .at = 0, .read = read_heights,
      .form = "list of 2 .. 8192 rows along z, each of as many numbers along x, -1e6 .. 1e6", .unit = METRES,
      .help = "Heights of a grid around the y axis." },
    { "spacing", .help = "Distance of the heights along x and z." },
};

#define BLOCK( fields ) SCENE_BLOCK_OF( fields, collider_def, wisp_scene_collider, def )
const scene_block SCENE_COLLIDER_BLOCKS[WISP_COLLIDER_COUNT] = {
    [WISP_COLLIDER_PLANE] = BLOCK( PLANE_FIELDS ),
    [WISP_COLLIDER_SPHERE] = BLOCK( SPHERE_FIELDS ),
    [WISP_COLLIDER_CAPSULE] = BLOCK( CAPSULE_FIELDS ),
    [WISP_COLLIDER_BOX] = BLOCK( BOX_FIELDS ),
    [WISP_COLLIDER_MESH] = BLOCK( MESH_FIELDS ),
    [WISP_COLLIDER_TAPERED_CAPSULE] = BLOCK( TAPERED_CAPSULE_FIELDS ),
    [WISP_COLLIDER_CONVEX] = BLOCK( CONVEX_FIELDS ),
    [WISP_COLLIDER_HEIGHT_FIELD] = BLOCK( HEIGHT_FIELD_FIELDS ),
};

// Read one number, or a pair of static and kinetic friction.
static wisp_status read_friction( scene_reader* r, const text_node* node, void* at )
{
    static const scene_field pair[2] = { { "friction", SCENE_NUMBER, .range = RANGE( 0, 1e6 ) },
                                         { "friction", SCENE_NUMBER, .range = RANGE( 0, 1e6 ) } };
    wisp_collider_def* def = &( (wisp_scene_collider*)at )->def;
    if ( node->kind != TEXT_LIST )
    {
        WISP_TRY( scene_read_number( r, node, pair, &def->static_friction ) );
        def->kinetic_friction = def->static_friction;
        return WISP_OK;
    }
    WISP_TRY( scene_read_pair( r, node, "a number, or a pair [static, kinetic]", pair, &def->static_friction,
                               &def->kinetic_friction ) );
    return def->kinetic_friction <= def->static_friction
               ? WISP_OK
               : scene_refuse_node( r, node, "got kinetic friction %g, expected at most static friction, %g",
                                    (double)def->kinetic_friction, (double)def->static_friction );
}

static wisp_status read_height_row( scene_reader* r, const text_node* row, int index, void* at )
{
    static const scene_field field = { "heights", SCENE_NUMBER, .range = COORDINATE };
    const wisp_collider_def* def = at;
    float* heights = (float*)(uintptr_t)def->heights; // memory of the scene
    WISP_TRY( scene_expect_list( r, row, "a row of heights" ) );
    return row->count == def->height_count_x
               ? scene_read_numbers( r, row, &field, heights + (size_t)index * (size_t)def->height_count_x )
               : scene_refuse_node( r, row, "got a row of %d heights, expected %d as in the first row", row->count,
                                    def->height_count_x );
}

// Rows along z of heights along x.
static wisp_status read_heights( scene_reader* r, const text_node* node, void* at )
{
    wisp_collider_def* def = &( (wisp_scene_collider*)at )->def;
    WISP_TRY( scene_expect_list( r, node, "a list of rows of heights" ) );
    const text_node* first = text_first( node );
    def->height_count_z = node->count;
    def->height_count_x = first && first->kind == TEXT_LIST ? first->count : 0;
    if ( node->count < 2 || node->count > 8192 || def->height_count_x < 2 || def->height_count_x > 8192 )
    {
        return scene_refuse_node( r, node, "got %d rows of %d heights, expected 2 to 8192 of each", node->count,
                                  def->height_count_x );
    }
    def->heights = scene_take( r->scene, (size_t)node->count * (size_t)def->height_count_x, sizeof *def->heights );
    return def->heights ? scene_read_items( r, node, read_height_row, def ) : scene_no_memory( r );
}

wisp_scene_collider scene_default_collider( void )
{
    return ( wisp_scene_collider ){
        .def = wisp_default_collider_def(),
        .copies = { .count = 1 },
        .mesh = { .generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR ), .scale = 1.0f },
    };
}

static wisp_status read_entry( scene_reader* r, const text_node* node, int index, void* entries )
{
    wisp_scene_collider* collider = (wisp_scene_collider*)entries + index;
    *collider = scene_default_collider();
    collider->line = node->line;
    collider->column = node->column;
    r->entry = collider;
    int kind = 0;
    WISP_TRY( scene_read_shape( r, node, SHAPES, &kind ) );
    WISP_TRY( scene_read_block( r, node, &SCENE_COLLIDER_BLOCKS[kind], collider ) );
    if ( kind == WISP_COLLIDER_MESH || kind == WISP_COLLIDER_CONVEX )
    {
        WISP_TRY( scene_expect_one( r, node, "file", collider->mesh.file != NULL, "generate",
                                    collider->mesh.is_generated ) );
    }
    return scene_check_weld( r, node, &collider->mesh );
}

const scene_list SCENE_COLLIDERS_LIST = { .what = "a list of colliders",
                                          .size = sizeof( wisp_scene_collider ),
                                          .most = WISP_SCENE_MAX_COLLIDERS,
                                          .read = read_entry,
                                          .is_named = true,
                                          .named = SCENE_COLLIDER };
