// Vertices that a scene gives by number, by position, or by a box around them.
#include "world_from_scene_parts.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A surface's vertices: the scene's numbering and the initial positions.
typedef struct vertex_finder
{
    const wisp_scene* scene;
    const wisp_scene_surface* entry;
    const wisp_mesh* mesh;
    const wisp_mesh_repairs* repairs;
    wisp_error* error;
} vertex_finder;

static wisp_status refuse_pins( const vertex_finder* f, const char* message )
{
    return scene_fail_at( f->scene, f->entry->line, f->entry->column, "surface", f->entry->name, WISP_BAD_INPUT,
                          message, f->error );
}

static int compare_vertices( const void* a, const void* b )
{
    const int32_t *x = a, *y = b;
    return ( *x > *y ) - ( *x < *y );
}

// @return where a vertex stands in an ascending list, -1: it does not
static int32_t place_in_list( const int32_t* ascending, int count, int32_t vertex )
{
    const int32_t* found =
        count > 0 ? bsearch( &vertex, ascending, (size_t)count, sizeof vertex, compare_vertices ) : NULL;
    return found ? (int32_t)( found - ascending ) : -1;
}

// @param number >= 0, of a vertex in the file @return its index in the repaired mesh, -1: it has none
static int32_t vertex_of_number( const wisp_mesh_repairs* repairs, int32_t number )
{
    return repairs->became == NULL ? number : number < repairs->original_count ? repairs->became[number] : -1;
}

// A repair that drops vertices renumbers the others; the scene keeps the numbers of the file.
static wisp_status find_number( const vertex_finder* f, const char* what, int32_t number, int32_t* vertex )
{
    char message[160];
    *vertex = vertex_of_number( f->repairs, number );
    if ( *vertex < 0 )
    {
        snprintf( message, sizeof message, "%s: got vertex %d, which the mesh does not have or which repair removed",
                  what, number );
        return refuse_pins( f, message );
    }
    if ( *vertex >= f->mesh->vertex_count )
    {
        snprintf( message, sizeof message, "%s: got vertex %d, but the mesh has %d vertices, counted from 0", what,
                  number, f->mesh->vertex_count );
        return refuse_pins( f, message );
    }
    return WISP_OK;
}

static double distance2( wisp_vec3 a, wisp_vec3 b )
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return x * x + y * y + z * z;
}

// Ties go to the lowest index.
static int32_t nearest_vertex( const wisp_mesh* mesh, wisp_vec3 place )
{
    int32_t best = 0;
    for ( int32_t v = 1; v < mesh->vertex_count; ++v )
    {
        if ( distance2( mesh->points[v], place ) < distance2( mesh->points[best], place ) )
        {
            best = v;
        }
    }
    return best;
}

// ---- pins ----

/// Marks of a vertex.
enum
{
    IN_GROUP = 1, // of the group that is being found
    TAKEN = 2,    // of a group before it
    HELD = 4,     // from the start
};

static bool is_inside( const wisp_scene_box* box, wisp_vec3 p )
{
    return p.x >= box->lower.x && p.x <= box->upper.x && p.y >= box->lower.y && p.y <= box->upper.y &&
           p.z >= box->lower.z && p.z <= box->upper.z;
}

static wisp_status mark_boxes( const vertex_finder* f, const wisp_scene_pins* pins, unsigned char* marks )
{
    for ( int i = 0; i < pins->box_count; ++i )
    {
        bool any = false;
        for ( int v = 0; v < f->mesh->vertex_count; ++v )
        {
            bool inside = is_inside( &pins->boxes[i], f->mesh->points[v] );
            marks[v] |= inside ? IN_GROUP : 0;
            any = any || inside;
        }
        if ( !any )
        {
            char message[160];
            snprintf( message, sizeof message, "%s%s%sno vertex starts in pin_box %d", pins->name ? "group '" : "",
                      pins->name ? pins->name : "", pins->name ? "': " : "", i );
            return refuse_pins( f, message );
        }
    }
    return WISP_OK;
}

static wisp_status mark_pins( const vertex_finder* f, const wisp_scene_pins* pins, unsigned char* marks )
{
    for ( int i = 0; i < pins->vertex_count; ++i )
    {
        int32_t vertex;
        WISP_TRY( find_number( f, "pins", pins->vertices[i], &vertex ) );
        marks[vertex] |= IN_GROUP;
    }
    for ( int i = 0; i < pins->nearest_count; ++i )
    {
        marks[nearest_vertex( f->mesh, pins->nearest[i] )] |= IN_GROUP;
    }
    if ( wisp_scene_is_driven( f->entry ) && pins == &f->entry->pins )
    {
        memset( marks, IN_GROUP, (size_t)f->mesh->vertex_count );
    }
    return mark_boxes( f, pins, marks );
}

static wisp_vec3 middle_of( const wisp_mesh* mesh, const scene_world_pins* pins )
{
    double sum[3] = { 0 };
    for ( int i = 0; i < pins->count; ++i )
    {
        const wisp_vec3 p = mesh->points[pins->vertices[i]];
        sum[0] += (double)p.x;
        sum[1] += (double)p.y;
        sum[2] += (double)p.z;
    }
    double fraction = 1.0 / (double)pins->count;
    return ( wisp_vec3 ){ (float)( sum[0] * fraction ), (float)( sum[1] * fraction ), (float)( sum[2] * fraction ) };
}

// Vertices with a mark, in ascending order.
static int32_t* list_marked( const unsigned char* marks, unsigned char mark, int vertex_count, io_memory* memory,
                             int* count )
{
    *count = 0;
    for ( int v = 0; v < vertex_count; ++v )
    {
        *count += ( marks[v] & mark ) != 0;
    }
    int32_t* out = io_get( memory, (size_t)*count * sizeof *out );
    for ( int v = 0, i = 0; v < vertex_count && out; ++v )
    {
        if ( ( marks[v] & mark ) != 0 )
        {
            out[i++] = v;
        }
    }
    return out;
}

static wisp_status list_group( const vertex_finder* f, const wisp_scene_pins* pins, const unsigned char* marks,
                               io_memory* memory, scene_world_pins* out )
{
    const bool has_path = pins->path.count > 0 && !f->entry->has_animation;
    const bool moves = pins->path.count > 0 || f->entry->has_animation;
    out->vertices = list_marked( marks, IN_GROUP, f->mesh->vertex_count, memory, &out->count );
    out->starts = has_path ? io_get( memory, (size_t)out->count * sizeof *out->starts ) : NULL;
    out->targets = moves ? io_get( memory, (size_t)out->count * sizeof *out->targets ) : NULL;
    if ( memory->is_short )
    {
        return wisp_fail( f->error, WISP_NO_MEMORY, "out of memory for %d pins", out->count );
    }
    for ( int i = 0; i < out->count && has_path; ++i )
    {
        out->starts[i] = f->mesh->points[out->vertices[i]];
    }
    if ( out->count > 0 )
    {
        out->pivot = pins->has_pivot ? pins->pivot : middle_of( f->mesh, out );
    }
    out->is_held = !pins->starts_free;
    return WISP_OK;
}

static wisp_status take_group( const vertex_finder* f, const wisp_scene_pins* pins, unsigned char* marks )
{
    for ( int v = 0; v < f->mesh->vertex_count; ++v )
    {
        if ( ( marks[v] & ( IN_GROUP | TAKEN ) ) == ( IN_GROUP | TAKEN ) )
        {
            char message[160];
            snprintf( message, sizeof message,
                      "vertex %d of the group '%s' is also pinned by the surface or by a group before it",
                      f->repairs->kept ? f->repairs->kept[v] : v, pins->name );
            return refuse_pins( f, message );
        }
        const bool is_in = ( marks[v] & IN_GROUP ) != 0;
        marks[v] = (unsigned char)( ( marks[v] & ~IN_GROUP ) | ( is_in ? TAKEN : 0 ) |
                                    ( is_in && !pins->starts_free ? HELD : 0 ) );
    }
    return WISP_OK;
}

static wisp_status find_groups( const vertex_finder* f, unsigned char* marks, scene_world_surface* out )
{
    for ( int g = 0; g <= f->entry->pin_group_count; ++g )
    {
        const wisp_scene_pins* pins = scene_pins_entry( f->entry, g );
        WISP_TRY( mark_pins( f, pins, marks ) );
        WISP_TRY( list_group( f, pins, marks, &out->memory, &out->groups[out->group_count++] ) );
        WISP_TRY( take_group( f, pins, marks ) );
    }
    out->pins = list_marked( marks, HELD, out->mesh.vertex_count, &out->memory, &out->pin_count );
    return out->pins ? WISP_OK : wisp_fail( f->error, WISP_NO_MEMORY, "out of memory for %d pins", out->pin_count );
}

wisp_status scene_pins_find( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                             scene_world_surface* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const vertex_finder finder = { scene, entry, &out->mesh, repairs, error };
    io_memory short_lived = { 0 };
    unsigned char* marks = io_get( &short_lived, (size_t)out->mesh.vertex_count );
    out->groups = io_get( &out->memory, ( (size_t)entry->pin_group_count + 1 ) * sizeof *out->groups );
    wisp_status status =
        marks && out->groups
            ? find_groups( &finder, marks, out )
            : wisp_fail( error, WISP_NO_MEMORY, "out of memory for the pins of %d vertices", out->mesh.vertex_count );
    io_release( &short_lived );
    return status;
}

const wisp_scene_pins* scene_pins_entry( const wisp_scene_surface* entry, int group )
{
    return group == 0 ? &entry->pins : &entry->pin_groups[group - 1];
}

int scene_pins_holding( const scene_world_surface* surface, int32_t vertex )
{
    for ( int g = 0; g < surface->group_count; ++g )
    {
        const scene_world_pins* pins = &surface->groups[g];
        if ( pins->is_held && place_in_list( pins->vertices, pins->count, vertex ) >= 0 )
        {
            return g;
        }
    }
    return -1;
}

// ---- what a host saves ----

static size_t starts_size( const scene_world_pins* pins )
{
    return pins->starts ? (size_t)pins->count * sizeof *pins->starts : 0;
}

size_t scene_pins_state_size( const scene_world* world )
{
    size_t size = 0;
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        for ( int g = 0; g < world->surfaces[i].group_count; ++g )
        {
            size += sizeof( int32_t ) + starts_size( &world->surfaces[i].groups[g] );
        }
    }
    return size;
}

void scene_pins_save( const scene_world* world, void* out )
{
    char* at = out;
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        for ( int g = 0; g < world->surfaces[i].group_count; ++g )
        {
            const scene_world_pins* pins = &world->surfaces[i].groups[g];
            const int32_t is_held = pins->is_held;
            memcpy( at, &is_held, sizeof is_held );
            at += sizeof is_held;
            if ( pins->starts )
            {
                memcpy( at, pins->starts, starts_size( pins ) );
                at += starts_size( pins );
            }
        }
    }
}

void scene_pins_load( scene_world* world, const void* bytes )
{
    const char* at = bytes;
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        for ( int g = 0; g < world->surfaces[i].group_count; ++g )
        {
            scene_world_pins* pins = &world->surfaces[i].groups[g];
            int32_t is_held;
            memcpy( &is_held, at, sizeof is_held );
            at += sizeof is_held;
            pins->is_held = is_held != 0;
            if ( pins->starts )
            {
                memcpy( pins->starts, at, starts_size( pins ) );
                at += starts_size( pins );
            }
        }
    }
}

// ---- the outlet ----

wisp_status scene_outlet_find( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                               const wisp_mesh* mesh, wisp_balloon_def* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const vertex_finder finder = { scene, entry, mesh, repairs, error };
    *out = entry->balloon;
    for ( int i = 0; i < out->outlet_count; ++i )
    {
        WISP_TRY( find_number( &finder, "balloon.outlet", entry->balloon.outlet[i], &out->outlet[i] ) );
    }
    if ( !entry->has_outlet_nearest )
    {
        return WISP_OK;
    }
    int32_t nearest = nearest_vertex( mesh, entry->outlet_nearest );
    double reach2 = (double)entry->outlet_radius * (double)entry->outlet_radius;
    for ( int32_t v = 0; v < mesh->vertex_count; ++v )
    {
        bool within = entry->outlet_radius > 0.0f && distance2( mesh->points[v], entry->outlet_nearest ) <= reach2;
        if ( !within && v != nearest )
        {
            continue;
        }
        if ( out->outlet_count == WISP_BALLOON_MAX_OUTLET )
        {
            char message[120];
            snprintf( message, sizeof message,
                      "balloon.outlet_radius: got more than %d vertices within %g m, which is the limit",
                      WISP_BALLOON_MAX_OUTLET, (double)entry->outlet_radius );
            return refuse_pins( &finder, message );
        }
        out->outlet[out->outlet_count++] = v;
    }
    return WISP_OK;
}

// ---- seams ----

// Seams of a scene in the world.

static wisp_status refuse_seam( const scene_world* world, const wisp_scene_seam* entry, wisp_status status,
                                const char* message, wisp_error* error )
{
    return scene_fail_at( world->scene, entry->line, entry->column, "seam", entry->name, status, message, error );
}

// The scene numbers vertices as the file does; a repair that drops vertices renumbers the others.
static int32_t find_vertex( const scene_world* world, int surface, int32_t number )
{
    const int source = world->scene->surfaces[surface].instance_of;
    return vertex_of_number( &world->surfaces[source >= 0 ? source : surface].repairs, number );
}

wisp_status scene_seam_pairs( const scene_world* world, const wisp_scene_seam* entry, int32_t* pairs,
                              wisp_error* error )
{
    for ( int i = 0; i < 2 * entry->pair_count; ++i )
    {
        const int surface = entry->surfaces[i % 2];
        pairs[i] = find_vertex( world, surface, entry->pairs[i] );
        if ( pairs[i] < 0 || pairs[i] >= world->surfaces[surface].mesh.vertex_count )
        {
            char message[200];
            snprintf( message, sizeof message,
                      "pairs[%d]: got vertex %d of '%s', which the mesh does not have or which repair removed", i / 2,
                      entry->pairs[i], world->scene->surfaces[surface].name );
            return refuse_seam( world, entry, WISP_BAD_INPUT, message, error );
        }
    }
    return WISP_OK;
}

static wisp_status add_seam( scene_world* world, int seam, wisp_error* error )
{
    const wisp_scene_seam* entry = &world->scene->seams[seam];
    int32_t* pairs = malloc( (size_t)entry->pair_count * 2 * sizeof *pairs + 1 );
    if ( !pairs )
    {
        return refuse_seam( world, entry, WISP_NO_MEMORY, "out of memory for its pairs", error );
    }
    wisp_status status = scene_seam_pairs( world, entry, pairs, error );
    if ( status == WISP_OK )
    {
        wisp_seam_def def = entry->def;
        def.a = world->surfaces[entry->surfaces[0]].entity;
        def.b = world->surfaces[entry->surfaces[1]].entity;
        def.pairs = pairs;
        def.pair_count = entry->pair_count;
        status = wisp_add_seam( world->world, &def, &world->seams[seam] );
        status = status == WISP_OK ? WISP_OK
                                   : refuse_seam( world, entry, status, wisp_world_message( world->world ), error );
    }
    free( pairs );
    return status;
}

wisp_status scene_seams_add( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    world->seams = io_get( &world->memory, (size_t)scene->seam_count * sizeof *world->seams );
    WISP_TRY( world->seams ? WISP_OK
                           : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its seams", scene->name ) );
    for ( int i = 0; i < scene->seam_count; ++i )
    {
        WISP_TRY( add_seam( world, i, error ) );
    }
    return WISP_OK;
}
