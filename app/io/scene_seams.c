// Seams: surfaces that are sewn together, by pairs of vertices or where their edges lie side by side.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

#define AT( member ) offsetof( wisp_scene_seam, member )
#define DEF( member ) offsetof( wisp_scene_seam, def.member )

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
    { "within", SCENE_NUMBER, .at = DEF( within ), .range = RANGE( 1e-6, 1e6 ), .unit = METRES, .initial = "none",
      .help = "Each boundary vertex of one surface is sewn to the nearest one of the other if it starts within this "
              "distance; instead of `pairs`." },
    { "distance", SCENE_NUMBER, .at = DEF( distance ), .range = RANGE( 0, 1e6 ), .unit = METRES,
      .help = "Distance that a seam holds; give surfaces with `contact` the thickness of the contact." },
    { "closing_speed", SCENE_NUMBER, .at = DEF( closing_speed ), .range = RANGE( 1e-6, 1e6 ), .unit = SPEEDS,
      .help = "Speed at which pairs go from where they start to that distance." },
    { "compliance", SCENE_NUMBER, .at = DEF( compliance ), .range = COMPLIANCE, .unit = COMPLIANCES,
      .help = "Compliance of each pair." },
    { "strength", SCENE_NUMBER, .at = DEF( strength ), .range = RANGE( 1e-9, 1e12 ), .unit = "N", .initial = "none",
      .help = "Force at which a pair breaks." },
};
const scene_block SCENE_SEAM_BLOCK = { SEAM_FIELDS, WISP_COUNT( SEAM_FIELDS ) };

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
