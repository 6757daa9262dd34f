// What moves in the course of a scene.
#include "scene_calls.h"
#include "world_from_scene_parts.h"

#include "gltf.h"
#include "skeleton.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

// ---- clips of keyframes ----

// Surfaces that clips of keyframes move: where the vertices of their mesh are at a time.

struct scene_animation
{
    wisp_rig rig;
    wisp_skin_pose pose;
    gltf_model model; // whose morph targets the vertices follow; empty: the rig moves them
    gltf_moment moment;
    int node;
    double* work;
    wisp_affine* joints;
    wisp_vec3* points; // [skin->point_count] m, in the world
};

void scene_animation_release( scene_animation* animation )
{
    if ( animation != NULL )
    {
        wisp_skin_pose_release( &animation->pose, NULL );
        wisp_rig_release( &animation->rig );
        gltf_release( &animation->model );
    }
}

static int count_of( const scene_animation* animation )
{
    return animation->model.meshes[animation->model.nodes[animation->node].mesh].mesh.vertex_count;
}

static wisp_status turn_joints( const wisp_scene_surface* entry, scene_animation* animation, double time,
                                wisp_error* error )
{
    wisp_skeleton_pose( &animation->rig.skeleton, &animation->rig.animation, (float)time, animation->joints );
    return wisp_skin_points( animation->rig.skin, &animation->pose, entry->animation.method, animation->joints,
                             animation->points, error );
}

// Before the clip and after it its first and its last pose stay.
static wisp_status morph( const wisp_scene_surface* entry, scene_animation* animation, double time,
                          wisp_error* error )
{
    const wisp_scene_clip* clip = &entry->animation.clips[0];
    animation->moment.time = fmax( time - (double)clip->time, 0.0 ) * (double)clip->speed;
    gltf_points_at( &animation->model, animation->node, animation->moment, animation->work, animation->points );
    for ( int v = 0; v < count_of( animation ); ++v )
    {
        const wisp_vec3 p = animation->points[v];
        if ( !( isfinite( p.x ) && isfinite( p.y ) && isfinite( p.z ) ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "animation: vertex %d is not finite at %g s", v, time );
        }
    }
    return WISP_OK;
}

// Where the vertices are. @param time s @param points receives [vertex_count] m, valid until the next call
static wisp_status pose_clips( const wisp_scene* scene, int surface, scene_animation* animation, double time,
                               const wisp_vec3** points, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const float scale = scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface].mesh.scale;
    const bool is_morphed = animation->work != NULL;
    const wisp_status status =
        is_morphed ? morph( entry, animation, time, error ) : turn_joints( entry, animation, time, error );
    const int count = is_morphed ? count_of( animation ) : animation->rig.skin->point_count;
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        const wisp_vec3 p = animation->points[v];
        animation->points[v] =
            wisp_transform_to_world( entry->pose, ( wisp_vec3 ){ scale * p.x, scale * p.y, scale * p.z } );
    }
    *points = animation->points;
    return status;
}

// Whether a file has morph targets that a clip moves, and no skin, which a rig would move.
static bool has_morphs( const char* path, const wisp_scene_clip* clip, scene_animation* out )
{
    bool has = false;
    if ( gltf_model_read( path, &out->model, &out->node, NULL ) == WISP_OK )
    {
        const gltf_node* node = &out->model.nodes[out->node];
        out->moment = ( gltf_moment ){ gltf_find_animation( &out->model, clip->name ), 0.0, -1 };
        const gltf_animation* a = out->moment.animation >= 0 ? &out->model.animations[out->moment.animation] : NULL;
        for ( int w = 0; a != NULL && node->skin < 0 && w < a->weights_count; ++w )
        {
            has = has || a->weights[w].node == out->node;
        }
    }
    if ( !has )
    {
        gltf_release( &out->model );
    }
    return has;
}

static wisp_status load_morphs( const wisp_scene_animation* entry, const char* path, int vertex_count,
                                io_memory* memory, scene_animation* out, wisp_error* error )
{
    if ( entry->clip_count > 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: got %d clips, expected one of a mesh with morph targets",
                          entry->clip_count );
    }
    if ( count_of( out ) != vertex_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: %.200s: got %d vertices, expected %d as the mesh has",
                          path, count_of( out ), vertex_count );
    }
    out->work = io_get( memory, gltf_points_work( &out->model, out->node ) * sizeof *out->work );
    out->points = io_get( memory, (size_t)vertex_count * sizeof *out->points );
    return !memory->is_short
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d vertices", vertex_count );
}

static wisp_status load( const wisp_scene* scene, int surface, int vertex_count, io_memory* memory,
                         scene_animation* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const wisp_scene_surface* source = &scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface];
    const char* path = entry->animation.file != NULL ? entry->animation.file
                       : source->mesh.arrays == NULL ? source->mesh.file
                                                     : NULL;
    if ( path != NULL && gltf_is_path( path ) && has_morphs( path, &entry->animation.clips[0], out ) )
    {
        return load_morphs( &entry->animation, path, vertex_count, memory, out, error );
    }
    WISP_TRY( wisp_rig_load( &source->mesh, &entry->animation, (float)scene->steps * scene->dt, &out->rig, error ) );
    if ( out->rig.skin->point_count != vertex_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "animation: the skeleton moves %d vertices, but repair left %d of them: use a repair that "
                          "removes none",
                          out->rig.skin->point_count, vertex_count );
    }
    out->joints = io_get( memory, (size_t)out->rig.skeleton.joint_count * sizeof *out->joints );
    out->points = io_get( memory, (size_t)vertex_count * sizeof *out->points );
    return !memory->is_short
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d vertices", vertex_count );
}

wisp_status scene_animation_load( const wisp_scene* scene, int surface, scene_world_surface* s, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    if ( !entry->has_animation )
    {
        return WISP_OK;
    }
    wisp_error cause = { 0 };
    const wisp_vec3* points = NULL;
    s->animation = io_get( &s->memory, sizeof *s->animation );
    wisp_status status = s->animation != NULL
                             ? load( scene, surface, s->mesh.vertex_count, &s->memory, s->animation, &cause )
                             : wisp_fail( &cause, WISP_NO_MEMORY, "out of memory for an animation" );
    status = status == WISP_OK ? pose_clips( scene, surface, s->animation, 0.0, &points, &cause ) : status;
    for ( int v = 0; v < s->mesh.vertex_count && status == WISP_OK; ++v )
    {
        s->mesh.points[v] = points[v];
    }
    return status == WISP_OK ? WISP_OK
                             : scene_fail_at( scene, entry->line, entry->column, "surface", entry->name, status,
                                              cause.message, error );
}

// ---- surfaces that are held ----

// Surfaces that are held near targets, in a moving frame, or limited in speed.

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
        s->motion_targets = io_get( &s->memory, (size_t)s->mesh.vertex_count * sizeof *s->motion_targets );
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
    wisp_world* w = world->world;
    WISP_TRY( entry->has_motion_constraints ? set_motion_constraints( world, entry, s ) : WISP_OK );
    if ( entry->has_frame )
    {
        wisp_moving_frame_def frame = entry->frame;
        s->frame_pivot = entry->has_frame_pivot ? entry->frame_pivot : centre_of( &s->mesh );
        frame.pose.translation = s->frame_pivot;
        WISP_TRY( wisp_set_moving_frame( w, s->entity, &frame ) );
    }
    WISP_TRY( entry->max_speed < INFINITY ? wisp_set_max_speed( w, s->entity, entry->max_speed ) : WISP_OK );
    WISP_TRY( entry->has_sleep ? wisp_set_sleep( w, s->entity, &entry->sleep ) : WISP_OK );
    return entry->has_detail ? wisp_set_detail( w, s->entity, &entry->detail ) : WISP_OK;
}

// Move motion targets and frame of a surface to displacements from where they started.
// @param points [vertex_count] m, targets before the displacement
static wisp_status move_targets( scene_world* world, int surface, const wisp_vec3* points,
                                 wisp_transform displacement )
{
    const scene_world_surface* s = &world->surfaces[surface];
    for ( int v = 0; v < s->mesh.vertex_count; ++v )
    {
        s->motion_targets[v] = displaced( displacement, s->target_pivot, points[v] );
    }
    scene_call_begin( world, "wisp_move_motion_targets", s->entity );
    scene_call_points( world, s->motion_targets, s->mesh.vertex_count );
    scene_call_end( world, ", NULL" );
    return wisp_move_motion_targets( world->world, s->entity, s->motion_targets, NULL );
}

static wisp_status move_frame( scene_world* world, int surface, wisp_transform displacement )
{
    const scene_world_surface* s = &world->surfaces[surface];
    const wisp_vec3 to = displaced( displacement, s->frame_pivot, s->frame_pivot );
    return SCENE_CALL( world, wisp_move_frame, s->entity, wisp_transform_make( displacement.rotation, to ) );
}

// ---- events ----

// What happens to surfaces, colliders and strands before a step: keyframes, then the script's entries.

/// A step of simulated time, s, and when the step before it began.
typedef struct step_times
{
    double last, begin, end;
} step_times;

static step_times next_times( const scene_world* world )
{
    const int step = world->next_step;
    return ( step_times ){ step > 0 ? wisp_scene_step_time( world->scene, step - 1 ) : -INFINITY,
                           wisp_scene_step_time( world->scene, step ),
                           wisp_scene_step_time( world->scene, step + 1 ) };
}

// Keyframes are in decimals and steps may be 1/60 s: within a thousandth of a step two times are the same.
static bool is_before( const scene_world* world, double a, double b )
{
    return a < b - 1e-3 * (double)world->scene->dt;
}

// ---- poses ----

// Number of keyframes that are not after the time. Searched by halves: a hostile path has a million of them.
static int count_reached( const wisp_scene_path* path, double time )
{
    int lower = 0, upper = path->count;
    while ( lower < upper )
    {
        int middle = lower + ( upper - lower ) / 2;
        if ( (double)path->poses[middle].time <= time )
        {
            lower = middle + 1;
        }
        else
        {
            upper = middle;
        }
    }
    return lower;
}

static wisp_transform pose_before( const wisp_scene_path* path, int next, wisp_transform start )
{
    return next > 0 ? path->poses[next - 1].pose : start;
}

// Before the first keyframe the pose comes from the start at time 0; after the last one it stays. Until a step begins at the
// time of a jump or after it, the pose before it stays too.
static wisp_transform pose_at_end( const scene_world* world, const wisp_scene_path* path, wisp_transform start,
                                   step_times t )
{
    const int reached = count_reached( path, t.end );
    for ( int i = count_reached( path, t.begin ); i < path->count && i <= reached; ++i )
    {
        if ( path->poses[i].jump && is_before( world, t.begin, (double)path->poses[i].time ) )
        {
            return pose_before( path, i, start );
        }
    }
    if ( reached == path->count )
    {
        return reached > 0 ? path->poses[reached - 1].pose : start;
    }
    const wisp_scene_pose* next = &path->poses[reached];
    const double from = reached > 0 ? (double)path->poses[reached - 1].time : 0.0;
    const double fraction = ( t.end - from ) / ( (double)next->time - from );
    return wisp_transform_interpolate( pose_before( path, reached, start ), next->pose, (float)fraction );
}

static bool is_moving( const scene_world* world, const wisp_scene_path* path, step_times t )
{
    const wisp_scene_pose* last = path->count > 0 ? &path->poses[path->count - 1] : NULL;
    // A jump is made by the step after it.
    return last != NULL && is_before( world, last->jump ? t.last : t.begin, (double)last->time );
}

// ---- jumps ----

// The motion of the world that takes one pose about a pivot to another.
static wisp_transform motion_between( wisp_transform from, wisp_transform to, wisp_vec3 pivot )
{
    const wisp_quat back = { -from.rotation.x, -from.rotation.y, -from.rotation.z, from.rotation.w };
    wisp_transform motion =
        wisp_transform_make( wisp_quat_multiply( to.rotation, back ), ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const wisp_vec3 a = from.translation, b = to.translation;
    const wisp_vec3 turned =
        wisp_quat_rotate( motion.rotation, ( wisp_vec3 ){ a.x + pivot.x, a.y + pivot.y, a.z + pivot.z } );
    motion.translation =
        ( wisp_vec3 ){ b.x + pivot.x - turned.x, b.y + pivot.y - turned.y, b.z + pivot.z - turned.z };
    return motion;
}

// Does a keyframe jump between the beginnings of the last step and of this one?
static bool is_jump_due( const scene_world* world, const wisp_scene_pose* pose, step_times t )
{
    return pose->jump && !is_before( world, t.begin, (double)pose->time ) &&
           is_before( world, t.last, (double)pose->time );
}

// Teleport an entity by the jumps of its path that come before this step.
static wisp_status make_jumps( scene_world* world, wisp_entity entity, const wisp_scene_path* path,
                               wisp_transform start, wisp_vec3 pivot, step_times t )
{
    wisp_status status = WISP_OK;
    for ( int i = count_reached( path, t.last - (double)world->scene->dt ); i < path->count && status == WISP_OK;
          ++i )
    {
        if ( is_jump_due( world, &path->poses[i], t ) )
        {
            const wisp_transform motion = motion_between( pose_before( path, i, start ), path->poses[i].pose, pivot );
            status = SCENE_CALL_2( world, wisp_teleport, entity, motion, (bool)true );
        }
    }
    return status;
}

static const wisp_vec3 ORIGIN = { 0.0f, 0.0f, 0.0f };
static const wisp_transform still = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };

// @param points [vertex_count] m, before the displacement; null: the group's starts
static wisp_vec3 target_of( const scene_world_pins* pins, int i, const wisp_vec3* points,
                            wisp_transform displacement )
{
    const wisp_vec3 p = points != NULL ? points[pins->vertices[i]] : pins->starts[i], o = pins->pivot;
    const wisp_vec3 to = wisp_transform_to_world( displacement, ( wisp_vec3 ){ p.x - o.x, p.y - o.y, p.z - o.z } );
    return ( wisp_vec3 ){ to.x + o.x, to.y + o.y, to.z + o.z };
}

// @param points [vertex_count] m, before the displacement; null: the group's starts
static wisp_status move_group( scene_world* world, int surface, int group, const wisp_vec3* points, step_times t )
{
    scene_world_surface* s = &world->surfaces[surface];
    const scene_world_pins* pins = &s->groups[group];
    const wisp_scene_path* path = &scene_pins_entry( &world->scene->surfaces[surface], group )->path;
    if ( !pins->is_held || pins->count == 0 || !( points != NULL || is_moving( world, path, t ) ) )
    {
        return WISP_OK;
    }
    const wisp_transform pose = pose_at_end( world, path, still, t );
    for ( int i = 0; i < pins->count; ++i )
    {
        pins->targets[i] = target_of( pins, i, points, pose );
    }
    return SCENE_CALL_POINTS( world, wisp_move_pins, s->entity, pins->vertices, pins->targets, pins->count );
}

static wisp_status follow_collider( scene_world* world, int collider, step_times t )
{
    const wisp_scene_collider* entry = &world->scene->colliders[collider];
    scene_world_collider* c = &world->colliders[collider];
    const wisp_status status = make_jumps( world, c->entity, &entry->path, entry->def.pose, ORIGIN, t );
    if ( status != WISP_OK || !is_moving( world, &entry->path, t ) )
    {
        return status;
    }
    c->pose = pose_at_end( world, &entry->path, entry->def.pose, t );
    return SCENE_CALL( world, wisp_move_collider, c->entity, c->pose );
}

// ---- filling ----

// From the first keyframe's time to that of the last the filling is told; before and after, the gas is left to itself.
static bool is_filling( const scene_world* world, const wisp_scene_surface* entry, step_times t )
{
    return entry->gas_ratio_keyframe_count > 0 &&
           !is_before( world, t.end, (double)entry->gas_ratio_keyframes[0].time ) &&
           is_before( world, t.begin, (double)entry->gas_ratio_keyframes[entry->gas_ratio_keyframe_count - 1].time );
}

static float fill_at( const wisp_scene_surface* entry, double time )
{
    int lower = 0, upper = entry->gas_ratio_keyframe_count - 1; // the pair around the time is low and high in the end
    if ( time <= (double)entry->gas_ratio_keyframes[0].time )
    {
        return entry->gas_ratio_keyframes[0].gas_ratio;
    }
    if ( time >= (double)entry->gas_ratio_keyframes[upper].time )
    {
        return entry->gas_ratio_keyframes[upper].gas_ratio;
    }
    while ( upper - lower > 1 )
    {
        int middle = lower + ( upper - lower ) / 2;
        lower = (double)entry->gas_ratio_keyframes[middle].time <= time ? middle : lower;
        upper = lower == middle ? upper : middle;
    }
    const wisp_scene_gas_ratio_keyframe *a = &entry->gas_ratio_keyframes[lower],
                                        *b = &entry->gas_ratio_keyframes[upper];
    double fraction = ( time - (double)a->time ) / ( (double)b->time - (double)a->time );
    return (float)( (double)a->gas_ratio + fraction * ( (double)b->gas_ratio - (double)a->gas_ratio ) );
}

// ---- keyframes ----

static wisp_status follow_surface( scene_world* world, int surface, step_times t, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    scene_world_surface* s = &world->surfaces[surface];
    wisp_status status = WISP_OK;
    if ( is_filling( world, entry, t ) )
    {
        status = SCENE_CALL( world, wisp_set_balloon_gas_ratio, s->entity, fill_at( entry, t.end ) );
    }
    if ( status == WISP_OK && s->groups[0].is_held )
    {
        status = make_jumps( world, s->entity, &entry->pins.path, still, s->groups[0].pivot, t );
    }
    const wisp_vec3* points = s->mesh.points;
    wisp_error cause = { 0 };
    if ( status == WISP_OK && s->animation != NULL &&
         pose_clips( world->scene, surface, s->animation, t.end, &points, &cause ) != WISP_OK )
    {
        status = wisp_world_fail( world->world, cause.status, "%s", cause.message );
    }
    const bool is_animated = s->animation != NULL;
    for ( int g = 0; g < s->group_count && status == WISP_OK; ++g )
    {
        status = move_group( world, surface, g, is_animated ? points : NULL, t );
    }
    if ( status == WISP_OK && entry->has_motion_constraints &&
         ( is_animated || is_moving( world, &entry->target_path, t ) ) )
    {
        status = move_targets( world, surface, points, pose_at_end( world, &entry->target_path, still, t ) );
    }
    if ( status == WISP_OK && is_moving( world, &entry->frame_path, t ) )
    {
        status = move_frame( world, surface, pose_at_end( world, &entry->frame_path, still, t ) );
    }
    return status == WISP_OK ? WISP_OK : scene_fail_at_line( world, entry->line, entry->column, status, error );
}

// A head is a body that starts at its pivot, not turned. Its path tells where the pivot is; the engine wants to know what
// becomes of the origin.
static wisp_status follow_head( scene_world* world, int strands, step_times t )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_vec3 pivot = entry->has_head_pivot ? entry->head_pivot : entry->pose.translation;
    const wisp_transform start = { { 0.0f, 0.0f, 0.0f, 1.0f }, pivot };
    const wisp_status status = make_jumps( world, world->entities[strands], &entry->head, start, ORIGIN, t );
    if ( status != WISP_OK || !is_moving( world, &entry->head, t ) )
    {
        return status;
    }
    wisp_transform pose = pose_at_end( world, &entry->head, start, t );
    if ( entry->has_frame && entry->frame_path.count == 0 )
    {
        const wisp_vec3 from = scene_strand_frame_pivot( entry );
        const wisp_vec3 arm = { from.x - pivot.x, from.y - pivot.y, from.z - pivot.z };
        const wisp_transform frame = wisp_transform_make( pose.rotation, wisp_transform_to_world( pose, arm ) );
        const wisp_status moved = SCENE_CALL( world, wisp_move_frame, world->entities[strands], frame );
        if ( moved != WISP_OK )
        {
            return moved;
        }
    }
    const wisp_vec3 turned = wisp_quat_rotate( pose.rotation, pivot );
    pose.translation =
        ( wisp_vec3 ){ pose.translation.x - turned.x, pose.translation.y - turned.y, pose.translation.z - turned.z };
    return SCENE_CALL( world, wisp_move_strand_head, world->entities[strands], pose );
}

// Tips follow their path until they are released.
static wisp_status follow_tips( scene_world* world, int strands, step_times t )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_groom* groom = &world->grooms[strands];
    wisp_status status = WISP_OK;
    if ( !is_before( world, t.begin, (double)entry->tips_release ) )
    {
        return scene_hold_tips( world, strands, WISP_STRAND_TIP_FREE );
    }
    if ( !is_moving( world, &entry->tips_path, t ) )
    {
        return WISP_OK;
    }
    const wisp_transform pose = pose_at_end( world, &entry->tips_path, still, t );
    for ( int i = 0; i < groom->strand_count && status == WISP_OK; ++i )
    {
        if ( groom->offsets[i + 1] - groom->offsets[i] > 1 )
        {
            status = SCENE_CALL_2( world, wisp_move_strand_tip, world->entities[strands], i, pose );
        }
    }
    return status;
}

// A frame with a path of its own; one without goes with the head.
static wisp_status follow_frame( scene_world* world, int strands, step_times t )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    if ( !is_moving( world, &entry->frame_path, t ) )
    {
        return WISP_OK;
    }
    const wisp_transform way = pose_at_end( world, &entry->frame_path, still, t );
    const wisp_vec3 from = scene_strand_frame_pivot( entry );
    const wisp_vec3 to = { from.x + way.translation.x, from.y + way.translation.y, from.z + way.translation.z };
    return SCENE_CALL( world, wisp_move_frame, world->entities[strands], wisp_transform_make( way.rotation, to ) );
}

static wisp_status follow_heads( scene_world* world, step_times t, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        const wisp_scene_strands* entry = &scene->strands[i];
        status = follow_head( world, i, t );
        status = status == WISP_OK && entry->has_frame ? follow_frame( world, i, t ) : status;
        status = status == WISP_OK && entry->has_tips && entry->tips_hold != WISP_STRAND_TIP_FREE
                     ? follow_tips( world, i, t )
                     : status;
        status = status == WISP_OK ? WISP_OK : scene_fail_at_line( world, entry->line, entry->column, status, error );
    }
    return status;
}

static wisp_status follow_keyframes( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    const step_times t = next_times( world );
    wisp_status status = follow_heads( world, t, error );
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        status = follow_surface( world, i, t, error );
    }
    for ( int i = 0; i < scene->collider_count && status == WISP_OK; ++i )
    {
        const wisp_scene_collider* entry = &scene->colliders[i];
        status = follow_collider( world, i, t );
        status = status == WISP_OK ? WISP_OK : scene_fail_at_line( world, entry->line, entry->column, status, error );
    }
    return status;
}

// ---- the script ----

static wisp_status play_gas( scene_world* world, const wisp_scene_event* e )
{
    wisp_entity entity = world->surfaces[e->surface].entity;
    WISP_TRY( e->has_gas_ratio ? SCENE_CALL( world, wisp_set_balloon_gas_ratio, entity, e->gas_ratio ) : WISP_OK );
    WISP_TRY( e->has_inflation_rate ? SCENE_CALL( world, wisp_set_balloon_inflation, entity, e->inflation_rate )
                                    : WISP_OK );
    return e->has_open ? SCENE_CALL( world, wisp_open_balloon, entity, e->open ) : WISP_OK;
}

// BDF2 looks back on the substep before: it starts again with another velocity.
static bool looks_back( const wisp_scene_surface* entry )
{
    return entry->has_implicit && entry->implicit.integrator == WISP_INTEGRATOR_BDF2;
}

// A gust comes on top of a velocity that is set.
static wisp_status play_velocity( scene_world* world, const wisp_scene_event* e )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[e->surface];
    wisp_entity entity = world->surfaces[e->surface].entity;
    wisp_status status = WISP_OK;
    if ( e->has_velocity || e->has_angular_velocity )
    {
        status = SCENE_CALL_2( world, wisp_set_velocity, entity, e->velocity, e->angular_velocity );
    }
    if ( status == WISP_OK && e->has_gust )
    {
        status = SCENE_CALL_2( world, wisp_apply_gust, entity, e->gust, e->gust_per_triangle );
    }
    return status == WISP_OK && looks_back( entry ) ? scene_implicit_set( world, e->surface ) : status;
}

// Held again, pins are moved from where they are, as if they had started where the keyframes have brought them here from.
static wisp_status hold_group( scene_world* world, int surface, int group )
{
    scene_world_surface* s = &world->surfaces[surface];
    scene_world_pins* pins = &s->groups[group];
    const step_times t = next_times( world );
    const step_times now = { t.last, t.begin, t.begin };
    const wisp_transform pose =
        pose_at_end( world, &scene_pins_entry( &world->scene->surfaces[surface], group )->path, still, now );
    const float* x = wisp_world_column( world->world, s->entity, WISP_PARTICLE_POSITION, 0 );
    const wisp_vec3 offset = wisp_world_offset( world->world, s->entity );
    const wisp_status status = SCENE_CALL_VERTICES( world, wisp_pin, s->entity, pins->vertices, pins->count );
    for ( int i = 0; i < pins->count && pins->starts != NULL && status == WISP_OK; ++i )
    {
        const float* p = x + (size_t)s->fabric->vertex_slot[pins->vertices[i]] * 4;
        const wisp_vec3 o = pins->pivot, d = pose.translation;
        const wisp_quat back = { -pose.rotation.x, -pose.rotation.y, -pose.rotation.z, pose.rotation.w };
        const wisp_vec3 start =
            wisp_quat_rotate( back, ( wisp_vec3 ){ p[0] - offset.x - o.x - d.x, p[1] - offset.y - o.y - d.y,
                                                   p[2] - offset.z - o.z - d.z } );
        pins->starts[i] = ( wisp_vec3 ){ start.x + o.x, start.y + o.y, start.z + o.z };
    }
    pins->is_held = true;
    return status == WISP_OK ? move_group( world, surface, group, NULL, t ) : status;
}

// Vertices that were let go go on with the velocity that they were moved with in the last step. None comes of a jump.
static wisp_status pass_velocities( scene_world* world, int surface, int group )
{
    scene_world_surface* s = &world->surfaces[surface];
    scene_world_pins* pins = &s->groups[group];
    const wisp_scene_path* path = &scene_pins_entry( &world->scene->surfaces[surface], group )->path;
    const step_times t = next_times( world );
    const float rate = 1.0f / (float)( t.begin - t.last );
    for ( int i = count_reached( path, t.last - (double)world->scene->dt ); i < path->count; ++i )
    {
        if ( is_jump_due( world, &path->poses[i], t ) )
        {
            return WISP_OK;
        }
    }
    wisp_vec3* places = pins->targets; // before the last step, then velocities
    for ( int now = 0; now < 2; ++now )
    {
        const double time = now ? t.begin : t.last;
        const wisp_transform pose = pose_at_end( world, path, still, ( step_times ){ t.last, t.begin, time } );
        const wisp_vec3* points = NULL;
        wisp_error cause = { 0 };
        if ( s->animation != NULL &&
             pose_clips( world->scene, surface, s->animation, time, &points, &cause ) != WISP_OK )
        {
            return wisp_world_fail( world->world, cause.status, "%s", cause.message );
        }
        for ( int i = 0; i < pins->count; ++i )
        {
            const wisp_vec3 p = target_of( pins, i, points, pose ), d = places[i];
            places[i] = now ? ( wisp_vec3 ){ rate * ( p.x - d.x ), rate * ( p.y - d.y ), rate * ( p.z - d.z ) } : p;
        }
    }
    const wisp_status status =
        SCENE_CALL_POINTS( world, wisp_set_vertex_velocities, s->entity, pins->vertices, places, pins->count );
    return status == WISP_OK && looks_back( &world->scene->surfaces[surface] ) ? scene_implicit_set( world, surface )
                                                                               : status;
}

static wisp_status play_pins( scene_world* world, const wisp_scene_event* e, int group )
{
    scene_world_surface* s = &world->surfaces[e->surface];
    scene_world_pins* pins = &s->groups[group];
    if ( e->release )
    {
        const bool moves = pins->is_held && pins->targets != NULL && world->next_step > 0;
        const wisp_status status = SCENE_CALL_VERTICES( world, wisp_unpin, s->entity, pins->vertices, pins->count );
        pins->is_held = false;
        return status == WISP_OK && moves ? pass_velocities( world, e->surface, group ) : status;
    }
    if ( e->attach_to >= 0 )
    {
        pins->is_held = true;
        return scene_attach_pins( world, e->surface, group, e->attach_to );
    }
    if ( e->detach )
    {
        return SCENE_CALL_VERTICES( world, wisp_detach_pins, s->entity, pins->vertices, pins->count );
    }
    return e->hold && !pins->is_held ? hold_group( world, e->surface, group ) : WISP_OK;
}

static wisp_status play_detail( scene_world* world, const wisp_scene_event* e )
{
    const bool is_strands = e->strands >= 0;
    wisp_detail_def def =
        is_strands ? world->scene->strands[e->strands].detail : world->scene->surfaces[e->surface].detail;
    def.level = e->detail;
    return wisp_set_detail( world->world,
                            is_strands ? world->entities[e->strands] : world->surfaces[e->surface].entity, &def );
}

// Pins are let go first, so that a velocity reaches them too.
static wisp_status play( scene_world* world, const wisp_scene_event* e )
{
    WISP_TRY( e->has_detail ? play_detail( world, e ) : WISP_OK );
    if ( e->strands >= 0 )
    {
        return e->has_wind ? SCENE_CALL( world, wisp_set_strand_wind, world->entities[e->strands], e->wind )
                           : WISP_OK;
    }
    scene_world_surface* s = &world->surfaces[e->surface];
    WISP_TRY( play_gas( world, e ) );
    for ( int g = 0; g < s->group_count; ++g )
    {
        const bool is_meant = e->pin_group < 0 || e->pin_group + 1 == g;
        WISP_TRY( is_meant && s->groups[g].count > 0 ? play_pins( world, e, g ) : WISP_OK );
    }
    WISP_TRY( e->has_wind ? SCENE_CALL( world, wisp_set_cloth_wind, s->entity, e->wind ) : WISP_OK );
    if ( e->has_teleport )
    {
        const wisp_transform motion = { still.rotation, e->teleport };
        WISP_TRY( SCENE_CALL_2( world, wisp_teleport, s->entity, motion, (bool)true ) );
    }
    return e->has_velocity || e->has_angular_velocity || e->has_gust ? play_velocity( world, e ) : WISP_OK;
}

wisp_status scene_events_play( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = follow_keyframes( world, error );
    while ( status == WISP_OK && world->next_event < scene->event_count &&
            scene->events[world->next_event].step <= world->next_step )
    {
        const wisp_scene_event* event = &scene->events[world->next_event++];
        status = play( world, event );
        status = status == WISP_OK ? WISP_OK : scene_fail_at_line( world, event->line, event->column, status, error );
    }
    return status;
}
