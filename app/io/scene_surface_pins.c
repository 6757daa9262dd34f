// Pins of a surface: its own, and those of groups with a motion each.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>
#include <string.h>

static const scene_field VERTEX = { "vertex", SCENE_WHOLE, .range = RANGE( 0, WISP_SCENE_MAX_VERTICES - 1 ) };
static const scene_field PLACE = { "place", SCENE_VECTOR, .range = COORDINATE, .unit = METRES };

// ---- vertices ----

// How many vertices there are is known if the mesh is made.
static wisp_status read_vertex( scene_reader* r, const scene_node* node, int index, void* context )
{
    const wisp_scene_mesh* mesh = r->mesh;
    int32_t* out = context;
    int vertex = 0;
    wisp_status status = scene_read_whole( r, node, &VERTEX, &vertex );
    int64_t count = scene_generator_vertices( &mesh->generator );
    if ( !status && mesh->is_generated && vertex >= count )
    {
        return scene_refuse_node( r, node, "got vertex %d, expected 0 .. %lld", vertex, (long long)( count - 1 ) );
    }
    out[index] = vertex;
    return status;
}

wisp_status scene_read_vertices( scene_reader* r, const scene_node* node, int32_t* out )
{
    return scene_read_items( r, node, read_vertex, out );
}

wisp_status scene_read_pins( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_pins* pins = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of vertices", SCENE_MAX_NODES, sizeof( int32_t ), &items );
    if ( !status && items )
    {
        status = scene_read_vertices( r, node, items );
        pins->vertices = items;
        pins->vertex_count = node->count;
    }
    return status;
}

static wisp_status read_place( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_vec3* places = context;
    return scene_read_vector( r, node, &PLACE, &places[index] );
}

wisp_status scene_read_pin_nearest( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_pins* pins = at;
    void* items;
    const wisp_status status =
        scene_begin_list( r, node, "a list of points", SCENE_MAX_NODES, sizeof( wisp_vec3 ), &items );
    pins->nearest = items;
    pins->nearest_count = status ? 0 : node->count;
    return status ? status : scene_read_items( r, node, read_place, items );
}

#define AT( member ) offsetof( wisp_scene_box, member )
static const scene_field BOX_FIELDS[] = {
    { "min", SCENE_VECTOR, .required = true, .at = AT( lower ), .range = COORDINATE, .unit = METRES,
      .help = "Corner with the smallest coordinates." },
    { "max", SCENE_VECTOR, .required = true, .at = AT( upper ), .range = COORDINATE, .unit = METRES,
      .help = "Corner with the largest coordinates." },
};
#undef AT
const scene_block SCENE_BOX_BLOCK = SCENE_BLOCK_ALONE( BOX_FIELDS );

static wisp_status read_box( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene_box* box = (wisp_scene_box*)context + index;
    wisp_status status = scene_read_block( r, node, &SCENE_BOX_BLOCK, box );
    if ( !status && ( box->lower.x > box->upper.x || box->lower.y > box->upper.y || box->lower.z > box->upper.z ) )
    {
        return scene_refuse_node( r, node, "got an empty box, expected 'min' below 'max'" );
    }
    return status;
}

// One box, or a list of them.
wisp_status scene_read_pin_box( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_pins* pins = at;
    const bool is_list = node->kind == SCENE_LIST;
    int count = is_list ? node->count : 1;
    wisp_scene_box* boxes = scene_take( r->scene, (size_t)count + 1, sizeof *boxes );
    if ( !boxes )
    {
        return scene_no_memory( r );
    }
    pins->boxes = boxes;
    pins->box_count = count;
    return is_list ? scene_read_items( r, node, read_box, boxes ) : read_box( r, node, 0, boxes );
}

// ---- groups ----

// In the order of the struct: `pins` and the others are those of the surface.
static const scene_field GROUP_FIELDS[] = {
    { "name", SCENE_CUSTOM, .required = true, .at = offsetof( wisp_scene_pins, name ), .read = scene_read_name,
      .help = "Unique among the groups of the surface.", .form = "1 to 64 of the characters A-Z a-z 0-9 _ -" },
    SCENE_PIN_FIELDS( 0 ),
    { "starts_free", SCENE_SWITCH, .at = offsetof( wisp_scene_pins, starts_free ),
      .help = "Whether nothing holds them until an event with `hold` or `attach_pins` does." },
};
const scene_block SCENE_PIN_GROUP_BLOCK = SCENE_BLOCK_ALONE( GROUP_FIELDS );

static bool has_vertices( const wisp_scene_pins* pins )
{
    return pins->vertex_count + pins->box_count + pins->nearest_count > 0;
}

static wisp_status check_group( scene_reader* r, const scene_node* node, const wisp_scene_pins* groups, int group )
{
    const wisp_scene_pins* g = &groups[group];
    if ( !has_vertices( g ) )
    {
        return scene_refuse_node( r, node, "got none of 'pins', 'pin_box' and 'pin_nearest', expected one of them" );
    }
    for ( int i = 0; i < g->path.count; ++i )
    {
        if ( g->path.poses[i].jump )
        {
            return scene_refuse_node( r, scene_child( r, node, "pin_keyframes" ),
                                      "'jump' in keyframe %d: not in a group, the whole surface jumps", i );
        }
    }
    for ( int i = 0; i < group; ++i )
    {
        if ( strcmp( groups[i].name, g->name ) == 0 )
        {
            return scene_refuse_node( r, node, "got the name '%s' of the group in line %d", g->name, groups[i].line );
        }
    }
    return WISP_OK;
}

wisp_scene_pins scene_default_pins( void )
{
    return ( wisp_scene_pins ){ .attached_to = -1 };
}

static wisp_status read_group( scene_reader* r, const scene_node* item, int index, void* context )
{
    wisp_scene_surface* surface = context;
    wisp_scene_pins* group = &surface->pin_groups[index];
    surface->pin_group_count = index + 1;
    *group = scene_default_pins();
    group->line = item->line;
    group->column = item->column;
    const wisp_status status = scene_read_block( r, item, &SCENE_PIN_GROUP_BLOCK, group );
    return status ? status : check_group( r, item, surface->pin_groups, index );
}

wisp_status scene_read_pin_groups( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_surface* surface = at;
    void* items;
    const wisp_status status =
        scene_begin_list( r, node, "a list of groups", WISP_SCENE_MAX_PIN_GROUPS, sizeof( wisp_scene_pins ), &items );
    surface->pin_groups = items;
    return status ? status : scene_read_items( r, node, read_group, surface );
}

bool wisp_scene_has_pins( const wisp_scene_surface* surface )
{
    bool any = has_vertices( &surface->pins );
    for ( int i = 0; i < surface->pin_group_count; ++i )
    {
        any = any || !surface->pin_groups[i].starts_free;
    }
    return any;
}

bool scene_moves_groups( const wisp_scene_surface* surface )
{
    bool any = false;
    for ( int i = 0; i < surface->pin_group_count; ++i )
    {
        any = any || surface->pin_groups[i].path.count > 0;
    }
    return any;
}

// ---- the surfaces that pins are attached to ----

static wisp_status bind_attachment( scene_reader* r, const scene_node* parent, int surface, wisp_scene_pins* pins )
{
    const scene_node* node = scene_child( r, parent, "attach_pins" );
    if ( !node )
    {
        return WISP_OK;
    }
    const size_t outside = scene_enter_key( r, "attach_pins" );
    const wisp_status status = scene_read_named( r, node, SCENE_SURFACE, &pins->attached_to );
    if ( status )
    {
        return status;
    }
    if ( pins->attached_to == surface )
    {
        return scene_refuse_node( r, node, "got '%s', expected another surface", r->scene->surfaces[surface].name );
    }
    if ( !has_vertices( pins ) )
    {
        return scene_refuse_node( r, node, "'attach_pins' needs pins, but nothing is pinned" );
    }
    if ( pins->path.count > 0 )
    {
        return scene_refuse_node( r, node, "got both 'attach_pins' and 'pin_keyframes', expected one of them" );
    }
    if ( pins->starts_free )
    {
        return scene_refuse_node( r, node, "got both 'attach_pins' and 'starts_free: true', expected one of them" );
    }
    scene_leave( r, outside );
    return WISP_OK;
}

static wisp_status bind_group( scene_reader* r, const scene_node* item, int index, void* context )
{
    const int surface = *(const int*)context;
    return bind_attachment( r, item, surface, &r->scene->surfaces[surface].pin_groups[index] );
}

wisp_status scene_bind_attachments( scene_reader* r, const scene_node* entry, int surface )
{
    wisp_status status = bind_attachment( r, entry, surface, &r->scene->surfaces[surface].pins );
    const scene_node* list = scene_child( r, entry, "pin_groups" );
    if ( status || !list )
    {
        return status;
    }
    const size_t outside = scene_enter_key( r, "pin_groups" );
    status = scene_read_items( r, list, bind_group, &surface );
    if ( !status )
    {
        scene_leave( r, outside );
    }
    return status;
}
