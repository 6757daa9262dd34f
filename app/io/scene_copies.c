// Copies of an entry in a grid: read as one entry, and made into entries of their own once all names are known.
#include "groom.h"
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_NAME = 64,
};

// ---- where a copy is ----

static wisp_vec3 shift_of( const wisp_scene_copies* copies, int k )
{
    const int root = (int)ceil( sqrt( copies->count ) );
    const int columns = copies->columns > 0 ? copies->columns : root;
    const float column = (float)( k % columns ), row = (float)( k / columns );
    return ( wisp_vec3 ){ column * copies->spacing.x, row * copies->spacing.y, row * copies->spacing.z };
}

static wisp_vec3 moved( wisp_vec3 point, wisp_vec3 by )
{
    return ( wisp_vec3 ){ point.x + by.x, point.y + by.y, point.z + by.z };
}

// ---- names ----

// @return null without memory
static const char* name_copy( scene_reader* r, const char* name, int number )
{
    char* out = scene_take( r->scene, MAX_NAME + 12, 1 );
    if ( out )
    {
        snprintf( out, MAX_NAME + 12, "%s-%d", name, number );
    }
    return out;
}

static wisp_status check_name( const scene_reader* r, const char* name, int line, int column, const char* list )
{
    if ( strlen( name ) > MAX_NAME )
    {
        return scene_refuse( r->source, line, column, list, "the name of the copy '%s' has more than %d characters",
                             name, (int)MAX_NAME );
    }
    const scene_name* taken = scene_find_name( r, name );
    if ( taken )
    {
        return scene_refuse( r->source, line, column, list,
                             "the name of the copy '%s' is taken by the entry in line %d", name, taken->line );
    }
    return WISP_OK;
}

// ---- surfaces ----

static wisp_status move_pins( scene_reader* r, wisp_scene_pins* pins, wisp_vec3 by )
{
    wisp_scene_box* boxes = scene_take( r->scene, (size_t)pins->box_count + 1, sizeof *boxes );
    wisp_vec3* nearest = scene_take( r->scene, (size_t)pins->nearest_count + 1, sizeof *nearest );
    if ( !boxes || !nearest )
    {
        return scene_no_memory( r );
    }
    for ( int i = 0; i < pins->box_count; ++i )
    {
        boxes[i] = ( wisp_scene_box ){ moved( pins->boxes[i].lower, by ), moved( pins->boxes[i].upper, by ) };
    }
    for ( int i = 0; i < pins->nearest_count; ++i )
    {
        nearest[i] = moved( pins->nearest[i], by );
    }
    pins->boxes = boxes;
    pins->nearest = nearest;
    pins->pivot = moved( pins->pivot, by );
    return WISP_OK;
}

static wisp_status move_places( scene_reader* r, wisp_scene_surface* s, wisp_vec3 by )
{
    wisp_scene_pins* groups = scene_take( r->scene, (size_t)s->pin_group_count + 1, sizeof *groups );
    wisp_status status = groups ? move_pins( r, &s->pins, by ) : scene_no_memory( r );
    for ( int i = 0; i < s->pin_group_count && !status; ++i )
    {
        groups[i] = s->pin_groups[i];
        status = move_pins( r, &groups[i], by );
    }
    s->pin_groups = groups;
    s->target_pivot = moved( s->target_pivot, by );
    s->frame_pivot = moved( s->frame_pivot, by );
    s->outlet_nearest = moved( s->outlet_nearest, by );
    return status;
}

// A copy is an instance: it shares the fabric of the entry, or of the one that this shares.
static wisp_status copy_surface( scene_reader* r, int source, int k, wisp_scene_surface* out )
{
    const wisp_scene_surface* from = &r->scene->surfaces[source];
    const wisp_scene_surface none = scene_default_surface( r->scene->gravity );
    const wisp_vec3 by = shift_of( &from->copies, k );
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    if ( !out->name )
    {
        return scene_no_memory( r );
    }
    out->mesh = none.mesh;
    out->instance_of = from->instance_of >= 0 ? from->instance_of : source;
    out->pose.translation = moved( from->pose.translation, by );
    const wisp_status status = move_places( r, out, by );
    return status ? status : check_name( r, out->name, out->line, out->column, "surfaces" );
}

static wisp_status copy_surfaces( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0, vertices = 0;
    int count = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* s = &scene->surfaces[i];
        const wisp_scene_mesh* mesh = &scene->surfaces[s->instance_of >= 0 ? s->instance_of : i].mesh;
        sum += s->copies.count;
        vertices += mesh->is_generated ? s->copies.count * scene_generator_vertices( &mesh->generator ) : 0;
        if ( sum > WISP_SCENE_MAX_SURFACES || vertices > WISP_SCENE_MAX_VERTICES )
        {
            return scene_refuse( r->source, s->line, s->column, "surfaces",
                                 "got %lld surfaces of %lld vertices with this one's copies, expected at most %d "
                                 "of %d",
                                 (long long)sum, (long long)vertices, WISP_SCENE_MAX_SURFACES,
                                 WISP_SCENE_MAX_VERTICES );
        }
    }
    if ( sum == scene->surface_count )
    {
        return WISP_OK;
    }
    wisp_scene_surface* all = scene_take( scene, (size_t)sum, sizeof *all );
    if ( !all )
    {
        return scene_no_memory( r );
    }
    memcpy( all, scene->surfaces, (size_t)scene->surface_count * sizeof *all );
    count = scene->surface_count;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count; ++k )
        {
            const wisp_status status = copy_surface( r, i, k, &all[count++] );
            if ( status )
            {
                return status;
            }
        }
    }
    scene->surfaces = all;
    scene->surface_count = count;
    return WISP_OK;
}

// ---- strands ----

static wisp_status check_strands( const scene_reader* r, const wisp_scene_strands* s )
{
    const char* other = s->is_scattered      ? "scatter"
                        : s->is_curves       ? "curves"
                        : s->has_ghosts      ? "ghosts"
                        : s->has_head        ? "head"
                        : s->on_surface >= 0 ? "on_surface"
                                             : NULL;
    return other && s->copies.count > 1
               ? scene_refuse( r->source, s->line, s->column, "strands", "'copies' is not possible with '%s'", other )
               : WISP_OK;
}

static wisp_status copy_entry( scene_reader* r, const wisp_scene_strands* from, int k, wisp_scene_strands* out )
{
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    if ( !out->name )
    {
        return scene_no_memory( r );
    }
    out->pose.translation = moved( from->pose.translation, shift_of( &from->copies, k ) );
    return check_name( r, out->name, out->line, out->column, "strands" );
}

static wisp_status copy_strands( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0;
    int count = 0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        const wisp_status status = check_strands( r, s );
        const int64_t vertices = s->is_generated ? s->copies.count * scene_made_vertices( s ) : 0;
        sum += s->copies.count;
        if ( status )
        {
            return status;
        }
        if ( sum > WISP_SCENE_MAX_STRANDS || vertices > WISP_GROOM_MAX_GENERATED )
        {
            return scene_refuse( r->source, s->line, s->column, "strands",
                                 "got %lld entries with copies, and %lld vertices of this one, expected at most %d "
                                 "and %d",
                                 (long long)sum, (long long)vertices, WISP_SCENE_MAX_STRANDS,
                                 WISP_GROOM_MAX_GENERATED );
        }
    }
    if ( sum == scene->strands_count )
    {
        return WISP_OK;
    }
    wisp_scene_strands* all = scene_take( scene, (size_t)sum, sizeof *all );
    if ( !all )
    {
        return scene_no_memory( r );
    }
    memcpy( all, scene->strands, (size_t)scene->strands_count * sizeof *all );
    count = scene->strands_count;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count; ++k )
        {
            const wisp_status status = copy_entry( r, &all[i], k, &all[count++] );
            if ( status )
            {
                return status;
            }
        }
    }
    scene->strands = all;
    scene->strands_count = count;
    return WISP_OK;
}

// ---- colliders ----

static wisp_status copy_collider( scene_reader* r, const wisp_scene_collider* from, int k, wisp_scene_collider* out )
{
    const wisp_vec3 by = shift_of( &from->copies, k );
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    wisp_scene_pose* poses = scene_take( r->scene, (size_t)from->path.count + 1, sizeof *poses );
    if ( !out->name || !poses )
    {
        return scene_no_memory( r );
    }
    for ( int i = 0; i < from->path.count; ++i )
    {
        poses[i] = from->path.poses[i];
        poses[i].pose.translation = moved( poses[i].pose.translation, by );
    }
    out->path.poses = poses;
    out->def.pose.translation = moved( from->def.pose.translation, by );
    return check_name( r, out->name, out->line, out->column, "colliders" );
}

static wisp_status copy_colliders( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0;
    int count = scene->collider_count;
    for ( int i = 0; i < count; ++i )
    {
        const wisp_scene_collider* c = &scene->colliders[i];
        sum += c->copies.count;
        if ( sum > WISP_SCENE_MAX_COLLIDERS )
        {
            return scene_refuse( r->source, c->line, c->column, "colliders",
                                 "got %lld entries with this one's copies, expected at most %d", (long long)sum,
                                 WISP_SCENE_MAX_COLLIDERS );
        }
    }
    wisp_scene_collider* all = sum > count ? scene_take( scene, (size_t)sum, sizeof *all ) : scene->colliders;
    if ( !all || sum == count )
    {
        return all || sum == count ? WISP_OK : scene_no_memory( r );
    }
    memcpy( all, scene->colliders, (size_t)count * sizeof *all );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count && !status; ++k )
        {
            status = copy_collider( r, &all[i], k, &all[count++] );
        }
    }
    scene->colliders = all;
    scene->collider_count = status ? scene->collider_count : count;
    return status;
}

wisp_status scene_make_copies( scene_reader* r )
{
    wisp_status status = copy_surfaces( r );
    status = status ? status : copy_strands( r );
    return status ? status : copy_colliders( r );
}
