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

static inline wisp_vec3 point_of( fixture* f, int body, int vertex )
{
    SCOPED( free_local )
    wisp_vec3* points = checked_calloc( (size_t)scene_world_body( &f->world, body ).vertex_count, sizeof *points );
    if ( scene_world_points( &f->world, body, points, &f->error ) != WISP_OK )
    {
        fail_msg( "no points: %s", f->error.message );
    }
    return points[vertex];
}

// Turns are made of a sine within 1e-7, and lengths here are below 10 m.
static inline void assert_point_at( wisp_vec3 v, float x, float y, float z )
{
    const float tolerance = 1e-5f;
    if ( !( fabsf( v.x - x ) < tolerance && fabsf( v.y - y ) < tolerance && fabsf( v.z - z ) < tolerance ) )
    {
        fail_msg( "(%g, %g, %g) is not (%g, %g, %g)", (double)v.x, (double)v.y, (double)v.z, (double)x, (double)y,
                  (double)z );
    }
}
