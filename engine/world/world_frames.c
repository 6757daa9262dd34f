// Moving frames and largest speeds of surfaces and strands: the calls of the host.
#include "world.h"

#include "wisp/module/components.h"
#include "wisp/moving_frame.h"

#include <math.h>

void wisp_init_moving_frame_def( wisp_moving_frame_def* def, size_t size )
{
    const wisp_moving_frame_def values = {
        .linear_inertia = 1.0f,
        .angular_inertia = 1.0f,
        .pose = { .rotation = { 0.0f, 0.0f, 0.0f, 1.0f } },
    };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

static wisp_status check_pose( wisp_world* world, wisp_transform pose )
{
    const wisp_vec3 p = pose.translation;
    const wisp_quat q = pose.rotation;
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if ( !( fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "moving frame: got position (%g, %g, %g), expected finite coordinates within 1e6 m of "
            "the origin",
            (double)p.x, (double)p.y, (double)p.z );
    }
    return squared >= 1e-12f && squared <= 1e12f
               ? WISP_OK
               : wisp_world_fail( world, WISP_BAD_INPUT,
                                  "moving frame: the quaternion (%g, %g, %g, %g) is not a rotation", (double)q.x,
                                  (double)q.y, (double)q.z, (double)q.w );
}

// Check that an entity is a surface, or strands that move.
static wisp_status check_framed_entity( wisp_world* world, wisp_entity entity )
{
    store_entity* e;
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    if ( wisp_world_strands( world, entity ) != NULL &&
         wisp_world_has( world, entity, WISP_STRAND_VELOCITY ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "entity %u: has strands that do not move: give them dynamics first", entity.index );
    }
    return wisp_world_strands( world, entity ) != NULL ? WISP_OK : world_find_surface( world, entity, &e );
}

static wisp_status check_frame( wisp_world* world, wisp_entity entity, const wisp_moving_frame_def* def )
{
    const wisp_number_range ranges[] = {
        { "linear_inertia", def->linear_inertia, 0.0f, 1.0f },
        { "angular_inertia", def->angular_inertia, 0.0f, 1.0f },
    };
    WISP_TRY( wisp_world_check_ranges( world, "moving frame", ranges, WISP_COUNT( ranges ) ) );
    WISP_TRY( check_pose( world, def->pose ) );
    return wisp_world_has( world, entity, WISP_PARTICLE_EXTERNAL_SOLVER )
               ? wisp_world_fail( world, WISP_CONFLICT,
                                  "moving frame: entity %u has an external solver, which has none", entity.index )
               : WISP_OK;
}

wisp_status wisp_set_moving_frame( wisp_world* world, wisp_entity entity, const wisp_moving_frame_def* given )
{
    wisp_moving_frame_def def = wisp_default_moving_frame_def();
    WISP_TRY( wisp_world_begin_def( world, "wisp_default_moving_frame_def", &def, given ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    WISP_TRY( check_frame( world, entity, &def ) );
    if ( def.linear_inertia == 1.0f && def.angular_inertia == 1.0f )
    {
        return wisp_world_detach( world, entity, WISP_PARTICLE_FRAME );
    }
    WISP_TRY( wisp_world_attach( world, entity, WISP_PARTICLE_FRAME ) );
    wisp_transform* pose = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 0 );
    float* felt = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 1 );
    pose[0] = pose[1] = pose[2] = wisp_pose_to_rows( def.pose, wisp_world_offset( world, entity ) );
    felt[0] = def.linear_inertia;
    felt[1] = def.angular_inertia;
    return WISP_OK;
}

wisp_status wisp_move_frame( wisp_world* world, wisp_entity entity, wisp_transform pose )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    WISP_TRY( check_pose( world, pose ) );
    wisp_transform* poses = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 0 );
    if ( poses != NULL )
    {
        poses[2] = wisp_pose_to_rows( pose, wisp_world_offset( world, entity ) );
    }
    return WISP_OK;
}

wisp_status wisp_set_max_speed( wisp_world* world, wisp_entity entity, float speed )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    if ( !( speed > 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "max_speed: got %g m/s, expected a number above 0",
                                (double)speed );
    }
    const bool is_limited = speed < INFINITY;
    WISP_TRY( is_limited ? wisp_world_attach( world, entity, WISP_PARTICLE_MAX_SPEED )
                         : wisp_world_detach( world, entity, WISP_PARTICLE_MAX_SPEED ) );
    if ( is_limited )
    {
        *(float*)wisp_world_column( world, entity, WISP_PARTICLE_MAX_SPEED, 0 ) = speed;
    }
    return WISP_OK;
}
