// Vertices that a scene gives by number, by position, or by a box around them.
#include "world_from_scene_parts.h"

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

static wisp_status refuse( const vertex_finder* f, const char* message )
{
    return scene_fail_at( f->scene, f->entry->line, f->entry->column, "surface", f->entry->name, WISP_BAD_INPUT,
                          message, f->error );
}

static int compare_vertices( const void* a, const void* b )
{
    const int32_t *x = a, *y = b;
    return ( *x > *y ) - ( *x < *y );
}

int32_t scene_pins_find_vertex( const int32_t* ascending, int count, int32_t vertex )
{
    const int32_t* found =
        count > 0 ? bsearch( &vertex, ascending, (size_t)count, sizeof vertex, compare_vertices ) : NULL;
    return found ? (int32_t)( found - ascending ) : -1;
}

int32_t scene_vertex_of_number( const wisp_mesh_repairs* repairs, int32_t number )
{
    return repairs->became == NULL ? number : number < repairs->original_count ? repairs->became[number] : -1;
}

// A repair that drops vertices renumbers the others; the scene keeps the numbers of the file.
static wisp_status find_number( const vertex_finder* f, const char* what, int32_t number, int32_t* vertex )
{
    char message[160];
    *vertex = scene_vertex_of_number( f->repairs, number );
    if ( *vertex < 0 )
    {
        snprintf( message, sizeof message, "%s: got vertex %d, which the mesh does not have or which repair removed",
                  what, number );
        return refuse( f, message );
    }
    if ( *vertex >= f->mesh->vertex_count )
    {
        snprintf( message, sizeof message, "%s: got vertex %d, but the mesh has %d vertices, counted from 0", what,
                  number, f->mesh->vertex_count );
        return refuse( f, message );
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

static bool is_inside( const wisp_scene_box* box, wisp_vec3 p )
{
    return p.x >= box->lower.x && p.x <= box->upper.x && p.y >= box->lower.y && p.y <= box->upper.y &&
           p.z >= box->lower.z && p.z <= box->upper.z;
}

static wisp_status mark_boxes( const vertex_finder* f, unsigned char* marks )
{
    for ( int i = 0; i < f->entry->pin_box_count; ++i )
    {
        bool any = false;
        for ( int v = 0; v < f->mesh->vertex_count; ++v )
        {
            bool inside = is_inside( &f->entry->pin_boxes[i], f->mesh->points[v] );
            marks[v] |= inside;
            any = any || inside;
        }
        if ( !any )
        {
            char message[80];
            snprintf( message, sizeof message, "no vertex starts in pin_box %d", i );
            return refuse( f, message );
        }
    }
    return WISP_OK;
}

static wisp_status mark_pins( const vertex_finder* f, unsigned char* marks )
{
    for ( int i = 0; i < f->entry->pin_count; ++i )
    {
        int32_t vertex;
        wisp_status status = find_number( f, "pins", f->entry->pins[i], &vertex );
        if ( status != WISP_OK )
        {
            return status;
        }
        marks[vertex] = 1;
    }
    for ( int i = 0; i < f->entry->pin_nearest_count; ++i )
    {
        marks[nearest_vertex( f->mesh, f->entry->pin_nearest[i] )] = 1;
    }
    const bool moves_itself = f->entry->has_cloth || f->entry->has_balloon || f->entry->has_implicit;
    if ( f->entry->has_animation && !moves_itself )
    {
        memset( marks, 1, (size_t)f->mesh->vertex_count );
    }
    return mark_boxes( f, marks );
}

static wisp_vec3 middle_of( const scene_world_surface* s )
{
    double sum[3] = { 0 };
    for ( int i = 0; i < s->pin_count; ++i )
    {
        const wisp_vec3 p = s->mesh.points[s->pins[i]];
        sum[0] += (double)p.x;
        sum[1] += (double)p.y;
        sum[2] += (double)p.z;
    }
    double fraction = 1.0 / (double)s->pin_count;
    return ( wisp_vec3 ){ (float)( sum[0] * fraction ), (float)( sum[1] * fraction ), (float)( sum[2] * fraction ) };
}

static wisp_status list_pins( const vertex_finder* f, const unsigned char* marks, scene_world_surface* out )
{
    int count = 0;
    for ( int v = 0; v < f->mesh->vertex_count; ++v )
    {
        count += marks[v];
    }
    const bool moves = f->entry->pin_path.count > 0 || f->entry->has_animation;
    out->pins = calloc( (size_t)count + 1, sizeof *out->pins );
    out->pin_targets = moves ? calloc( (size_t)count + 1, sizeof *out->pin_targets ) : NULL;
    if ( !out->pins || ( moves && !out->pin_targets ) )
    {
        return wisp_fail( f->error, WISP_NO_MEMORY, "out of memory for %d pins", count );
    }
    for ( int v = 0; v < f->mesh->vertex_count; ++v )
    {
        if ( marks[v] )
        {
            out->pins[out->pin_count++] = v;
        }
    }
    if ( count > 0 )
    {
        out->pivot = f->entry->has_pin_pivot ? f->entry->pin_pivot : middle_of( out );
    }
    return WISP_OK;
}

wisp_status scene_pins_find( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                             scene_world_surface* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const vertex_finder finder = { scene, entry, &out->mesh, repairs, error };
    unsigned char* marks = calloc( (size_t)out->mesh.vertex_count + 1, 1 );
    if ( !marks )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the pins of %d vertices",
                          out->mesh.vertex_count );
    }
    wisp_status status = mark_pins( &finder, marks );
    status = status == WISP_OK ? list_pins( &finder, marks, out ) : status;
    free( marks );
    return status;
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
        wisp_status status = find_number( &finder, "balloon.outlet", entry->balloon.outlet[i], &out->outlet[i] );
        if ( status != WISP_OK )
        {
            return status;
        }
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
            return refuse( &finder, message );
        }
        out->outlet[out->outlet_count++] = v;
    }
    return WISP_OK;
}
