// Pins of a surface: its own, and those of groups with a motion each.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>
#include <string.h>

static const scene_field VERTEX = { "vertex", SCENE_WHOLE, .range = RANGE( 0, WISP_SCENE_MAX_VERTICES - 1 ) };
static const scene_field PLACE = { "place", SCENE_VECTOR, .range = COORDINATE, .unit = METRES };

// ---- vertices ----

// How many vertices there are is known if the mesh is made.
static wisp_status read_vertex( scene_reader* r, const text_node* node, int index, void* vertices )
{
    const wisp_scene_mesh* mesh = &( (const wisp_scene_surface*)r->entry )->mesh;
    int32_t* vertex = (int32_t*)vertices + index;
    WISP_TRY( scene_read_whole( r, node, &VERTEX, vertex ) );
    return scene_check_vertex( r, node, *vertex, mesh->is_generated, scene_generator_vertices( &mesh->generator ),
                               NULL );
}

wisp_status scene_read_vertices( scene_reader* r, const text_node* node, int32_t* out )
{
    return scene_read_items( r, node, read_vertex, out );
}

const scene_list SCENE_VERTICES = { .what = "a list of vertices", .size = sizeof( int32_t ), .read = read_vertex };
const scene_list SCENE_PIN_PLACES = { .what = "a list of points", .size = sizeof( wisp_vec3 ), .each = &PLACE };

#define AT( member ) offsetof( wisp_scene_box, member )
static const scene_field BOX_FIELDS[] = {
    { "min", SCENE_VECTOR, .required = true, .at = AT( lower ), .range = COORDINATE, .unit = METRES,
      .help = "Corner with the smallest coordinates." },
    { "max", SCENE_VECTOR, .required = true, .at = AT( upper ), .range = COORDINATE, .unit = METRES,
      .help = "Corner with the largest coordinates." },
};
#undef AT
const scene_block SCENE_BOX_BLOCK = SCENE_BLOCK_ALONE( BOX_FIELDS );

static wisp_status read_box( scene_reader* r, const text_node* node, int index, void* boxes )
{
    wisp_scene_box* box = (wisp_scene_box*)boxes + index;
    WISP_TRY( scene_read_block( r, node, &SCENE_BOX_BLOCK, box ) );
    return box->lower.x > box->upper.x || box->lower.y > box->upper.y || box->lower.z > box->upper.z
               ? scene_refuse_node( r, node, "got an empty box, expected 'min' below 'max'" )
               : WISP_OK;
}

const scene_list SCENE_PIN_BOXES = { .size = sizeof( wisp_scene_box ), .read = read_box, .is_one_too = true };

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

static wisp_status check_group( scene_reader* r, const text_node* node, const wisp_scene_pins* groups, int group )
{
    const wisp_scene_pins* g = &groups[group];
    if ( !has_vertices( g ) )
    {
        return scene_refuse_node( r, node, "got none of 'pins', 'pin_box' and 'pin_nearest', expected one of them" );
    }
    WISP_TRY( scene_refuse_jumps( r, text_find_path( node, "pin_keyframes" ), &g->path,
                                  "not in a group, the whole surface jumps" ) );
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

static wisp_status read_group( scene_reader* r, const text_node* item, int index, void* groups )
{
    wisp_scene_pins* group = (wisp_scene_pins*)groups + index;
    *group = scene_default_pins();
    group->line = item->line;
    group->column = item->column;
    WISP_TRY( scene_read_block( r, item, &SCENE_PIN_GROUP_BLOCK, group ) );
    return check_group( r, item, groups, index );
}

const scene_list SCENE_PIN_GROUPS = { .what = "a list of groups",
                                      .size = sizeof( wisp_scene_pins ),
                                      .most = WISP_SCENE_MAX_PIN_GROUPS,
                                      .read = read_group };

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

static wisp_status bind_attachment( scene_reader* r, const text_node* parent, int surface, wisp_scene_pins* pins )
{
    const text_node* node = text_find_path( parent, "attach_pins" );
    if ( !node )
    {
        return WISP_OK;
    }
    const size_t outside = scene_enter_key( r, "attach_pins" );
    WISP_TRY( scene_read_named( r, node, SCENE_SURFACE, &pins->attached_to ) );
    if ( pins->attached_to == surface )
    {
        return scene_refuse_node( r, node, "got '%s', expected another surface", r->scene->surfaces[surface].name );
    }
    const scene_case cases[] = {
        { !has_vertices( pins ), NULL, "'attach_pins' needs pins, but nothing is pinned" },
        { pins->path.count > 0, NULL, "got both 'attach_pins' and 'pin_keyframes', expected one of them" },
        { pins->starts_free, NULL, "got both 'attach_pins' and 'starts_free: true', expected one of them" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    scene_leave( r, outside );
    return WISP_OK;
}

static wisp_status bind_group( scene_reader* r, const text_node* item, int index, void* surface )
{
    const int s = *(const int*)surface;
    return bind_attachment( r, item, s, &r->scene->surfaces[s].pin_groups[index] );
}

wisp_status scene_bind_attachments( scene_reader* r, const text_node* entry, int surface, void* none )
{
    (void)none;
    WISP_TRY( bind_attachment( r, entry, surface, &r->scene->surfaces[surface].pins ) );
    const text_node* list = text_find_path( entry, "pin_groups" );
    const size_t outside = scene_enter_key( r, "pin_groups" );
    WISP_TRY( list ? scene_read_items( r, list, bind_group, &surface ) : WISP_OK );
    scene_leave( r, outside );
    return WISP_OK;
}
