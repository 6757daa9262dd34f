/// Valid scenes from text and from files.
#pragma once

#include "unit.h"

#include "scene.h"

/// Parse a text as the file of this name; paths in it are relative to the name.
static inline wisp_scene parsed_as( const char* name, const char* text )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_scene_parse( text, strlen( text ), name, &scene, &error ), error );
    return scene;
}

static inline wisp_scene parsed( const char* text )
{
    return parsed_as( "test.yaml", text );
}

/// Read a scene of data/scenes.
static inline wisp_scene read_good( const char* file )
{
    char path[1024];
    int length = snprintf( path, sizeof path, "%s/data/scenes/%s", WISP_SOURCE_ROOT, file );
    assert_true( length > 0 && (size_t)length < sizeof path );
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_scene_read( path, &scene, &error ), error );
    return scene;
}

static inline void assert_vector( wisp_vec3 v, float x, float y, float z )
{
    assert_true( v.x == x && v.y == y && v.z == z );
}
