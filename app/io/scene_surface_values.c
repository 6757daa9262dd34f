// Values of a surface: limits, gas, words of `compute`.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>
#include <string.h>

// ---- limits and gas ----

wisp_status scene_read_strain_limit( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field least = { "least", SCENE_NUMBER, .range = UNIT_RANGE };
    static const scene_field most = { "most", SCENE_NUMBER, .range = RANGE( 1, 1e6 ) };
    float* limit = at;
    wisp_status status = scene_expect_pair( r, node, "a pair [min, max] in rest lengths" );
    const scene_node* first = scene_first( r->tree, node );
    status = status ? status : scene_read_number( r, first, &least, &limit[0] );
    return status ? status : scene_read_number( r, scene_next( r->tree, first ), &most, &limit[1] );
}

wisp_status scene_read_tile_size( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field field = { "tile_size", SCENE_WHOLE, .range = RANGE( 0, 65536 ) };
    int* size = at;
    wisp_status status = scene_read_whole( r, node, &field, size );
    if ( !status && *size != 0 && ( *size < 64 || *size % 8 != 0 ) )
    {
        return scene_refuse_node( r, node, "got %d, expected 0, or a multiple of 8 in [64, 65536]", *size );
    }
    return status;
}

wisp_status scene_read_outlet( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_surface* surface = at;
    wisp_status status = scene_expect_list( r, node, "a list of vertices" );
    if ( !status && ( node->count == 0 || node->count > WISP_BALLOON_MAX_OUTLET ) )
    {
        return scene_refuse_node( r, node, "got %d vertices, expected 1 to %d", node->count,
                                  WISP_BALLOON_MAX_OUTLET );
    }
    if ( !status )
    {
        surface->balloon.outlet_count = node->count;
        status = scene_read_vertices( r, node, surface->balloon.outlet );
    }
    return status;
}

static wisp_status read_fill( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene_gas_ratio_keyframe* gas_ratio = (wisp_scene_gas_ratio_keyframe*)context + index;
    static const scene_field time = { "time", SCENE_NUMBER, .range = TIME, .unit = SECONDS };
    static const scene_field fraction = { "gas_ratio", SCENE_NUMBER, .range = RANGE( 1e-3, 1e6 ) };
    wisp_status status = scene_expect_pair( r, node, "a pair [time, gas_ratio]" );
    const scene_node* first = scene_first( r->tree, node );
    status = status ? status : scene_read_number( r, first, &time, &gas_ratio->time );
    status = status ? status : scene_read_number( r, scene_next( r->tree, first ), &fraction, &gas_ratio->gas_ratio );
    return status || index == 0 ? status : scene_check_rises( r, first, gas_ratio[-1].time, gas_ratio->time );
}

wisp_status scene_read_gas_ratio_keyframes( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_surface* surface = at;
    void* items;
    wisp_status status = scene_begin_list( r, node, "a list of pairs [time, gas_ratio]", SCENE_MAX_NODES,
                                           sizeof( wisp_scene_gas_ratio_keyframe ), &items );
    surface->gas_ratio_keyframes = items;
    surface->gas_ratio_keyframe_count = status ? 0 : node->count;
    return status ? status : scene_read_items( r, node, read_fill, items );
}

// ---- compute ----

const scene_choice SCENE_SURFACE_WORDS[] = {
    { "points", "positions" },
    { "normals", "unit normals of vertices" },
    { "strain", "relative error of the length of each edge" },
    { "speed", "speed of each vertex" },
    { "motion_stats", "mass, momentum, energy, volume, largest strain and speed" },
    { "effect_stats", "forces, pressure and volume of a balloon; solves of an implicit cloth" },
    { "collision_stats", "largest penetration and number of contacts; needs `collision`" },
    { NULL, NULL },
};

static wisp_status check_word( scene_reader* r, const scene_node* item, int word, const void* entry )
{
    const wisp_scene_surface* s = entry;
    const char* name = SCENE_SURFACE_WORDS[word].word;
    if ( strcmp( name, "effect_stats" ) == 0 && !s->has_balloon && !s->has_implicit )
    {
        return scene_refuse_node( r, item, "'effect_stats' needs the key 'balloon' or 'implicit'" );
    }
    return strcmp( name, "collision_stats" ) == 0 && !s->has_collision
               ? scene_refuse_node( r, item, "'collision_stats' needs the key 'collision'" )
               : WISP_OK;
}

wisp_status scene_read_surface_request( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_surface* s = at;
    bool* const requests[] = { &s->request_points,       &s->request_normals, &s->request_strain,  &s->request_speed,
                               &s->request_motion_stats, &s->request_stats,   &s->request_contacts };
    return scene_read_words( r, node, SCENE_SURFACE_WORDS, requests, check_word, s );
}
