/// Frozen hair on strands that a module of the test moves rigidly, as a head does.
#pragma once

#include "frozen_hair_engine_fixture.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

static wisp_component mover_pose;

static inline void move_rigidly( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_transform* pose = wisp_frame_column( frame, span->entity, mover_pose, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
    float* posed = wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 );
    const size_t first = (size_t)t->group_row[span->begin] * 48, end = (size_t)t->group_row[span->end] * 48;
    memcpy( posed + first, rest + first, ( end - first ) * sizeof( float ) );
    const wisp_teleport_motion motion = { .motion = *pose };
    wisp_teleport_lanes( &motion, posed + first, NULL, t->group_row[span->end] - t->group_row[span->begin] );
}

static inline wisp_status declare_mover( wisp_registry* r )
{
    static const wisp_column_def columns[] = { WISP_COLUMN_DEF( wisp_transform, pose, 1 ) };
    mover_pose = wisp_declare_component( r, &( wisp_component_def ){ "mover.pose", WISP_TABLE_ENTITY, columns, 1 } );
    return wisp_declare_pass( r, &( wisp_pass ){
                                     WISP_PASS( "mover.move", DERIVE, STRAND_GROUP, move_rigidly ),
                                     .required = { mover_pose },
                                     .reads = { mover_pose, WISP_STRAND_REST, WISP_STRAND_POSITION },
                                     .writes = { WISP_STRAND_POSED },
                                 } );
}

static inline void forget_message( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    (void)level;
    (void)message;
}

/// A world with hair whose posed shape is the rest shape moved rigidly.
static inline wisp_entity moved_hair( wisp_world** world, const hair_groom* groom, const wisp_frozen_hair_def* def,
                                      wisp_transform pose )
{
    static const wisp_module mover = { .name = "mover", .declare = declare_mover };
    static const wisp_module* const modules[] = { &mover, &wisp_frozen_hair_module };
    wisp_world_def world_def = wisp_default_world_def();
    world_def.substeps = 1;
    world_def.modules = modules;
    world_def.module_count = WISP_COUNT( modules );
    world_def.log = forget_message;
    assert_int_equal( wisp_world_create( &world_def, world, NULL ), WISP_OK );
    const wisp_entity hair = hair_add_frozen( *world, groom, def );
    assert_int_equal( wisp_world_attach( *world, hair, mover_pose ), WISP_OK );
    assert_int_equal( wisp_request( *world, hair, WISP_STRAND_POSED ), WISP_OK );
    *(wisp_transform*)wisp_world_column( *world, hair, mover_pose, 0 ) = pose;
    return hair;
}

static inline void set_pose( wisp_world* world, wisp_entity hair, wisp_transform pose )
{
    *(wisp_transform*)wisp_world_column( world, hair, mover_pose, 0 ) = pose;
}
