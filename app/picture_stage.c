#include "picture_stage.h"

#include "palette.h"
#include "world_from_scene.h"

#include "wisp/module/definition.h"

#include <math.h>

// ---- glass ----

// Which colliders hide what moves. A surface that nothing solves, such as a figure that wears cloth, hides half of it by nature.

enum
{
    SIGHTS_MAX = 400, // points of a surface that are looked at
};

// A surface is hidden if a quarter of it would be seen but for colliders; each that hides a tenth of it is glass.
// Hair grows on what hides a part of it.
static const double HIDDEN = 0.25, HIDES = 0.10, HIDDEN_HAIR = 0.9;

/// Points of all that moves, and what is seen before them.
typedef struct sights
{
    wisp_vec3* points;  // [count]
    int *owner, *first; // [count] bodies of the source; first is -1 where the view is free
    int count;
} sights;

static bool is_sight( const picture_body* body )
{
    return picture_is_surface( body ) || body->kind == SCENE_BODY_STRANDS;
}

static sights make_sights( const picture_source* source, io_memory* memory )
{
    const size_t room = (size_t)source->body_count * SIGHTS_MAX + 1;
    sights out = {
        .points = io_get( memory, room * sizeof *out.points ),
        .owner = io_get( memory, room * sizeof *out.owner ),
        .first = io_get( memory, room * sizeof *out.first ),
    };
    for ( int i = 0; i < source->body_count && !memory->is_short; ++i )
    {
        const picture_body* body = &source->bodies[i];
        const int step = 1 + ( body->vertex_count - 1 ) / SIGHTS_MAX;
        for ( int v = 0; v < body->vertex_count && is_sight( body ); v += step )
        {
            out.owner[out.count] = i;
            out.points[out.count++] = body->points[v];
        }
    }
    return out;
}

// Numbers of the stage's meshes as bodies of the source: the stage has them in the source's order.
static void name_bodies( const picture_source* source, const picture_stage* stage, sights* s )
{
    for ( int k = 0; k < s->count; ++k )
    {
        int mesh = s->first[k], body = -1;
        for ( int i = 0; i < source->body_count && mesh >= 0 && mesh < stage->scene.mesh_count && body < 0; ++i )
        {
            body = stage->meshes[mesh].points == source->bodies[i].points ? i : -1;
        }
        s->first[k] = body;
    }
}

static bool is_collider( const picture_source* source, int body )
{
    return body >= 0 && !is_sight( &source->bodies[body] ) && !source->bodies[body].is_led;
}

// @param begin, end sights of one surface
// @param hides [body_count] zero, and zero afterwards
static void judge( const picture_source* source, const sights* s, int begin, int end, int* hides, bool* is_glass )
{
    const double count = (double)( end - begin );
    const bool is_hair = source->bodies[s->owner[begin]].kind == SCENE_BODY_STRANDS;
    int hidden = 0;
    for ( int k = begin; k < end; ++k )
    {
        if ( is_collider( source, s->first[k] ) )
        {
            ++hides[s->first[k]];
            ++hidden;
        }
    }
    for ( int i = 0; i < source->body_count; ++i )
    {
        is_glass[i] = is_glass[i] || ( (double)hidden > ( is_hair ? HIDDEN_HAIR : HIDDEN ) * count &&
                                       (double)hides[i] > HIDES * count );
        hides[i] = 0;
    }
}

static void judge_all( const picture_source* source, const sights* s, int* hides, bool* is_glass )
{
    for ( int begin = 0, end = 0; begin < s->count; begin = end )
    {
        for ( end = begin; end < s->count && s->owner[end] == s->owner[begin]; )
        {
            ++end;
        }
        judge( source, s, begin, end, hides, is_glass );
    }
}

wisp_status picture_stage_find_glass( const picture_source* source, const render_camera* camera, picture_look* look,
                                      io_memory* memory, wisp_error* error )
{
    picture_stage stage;
    WISP_TRY( picture_stage_make( source, look, &stage, error ) );
    const size_t count = (size_t)source->body_count + 1;
    look->is_glass = io_get( memory, count * sizeof *look->is_glass );
    int* hides = io_get( &stage.memory, count * sizeof *hides );
    sights s = make_sights( source, &stage.memory );
    wisp_status status = memory->is_short || stage.memory.is_short
                             ? wisp_fail( error, WISP_NO_MEMORY, "out of memory for its picture" )
                             : render_find_hiding( &stage.scene, camera, s.points, s.count, s.first, error );
    if ( status == WISP_OK )
    {
        name_bodies( source, &stage, &s );
        judge_all( source, &s, hides, look->is_glass );
    }
    picture_stage_release( &stage );
    return status;
}

// A rigid mesh of so few triangles is meant to have edges.
#define BOX_TRIANGLES 12

// ---- materials and colours ----

static render_material material_of( scene_body_kind kind )
{
    return kind == SCENE_BODY_CLOTH ? RENDER_CLOTH : kind == SCENE_BODY_BALLOON ? RENDER_LATEX : RENDER_SOLID;
}

// A level infinite plane is drawn as the renderer's ground; a slope is drawn as its square.
bool picture_is_floor( const picture_body* body )
{
    float lower = INFINITY, upper = -INFINITY;
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        lower = fminf( lower, body->points[v].y );
        upper = fmaxf( upper, body->points[v].y );
    }
    return body->kind == SCENE_BODY_PLANE && upper - lower <= 1e-4f;
}

// ---- the stage ----

static void colour_by_value( picture_stage* stage, const picture_look* look, const picture_body* body,
                             const wisp_vec3** colours )
{
    if ( look->value == PICTURE_BODY || !body->values )
    {
        return;
    }
    wisp_vec3* made = io_get( &stage->memory, (size_t)body->vertex_count * sizeof *made );
    if ( made )
    {
        colour_map_apply( COLOUR_MAP_RISING, body->values, body->vertex_count, look->range[0], look->range[1], made );
        *colours = made;
    }
}

static void add_strands( picture_stage* stage, const picture_look* look, const picture_body* body )
{
    render_curves* curves = &stage->curves[stage->scene.curves_count++];
    *curves = render_default_curves();
    curves->name = body->name;
    curves->points = body->points;
    curves->offsets = body->offsets;
    curves->strand_count = body->strand_count;
    curves->colours = body->colours;
    curves->is_hair = true;
    if ( body->widths )
    {
        float* radii = io_get( &stage->memory, (size_t)body->vertex_count * sizeof *radii );
        for ( int v = 0; radii && v < body->vertex_count; ++v )
        {
            radii[v] = 0.5f * body->widths[v];
        }
        curves->radii = radii;
    }
    colour_by_value( stage, look, body, &curves->colours );
}

static void add_body_mesh( picture_stage* stage, const picture_look* look, const picture_body* body, wisp_vec3 colour,
                           bool is_glass )
{
    render_mesh* mesh = &stage->meshes[stage->scene.mesh_count++];
    *mesh = render_default_mesh( material_of( body->kind ) );
    mesh->name = body->name;
    mesh->points = body->points;
    mesh->triangles = body->triangles;
    mesh->vertex_count = body->vertex_count;
    mesh->triangle_count = body->triangle_count;
    mesh->colour = colour;
    mesh->material = is_glass ? RENDER_GLASS : mesh->material;
    mesh->is_faceted = body->kind == SCENE_BODY_PLANE ||
                       ( body->kind == SCENE_BODY_COLLIDER && body->triangle_count <= BOX_TRIANGLES );
    if ( body->kind != SCENE_BODY_COLLIDER && body->kind != SCENE_BODY_PLANE )
    {
        colour_by_value( stage, look, body, &mesh->colours );
    }
}

// ---- boundary particles ----

// Relative to their spacing. The source draws its points at this size.
#define BALL_RADIUS 0.3f
#define LINE_LENGTH 0.8f
#define LINE_RADIUS 0.03f

// Displays show about the square root of linear colour, and directions should be distinguishable on displays.
static wisp_vec3 direction_colour( wisp_vec3 n )
{
    const wisp_vec3 c = { 0.5f + 0.5f * n.x, 0.5f + 0.5f * n.y, 0.5f + 0.5f * n.z };
    return ( wisp_vec3 ){ c.x * c.x, c.y * c.y, c.z * c.z };
}

static void add_balls( picture_stage* stage, const picture_look* look, const picture_body* body )
{
    const picture_layer* layer = &body->layer;
    wisp_vec3* colours = io_get( &stage->memory, (size_t)layer->count * sizeof *colours );
    for ( int i = 0; colours && i < layer->count; ++i )
    {
        colours[i] = look->layer != PICTURE_LAYER_CLASS ? direction_colour( layer->normals[i] )
                                                        : palette_body( i < layer->edge_count ? 2 : 5 );
    }
    render_points* points = &stage->points[stage->scene.points_count++];
    *points = render_default_points();
    points->name = body->name;
    points->points = layer->points;
    points->colours = colours;
    points->count = layer->count;
    points->radius = BALL_RADIUS * layer->spacing;
}

// A line is a strand of two vertices.
static void add_normals( picture_stage* stage, const picture_body* body )
{
    const picture_layer* layer = &body->layer;
    const float length = LINE_LENGTH * layer->spacing;
    wisp_vec3* ends = io_get( &stage->memory, 2 * (size_t)layer->count * sizeof *ends );
    int32_t* offsets = io_get( &stage->memory, ( (size_t)layer->count + 1 ) * sizeof *offsets );
    for ( int i = 0; !stage->memory.is_short && i < layer->count; ++i )
    {
        const wisp_vec3 p = layer->points[i], n = layer->normals[i];
        ends[2 * i] = p;
        ends[2 * i + 1] = ( wisp_vec3 ){ p.x + length * n.x, p.y + length * n.y, p.z + length * n.z };
        offsets[i + 1] = 2 * i + 2;
    }
    render_curves* curves = &stage->curves[stage->scene.curves_count++];
    *curves = render_default_curves();
    curves->name = body->name;
    curves->points = ends;
    curves->offsets = offsets;
    curves->strand_count = layer->count;
    curves->radius = LINE_RADIUS * layer->spacing;
}

// ---- all bodies ----

wisp_status picture_stage_make( const picture_source* source, const picture_look* look, picture_stage* out,
                                wisp_error* error )
{
    const size_t count = (size_t)source->body_count + 1;
    *out = ( picture_stage ){ .scene = render_default_scene() };
    out->meshes = io_get( &out->memory, count * sizeof *out->meshes );
    out->curves = io_get( &out->memory, count * sizeof *out->curves );
    out->points = io_get( &out->memory, count * sizeof *out->points );
    int cloths = 0, balloons = 0;
    for ( int i = 0; i < source->body_count && !out->memory.is_short; ++i )
    {
        const picture_body* body = &source->bodies[i];
        wisp_vec3 colour = scene_body_colour( body->kind, &cloths, &balloons );
        if ( body->kind == SCENE_BODY_STRANDS )
        {
            add_strands( out, look, body );
            continue;
        }
        if ( body->triangle_count == 0 || picture_is_floor( body ) )
        {
            continue;
        }
        add_body_mesh( out, look, body, colour, look->is_glass && look->is_glass[i] );
        if ( body->layer.count > 0 && look->layer != PICTURE_LAYER_NONE )
        {
            add_balls( out, look, body );
        }
        if ( body->layer.count > 0 && look->has_layer_normals )
        {
            add_normals( out, body );
        }
    }
    if ( out->memory.is_short )
    {
        picture_stage_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its picture", source->path );
    }
    out->scene.meshes = out->meshes;
    out->scene.curves = out->curves;
    out->scene.points = out->points;
    out->scene.has_ground = look->has_ground;
    out->scene.ground_height = look->ground_height;
    out->scene.background_top = look->background[0];
    out->scene.background_bottom = look->background[1];
    out->scene.cut_normal = look->cut_normal;
    out->scene.cut_offset = look->cut_offset;
    return WISP_OK;
}

void picture_stage_release( picture_stage* stage )
{
    io_release( &stage->memory );
    *stage = ( picture_stage ){ 0 };
}
