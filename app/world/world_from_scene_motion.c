// Moving strands of a scene, their ghosts, curves through them, and the heads that carry them.
#include "world_from_scene_parts.h"

#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

static wisp_status fail_here( const scene_world* world, int strands, wisp_status status, wisp_error* error )
{
    return status == WISP_OK
               ? WISP_OK
               : scene_fail_at_strands( world->scene, strands, status, wisp_world_message( world->world ), error );
}

static wisp_status set_collision( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_entity entity = world->entities[strands];
    wisp_status status =
        entry->has_collision ? wisp_set_collision( world->world, entity, &entry->collision ) : WISP_OK;
    if ( status == WISP_OK && entry->request_contacts )
    {
        status = wisp_request_collision_stats( world->world, entity, true );
    }
    return status;
}

// With masses that grow along strands, which are copied.
static wisp_status set_weighed( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_strand_dynamics_def def = entry->dynamics;
    float* masses = malloc( (size_t)world->grooms[strands].vertex_count * sizeof *masses + 1 );
    if ( !masses )
    {
        return wisp_world_fail( world->world, WISP_NO_MEMORY, "out of memory for masses" );
    }
    scene_strands_weigh( entry, &world->grooms[strands], masses );
    def.vertex_masses = masses;
    const wisp_status status = wisp_set_strand_dynamics( world->world, world->entities[strands], &def );
    free( masses );
    return status;
}

wisp_status scene_hold_tips( scene_world* world, int strands, wisp_strand_tip hold )
{
    const wisp_groom* groom = &world->grooms[strands];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < groom->strand_count && status == WISP_OK; ++i )
    {
        if ( groom->offsets[i + 1] - groom->offsets[i] > 1 ) // a root alone has no tip
        {
            status = wisp_hold_strand_tip( world->world, world->entities[strands], i, hold );
        }
    }
    return status;
}

wisp_vec3 scene_strand_frame_pivot( const wisp_scene_strands* entry )
{
    return entry->has_frame_pivot  ? entry->frame_pivot
           : entry->has_head_pivot ? entry->head_pivot
                                   : entry->pose.translation;
}

static wisp_status set_dynamics( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_entity entity = world->entities[strands];
    wisp_status status = entry->mass_ratio != 1.0f
                             ? set_weighed( world, strands )
                             : wisp_set_strand_dynamics( world->world, entity, &entry->dynamics );
    status = status == WISP_OK ? wisp_set_substeps( world->world, entity, entry->substeps ) : status;
    if ( status == WISP_OK && entry->has_grid )
    {
        status = wisp_set_strand_grid( world->world, entity, &entry->grid );
    }
    if ( status == WISP_OK && entry->has_frame )
    {
        wisp_moving_frame_def frame = entry->frame;
        frame.pose.translation = scene_strand_frame_pivot( entry );
        status = wisp_set_moving_frame( world->world, entity, &frame );
    }
    if ( status == WISP_OK && entry->max_speed < INFINITY )
    {
        status = wisp_set_max_speed( world->world, entity, entry->max_speed );
    }
    status = status == WISP_OK && entry->has_tips ? scene_hold_tips( world, strands, entry->tips_hold ) : status;
    status = status == WISP_OK ? set_collision( world, strands ) : status;
    if ( status == WISP_OK && entry->has_contact )
    {
        status = wisp_set_contact( world->world, entity, &entry->contact );
    }
    if ( status == WISP_OK && entry->has_sleep )
    {
        status = wisp_set_sleep( world->world, entity, &entry->sleep );
    }
    if ( status == WISP_OK && entry->on_surface >= 0 )
    {
        status = wisp_root_strands( world->world, entity, world->surfaces[entry->on_surface].entity );
    }
    return status;
}

// Frozen hair on ghosts starts from their moved positions, which are kept separate from its output.
static wisp_status set_ghosts( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_ghosts_def def = entry->ghosts;
    def.targets = world->entities[entry->targets];
    def.between = world->scene->frames_per_step > 1;
    wisp_status status = WISP_OK;
    if ( entry->has_frozen_hair )
    {
        status = wisp_request( world->world, world->entities[strands], WISP_STRAND_POSED );
    }
    status = status == WISP_OK ? wisp_set_ghosts( world->world, world->entities[strands], &def ) : status;
    return status == WISP_OK ? set_collision( world, strands ) : status;
}

static wisp_status add_curves( scene_world* world, int strands, wisp_error* error )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_status status =
        scene_groom_of( world->scene, strands, &world->grooms[entry->curves_of], &world->grooms[strands], error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_curves_def def = entry->curves;
    def.source = world->entities[entry->curves_of];
    status = wisp_add_curves( world->world, &def, &world->entities[strands] );
    status = status == WISP_OK ? scene_strands_dress( world, strands ) : status;
    return fail_here( world, strands, status, error );
}

// Ghosts need their targets, and curves need either.
wisp_status scene_motion_set( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        status = scene->strands[i].has_dynamics ? fail_here( world, i, set_dynamics( world, i ), error ) : WISP_OK;
    }
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        status = scene->strands[i].has_ghosts ? fail_here( world, i, set_ghosts( world, i ), error ) : WISP_OK;
    }
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        status = scene->strands[i].is_curves ? add_curves( world, i, error ) : WISP_OK;
    }
    // last, because ghosts and curves are placed by the rest shape of what they follow
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        if ( scene->strands[i].has_start && scene->strands[i].has_dynamics )
        {
            scene_strands_start( &scene->strands[i], world->world, world->entities[i], &world->grooms[i] );
        }
    }
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        const wisp_detail_def* detail = &scene->strands[i].detail;
        status = scene->strands[i].has_detail
                     ? fail_here( world, i, wisp_set_detail( world->world, world->entities[i], detail ), error )
                     : WISP_OK;
    }
    return status;
}

void scene_request_points( wisp_scene* scene )
{
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        scene->strands[i].request_points = true;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].request_points = true;
    }
}

void scene_request_statistics( wisp_scene* scene )
{
    scene_request_points( scene );
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        wisp_scene_strands* s = &scene->strands[i];
        s->request_motion_stats = s->has_dynamics;
        s->request_contacts = s->has_collision;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        wisp_scene_surface* s = &scene->surfaces[i];
        s->request_motion_stats = true;
        s->request_contacts = s->has_collision;
        s->request_stats = s->request_stats || s->has_implicit;
    }
}

void scene_request_intersections( wisp_scene* scene )
{
    scene->request_contact_stats = scene->request_intersections = true;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        wisp_scene_surface* s = &scene->surfaces[i];
        if ( !s->has_contact && !s->has_implicit )
        {
            s->has_contact = true;
            s->contact.self = false;
            s->contact.mask = 0;
        }
    }
}

bool scene_is_driven( const wisp_scene_surface* surface )
{
    return surface->has_animation &&
           !( surface->has_cloth || surface->has_balloon || surface->has_implicit || surface->has_membrane );
}

bool scene_has_contact( const wisp_scene* scene )
{
    bool any = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        any = any || scene->surfaces[i].has_contact;
    }
    return any;
}
