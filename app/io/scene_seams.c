// Seams: surfaces that are sewn together, by pairs of vertices or where their edges lie side by side.
#include "scene_parts.h"

#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>

// ---- contact ----

// Boundary particles and contact: their tables, of surfaces, of strands and of the scene, and what no table can say.

// ---- boundary particles of a surface ----

static const scene_choice POLICIES[] = { { "even", "equal parts" },
                                         { "exact", "a spacing apart from one end on" },
                                         { NULL, NULL } };
static const scene_choice ROUNDINGS[] = { { "down", "fewer points" },
                                          { "nearest", "the nearest count" },
                                          { "up", "more points; with `policy: even` no gap is above the spacing" },
                                          { NULL, NULL } };

static const scene_field BOUNDARY_FIELDS[] = {
    { "spacing", .range = SIZE, .help = "Distance between points.",
      .initial = "half of the mean rest length of the edges" },
    { "policy", .choices = POLICIES, .constants = "WISP_SPACING_",
      .help = "Where points stand on an edge or a line." },
    { "rounding", .choices = ROUNDINGS, .constants = "WISP_ROUND_",
      .help = "Rounding of the number of spacings in a length." },
    { "hysteresis",
      .help = "Counts of points stay while a length is within this many spacings of where they would change." },
    { "max_points", .help = "A layer that would have more points stays as it was, and a message says so." },
    { "min_spacing", .range = SIZE, .help = "Smallest local spacing.", .initial = "a quarter of the spacing" },
    { "max_spacing", .range = SIZE, .help = "Largest local spacing.", .initial = "four times the spacing" },
    { "curvature_gain",
      .help = "Local spacing is divided by 1 + gain times the angle between the normals of the ends of an edge." },
    { "strain_gain",
      .help = "Local spacing is divided by 1 + gain times the strain of an edge; a negative gain multiplies." },
    { "eye_angle", .range = RANGE( 0, 1 ),
      .help = "Local spacing spans this angle as seen from `eye`; 0: it does not depend on the distance." },
    { "eye", .help = "Where the camera is, with `eye_angle`." },
};
const scene_block SCENE_BOUNDARY_BLOCK =
    SCENE_BLOCK_OF( BOUNDARY_FIELDS, boundary_def, wisp_scene_surface, boundary );

// Spacings that are left out depend on the mesh; the module checks them.
wisp_status scene_check_boundary( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const wisp_boundary_def* b = &s->boundary;
    const text_node* eye = text_find_path( node, "boundary.eye" );
    if ( eye && b->eye_angle == 0.0f )
    {
        return scene_refuse_node( r, eye, "boundary.eye needs an 'eye_angle' above 0" );
    }
    if ( b->max_spacing > 0.0f && b->min_spacing > b->max_spacing )
    {
        return scene_refuse_node( r, node, "got boundary.min_spacing %g, expected at most boundary.max_spacing, %g",
                                  (double)b->min_spacing, (double)b->max_spacing );
    }
    return WISP_OK;
}

// ---- participants of contact ----

// Strands never meet themselves, and have no maps, so theirs is the same table without `self`.
#define PARTICIPANT_FIELDS( owner, thickness_map, friction_map )                                                     \
    { "thickness", .map = thickness_map,                                                                             \
      .initial =                                                                                                     \
          "a quarter of the mean edge, at most 0.9 of the shortest; of strands a quarter of the mean segment",       \
      .help = "Two participants keep half of the sum of theirs apart; above the shortest edge a surface bends "      \
              "stiffly there." },                                                                                    \
        { "friction", .map = friction_map,                                                                           \
          .help = "Friction coefficient; two participants have the geometric mean of theirs." },                     \
        { "max_push_out_speed", .initial = "ten thicknesses per second",                                             \
          .help = "Speed at which primitives that are too close are parted." },                                      \
        { "layers",                                                                                                  \
          SCENE_CUSTOM,                                                                                              \
          .at = offsetof( owner, contact.layers ),                                                                   \
          .read = scene_read_layers,                                                                                 \
          .form = "list of layers, 0 .. 31",                                                                         \
          .initial = "[0]",                                                                                          \
          .help =                                                                                                    \
              "Layers of this participant; two participants meet if each has a layer of the mask of the other." },   \
        { "mask",                                                                                                    \
          SCENE_CUSTOM,                                                                                              \
          .at = offsetof( owner, contact.mask ),                                                                     \
          .read = scene_read_layers,                                                                                 \
          .form = "list of layers, 0 .. 31",                                                                         \
          .initial = "all layers",                                                                                   \
          .help = "Layers of other participants that this one meets." },                                             \
    {                                                                                                                \
        "enabled", .help = "Whether it takes part."                                                                  \
    }

static const scene_field SURFACE_FIELDS[] = {
    PARTICIPANT_FIELDS( wisp_scene_surface, WISP_MAP_CONTACT_THICKNESS, WISP_MAP_CONTACT_FRICTION ),
    { "self", .help = "Whether the surface keeps its distance from itself." },
};
const scene_block SCENE_CONTACT_BLOCK = SCENE_BLOCK_OF( SURFACE_FIELDS, contact_def, wisp_scene_surface, contact );

static const scene_field STRANDS_FIELDS[] = {
    PARTICIPANT_FIELDS( wisp_scene_strands, 0, 0 ),
    { "between_strands",
      .help =
          "Whether the strands keep their distance from strands: from each other, and from those of other entries "
          "that have it too." },
};
const scene_block SCENE_STRAND_CONTACT_BLOCK =
    SCENE_BLOCK_OF( STRANDS_FIELDS, contact_def, wisp_scene_strands, contact );

// ---- contact of the scene ----

static const scene_choice LEVELS[] = {
    { "exact", "vertices keep off triangles and edges off edges, and nothing passes" },
    { "triangles", "the same pairs, but displacements are not limited; what is fast may pass" },
    { "spheres",
      "points keep off points: vertices, and those of `boundary`; what is finer than their spacing passes" },
    { NULL, NULL }
};
static const scene_choice WORDS[] = {
    { "stats", "numbers of contacts, candidates and searches, and the sum of impulses" },
    { "intersections", "edges that pass through triangles at the end of a step; costs a search per step" },
    { NULL, NULL },
};

static const size_t REQUESTS[] = { offsetof( wisp_scene, request_contact_stats ),
                                   offsetof( wisp_scene, request_intersections ) };

static const scene_field WORLD_FIELDS[] = {
    { "level", .choices = LEVELS, .constants = "WISP_CONTACT_", .help = "What is kept apart, and how surely." },
    { "margin",
      .help = "How much farther than they keep apart pairs are searched, in such distances; it changes the time and "
              "not the "
              "result, except with `level: spheres`." },
    { "compute", SCENE_WORDS, .choices = WORDS, .switches = REQUESTS,
      .help = "Statistics that are computed and printed.", .initial = "none" },
};
const scene_block SCENE_WORLD_CONTACT_BLOCK = SCENE_BLOCK_OF( WORLD_FIELDS, contact_settings, wisp_scene, contact );

wisp_status scene_read_contact( scene_reader* r, const text_node* node, void* at )
{
    wisp_scene* scene = at;
    WISP_TRY( scene_read_block( r, node, &SCENE_WORLD_CONTACT_BLOCK, scene ) );
    scene->has_contact = true;
    return WISP_OK;
}

// ---- seams ----

#define AT( member ) offsetof( wisp_scene_seam, member )

// ---- values ----

static wisp_status read_side( scene_reader* r, const text_node* node, int side, void* surfaces )
{
    return scene_read_named( r, node, SCENE_SURFACE, (int*)surfaces + side );
}

static wisp_status read_surfaces( scene_reader* r, const text_node* node, void* at )
{
    WISP_TRY( scene_expect_pair( r, node, "a pair of names of surfaces" ) );
    return scene_read_items( r, node, read_side, at );
}

// How many vertices a surface has is known if its mesh is made; else the world says it.
static wisp_status read_vertex( scene_reader* r, const text_node* node, int side, void* pair )
{
    static const scene_field field = { "vertex", SCENE_WHOLE, .range = RANGE( 0, WISP_SCENE_MAX_VERTICES - 1 ) };
    const wisp_scene_seam* seam = r->entry;
    const wisp_scene_surface* surface = &r->scene->surfaces[seam->surfaces[side]];
    int32_t* vertex = (int32_t*)pair + side;
    WISP_TRY( scene_read_whole( r, node, &field, vertex ) );
    return scene_check_vertex( r, node, *vertex, surface->mesh.is_generated,
                               scene_generator_vertices( &surface->mesh.generator ), surface->name );
}

static wisp_status read_pair( scene_reader* r, const text_node* node, int index, void* pairs )
{
    const wisp_scene_seam* seam = r->entry;
    int32_t* pair = (int32_t*)pairs + 2 * (size_t)index;
    WISP_TRY( scene_expect_pair( r, node, "a pair of vertices" ) );
    WISP_TRY( scene_read_items( r, node, read_vertex, pair ) );
    return seam->surfaces[0] == seam->surfaces[1] && pair[0] == pair[1]
               ? scene_refuse_node( r, node, "got vertex %d twice", pair[0] )
               : WISP_OK;
}

static const scene_list PAIRS = { .what = "a list of pairs of vertices",
                                  .size = 2 * sizeof( int32_t ),
                                  .read = read_pair };

// `surfaces` stands before `pairs`: it says which vertices there are.
static const scene_field SEAM_FIELDS[] = {
    SCENE_NAME_FIELD,
    { "surfaces", SCENE_CUSTOM, .required = true, .at = AT( surfaces ), .read = read_surfaces,
      .form = "pair of names of surfaces",
      .help = "What is sewn together; the same name twice sews a surface to itself." },
    { "pairs", SCENE_ENTRIES, .at = AT( pairs ), .of = &PAIRS,
      .form = "list of pairs [vertex of the first, vertex of the second]", .initial = "those that `within` finds",
      .help = "Vertices that are sewn together, as numbered in the file. A vertex may be in several pairs." },
    { "within", .range = RANGE( 1e-6, 1e6 ), .initial = "none",
      .help = "Each boundary vertex of one surface is sewn to the nearest one of the other if it starts within this "
              "distance; instead of `pairs`." },
    { "distance", .help = "Distance that a seam holds; give surfaces with `contact` the thickness of the contact." },
    { "closing_speed", .range = RANGE( 1e-6, 1e6 ),
      .help = "Speed at which pairs go from where they start to that distance." },
    { "compliance", .help = "Compliance of each pair." },
    { "strength", .range = RANGE( 1e-9, 1e12 ), .initial = "none", .help = "Force at which a pair breaks." },
};
const scene_block SCENE_SEAM_BLOCK = SCENE_BLOCK_OF( SEAM_FIELDS, seam_def, wisp_scene_seam, def );

// ---- the list ----

wisp_scene_seam scene_default_seam( void )
{
    return ( wisp_scene_seam ){ .def = wisp_default_seam_def() };
}

static wisp_status read_entry( scene_reader* r, const text_node* node, int index, void* entries )
{
    wisp_scene_seam* seam = (wisp_scene_seam*)entries + index;
    *seam = scene_default_seam();
    seam->line = node->line;
    seam->column = node->column;
    r->entry = seam;
    WISP_TRY( scene_read_block( r, node, &SCENE_SEAM_BLOCK, seam ) );
    const bool has_within = seam->def.within > 0.0f;
    WISP_TRY( scene_expect_one( r, node, "pairs", seam->pair_count > 0, "within", has_within ) );
    return has_within && seam->surfaces[0] == seam->surfaces[1]
               ? scene_refuse_node( r, text_find_path( node, "within" ),
                                    "'within' needs two surfaces, a surface that is sewn to itself needs 'pairs'" )
               : WISP_OK;
}

const scene_list SCENE_SEAMS_LIST = { .what = "a list of seams",
                                      .size = sizeof( wisp_scene_seam ),
                                      .most = WISP_SCENE_MAX_SEAMS,
                                      .read = read_entry,
                                      .is_named = true,
                                      .named = SCENE_SEAM };
