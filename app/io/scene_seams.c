// Seams: surfaces that are sewn together, by pairs of vertices or where their edges lie side by side.
#include "scene_parts.h"

#include "scene_ranges.h"

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
wisp_status scene_check_boundary( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const wisp_boundary_def* b = &s->boundary;
    const scene_node* eye = scene_child( r, scene_child( r, node, "boundary" ), "eye" );
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

static wisp_status read_requests( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    bool* const requests[] = { &scene->request_contact_stats, &scene->request_intersections };
    return scene_read_words( r, node, WORDS, requests, NULL, NULL );
}

static const scene_field WORLD_FIELDS[] = {
    { "level", .choices = LEVELS, .constants = "WISP_CONTACT_", .help = "What is kept apart, and how surely." },
    { "margin",
      .help = "How much farther than they keep apart pairs are searched, in such distances; it changes the time and "
              "not the "
              "result, except with `level: spheres`." },
    { "compute", SCENE_CUSTOM, .read = read_requests, .choices = WORDS,
      .help = "Statistics that are computed and printed.", .form = "list of words", .initial = "none" },
};
const scene_block SCENE_WORLD_CONTACT_BLOCK = SCENE_BLOCK_OF( WORLD_FIELDS, contact_settings, wisp_scene, contact );

wisp_status scene_read_contact( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    wisp_status status = scene_read_block( r, node, &SCENE_WORLD_CONTACT_BLOCK, scene );
    scene->has_contact = status == WISP_OK;
    return status;
}

// ---- seams ----

#define AT( member ) offsetof( wisp_scene_seam, member )

// ---- values ----

static scene_read_fn read_surfaces, read_pairs;

// `surfaces` stands before `pairs`: it says which vertices there are.
static const scene_field SEAM_FIELDS[] = {
    { "name", SCENE_CUSTOM, .required = true, .at = AT( name ), .read = scene_read_name,
      .form = "1 to 64 of the characters A-Z a-z 0-9 _ -",
      .help = "Unique among strands, surfaces, colliders and seams." },
    { "surfaces", SCENE_CUSTOM, .required = true, .read = read_surfaces, .form = "pair of names of surfaces",
      .help = "What is sewn together; the same name twice sews a surface to itself." },
    { "pairs", SCENE_CUSTOM, .read = read_pairs, .form = "list of pairs [vertex of the first, vertex of the second]",
      .initial = "those that `within` finds",
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

static wisp_status read_surfaces( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_seam* seam = base;
    wisp_status status = scene_expect_pair( r, node, "a pair of names of surfaces" );
    const scene_node* item = status ? NULL : scene_first( r->tree, node );
    for ( int k = 0; k < 2 && !status; ++k, item = scene_next( r->tree, item ) )
    {
        const size_t outside = scene_enter_index( r, k );
        status = scene_read_named( r, item, SCENE_SURFACE, &seam->surfaces[k] );
        if ( !status )
        {
            scene_leave( r, outside );
        }
    }
    return status;
}

// How many vertices a surface has is known if its mesh is made; else the world says it.
static wisp_status read_vertex( scene_reader* r, const scene_node* node, const wisp_scene_seam* seam, int side,
                                int32_t* out )
{
    static const scene_field field = { "vertex", SCENE_WHOLE, .range = RANGE( 0, WISP_SCENE_MAX_VERTICES - 1 ) };
    const wisp_scene_surface* surface = &r->scene->surfaces[seam->surfaces[side]];
    int vertex = 0;
    wisp_status status = scene_read_whole( r, node, &field, &vertex );
    const int64_t count = scene_generator_vertices( &surface->mesh.generator );
    if ( !status && surface->mesh.is_generated && vertex >= count )
    {
        return scene_refuse_node( r, node, "got vertex %d of '%s', expected 0 .. %lld", vertex, surface->name,
                                  (long long)( count - 1 ) );
    }
    *out = vertex;
    return status;
}

typedef struct seam_pairs
{
    const wisp_scene_seam* seam;
    int32_t* pairs; // [][2]
} seam_pairs;

static wisp_status read_pair( scene_reader* r, const scene_node* node, int index, void* context )
{
    const wisp_scene_seam* seam = ( (const seam_pairs*)context )->seam;
    int32_t* pair = ( (const seam_pairs*)context )->pairs + 2 * (size_t)index;
    wisp_status status = scene_expect_pair( r, node, "a pair of vertices" );
    const scene_node* item = status ? NULL : scene_first( r->tree, node );
    for ( int k = 0; k < 2 && !status; ++k, item = scene_next( r->tree, item ) )
    {
        const size_t outside = scene_enter_index( r, k );
        status = read_vertex( r, item, seam, k, &pair[k] );
        if ( !status )
        {
            scene_leave( r, outside );
        }
    }
    return !status && seam->surfaces[0] == seam->surfaces[1] && pair[0] == pair[1]
               ? scene_refuse_node( r, node, "got vertex %d twice", pair[0] )
               : status;
}

static wisp_status read_pairs( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_seam* seam = base;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of pairs of vertices", SCENE_MAX_NODES, 2 * sizeof( int32_t ), &items );
    seam_pairs list = { seam, items };
    seam->pairs = items;
    seam->pair_count = status ? 0 : node->count;
    return status ? status : scene_read_items( r, node, read_pair, &list );
}

// ---- the list ----

wisp_scene_seam scene_default_seam( void )
{
    return ( wisp_scene_seam ){ .def = wisp_default_seam_def() };
}

static wisp_status read_entry( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene* scene = context;
    wisp_scene_seam* seam = &scene->seams[index];
    scene->seam_count = index + 1;
    *seam = scene_default_seam();
    seam->line = node->line;
    seam->column = node->column;
    const wisp_status status = scene_read_block( r, node, &SCENE_SEAM_BLOCK, seam );
    const bool has_within = seam->def.within > 0.0f;
    if ( !status && has_within == ( seam->pair_count > 0 ) )
    {
        return scene_refuse_node( r, node, "got %s, expected one of them",
                                  has_within ? "both 'pairs' and 'within'" : "neither 'pairs' nor 'within'" );
    }
    if ( !status && has_within && seam->surfaces[0] == seam->surfaces[1] )
    {
        return scene_refuse_node( r, scene_child( r, node, "within" ),
                                  "'within' needs two surfaces, a surface that is sewn to itself needs 'pairs'" );
    }
    return status;
}

wisp_status scene_read_seams( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of seams", WISP_SCENE_MAX_SEAMS, sizeof *scene->seams, &items );
    scene->seams = items;
    status = status ? status : scene_read_items( r, node, read_entry, scene );
    return status ? status : scene_register( r, SCENE_SEAM, scene->seams, sizeof *scene->seams, scene->seam_count );
}
