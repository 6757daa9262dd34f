// Colliders: a table for each shape, so that a size that the shape does not have is refused as unknown.
#include "scene_ranges.h"

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
static const scene_field COPIES_FIELDS[] = { SCENE_COPIES_FIELDS( wisp_scene_collider ) };
static const scene_block COPIES_BLOCK = SCENE_BLOCK_ALONE( COPIES_FIELDS );

#define COMMON_FIELDS                                                                                                \
    { "name",                                                                                                        \
      SCENE_CUSTOM,                                                                                                  \
      .required = true,                                                                                              \
      .at = AT( name ),                                                                                              \
      .read = scene_read_name,                                                                                       \
      .form = "1 to 64 of the characters A-Z a-z 0-9 _ -",                                                           \
      .help = "Unique among strands, surfaces, colliders and seams." },                                              \
        { "shape",         .member = "kind", .required = true, .choices = SHAPES, .constants = "WISP_COLLIDER_",     \
          .help = "Shape." },                                                                                        \
        { "position",          SCENE_VECTOR,   .at = DEF( pose.translation ),                                        \
          .range = COORDINATE, .unit = METRES, .help = "Where it stands." },                                         \
        { "rotation",         SCENE_CUSTOM,      .at = DEF( pose.rotation ), .read = scene_read_rotation,            \
          .form = "rotation", .initial = "none", .help = "How it is turned." },                                      \
        { "keyframes",                                                                                               \
          SCENE_CUSTOM,                                                                                              \
          .read = scene_read_collider_path,                                                                          \
          .form = "list of keyframes {time, position, rotation}",                                                    \
          .initial = "none",                                                                                         \
          .help = "Motion; before the first keyframe it comes from `position` at time 0." },                         \
        { "friction",                                                                                                \
          SCENE_CUSTOM,                                                                                              \
          .read = scene_read_friction,                                                                               \
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
        "compute", SCENE_CUSTOM, .at = AT( request_reaction ), .read = scene_read_collider_request,                  \
                                 .choices = WORDS, .form = "list of words", .initial = "none",                       \
                                 .help = "What to compute; `wisp run` prints it."                                    \
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
    { "repair", SCENE_CUSTOM, .at = AT( mesh.repairs ), .read = scene_read_repair, .choices = SCENE_REPAIR_WORDS,
      .help = "Repairs of the mesh, as for a surface.", .form = "list of words", .initial = "none" },
    { "weld_distance", SCENE_NUMBER, .at = AT( mesh.weld_distance ), .range = SIZE, .unit = METRES,
      .help = "Distance of `repair: [weld]`, before `scale`.",
      .initial = "a hundred-thousandth of the longest side of the mesh" },
    { "require", SCENE_CUSTOM, .at = AT( mesh.demands ), .read = scene_read_require, .choices = SCENE_REQUIRE_WORDS,
      .help = "Properties that the repaired mesh must have, as for a surface.", .form = "list of words",
      .initial = "none" },
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
    { "heights", SCENE_CUSTOM, .required = true, .at = 0, .read = scene_read_heights,
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

static wisp_status read_word( scene_reader* r, const scene_node* item, int index, void* context )
{
    bool* is_requested = context;
    int word = 0;
    const wisp_status status = scene_read_choice( r, item, WORDS, &word );
    if ( !status && index > 0 )
    {
        return scene_refuse_node( r, item, "'%s' is listed twice", WORDS[word].word );
    }
    *is_requested = true;
    return status;
}

wisp_status scene_read_collider_request( scene_reader* r, const scene_node* node, void* at )
{
    const wisp_status status = scene_expect_list( r, node, "a list of words" );
    return status ? status : scene_read_items( r, node, read_word, at );
}

// Read one number, or a pair of static and kinetic friction.
wisp_status scene_read_friction( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field field = { "friction", SCENE_NUMBER, .range = RANGE( 0, 1e6 ) };
    wisp_collider_def* def = &( (wisp_scene_collider*)at )->def;
    if ( node->kind != SCENE_LIST )
    {
        wisp_status status = scene_read_number( r, node, &field, &def->static_friction );
        def->kinetic_friction = def->static_friction;
        return status;
    }
    wisp_status status = scene_expect_pair( r, node, "a number, or a pair [static, kinetic]" );
    const scene_node* first = scene_first( r->tree, node );
    status = status ? status : scene_read_number( r, first, &field, &def->static_friction );
    status = status ? status : scene_read_number( r, scene_next( r->tree, first ), &field, &def->kinetic_friction );
    if ( !status && def->kinetic_friction > def->static_friction )
    {
        return scene_refuse_node( r, node, "got kinetic friction %g, expected at most static friction, %g",
                                  (double)def->kinetic_friction, (double)def->static_friction );
    }
    return status;
}

typedef struct height_rows
{
    float* heights;
    int width;
} height_rows;

static wisp_status read_height_row( scene_reader* r, const scene_node* row, int index, void* context )
{
    static const scene_field field = { "heights", SCENE_NUMBER, .range = COORDINATE };
    const height_rows* rows = context;
    wisp_status status = scene_expect_list( r, row, "a row of heights" );
    if ( !status && row->count != rows->width )
    {
        return scene_refuse_node( r, row, "got a row of %d heights, expected %d as in the first row", row->count,
                                  rows->width );
    }
    return status ? status
                  : scene_read_numbers( r, row, &field, rows->heights + (size_t)index * (size_t)rows->width );
}

// Rows along z of heights along x.
wisp_status scene_read_heights( scene_reader* r, const scene_node* node, void* at )
{
    wisp_collider_def* def = &( (wisp_scene_collider*)at )->def;
    wisp_status status = scene_expect_list( r, node, "a list of rows of heights" );
    if ( status )
    {
        return status;
    }
    const scene_node* first = scene_first( r->tree, node );
    def->height_count_z = node->count;
    def->height_count_x = first && first->kind == SCENE_LIST ? first->count : 0;
    if ( node->count < 2 || node->count > 8192 || def->height_count_x < 2 || def->height_count_x > 8192 )
    {
        return scene_refuse_node( r, node, "got %d rows of %d heights, expected 2 to 8192 of each", node->count,
                                  def->height_count_x );
    }
    float* heights = scene_take( r->scene, (size_t)node->count * (size_t)def->height_count_x, sizeof *heights );
    if ( !heights )
    {
        return scene_no_memory( r );
    }
    height_rows rows = { heights, def->height_count_x };
    def->heights = heights;
    return scene_read_items( r, node, read_height_row, &rows );
}

wisp_scene_collider scene_default_collider( void )
{
    return ( wisp_scene_collider ){
        .def = wisp_default_collider_def(),
        .copies = { .count = 1 },
        .mesh = { .generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR ), .scale = 1.0f },
    };
}

static wisp_status read_entry( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene* scene = context;
    wisp_scene_collider* collider = &scene->colliders[index];
    scene->collider_count = index + 1;
    *collider = scene_default_collider();
    collider->line = node->line;
    collider->column = node->column;
    int kind = 0;
    wisp_status status = scene_read_shape( r, node, SHAPES, &kind );
    status = status ? status : scene_read_block( r, node, &SCENE_COLLIDER_BLOCKS[kind], collider );
    const bool has_mesh = kind == WISP_COLLIDER_MESH || kind == WISP_COLLIDER_CONVEX;
    if ( !status && has_mesh && ( collider->mesh.file != NULL ) == collider->mesh.is_generated )
    {
        return scene_refuse_node( r, node, "got %s, expected one of them",
                                  collider->mesh.is_generated ? "both 'file' and 'generate'"
                                                              : "neither 'file' nor 'generate'" );
    }
    return status ? status : scene_check_weld( r, node, &collider->mesh );
}

wisp_status scene_read_colliders( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    void* items;
    wisp_status status = scene_begin_list( r, node, "a list of colliders", WISP_SCENE_MAX_COLLIDERS,
                                           sizeof *scene->colliders, &items );
    scene->colliders = items;
    status = status ? status : scene_read_items( r, node, read_entry, scene );
    return status ? status
                  : scene_register( r, SCENE_COLLIDER, scene->colliders, sizeof *scene->colliders,
                                    scene->collider_count );
}
