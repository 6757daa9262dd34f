/// Worlds that are built from scenes, and their steps.
#pragma once

#include "scene_fixture.h"

#include "world_from_scene.h"

typedef struct fixture
{
    wisp_scene scene;
    scene_world world;
    wisp_error error;
} fixture;

static inline wisp_status try_create( fixture* f, int workers )
{
    const scene_world_options options = { .workers = workers };
    return scene_world_create( &f->scene, &options, &f->world, &f->error );
}

static inline void create( fixture* f, int workers )
{
    assert_ok( try_create( f, workers ), f->error );
}

/// Parse a text, which must be a scene, and build its world, which may be rejected.
static inline wisp_status try_build( fixture* f, const char* text )
{
    *f = ( fixture ){ .scene = parsed( text ) };
    return try_create( f, 1 );
}

static inline void build( fixture* f, const char* text )
{
    *f = ( fixture ){ .scene = parsed( text ) };
    create( f, 1 );
}

/// Build the world of a scene of data/scenes.
static inline void open_scene( fixture* f, const char* file, int workers )
{
    *f = ( fixture ){ .scene = read_good( file ) };
    create( f, workers );
}

static inline void step( fixture* f, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( scene_world_step( &f->world, &f->error ) != WISP_OK )
        {
            fail_msg( "step %d: %s", i, f->error.message );
        }
    }
}

static inline void release( fixture* f )
{
    scene_world_destroy( &f->world );
    wisp_scene_release( &f->scene );
}

static inline void demand_refusal( const char* text, const char* message )
{
    fixture f;
    assert_int_equal( try_build( &f, text ), WISP_BAD_INPUT );
    assert_string_equal( f.error.message, message );
    assert_null( f.world.world );
    wisp_scene_release( &f.scene );
}
