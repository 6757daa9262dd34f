// Surfaces that are held near targets, in a moving frame, or limited in speed.
#include "world_from_scene_parts.h"

#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

static wisp_vec3 centre_of( const wisp_mesh* mesh )
{
    double sum[3] = { 0 };
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        sum[0] += (double)mesh->points[v].x;
        sum[1] += (double)mesh->points[v].y;
        sum[2] += (double)mesh->points[v].z;
    }
    const double fraction = 1.0 / (double)( mesh->vertex_count > 0 ? mesh->vertex_count : 1 );
    return ( wisp_vec3 ){ (float)( sum[0] * fraction ), (float)( sum[1] * fraction ), (float)( sum[2] * fraction ) };
}

// Where a displacement about a pivot takes a point.
static wisp_vec3 displaced( wisp_transform displacement, wisp_vec3 pivot, wisp_vec3 p )
{
    const wisp_vec3 arm = { p.x - pivot.x, p.y - pivot.y, p.z - pivot.z };
    const wisp_vec3 to = wisp_transform_to_world( displacement, arm );
    return ( wisp_vec3 ){ to.x + pivot.x, to.y + pivot.y, to.z + pivot.z };
}

static wisp_status set_motion_constraints( scene_world* world, const wisp_scene_surface* entry,
                                           scene_world_surface* s )
{
    s->target_pivot = entry->has_target_pivot ? entry->target_pivot : centre_of( &s->mesh );
    if ( entry->target_path.count > 0 || entry->has_animation )
    {
        s->motion_targets = malloc( (size_t)s->mesh.vertex_count * sizeof *s->motion_targets + 1 );
        if ( !s->motion_targets )
        {
            return wisp_world_fail( world->world, WISP_NO_MEMORY, "out of memory for %d motion targets",
                                    s->mesh.vertex_count );
        }
    }
    return wisp_set_motion_constraints( world->world, s->entity, &entry->motion_constraints );
}

wisp_status scene_held_set( scene_world* world, int surface )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    scene_world_surface* s = &world->surfaces[surface];
    wisp_status status = entry->has_motion_constraints ? set_motion_constraints( world, entry, s ) : WISP_OK;
    if ( status == WISP_OK && entry->has_frame )
    {
        wisp_moving_frame_def frame = entry->frame;
        s->frame_pivot = entry->has_frame_pivot ? entry->frame_pivot : centre_of( &s->mesh );
        frame.pose.translation = s->frame_pivot;
        status = wisp_set_moving_frame( world->world, s->entity, &frame );
    }
    if ( status == WISP_OK && entry->max_speed < INFINITY )
    {
        status = wisp_set_max_speed( world->world, s->entity, entry->max_speed );
    }
    status =
        status == WISP_OK && entry->has_sleep ? wisp_set_sleep( world->world, s->entity, &entry->sleep ) : status;
    return status == WISP_OK && entry->has_detail ? wisp_set_detail( world->world, s->entity, &entry->detail )
                                                  : status;
}

wisp_status scene_targets_move( scene_world* world, int surface, const wisp_vec3* points,
                                wisp_transform displacement )
{
    const scene_world_surface* s = &world->surfaces[surface];
    for ( int v = 0; v < s->mesh.vertex_count; ++v )
    {
        s->motion_targets[v] = displaced( displacement, s->target_pivot, points[v] );
    }
    return wisp_move_motion_targets( world->world, s->entity, s->motion_targets, NULL );
}

wisp_status scene_frame_move( scene_world* world, int surface, wisp_transform displacement )
{
    const scene_world_surface* s = &world->surfaces[surface];
    const wisp_vec3 to = displaced( displacement, s->frame_pivot, s->frame_pivot );
    return wisp_move_frame( world->world, s->entity, wisp_transform_make( displacement.rotation, to ) );
}
