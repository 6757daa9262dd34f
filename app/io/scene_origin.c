// Where a scene is: places far from the origin of the world become relative to a place near the first body, so that floats keep their
// digits. In: places as they are written. Out: wisp_scene.origin, and places relative to it.
#include "scene_parts.h"

#include <math.h>

// A multiple of 8 m: a scene that is moved by such has the bits that it had, if its first body is within 4 m of 0.
static double origin_near( float place )
{
    const double cell = 8.0, home = 16.0; // m
    return fabs( (double)place ) > home ? cell * rint( (double)place / cell ) : 0.0;
}

static void move( const wisp_scene* scene, wisp_vec3* place )
{
    place->x = (float)( (double)place->x - scene->origin[0] );
    place->y = (float)( (double)place->y - scene->origin[1] );
    place->z = (float)( (double)place->z - scene->origin[2] );
}

static void move_pins( const wisp_scene* scene, wisp_scene_pins* pins )
{
    for ( int i = 0; i < pins->box_count; ++i )
    {
        wisp_scene_box* box = (wisp_scene_box*)(uintptr_t)( pins->boxes + i ); // memory of the scene
        move( scene, &box->lower );
        move( scene, &box->upper );
    }
    for ( int i = 0; i < pins->nearest_count; ++i )
    {
        move( scene, (wisp_vec3*)(uintptr_t)( pins->nearest + i ) );
    }
    move( scene, &pins->pivot );
}

static void move_surface( const wisp_scene* scene, wisp_scene_surface* s )
{
    move( scene, &s->pose.translation );
    move_pins( scene, &s->pins );
    for ( int g = 0; g < s->pin_group_count; ++g )
    {
        move_pins( scene, &s->pin_groups[g] );
    }
    move( scene, &s->target_pivot );
    move( scene, &s->frame_pivot );
    move( scene, &s->outlet_nearest );
    if ( s->boundary.eye_angle > 0.0f )
    {
        move( scene, &s->boundary.eye );
    }
}

static void move_path( const wisp_scene* scene, const wisp_scene_path* path )
{
    for ( int i = 0; i < path->count; ++i )
    {
        move( scene, &( (wisp_scene_pose*)(uintptr_t)( path->poses + i ) )->pose.translation );
    }
}

// Is a groom made from another one, which is in its place?
static bool is_made_of_another( const wisp_scene_strands* s )
{
    return s->is_scattered || s->is_curves;
}

static void move_strands( const wisp_scene* scene, wisp_scene_strands* s )
{
    if ( is_made_of_another( s ) == false )
    {
        move( scene, &s->pose.translation );
    }
    move( scene, &s->head_pivot );
    move( scene, &s->frame_pivot );
    if ( s->has_cursor )
    {
        move( scene, &s->frozen_hair.cursor );
    }
    move_path( scene, &s->head );
}

// A plane is endless: it keeps its height above the new origin, and its point goes along. One that is moved is a body as others are.
static void move_collider( const wisp_scene* scene, wisp_scene_collider* c )
{
    wisp_vec3* p = &c->def.pose.translation;
    move( scene, p );
    move_path( scene, &c->path );
    if ( c->def.kind == WISP_COLLIDER_PLANE && c->path.count == 0 )
    {
        const wisp_vec3 n = wisp_quat_rotate( c->def.pose.rotation, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const double height = (double)n.x * (double)p->x + (double)n.y * (double)p->y + (double)n.z * (double)p->z;
        *p = ( wisp_vec3 ){ (float)( height * (double)n.x ), (float)( height * (double)n.y ),
                            (float)( height * (double)n.z ) };
    }
}

static const wisp_vec3* find_first_place( const wisp_scene* scene )
{
    if ( scene->surface_count > 0 )
    {
        return &scene->surfaces[0].pose.translation;
    }
    return scene->strands_count > 0 ? &scene->strands[0].pose.translation : NULL;
}

void scene_find_origin( wisp_scene* scene )
{
    const wisp_vec3* place = find_first_place( scene );
    if ( place != NULL )
    {
        scene->origin[0] = origin_near( place->x );
        scene->origin[1] = origin_near( place->y );
        scene->origin[2] = origin_near( place->z );
    }
    if ( scene->origin[0] == 0.0 && scene->origin[1] == 0.0 && scene->origin[2] == 0.0 )
    {
        return;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        move_surface( scene, &scene->surfaces[i] );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        move_strands( scene, &scene->strands[i] );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        move_collider( scene, &scene->colliders[i] );
    }
    for ( int i = 0; i < scene->command_count; ++i )
    {
        move( scene, &scene->commands[i].cursor );
    }
}
