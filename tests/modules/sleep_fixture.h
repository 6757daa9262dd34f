/// Shared by the tests of sleep: a stage with a floor, sheets, balls, and a sheet that sleeps.
#pragma once

#include "contact_fixture.h"

#include "attachments.h"
#include "wisp/sleep.h"

static const wisp_vec3 NONE = { 0.0f, 0.0f, 0.0f };

enum
{
    SIDE = 12, // vertices along a side of a sheet
    PATIENCE = 400,
};

static inline void open_stage( hosted* h, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_attachments_module, &wisp_balloon_module,
                                                  &wisp_cloth_module,       &wisp_implicit_cloth_module,
                                                  &wisp_strands_module,     &wisp_collision_module,
                                                  &wisp_contact_module };
    OPEN( h, MODULES, .substeps = 4, .workers = workers );
    add_floor( h->world, NONE, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
}

static inline void let_sleep( wisp_world* world, wisp_entity e )
{
    SET_DEFAULT( world, e, sleep );
}

/// A damped sheet that falls on the floor.
static inline wisp_entity add_sheet( wisp_world* world, wisp_vec3 at, bool sleeps )
{
    test_mesh mesh = level_sheet( SIDE, 0.4f, at );
    const wisp_entity e = add_draping( world, &mesh, NULL, 0, EARTH );
    set_collision( world, e );
    assert_status( world, wisp_set_damping( world, e, 2.0f ), WISP_OK );
    if ( sleeps )
    {
        let_sleep( world, e );
    }
    return e;
}

static inline wisp_entity add_ball( wisp_world* world, wisp_vec3 at )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.05f;
    def.pose.translation = at;
    wisp_entity e;
    assert_status( world, wisp_add_collider( world, &def, &e ), WISP_OK );
    return e;
}

static inline void move_ball( wisp_world* world, wisp_entity ball, wisp_vec3 to )
{
    assert_status( world, wisp_move_collider( world, ball, ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, to } ),
                   WISP_OK );
}

/// @return steps until it sleeps
static inline int run_to_sleep( wisp_world* world, wisp_entity e )
{
    int steps = 0;
    for ( ; wisp_is_asleep( world, e ) == false; ++steps )
    {
        if ( steps == PATIENCE )
        {
            fail_msg( "entity %u does not fall asleep", e.index );
        }
        run_steps( world, 1, FRAME );
    }
    run_steps( world, 2, FRAME ); // derived rows are computed once more
    assert_true( wisp_is_asleep( world, e ) );
    return steps;
}

static inline int count_items( const wisp_world* world )
{
    int items = 0;
    const wisp_profile profile = wisp_world_profile( world );
    for ( int i = 0; i < profile.count; ++i )
    {
        items += profile.lines[i].items;
    }
    return items;
}

static inline void assert_wakes( wisp_world* world, wisp_entity e )
{
    run_steps( world, 1, FRAME );
    assert_false( wisp_is_asleep( world, e ) );
}

/// A world with one sheet, asleep, and a ball far above it.
typedef struct bed
{
    hosted h;
    wisp_world* world;
    wisp_entity sheet, ball;
} bed;

static inline void open_bed( bed* b, int workers )
{
    open_stage( &b->h, workers );
    b->world = b->h.world;
    b->ball = add_ball( b->world, ( wisp_vec3 ){ 0.0f, 2.0f, 0.0f } );
    b->sheet = add_sheet( b->world, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, true );
    run_to_sleep( b->world, b->sheet );
}

static inline void set_gravity( bed* b )
{
    assert_status( b->world, wisp_set_gravity( b->world, b->sheet, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ), WISP_OK );
}

static inline void set_velocity( bed* b )
{
    assert_status( b->world, wisp_set_velocity( b->world, b->sheet, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, NONE ),
                   WISP_OK );
}
